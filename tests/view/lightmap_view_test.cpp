// Scenes whose light is in a lightmap look as if it were at their vertices.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/srgb.h"
#include "libatlas/image/image_io.h"
#include "libatlas/view/play.h"
#include "libatlas/view/start_camera.h"
#include "tests/support/gltf_maker.h"
#include "tests/view/play_folder.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

Image8 picture(const ViewScene& view, const Camera& camera, const RenderOptions& options,
               const Vec3d& light = {1, 2, -0.5}) {
  test_context();
  Result<Renderer> r = Renderer::make(view, options);
  EXPECT_TRUE(r.ok()) << r.status().message();
  EXPECT_TRUE(r->draw(camera, still(light)).ok());
  return r->read_image();
}

int largest_difference(const Image8& a, const Image8& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    most = std::max(most, std::abs(int(a.texels[i]) - int(b.texels[i])));
  return most;
}

// Gives each triangle a light of its own, the same at all of its corners.
void light_up(Scene& scene) {
  scene.illumination.resize(scene.positions.size());
  for (std::size_t k = 0; k < scene.indices.size(); ++k) {
    const auto t = float(k / 3 * 37 % 100);
    scene.illumination[scene.indices[k]] = {20 + 7 * t, 30 + 4 * t, 300 - 2 * t};
  }
}

// Moves such light onto pages of a lightmap, a texel for each triangle, in turn.
Scene on_lightmap(Scene scene, std::size_t pages) {
  auto map = std::make_shared<SceneLightmap>();
  constexpr int kSide = 64;
  map->pages.resize(pages, ImageF(kSide, kSide, 3));
  for (std::uint32_t t = 0; t < scene.triangle_count(); ++t) {
    const std::size_t page = t % pages, texel = t / pages;
    const Vec3f e = scene.illumination[scene.indices[3 * t]];
    const int x = int(texel % kSide), y = int(texel / kSide);
    EXPECT_LT(y, kSide);
    std::copy_n(&e.x, 3, map->pages[page].at(x, y));
    map->triangle_page.push_back(std::uint32_t(page));
    map->texcoord_indices.insert(map->texcoord_indices.end(), 3, t);
    map->texcoords.push_back({(float(x) + 0.5f) / kSide, (float(y) + 0.5f) / kSide});
  }
  scene.illumination.clear();
  scene.lightmap = std::move(map);
  return scene;
}

// Gives the triangles two materials, of which one has a texture.
void paint(Scene& scene) {
  scene.materials.push_back({"textured", {0.9f, 0.5f, 0.7f}, 0});
  scene.materials[0].diffuse = {0.4f, 0.6f, 0.8f};
  scene.textures.resize(1);
  scene.textures[0].image = Image8(8, 8, 3, 200);
  for (int i = 0; i < 8; ++i) std::fill_n(scene.textures[0].image.at(i, i), 3, std::uint8_t{90});
  scene.texcoords = {{0, 0}, {1, 0}, {0, 1}};
  for (std::uint32_t k = 0; k < scene.indices.size(); ++k) {
    scene.texcoord_indices.push_back(k % 3);
    scene.triangle_material[k / 3] = k / 3 % 2;
  }
}

TEST(LightmapView, LooksLikeLightAtTheVertices) {
  RenderOptions o = small();
  o.width = 160;
  o.height = 120;
  for (const bool textured : {false, true})
    for (const std::size_t pages : {1, 2}) {
      View v = courtyard_view();
      light_up(v.scene);
      if (textured) paint(v.scene);
      const ViewScene at_vertices = *make_view_scene(v.scene, {}),
                      mapped = *make_view_scene(on_lightmap(v.scene, pages), {});
      EXPECT_TRUE(mapped.illumination.empty());
      EXPECT_TRUE(mapped.baked());
      EXPECT_NEAR(mapped.light_scale, at_vertices.light_scale, 1e-6 * mapped.light_scale);
      for (const Shading shading : {Shading::unlit, Shading::lambert, Shading::ward}) {
        o.shading = shading;
        const Image8 one = picture(at_vertices, v.camera, o), two = picture(mapped, v.camera, o);
        EXPECT_LE(largest_difference(one, two), 1) << pages << ' ' << name_of(shading);
        EXPECT_GT(*std::max_element(one.texels.begin(), one.texels.end()), 100);
      }
      o.show_visibility = true;
      EXPECT_EQ(picture(mapped, v.camera, o).texels, picture(at_vertices, v.camera, o).texels);
      o.show_visibility = false;
    }
}

