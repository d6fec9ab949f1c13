// Compares colours of single pixels with the formulas, evaluated here in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "libatlas/core/glm_bridge.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

class Plane : public ::testing::Test {
 protected:
  Plane() {
    add_quad(scene_, {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}});
    scene_.materials[0].diffuse = {0.6f, 0.4f, 0.2f};
    camera_.eye = {1, 3, 2};
    camera_.near_plane = 0.5;
    options_.width = options_.height = 65;  // odd, so that there is a pixel in the centre
    options_.map_resolution = 256;
    options_.shadows = ShadowMethod::classic;
  }
  // Returns the colour of the centre pixel, which sees the origin.
  std::array<int, 3> middle(const Vec3d& light) {
    Renderer r = must_render(scene_, options_);
    EXPECT_TRUE(r.draw(camera_, still(light)).ok());
    const Image8 image = r.read_image();
    const std::uint8_t* p = image.at(32, 32);
    return {p[0], p[1], p[2]};
  }
  Scene scene_;
  Camera camera_;
  RenderOptions options_;
};

TEST_F(Plane, Lambert) {
  const glm::dvec3 l = glm::normalize(glm::dvec3(1, 2, -1));
  const auto p = middle({1, 2, -1});
  const double light = options_.ambient + options_.intensity * l.y;
  EXPECT_NEAR(p[0], encoded(0.6 * light), 1.5);
  EXPECT_NEAR(p[1], encoded(0.4 * light), 1.5);
  EXPECT_NEAR(p[2], encoded(0.2 * light), 1.5);
}

TEST_F(Plane, SpecularTerms) {
  const glm::dvec3 n(0, 1, 0), v = glm::normalize(glm::dvec3(1, 3, 2));
  for (const glm::dvec3& l :
       {glm::normalize(glm::dvec3(-1, 3, -2)), glm::normalize(glm::dvec3(-1.4, 3, -1.5))}) {
    const glm::dvec3 h = glm::normalize(l + v);
    const double nl = glm::dot(n, l), nv = glm::dot(n, v), nh = glm::dot(n, h);
    options_.intensity = 0.5;
    options_.specular = 0.2;
    options_.shininess = 30;
    options_.roughness = 0.3;
    const double base = 0.4 * (options_.ambient + 0.5 * nl);
    options_.shading = Shading::blinn_phong;
    EXPECT_NEAR(middle(from_glm(l))[1], encoded(base + 0.5 * 0.2 * std::pow(nh, 30)), 1.5);
    options_.shading = Shading::ward;
    const double tangent = std::tan(std::acos(std::min(nh, 1.0)));
    const double ward = 0.2 * std::exp(-tangent * tangent / 0.09) /
                        (4 * std::numbers::pi * 0.09 * std::sqrt(nl * nv));
    EXPECT_NEAR(middle(from_glm(l))[1], encoded(base + 0.5 * ward * nl), 1.5);
  }
}

// The square of such a roughness is 0 as a float.
TEST_F(Plane, ASmoothPlaneIsNotBlack) {
  options_.shading = Shading::lambert;
  const int dull = middle({1, 2, 0})[1];
  options_.shading = Shading::ward;
  options_.roughness = 1e-25;
  EXPECT_EQ(middle({1, 2, 0})[1], dull);
}

TEST_F(Plane, ShadowsNeverDarkenTheAmbientTerm) {
  add_box(scene_, {-1, 1, -1}, {1, 1.1f, 1});
  camera_.eye = {3, 0.8, 2.4};
  for (Shading shading : {Shading::lambert, Shading::blinn_phong, Shading::ward}) {
    options_.shading = shading;
    EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.6 * options_.ambient), 1.5);
  }
}

TEST_F(Plane, BakedLightIsShownAndTheSunAdded) {
  scene_.illumination.assign(scene_.positions.size(), {200, 100, 50});
  options_.exposure = 0.5;
  options_.shading = Shading::unlit;
  // The scale puts the luminance of this uniform light at one.
  const double y = 0.2126 * 200 + 0.7152 * 100 + 0.0722 * 50;
  EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.5 * 0.6 * 200 / y), 1.5);
  options_.shading = Shading::lambert;
  EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.5 * 0.6 * (200 / y + options_.intensity)), 1.5);
}

