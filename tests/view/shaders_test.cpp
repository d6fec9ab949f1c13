#include <gtest/gtest.h>

#include "libatlas/view/shaders.h"

namespace atlas {
namespace {

bool has(const std::string& text, const char* word) {
  return text.find(word) != std::string::npos;
}

// Returns the text after the uniform block, which all shaders share.
std::string body_of(const std::string& text) {
  return text.substr(text.find("} frame;"));
}

TEST(Shaders, NothingIsCompiledThatIsNotUsed) {
  for (Shading shading : {Shading::unlit, Shading::lambert, Shading::blinn_phong, Shading::ward})
    for (ShadowSampling shadow :
         {ShadowSampling::none, ShadowSampling::one, ShadowSampling::two, ShadowSampling::march})
      for (bool textured : {false, true})
        for (bool baked : {false, true}) {
          ShaderFeatures f;
          f.shading = shading;
          f.shadow = shadow;
          f.textured = textured;
          f.baked_vertices = baked;
          f.emission = textured != baked;
          f.lightmap = !baked;
          const ShaderText t = shader_text(f);
          const bool lit = shading != Shading::unlit;
          const bool shadows = lit && shadow != ShadowSampling::none;
          EXPECT_EQ(has(t.fragment, "sampler2D diffuse"), textured);
          EXPECT_EQ(has(t.vertex, "v_texcoord"), textured);
          EXPECT_EQ(has(t.vertex, "v_illumination"), baked);
          EXPECT_EQ(has(t.fragment, "v_illumination"), baked);
          EXPECT_EQ(has(t.vertex, "v_lightcoord"), f.lightmap);
          EXPECT_EQ(has(t.fragment, "sampler2D lightmap"), f.lightmap);
          EXPECT_EQ(has(t.fragment, "texture(lightmap, v_lightcoord)"), f.lightmap);
          EXPECT_EQ(has(t.vertex, "v_emission"), f.emission);
          EXPECT_EQ(has(t.fragment, "v_emission"), f.emission);
          EXPECT_EQ(has(t.vertex, "v_normal"), lit);
          EXPECT_EQ(has(t.fragment, "v_normal"), lit);
          EXPECT_EQ(!t.lighting_vertex.empty(), lit);
          EXPECT_EQ(!t.lighting_fragment.empty(), lit);
          // The first pass uses nothing of the moving light, the second nothing of the materials.
          for (const char* word : {"visibility_at(", "frame.light", "specular("})
            EXPECT_FALSE(has(body_of(t.fragment), word)) << word;
          for (const char* word : {"diffuse", "v_illumination", "v_colour", "v_emission",
                                   "v_texcoord", "v_lightcoord"})
            EXPECT_FALSE(has(t.lighting_fragment, word)) << word;
          const std::string& second = t.lighting_fragment;
          const bool march = shadows && shadow == ShadowSampling::march;
          EXPECT_EQ(has(second, "visibility_at("), shadows);
          EXPECT_EQ(has(second, "uniform sampler2DArrayShadow maps"), shadows);
          EXPECT_EQ(has(second, "frame.to_map1"), shadows && shadow != ShadowSampling::one);
          EXPECT_EQ(has(second, "uniform sampler2DArray depths"), march);
          EXPECT_EQ(has(second, "float specular("),
                    shading == Shading::blinn_phong || shading == Shading::ward);
          EXPECT_EQ(has(second, "exp("), shading == Shading::ward);
        }
}

// Only scenes of both kinds tell their materials apart, and the second pass then leaves some alone.
TEST(Shaders, UnlitMaterialsAreToldApartOnlyWhereTheyDiffer) {
  ShaderFeatures f;
  f.textured = true;
  for (const bool some : {false, true}) {
    f.some_unlit = some;
    const ShaderText t = shader_text(f);
    EXPECT_EQ(has(t.vertex, "in vec4 colour"), some);
    EXPECT_EQ(has(t.fragment, "bool unlit"), some);
    EXPECT_EQ(has(t.lighting_fragment, "surface.x).x < 0.0"), some);
  }
}

TEST(Shaders, VisibilityNeedsNoColours) {
  ShaderFeatures f;
  f.visibility = true;
  f.shadow = ShadowSampling::one;
  f.textured = true;
  f.baked_vertices = f.emission = f.lightmap = true;
  const ShaderText t = shader_text(f);
  for (const char* word :
       {"v_colour", "v_texcoord", "v_illumination", "v_emission", "v_lightcoord", "diffuse;"}) {
    EXPECT_FALSE(has(t.fragment, word)) << word;
    EXPECT_FALSE(has(t.vertex, word)) << word;
  }
}

TEST(Shaders, NamesTellWhatIsIn) {
  ShaderFeatures f;
  f.shading = Shading::unlit;
  f.shadow = ShadowSampling::march;
  EXPECT_EQ(feature_names(f), std::vector<std::string>{"unlit"});
  f.shading = Shading::ward;
  f.pcf = 5;
  f.textured = true;
  EXPECT_EQ(feature_names(f),
            (std::vector<std::string>{"ward", "march", "pcf 5", "diffuse textures"}));
  f.lightmap = true;
  EXPECT_EQ(feature_names(f).back(), "lightmap");
}

}  // namespace
}  // namespace atlas