TEST(LightmapView, StartsWhereTheSameLightAtTheVerticesDoes) {
  Scene scene = room();
  light_up(scene);
  paint(scene);
  const ViewScene at_vertices = *make_view_scene(scene, {}),
                  mapped = *make_view_scene(on_lightmap(scene, 2), {});
  const Camera one = start_camera(at_vertices, {0, 1, 0}, 60),
               two = start_camera(mapped, {0, 1, 0}, 60);
  EXPECT_EQ(one.eye, two.eye);
  EXPECT_EQ(one.target, two.target);
}

TEST(LightmapView, ThePlanNamesIt) {
  View v = courtyard_view();
  light_up(v.scene);
  test_context();
  const ViewScene view = *make_view_scene(on_lightmap(v.scene, 1), {});
  for (const bool visibility : {false, true}) {
    RenderOptions o = small();
    o.show_visibility = visibility;
    const auto plan = Renderer::make(view, o)->plan();
    EXPECT_EQ(plan[0].find("lightmap") != std::string::npos, !visibility) << plan[0];
    for (const std::string& line : plan) EXPECT_EQ(line.find("no baked light"), line.npos) << line;
  }
}

// A floor seen from above, by the camera of a picture of 65 x 65 pixels.
class MappedFloor : public ::testing::Test {
 protected:
  MappedFloor() {
    add_quad(scene_, {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}}, 8);
    scene_.materials[0].diffuse = {0.6f, 0.4f, 0.2f};
    camera_.eye = {1, 3, 2};
    camera_.near_plane = 0.5;
    options_ = small();
    options_.width = options_.height = 65;
    options_.shading = Shading::unlit;
  }
  // Lays the scene on a page, as seen from above.
  void lay_on(ImageF page) {
    auto map = std::make_shared<SceneLightmap>();
    const auto w = float(page.width), h = float(page.height);
    for (const std::uint32_t i : scene_.indices) {
      const Vec3f& p = scene_.positions[i];
      map->texcoord_indices.push_back(std::uint32_t(map->texcoords.size()));
      map->texcoords.push_back(
          {(0.5f + (w - 1) * (p.x + 4) / 8) / w, (0.5f + (h - 1) * (p.z + 4) / 8) / h});
    }
    map->triangle_page.assign(scene_.triangle_count(), 0);
    map->pages.push_back(std::move(page));
    scene_.lightmap = map;
  }
  ViewScene view() const { return *make_view_scene(scene_, {}); }
  std::array<int, 3> middle(const Vec3d& light = {0, 1, 0}) const {
    const Image8 image = picture(view(), camera_, options_, light);
    const std::uint8_t* p = image.at(32, 32);
    return {p[0], p[1], p[2]};
  }
  Scene scene_;
  Camera camera_;
  RenderOptions options_;
};

// Light that grows evenly is the same between vertices and between texels.
TEST_F(MappedFloor, TexelsAreInterpolated) {
  Scene at_vertices = scene_;
  for (const Vec3f& p : scene_.positions)
    at_vertices.illumination.push_back({100 + 20 * p.x, 60 + 10 * p.z, 40});
  ImageF page(9, 5, 3);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) {
      const float rgb[3] = {100 + 20 * float(x - 4), 60 + 20 * float(y - 2), 40};
      std::copy_n(rgb, 3, page.at(x, y));
    }
  lay_on(std::move(page));
  for (const Shading shading : {Shading::unlit, Shading::lambert}) {
    options_.shading = shading;
    EXPECT_LE(largest_difference(picture(view(), camera_, options_),
                                 picture(*make_view_scene(at_vertices, {}), camera_, options_)),
              1);
  }
}