// A floor that faces the light lies at one depth in the map, so only rounding can put points behind
// it. How far off they are depends on the size of a pixel. Only graphics hardware rounds
// enough to need the offset for it (LIBATLAS_GPU).
TEST_F(Plane, IsLitWhateverTheSizeOfAPixel) {
  options_.show_visibility = true;
  fit_planes(camera_, {{-4, 0, -4}, {4, 0, 4}});
  for (const ShadowMethod method : {ShadowMethod::classic, ShadowMethod::march})
    for (const int bits : {16, 24, 32})
      for (const int size : {5, 33, 65, 257}) {
        options_.shadows = method;
        options_.map_bits = bits;
        options_.width = options_.height = size;
        for (const double x : {0.2, 1.0, 7.0}) {
          camera_.eye = {x, 3, 2};
          Renderer r = must_render(scene_, options_);
          ASSERT_TRUE(r.draw(camera_, still({0, 1, 0})).ok());
          const Image8 image = r.read_image();
          const auto dark = std::count(image.texels.begin(), image.texels.end(), 0);
          EXPECT_EQ(dark, 0) << name_of(method) << ", " << bits << " bits, " << size << " pixels";
        }
      }
}

TEST_F(Plane, EmissionIsAddedToWhatIsReflected) {
  Material& m = scene_.materials[0];
  m.emission = {0.1f, 0, 3};
  options_.exposure = 0.5;
  options_.shading = Shading::unlit;
  EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.5 * (0.6 + 0.1)), 1.5);
  for (Shading shading : {Shading::lambert, Shading::ward}) {
    options_.shading = shading;
    const auto p = middle({0, -1, 0});  // the light is on the other side
    EXPECT_NEAR(p[0], encoded(0.5 * (0.6 * options_.ambient + 0.1)), 1.5);
    EXPECT_NEAR(p[1], encoded(0.5 * 0.4 * options_.ambient), 1.5);
    EXPECT_EQ(p[2], 255);
  }
  m.emission_textured = true;  // the texture is not read, and most of it may be dark
  EXPECT_NEAR(middle({0, -1, 0})[2], encoded(0.5 * 0.2 * options_.ambient), 1.5);
}

TEST_F(Plane, TexturesReflectOrShine) {
  Texture t;
  t.image = Image8(4, 4, 3, 128);  // sRGB 128 is 0.2158 linear
  scene_.textures.push_back(t);
  scene_.materials[0].texture = 0;
  scene_.texcoords = {{0, 0}};
  scene_.texcoord_indices.assign(scene_.indices.size(), 0);
  const double light = options_.ambient + options_.intensity;
  EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.6 * 0.2158 * light), 1.5);
  test_context();
  ViewSceneOptions baked;
  baked.textures_hold_light = true;
  const ViewScene view = *make_view_scene(scene_, baked);
  options_.shading = Shading::unlit;
  Result<Renderer> r = Renderer::make(view, options_);
  ASSERT_TRUE(r.ok());
  ASSERT_TRUE(r->draw(camera_, still({0, 1, 0})).ok());
  EXPECT_NEAR(*r->read_image().at(32, 32), encoded(0.6 * 0.2158), 1.5);
}

// KHR_materials_unlit: the colour is the factor times the texture.
TEST_F(Plane, UnlitMaterialsShowTheirColourTimesTheirTexture) {
  Scene plain = scene_;
  plain.materials[0].unlit = true;
  Scene textured = plain;
  textured.textures.resize(1);
  textured.textures[0].image = Image8(4, 4, 3, 128);  // 0.2158 linear
  textured.materials[0].texture = 0;
  textured.texcoords = {{0, 0}};
  textured.texcoord_indices.assign(textured.indices.size(), 0);
  // The other material of these scenes is out of view, so they are mixed.
  const auto mixed = [](Scene s) {
    add_quad(s, {{50, 0, 4}, {51, 0, 4}, {51, 0, 3}, {50, 0, 3}});
    s.materials.push_back(s.materials[0]);
    s.materials[1].unlit = false;
    std::fill_n(s.triangle_material.rbegin(), 2, 1u);
    if (s.textured()) s.texcoord_indices.resize(s.indices.size(), 0);
    return s;
  };
  for (const Shading shading : {Shading::unlit, Shading::lambert, Shading::ward}) {
    options_.shading = shading;
    scene_ = mixed(plain);
    EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.6), 1.5) << name_of(shading);
    scene_ = mixed(textured);
    EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.6 * 0.2158), 1.5) << name_of(shading);
    add_box(scene_, {-1, 1, -1}, {1, 1.1f, 1});  // shades the middle, unlit likewise
    scene_.texcoord_indices.resize(scene_.indices.size(), 0);
    camera_.eye = {3, 0.8, 2.4};
    EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.6 * 0.2158), 1.5) << name_of(shading);
    camera_.eye = {1, 3, 2};
  }
  // Where all is unlit, a sun that is asked for falls on the colours without their textures.
  options_.shading = Shading::lambert;
  scene_ = textured;
  EXPECT_NEAR(middle({0, 1, 0})[0], encoded(0.6 * (0.2158 + options_.intensity)), 1.5);
  options_.shading = Shading::unlit;
  EXPECT_NEAR(middle({0, 1, 0})[1], encoded(0.4 * 0.2158), 1.5);
  scene_ = plain;
  EXPECT_NEAR(middle({0, 1, 0})[1], encoded(0.4), 1.5);
}

