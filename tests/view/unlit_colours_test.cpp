// Colours of vertices of unlit glTF materials, from file to picture: the format multiplies base
// colours by COLOR_0.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "libatlas/view/play.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

using test::Gltf;
using test::TempFolder;
using LinearColour = std::array<double, 3>;

constexpr double kTexture = 0.2158;            // 128 of 255, decoded
constexpr LinearColour kFactor{0.75, 1, 0.5};  // of the material
constexpr double kFirstX = 0, kSecondX = 10;   // where the two squares are

// Two squares of one textured material, unlit or not, at both places. The argument of load() is
// attributes that only the first one has.
class Squares {
 public:
  using json = nlohmann::json;

  explicit Squares(bool unlit) {
    EXPECT_TRUE(write_png(folder_ / "t.png", Image8(2, 2, 3, 128), {}).ok());
    const std::string png = TempFolder::read(folder_ / "t.png");
    const int view = gltf.view(std::vector<char>(png.begin(), png.end()));
    gltf.j["images"] = json::array({{{"bufferView", view}, {"mimeType", "image/png"}}});
    gltf.j["textures"] = json::array({{{"source", 0}}});
    json material = {{"pbrMetallicRoughness",
                      {{"baseColorTexture", {{"index", 0}}},
                       {"baseColorFactor", {kFactor[0], kFactor[1], kFactor[2], 1}}}}};
    if (unlit) {
      material["extensions"]["KHR_materials_unlit"] = json::object();
      gltf.j["extensionsUsed"] = {"KHR_materials_unlit"};
    }
    gltf.j["materials"] = json::array({material});
  }

  Result<ViewScene> load(const json& first) {
    gltf.single(square(float(kFirstX), first));
    gltf.j["meshes"][0]["primitives"].push_back(square(float(kSecondX), json::object()));
    return load_view(folder_.write("t.glb", gltf.glb()), {}, {});
  }

  Gltf gltf;

 private:
  json square(float x, json attributes) {
    attributes["POSITION"] =
        gltf.floats({x - 1, -1, 0, x + 1, -1, 0, x + 1, 1, 0, x - 1, 1, 0}, "VEC3", 3);
    attributes["TEXCOORD_0"] = gltf.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
    return {{"attributes", attributes},
            {"indices", gltf.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})},
            {"material", 0}};
  }

  TempFolder folder_;
};

// Returns the colour in the middle of the square at x.
LinearColour seen(const ViewScene& view, double x, RenderOptions options) {
  test_context();
  options.width = options.height = 65;
  options.map_resolution = 64;
  Result<Renderer> renderer = Renderer::make(view, options);
  EXPECT_TRUE(renderer.ok()) << renderer.status().message();
  EXPECT_TRUE(renderer->draw({.eye = {x, 0, 3}, .target = {x, 0, 0}}, still({0, 0, 1})).ok());
  const Image8 image = renderer->read_image();
  const std::uint8_t* p = image.at(32, 32);
  return {double(p[0]), double(p[1]), double(p[2])};
}

void expect_near(const LinearColour& shown, const LinearColour& linear) {
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], encoded(linear[c]), 1.5) << c;
}

LinearColour times(double scale, const LinearColour& a, const LinearColour& b = {1, 1, 1}) {
  return {scale * a[0] * b[0], scale * a[1] * b[1], scale * a[2] * b[2]};
}

// The light of `first` is no light of unlit materials, whichever attribute gives it.
TEST(UnlitColours, MultiplyTheTexture) {
  const LinearColour left{0.25, 1, 0}, right{0.75, 0.5, 1}, middle{0.5, 0.75, 0.5};
  for (const bool bright : {false, true}) {
    Squares squares(true);
    std::vector<float> colours;
    for (const LinearColour* c : {&left, &right, &right, &left})
      for (const double v : *c) colours.push_back(float(v));
    nlohmann::json first = {{"COLOR_0", squares.gltf.floats(colours, "VEC3", 3)}};
    if (bright) first["_ILLUMINANCE"] = squares.gltf.floats(std::vector<float>(12, 300), "VEC3", 3);
    const Result<ViewScene> view = squares.load(first);
    ASSERT_TRUE(view.ok()) << view.status().message();
    ASSERT_EQ(view->unlit, Unlit::all);
    for (const Shading shading : {Shading::unlit, Shading::lambert}) {
      RenderOptions options;
      options.shading = shading;
      options.intensity = 0;
      expect_near(seen(*view, kFirstX, options), times(kTexture, kFactor, middle));
      expect_near(seen(*view, kSecondX, options), times(kTexture, kFactor));
    }
    // A sun that is asked for falls on what the colours reflect without the texture.
    RenderOptions options;
    options.shading = Shading::lambert;
    options.intensity = 0.5;
    expect_near(seen(*view, kFirstX, options), times(kTexture + 0.5, kFactor, middle));
  }
}

// Alpha does not matter here, and values beyond the format's range are limited to it.
TEST(UnlitColours, AreSharesOfIntegersAndLimited) {
  Squares bytes(true);
  std::vector<std::uint8_t> colours;
  for (int v = 0; v < 4; ++v) colours.insert(colours.end(), {51, 255, 102, 7});
  Result<ViewScene> view =
      bytes.load({{"COLOR_0", bytes.gltf.accessor({{"bufferView", bytes.gltf.view(colours)},
                                                   {"componentType", 5121},
                                                   {"normalized", true},
                                                   {"type", "VEC4"},
                                                   {"count", 4}})}});
  ASSERT_TRUE(view.ok()) << view.status().message();
  RenderOptions options;
  options.shading = Shading::unlit;
  expect_near(seen(*view, kFirstX, options), times(kTexture, kFactor, {0.2, 1, 0.4}));
  Squares wild(true);
  std::vector<float> values;
  for (int v = 0; v < 4; ++v) values.insert(values.end(), {4, -2, NAN});
  view = wild.load({{"COLOR_0", wild.gltf.floats(values, "VEC3", 3)}});
  ASSERT_TRUE(view.ok()) << view.status().message();
  expect_near(seen(*view, kFirstX, options), times(kTexture, kFactor, {1, 0, 0}));
}

// Of other materials, COLOR_0 is light, which is exposed.
TEST(UnlitColours, AreLightOfOtherMaterials) {
  Squares squares(false);
  const Result<ViewScene> view =
      squares.load({{"COLOR_0", squares.gltf.floats(std::vector<float>(12, 0.25f), "VEC3", 3)}});
  ASSERT_TRUE(view.ok()) << view.status().message();
  RenderOptions options;
  options.shading = Shading::unlit;
  expect_near(seen(*view, kFirstX, options), times(kTexture, kFactor));
}

// A texture that only the caller calls unlit holds all light: that of the vertices is not added.
TEST(UnlitColours, AreNotThoseOfTexturesThatHoldLight) {
  Scene scene;
  scene.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  scene.indices = {0, 1, 2};
  scene.texcoords = {{0, 0}};
  scene.texcoord_indices = {0, 0, 0};
  scene.textures.push_back({"t", Image8(2, 2, 3, 128)});
  scene.materials.resize(1);
  scene.materials[0].texture = 0;
  scene.triangle_material = {0};
  scene.unlit_colours.assign(3, {0.5f, 0.5f, 0.5f});
  const Result<ViewScene> view = make_view_scene(scene, {.textures_hold_light = true});
  ASSERT_TRUE(view.ok()) << view.status().message();
  EXPECT_EQ(view->colours, std::vector<Vec3f>(3, {1, 1, 1}));
}

}  // namespace
}  // namespace atlas::testing