TEST_F(MappedFloor, TheSunIsAddedWithItsShadows) {
  lay_on(ImageF(4, 4, 3, 50));
  options_.exposure = 0.5;
  options_.baked_strength = 0.7;
  EXPECT_NEAR(middle()[0], encoded(0.5 * 0.6 * 0.7), 1.5);
  options_.shading = Shading::lambert;
  EXPECT_NEAR(middle()[0], encoded(0.5 * 0.6 * (0.7 + options_.intensity)), 1.5);
  add_box(scene_, {-1, 1, -1}, {1, 1.1f, 1});
  lay_on(ImageF(4, 4, 3, 50));
  camera_.eye = {3, 0.8, 2.4};
  EXPECT_NEAR(middle()[0], encoded(0.5 * 0.6 * 0.7), 1.5);
}

// Half floats, in which pages are stored, end at 65504 and 6e-8.
TEST_F(MappedFloor, LightOfAnyUnitIsShown) {
  for (const float light : {1e-30f, 1e-3f, 1e6f, 1e30f}) {
    lay_on(ImageF(4, 4, 3, light));
    EXPECT_NEAR(middle()[0], encoded(0.6), 1.5) << light;
  }
  ImageF page(4, 4, 3, -5);  // it is kept, but shown as none
  lay_on(page);
  EXPECT_EQ(middle()[0], 0);
}

// Of a floor that has both, vertices have no part; of one that is off the lightmap, they have all.
TEST_F(MappedFloor, VerticesHaveTheLightOfWhatIsOffTheLightmap) {
  scene_.illumination.assign(scene_.positions.size(), {100, 100, 100});
  lay_on(ImageF(4, 4, 3, 50));
  EXPECT_TRUE(view().illumination.empty()) << "memory for nothing";
  EXPECT_NEAR(middle()[0], encoded(0.6), 1.5);
  auto map = std::make_shared<SceneLightmap>(*scene_.lightmap);
  const auto off = [&](std::size_t triangle) {
    std::fill_n(map->texcoord_indices.begin() + std::ptrdiff_t(3 * triangle), 3,
                Scene::kNoTexcoord);
  };
  for (const std::size_t t : {0, 1}) off(t);  // in a corner of the floor
  scene_.lightmap = map;
  EXPECT_EQ(view().illumination.size(), view().positions.size());
  EXPECT_NEAR(middle()[0], encoded(0.6 * 50 / 100), 1.5);  // over 1 % has 100
  map = std::make_shared<SceneLightmap>(*map);
  for (std::size_t t = 0; t < scene_.triangle_count() - 1; ++t) off(t);
  scene_.lightmap = map;
  EXPECT_NEAR(middle()[0], encoded(0.6), 1.5);
  scene_.illumination.clear();
  EXPECT_EQ(middle()[0], 0);
  off(scene_.triangle_count() - 1);
  scene_.lightmap = map;
  EXPECT_FALSE(view().lightmap) << "memory for nothing";
  EXPECT_FALSE(view().baked());
}

// More texels than any driver takes.
TEST_F(MappedFloor, ImagesThatAreTooLargeAreNamed) {
  constexpr int kMany = 1 << 20;
  test_context();
  const auto error = [&] { return Renderer::make(view(), options_).status(); };
  lay_on(ImageF(kMany, 1, 3, 1));
  EXPECT_EQ(error().code(), ErrorCode::unsupported);
  EXPECT_EQ(error().message().find("page 0 of the lightmap has 1048576 x 1 texels; the driver"), 0u)
      << error().message();
  EXPECT_NE(error().message().find("(resize the image)"), std::string::npos);
  scene_.lightmap = nullptr;
  Texture wide;
  wide.path = "wide.png";
  wide.image = Image8(kMany, 1, 3, 128);
  scene_.textures.push_back(wide);
  scene_.materials[0].texture = 0;
  scene_.texcoords = {{0, 0}};
  scene_.texcoord_indices.assign(scene_.indices.size(), 0);
  EXPECT_EQ(error().message().find("wide.png: the texture has 1048576 x 1 texels; the driver"), 0u)
      << error().message();
}