// A cover over the floor, of a material of its own that the test sets.
class Cover : public Plane {
 protected:
  Cover() {
    add_quad(scene_, {{-2, 1, 2}, {2, 1, 2}, {2, 1, -2}, {-2, 1, -2}});
    scene_.materials.push_back({"cover", {0, 0, 0}});
    std::fill_n(scene_.triangle_material.rbegin(), 2, 1u);
    Texture t;
    t.image = Image8(4, 4, 4, 255);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 4; ++x) t.image.at(x, y)[3] = 100;
    scene_.textures.push_back(t);
    scene_.texcoords = {{0.5f, 0.5f}};
    scene_.texcoord_indices.assign(scene_.indices.size(), 0);
  }
  Material& cover() { return scene_.materials[1]; }
  // The floor's light under the cover, seen from beside it; for both methods that cast shadows.
  double floor_light() {
    camera_.eye = {3.5, 0.5, 0};
    options_.shading = Shading::lambert;
    return shown();
  }
  int shown() {
    options_.shadows = ShadowMethod::classic;
    const int one = middle({0, 1, 0})[0];
    options_.shadows = ShadowMethod::linear;
    EXPECT_EQ(middle({0, 1, 0})[0], one) << "maps in slices";
    return one;
  }
  double lit() const { return encoded(0.6 * (options_.ambient + options_.intensity)); }
  double shaded() const { return encoded(0.6 * options_.ambient); }
  // Whether the cover is seen from above: it is black, the floor is not.
  bool seen_from_above(Shading shading) {
    camera_.eye = {0.1, 4, 0};
    options_.shading = shading;
    return middle({1, 0.2, 0})[0] == 0;
  }
};

TEST_F(Cover, HolesOfAMaskAreSeenThroughAndLitThrough) {
  cover().texture = 0;  // alpha is 100 / 255
  EXPECT_NEAR(floor_light(), shaded(), 1.5) << "alpha means nothing";
  cover().alpha_mode = AlphaMode::mask;
  struct Case {
    float opacity, cutoff;
    bool hole;
  };
  for (const Case& c : {Case{1, 0.5f, true},
                        {1, 0.39f, false},
                        {0.9f, 0.39f, true},
                        {0, 0.5f, true},
                        {1, 0, false},
                        {1, 1.5f, true}}) {
    cover().opacity = c.opacity;
    cover().alpha_cutoff = c.cutoff;
    EXPECT_NEAR(floor_light(), c.hole ? lit() : shaded(), 1.5) << c.opacity << ' ' << c.cutoff;
    for (const Shading shading : {Shading::unlit, Shading::lambert})
      EXPECT_EQ(seen_from_above(shading), !c.hole) << c.opacity << ' ' << c.cutoff;
    options_.show_visibility = true;
    EXPECT_NEAR(floor_light(), c.hole ? 255 : 0, 1) << c.opacity << ' ' << c.cutoff;
    options_.show_visibility = false;
  }
}

TEST_F(Cover, AMaskWithoutATextureIsAllThereOrNotAtAll) {
  cover().alpha_mode = AlphaMode::mask;
  for (const float opacity : {0.4f, 0.6f}) {
    cover().opacity = opacity;
    EXPECT_NEAR(floor_light(), opacity < 0.5f ? lit() : shaded(), 1.5);
    EXPECT_EQ(seen_from_above(Shading::lambert), opacity > 0.5f);
  }
}

