// Masks that are finer than pixels and texels of shadow maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "libatlas/view/mask_colours.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

// A floor, and a cover over it whose texture of 4 x 4 texels has `opaque` rows of green; the others
// are white and transparent. It is repeated `times` along each axis.
Scene covered_floor(int opaque, float times) {
  Scene s;
  add_quad(s, {{-4, 0, 4}, {4, 0, 4}, {4, 0, -4}, {-4, 0, -4}});
  add_quad(s, {{-2, 1, 2}, {2, 1, 2}, {2, 1, -2}, {-2, 1, -2}});
  s.materials[0].diffuse = {0, 0, 0};
  s.materials.push_back({"grid", {1, 1, 1}});
  s.materials[1].alpha_mode = AlphaMode::mask;
  s.materials[1].texture = 0;
  std::fill_n(s.triangle_material.rbegin(), 2, 1u);
  Texture t;
  t.image = Image8(4, 4, 4, 255);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x) {
      std::uint8_t* texel = t.image.at(x, y);
      if (y < opaque)
        texel[0] = texel[2] = 0;
      else
        texel[3] = 0;
    }
  s.textures.push_back(t);
  for (const Vec3f& p : s.positions) s.texcoords.push_back({p.x / 4 * times, p.z / 4 * times});
  s.texcoord_indices = s.indices;
  return s;
}

RenderOptions small_with(ShadowMethod method) {
  RenderOptions o;
  o.width = o.height = 64;
  o.map_resolution = 256;
  o.shadows = method;
  return o;
}

Image8 picture(const Scene& scene, const Camera& camera, const RenderOptions& options) {
  Renderer r = must_render(scene, options);
  EXPECT_TRUE(r.draw(camera, still({0, 1, 0})).ok());
  return r.read_image();
}

// Returns a camera that sees the cover alone, or from below it (at y = 1) its shadow alone.
Camera over(double height) {
  Camera c;
  c.eye = {0, height, 0};
  c.target = {0, height - 1, 0};
  c.up = {0, 0, -1};
  c.near_plane = 0.1;
  c.far_plane = 10;
  return c;
}

TEST(Mask, WhatIsFinerThanATexelOfTheMapCastsItsShareOfShadow) {
  for (int opaque : {1, 2, 3})
    for (float times : {61.3f, 149.7f})
      for (const ShadowMethod method : {ShadowMethod::classic, ShadowMethod::march}) {
        RenderOptions o = small_with(method);
        o.show_visibility = true;
        const Image8 image = picture(covered_floor(opaque, times), over(0.9), o);
        double sum = 0;
        for (const std::uint8_t v : image.texels) sum += v / 255.0;
        EXPECT_NEAR(sum / double(image.texels.size()), 1 - opaque / 4.0, 0.12)
            << opaque << ", " << times << ", " << name_of(method);
      }
}

TEST(Mask, WhatIsFinerThanAPixelIsSeenByItsShareInItsOwnColour) {
  for (int opaque : {1, 2, 3})
    for (const Shading shading : {Shading::unlit, Shading::lambert}) {
      RenderOptions o = small_with(ShadowMethod::none);
      o.shading = shading;
      const Image8 image = picture(covered_floor(opaque, 149.7f), over(2.5), o);
      int seen = 0;
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
          const std::uint8_t* p = image.at(x, y);
          EXPECT_LE(p[0], 1) << "no white of what the mask leaves out";
          seen += p[1] > 127;
        }
      EXPECT_NEAR(seen / 4096.0, opaque / 4.0, 0.12) << opaque;
    }
}

TEST(Mask, WhereATextureIsOpaqueElsewhereItsColoursStay) {
  Scene s = covered_floor(2, 149.7f);
  add_quad(s, {{-2, 2, 2}, {2, 2, 2}, {2, 2, -2}, {-2, 2, -2}});
  s.materials.push_back({"opaque", {1, 1, 1}});
  s.materials[2].texture = 0;
  std::fill_n(s.triangle_material.rbegin(), 2, 2u);
  s.texcoords.push_back({0.5f, 0.75f});  // white
  s.texcoord_indices.resize(s.indices.size(), std::uint32_t(s.texcoords.size() - 1));
  RenderOptions o = small_with(ShadowMethod::none);
  o.shading = Shading::unlit;
  const Image8 image = picture(s, over(3), o);
  EXPECT_EQ(image.at(32, 32)[0], 255);
}

using Bytes = std::vector<std::uint8_t>;

TEST(MaskColours, AreThoseOfTheOpaqueTexelsAround) {
  Bytes rgba(5 * 3 * 4, 255);  // white and opaque
  for (int i = 0; i < 15; ++i) rgba[4 * std::size_t(i) + 3] = 127;
  const auto set = [&](int x, int y, Bytes texel) {
    std::copy(texel.begin(), texel.end(), rgba.begin() + 4 * (5 * y + x));
  };
  set(0, 0, {10, 20, 30, 255});
  set(4, 2, {50, 60, 70, 128});
  spread_mask_colours(rgba, 5, 3, 128);
  const auto at = [&](int x, int y) {
    const auto t = rgba.begin() + 4 * (5 * y + x);
    return Bytes(t, t + 4);
  };
  EXPECT_EQ(at(0, 0), (Bytes{10, 20, 30, 255}));
  EXPECT_EQ(at(1, 1), (Bytes{10, 20, 30, 127}));
  EXPECT_EQ(at(3, 1), (Bytes{10, 20, 30, 127})) << "the same quarter of the image";
  EXPECT_EQ(at(4, 2), (Bytes{50, 60, 70, 128}));
  EXPECT_EQ(at(4, 0), (Bytes{50, 60, 70, 127}));
}

TEST(MaskColours, StayWhereNothingIsOpaque) {
  for (const auto& [w, h] : {std::pair{1, 1}, {4, 2}}) {
    Bytes rgba(std::size_t(4 * w * h), 9);
    spread_mask_colours(rgba, w, h, 10);
    EXPECT_EQ(rgba, Bytes(rgba.size(), 9));
  }
}

}  // namespace
}  // namespace atlas::testing