TEST_F(MappedFloor, UnlitMaterialsShowTheirOwnLight) {
  Texture t;
  t.image = Image8(4, 4, 3, 128);  // 0.2158 linear
  scene_.textures.push_back(t);
  scene_.materials.push_back(scene_.materials[0]);
  Material& m = scene_.materials[1];
  m.unlit = true;
  std::fill(scene_.triangle_material.begin(), scene_.triangle_material.end() - 2, 1u);
  scene_.texcoords = {{0, 0}};
  scene_.texcoord_indices.assign(scene_.indices.size(), 0);
  lay_on(ImageF(4, 4, 3, 50));
  for (const bool textured : {false, true}) {
    m.texture = textured ? 0 : -1;
    for (const Shading shading : {Shading::unlit, Shading::lambert}) {
      options_.shading = shading;
      EXPECT_NEAR(middle()[0], encoded(textured ? 0.6 * 0.2158 : 0.6), 1.5) << name_of(shading);
    }
  }
  scene_.triangle_material.assign(scene_.triangle_count(), 1);
  EXPECT_FALSE(view().lightmap);
}

// A dark chart, eight texels from bright ones, is seen at a grazing angle.
TEST_F(MappedFloor, ChartsDoNotMixFarAway) {
  ImageF page(512, 512, 3, 100);
  for (int y = 0; y < 512; ++y) std::fill_n(page.at(0, y), 32 * 3, 0.0f);
  lay_on(std::move(page));
  auto map = std::make_shared<SceneLightmap>(*scene_.lightmap);
  for (std::size_t k = 0; k < scene_.indices.size(); ++k)
    map->texcoords[k].x = (16 + 2 * scene_.positions[scene_.indices[k]].x) / 512;
  map->texcoords.push_back({0.5f, 0.5f});  // a bright triangle, out of view
  std::fill_n(map->texcoord_indices.end() - 3, 3, std::uint32_t(map->texcoords.size() - 1));
  scene_.lightmap = map;
  camera_.eye = {0, 0.3, 8};
  const Image8 image = picture(view(), camera_, options_);
  for (int x = 22; x <= 42; ++x) EXPECT_LE(*image.at(x, 32), 1) << x;
}