TEST_F(Cover, PanesAreOpaqueAndClearOnesCastNoShadow) {
  cover().alpha_mode = AlphaMode::blend;
  for (const float opacity : {0.05f, 0.6f}) {
    cover().opacity = opacity;
    EXPECT_NEAR(floor_light(), opacity < 0.5f ? lit() : shaded(), 1.5);
    EXPECT_TRUE(seen_from_above(Shading::lambert));
  }
}

TEST_F(Plane, TexturesGoOnBeyondTheirEdgesAsMaterialsSay) {
  Texture t;
  t.image = Image8(64, 64, 3, 0);  // its right half is white
  for (int y = 0; y < 64; ++y) std::fill_n(t.image.at(32, y), 32 * 3, std::uint8_t{255});
  scene_.textures.push_back(t);
  scene_.materials[0].texture = 0;
  scene_.materials[0].diffuse = {1, 1, 1};
  scene_.texcoord_indices.assign(scene_.indices.size(), 0);
  options_.shading = Shading::unlit;
  const auto shown = [&](TextureWrap wrap, float u) {
    scene_.materials[0].wrap_u = wrap;
    scene_.texcoords = {{u, 0.5f}};
    return middle({0, 1, 0})[0];
  };
  EXPECT_EQ(shown(TextureWrap::repeat, 1.25f), 0);
  EXPECT_EQ(shown(TextureWrap::clamp, 1.25f), 255);
  EXPECT_EQ(shown(TextureWrap::mirror, 1.25f), 255);
  EXPECT_EQ(shown(TextureWrap::mirror, 2.25f), 0);
  EXPECT_EQ(shown(TextureWrap::clamp, -0.25f), 0);
  EXPECT_EQ(shown(TextureWrap::repeat, -0.25f), 255);
}

// A dark chart, eight texels from bright ones, is seen at a grazing angle.
TEST_F(Plane, ChartsOfAPageDoNotMixFarAway) {
  Texture t;
  t.image = Image8(512, 512, 3, 255);
  for (int y = 0; y < 512; ++y) std::fill_n(t.image.at(0, y), 32 * 3, std::uint8_t{0});
  scene_.textures.push_back(t);
  Material& m = scene_.materials[0];
  m.texture = 0;
  m.wrap_u = m.wrap_v = TextureWrap::clamp;
  for (const std::uint32_t i : scene_.indices) {
    const Vec3f& p = scene_.positions[i];
    scene_.texcoord_indices.push_back(std::uint32_t(scene_.texcoords.size()));
    scene_.texcoords.push_back({(16 + 2 * p.x) / 512, (p.z + 4) / 8});
  }
  camera_.eye = {0, 0.3, 8};
  options_.shading = Shading::unlit;
  test_context();
  ViewSceneOptions baked;
  baked.textures_hold_light = true;
  const ViewScene view = *make_view_scene(scene_, baked);
  Result<Renderer> r = Renderer::make(view, options_);
  ASSERT_TRUE(r.ok());
  ASSERT_TRUE(r->draw(camera_, still({0, 1, 0})).ok());
  const Image8 image = r->read_image();
  for (int x = 22; x <= 42; ++x) EXPECT_LE(*image.at(x, 32), 1) << x;
}

// Dark values matter most: there a power of 1 / 2.2 differs most from sRGB.
TEST_F(Plane, BakedPagesAreShownAsTheyAreStored) {
  scene_.materials[0].texture = 0;
  scene_.materials[0].diffuse = {1, 1, 1};
  scene_.texcoords = {{0, 0}};
  scene_.texcoord_indices.assign(scene_.indices.size(), 0);
  test_context();
  ViewSceneOptions baked;
  baked.textures_hold_light = true;
  options_.shading = Shading::unlit;
  for (const int stored : {0, 1, 3, 6, 10, 12, 20, 40, 80, 128, 200, 254, 255}) {
    scene_.textures.resize(1);
    scene_.textures[0].image = Image8(4, 4, 3, static_cast<std::uint8_t>(stored));
    const ViewScene view = *make_view_scene(scene_, baked);
    Result<Renderer> r = Renderer::make(view, options_);
    ASSERT_TRUE(r.ok());
    ASSERT_TRUE(r->draw(camera_, still({0, 1, 0})).ok());
    EXPECT_NEAR(*r->read_image().at(32, 32), stored, 1);
  }
}

}  // namespace
}  // namespace atlas::testing