// From file to picture: a square of a material of 0.6, lit by 0.2158 x 80.
class LightmapFiles : public Folder {
 protected:
  LightmapFiles() {
    const float light = 80 * srgb_decode8(128);
    EXPECT_TRUE(write_png(path_ / "lit_0.png", Image8(4, 4, 3, 128), {}).ok());
    EXPECT_TRUE(write_exr(path_ / "lit_0.exr", ImageF(4, 4, 3, light)).ok());
    const int uvs = gltf_.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
    gltf_.single({{"attributes",
                   {{"POSITION", gltf_.floats({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3", 3)},
                    {"TEXCOORD_1", uvs}}},
                  {"indices", gltf_.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})},
                  {"material", 0}});
    gltf_.j["materials"] =
        json::array({{{"pbrMetallicRoughness", {{"baseColorFactor", {0.6, 0.6, 0.6, 1}}}}}});
  }
  using json = nlohmann::json;
  ViewScene load(const json& map) {
    gltf_.j["asset"]["extras"]["lightmap"] = map;
    std::ofstream(path_ / "lit.glb", std::ios::binary) << gltf_.glb();
    Context context;
    context.warn = [&](std::string_view line) { said_.emplace_back(line); };
    Result<ViewScene> view = load_view(path_ / "lit.glb", {}, context);
    EXPECT_TRUE(view.ok()) << view.status().message();
    return std::move(view.value());
  }
  static int middle(const ViewScene& view) {
    RenderOptions o = small();
    o.shading = Shading::unlit;
    o.exposure = 0.5;
    Camera camera;
    camera.eye = {0, 0, 2};
    return *picture(view, camera, o).at(24, 16);
  }
  test::Gltf gltf_;
  std::vector<std::string> said_;
};

TEST_F(LightmapFiles, PicturesOfBothKindsOfImagesAreAlike) {
  const ViewScene bytes = load({{"images", {"lit_0.png"}}, {"texCoord", 1}, {"white", 80}});
  const ViewScene floats =
      load({{"images", {"gone.png"}}, {"linear", {"lit_0.exr"}}, {"texCoord", 1}, {"white", 80}});
  EXPECT_TRUE(said_.empty()) << said_[0];
  EXPECT_NEAR(middle(bytes), encoded(0.5 * 0.6 * srgb_decode8(128)), 1.5);
  EXPECT_NEAR(middle(floats), middle(bytes), 1);
  const auto& files = bytes.files;  // which pictures must not replace
  EXPECT_NE(std::find(files.begin(), files.end(), path_ / "lit_0.png"), files.end());
}

// Half of the map is brighter than white, which the PNG clips.
TEST_F(LightmapFiles, BothKindsOfImagesAreExposedByTheirWhite) {
  ImageF light(4, 4, 3, 20);
  Image8 codes(4, 4, 3, std::uint8_t(std::lround(encoded(0.25))));
  for (int y = 0; y < 4; ++y) {
    std::fill_n(light.at(2, y), 6, 900.0f);
    std::fill_n(codes.at(2, y), 6, std::uint8_t{255});
  }
  ASSERT_TRUE(write_exr(path_ / "lit_0.exr", light).ok());
  ASSERT_TRUE(write_png(path_ / "lit_0.png", codes, {}).ok());
  json map{{"images", {"lit_0.png"}}, {"texCoord", 1}, {"white", 80}};
  const ViewScene bytes = load(map);
  map["linear"] = {"lit_0.exr"};
  const ViewScene floats = load(map);
  RenderOptions o = small();
  o.shading = Shading::unlit;
  Camera camera;
  camera.eye = {0, 0, 2};
  const Image8 clipped = picture(bytes, camera, o), whole = picture(floats, camera, o);
  EXPECT_NEAR(*clipped.at(18, 16), encoded(0.6 * 0.25), 1.5);
  EXPECT_NEAR(*whole.at(18, 16), encoded(0.6 * 0.25), 1.5);
  EXPECT_NEAR(*clipped.at(30, 16), encoded(0.6), 1.5);
  EXPECT_EQ(*whole.at(30, 16), 255) << "0.6 x 900 is far above white";
}

TEST_F(LightmapFiles, WithoutAWhiteTheLightIsMeasured) {
  const json map{{"linear", {"lit_0.exr"}}, {"texCoord", 1}};
  const ViewScene view = load(map);
  EXPECT_NEAR(view.light_scale * 80 * srgb_decode8(128), 1, 1e-3);  // a page of half floats
  EXPECT_NEAR(middle(view), encoded(0.5 * 0.6), 1.5);
}

TEST_F(LightmapFiles, WithoutItsImagesASceneIsShownAsOneWithoutLight) {
  const ViewScene view = load({{"images", {"gone.png"}}, {"texCoord", 1}});
  ASSERT_EQ(said_.size(), 1u);
  EXPECT_NE(said_[0].find("gone.png"), std::string::npos) << said_[0];
  EXPECT_FALSE(view.baked());
  EXPECT_NEAR(middle(view), encoded(0.5 * 0.6), 1.5);
}

}  // namespace
}  // namespace atlas::testing
