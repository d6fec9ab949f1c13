#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <set>
#include <string_view>
#include <tuple>
#include <vector>

#include "libatlas/scene/check_scene.h"
#include "libatlas/view/start_camera.h"
#include "libatlas/view/view_scene.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

TEST(ViewScene, EveryTriangleIsInOneClusterAndInItsBall) {
  for (const Scene& scene : {courtyard(), room(), pavilion()})
    for (std::uint32_t size : {1u, 7u, 512u}) {
      ViewSceneOptions o;
      o.cluster_triangles = size;
      const ViewScene v = *make_view_scene(scene, o);
      EXPECT_EQ(v.indices.size(), scene.indices.size());
      EXPECT_EQ(v.caster_indices.size(), scene.indices.size());
      std::uint32_t next = 0;
      for (const ViewScene::Cluster& c : v.clusters) {
        EXPECT_EQ(c.first, next);
        EXPECT_LE(c.count, 3 * size);
        next = c.first + c.count;
        for (std::uint32_t i = c.first; i < next; ++i) {
          const Vec3f p = v.positions[v.indices[i]];
          EXPECT_LE(std::hypot(p.x - c.centre.x, p.y - c.centre.y, p.z - c.centre.z), c.radius);
        }
      }
      EXPECT_EQ(next, v.indices.size());
    }
}

// Both must have the same multiset of triangles, by position, in whatever order they are drawn.
TEST(ViewScene, DrawsAndCastsTheTrianglesOfTheScene) {
  const Scene scene = room();
  const ViewScene v = *make_view_scene(scene, {});
  using Corner = std::tuple<float, float, float>;
  const auto triangles = [](const std::vector<Vec3f>& p, const std::vector<std::uint32_t>& index) {
    std::multiset<std::vector<Corner>> all;
    for (std::size_t t = 0; t < index.size(); t += 3) {
      std::vector<Corner> c;
      for (int k = 0; k < 3; ++k)
        c.emplace_back(p[index[t + k]].x, p[index[t + k]].y, p[index[t + k]].z);
      all.insert(c);
    }
    return all;
  };
  const auto wanted = triangles(scene.positions, scene.indices);
  EXPECT_EQ(triangles(v.positions, v.indices), wanted);
  EXPECT_EQ(triangles(v.caster_positions, v.caster_indices), wanted);
}

// Each facet at the tip was once compared with all others, which took a minute for half as many.
TEST(ViewScene, ATipOfManyFacetsTakesNoMinutes) {
  constexpr std::uint32_t kFacets = 100000;
  Scene cone;
  cone.positions.push_back({0, 1, 0});
  for (std::uint32_t i = 0; i < kFacets; ++i) {
    const double angle = 2 * glm::radians(180.0) * i / kFacets;
    cone.positions.push_back({float(std::cos(angle)), 0, float(std::sin(angle))});
    cone.indices.insert(cone.indices.end(), {0u, 1 + (i + 1) % kFacets, 1 + i});
  }
  ASSERT_TRUE(complete_scene(cone).ok());
  const ViewScene v = *make_view_scene(cone, {});
  EXPECT_EQ(v.indices.size(), cone.indices.size());
  for (const Vec3f& n : v.normals) EXPECT_NEAR(n.y, std::sqrt(0.5), 1e-3);
}

TEST(ViewScene, NormalsAreFlatOnBoxesAndRadialOnSpheresAtEveryScale) {
  for (float scale : {1e-25f, 1e-4f, 1.0f, 1e4f, 1e25f}) {
    Scene box, sphere;
    add_box(box, {-scale, -scale, -scale}, {scale, scale, scale});
    add_sphere(sphere, {0, 0, 0}, scale, 24);
    const ViewScene b = *make_view_scene(box, {}), s = *make_view_scene(sphere, {});
    for (const Vec3f& n : b.normals)
      EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-6);
    EXPECT_EQ(b.positions.size(), 24u) << "a corner of a box has three normals";
    EXPECT_EQ(b.caster_positions.size(), 8u);
    for (std::size_t i = 0; i < s.normals.size(); ++i) {
      const Vec3f p = s.positions[i], n = s.normals[i];
      EXPECT_GT((p.x * n.x + p.y * n.y + p.z * n.z) / scale, 0.99);
    }
  }
}

TEST(ViewScene, KeepsLightAndTexcoordsAtTheirVertices) {
  Scene s;
  add_quad(s, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  for (std::size_t i = 0; i < s.positions.size(); ++i) {
    const Vec3f p = s.positions[i];
    s.illumination.push_back({100 * p.x, 50 * p.y, 1});
    s.texcoords.push_back({p.x, p.y});
    s.texcoord_indices.push_back(std::uint32_t(i));
  }
  Texture t;
  t.image = Image8(2, 2, 3, 128);
  s.textures.push_back(t);
  s.materials[0].texture = 0;
  const ViewScene v = *make_view_scene(s, {});
  ASSERT_TRUE(v.textured());
  for (std::size_t i = 0; i < v.positions.size(); ++i) {
    EXPECT_EQ(v.illumination[i].x, 100 * v.positions[i].x);
    EXPECT_EQ(v.texcoords[i], (Vec2f{v.positions[i].x, v.positions[i].y}));
  }
  EXPECT_GT(v.light_scale, 0);
  EXPECT_LT(v.light_scale, 0.1);
}

// Vertices of a lit scene at one place keep the light that each of them has.
TEST(ViewScene, LightMayDifferWherePositionsAreEqual) {
  Scene s;
  add_quad(s, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  for (std::size_t i = 0; i < s.positions.size(); ++i) s.illumination.push_back({float(i), 0, 0});
  const ViewScene v = *make_view_scene(s, {});
  EXPECT_EQ(v.caster_positions.size(), 4u);
  ASSERT_EQ(v.illumination.size(), 6u);
  std::set<float> light;
  for (const Vec3f& e : v.illumination) light.insert(e.x);
  EXPECT_EQ(light.size(), 6u);
}

// The light's 99th percentile, by the luminance of its colour, becomes 1.
TEST(ViewScene, TheExposureIsThatOfTheBrightestPercent) {
  Scene s;
  for (int i = 0; i < 67; ++i) add_quad(s, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  ASSERT_EQ(s.positions.size(), 402u);
  for (std::size_t i = 0; i < s.positions.size(); ++i) {  // corners that differ in light alone
    const auto rank = float((i * 5) % 402 + 1);
    s.illumination.push_back({3 * rank, 2 * rank, rank});
  }
  const double luminance = 3 * 0.2126 + 2 * 0.7152 + 0.0722;
  const ViewScene v = *make_view_scene(s, {});
  ASSERT_EQ(v.illumination.size(), 402u);
  EXPECT_NEAR(1 / (v.light_scale * luminance), 397, 1);
  for (Vec3f& e : s.illumination) e = {};
  EXPECT_EQ(make_view_scene(s, {})->light_scale, 1);
}

TEST(ViewScene, NegativeZerosAndOppositeWindingsMakeNoCrease) {
  Scene s;
  const float rise = std::tan(glm::radians(10.0f));
  add_quad(s, {{-1, -rise, 0}, {0, 0, 0}, {0, 0, -1}, {-1, -rise, -1}});
  add_quad(s, {{0, 0, 0}, {0, 0, -1}, {1, -rise, -1}, {1, -rise, 0}});
  for (std::size_t i = 6; i < 12; ++i)
    for (float* c : {&s.positions[i].x, &s.positions[i].y, &s.positions[i].z})
      if (*c == 0) *c = -0.0f;
  const ViewScene v = *make_view_scene(s, {});
  EXPECT_EQ(v.caster_positions.size(), 6u);
  int shared = 0;
  for (std::size_t i = 0; i < v.positions.size(); ++i) {
    const double upright = std::abs(double(v.normals[i].y));
    const bool at_ridge = v.positions[i].x == 0;
    if (at_ridge) {
      EXPECT_GT(upright, 0.995) << "a mean of both sides, whose areas there are as 1 to 2";
    } else {
      EXPECT_NEAR(upright, std::cos(glm::radians(10.0)), 1e-4);
    }
    shared += at_ridge;
  }
  EXPECT_EQ(shared, 4) << "two corners from either side";
}

// What has no texture looks alike, however its material would continue one.
TEST(ViewScene, OnlyTexturesTellLooksApart) {
  Scene s;
  add_quad(s, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  add_quad(s, {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}});
  s.materials.resize(4, s.materials[0]);
  s.materials[1].wrap_u = TextureWrap::clamp;
  s.materials[2].texture = s.materials[3].texture = 0;
  s.materials[3].wrap_v = TextureWrap::mirror;
  s.triangle_material = {0, 1, 2, 3};
  s.textures.resize(1);
  s.textures[0].image = Image8(2, 2, 3, 128);
  s.texcoords = {{0.25f, 0.75f}};
  s.texcoord_indices.assign(12, 0);
  const ViewScene v = *make_view_scene(s, {});
  ASSERT_EQ(v.clusters.size(), 3u);
  EXPECT_EQ(v.clusters[0].look, ViewScene::Look{});
  EXPECT_EQ(v.clusters[0].count, 6u);
  EXPECT_EQ(v.clusters[1].look, (ViewScene::Look{0, TextureWrap::repeat, TextureWrap::repeat}));
  EXPECT_EQ(v.clusters[2].look, (ViewScene::Look{0, TextureWrap::repeat, TextureWrap::mirror}));
}

// Materials of ordinary scenes are often one-sided by default, and shown from both sides.
TEST(ViewScene, OnlyOnBakedPagesMaterialsAreOneSided) {
  Scene s;
  add_quad(s, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  s.materials.resize(2, s.materials[0]);
  s.materials[1].texture = 0;
  s.materials[1].double_sided = false;
  s.triangle_material = {1, 0};
  s.textures.resize(1);
  s.textures[0].image = Image8(2, 2, 3, 128);
  s.texcoords = {{0.25f, 0.75f}};
  s.texcoord_indices.assign(6, 0);
  for (const bool baked : {false, true}) {
    ViewSceneOptions o;
    o.textures_hold_light = baked;
    const ViewScene v = *make_view_scene(s, o);
    ASSERT_EQ(v.clusters.size(), 2u);
    EXPECT_FALSE(v.clusters[0].look.one_sided);
    EXPECT_EQ(v.clusters[1].look.one_sided, baked);
    EXPECT_EQ(v.caster_indices.size(), 6u) << "both cast shadows";
  }
}

// Light at the vertices falls on what reflects it, and not on pages; the scale is that of all.
TEST(ViewScene, UnlitMaterialsAreToldApart) {
  Scene s;
  add_quad(s, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  s.materials.resize(2, s.materials[0]);
  s.materials[1].texture = 0;
  s.materials[1].wrap_u = s.materials[1].wrap_v = TextureWrap::clamp;
  s.materials[1].unlit = true;
  s.triangle_material = {1, 0};
  s.textures.resize(1);
  s.textures[0].image = Image8(2, 2, 3, 128);
  s.texcoords = {{0.25f, 0.75f}};
  s.texcoord_indices.assign(6, 0);
  s.illumination.assign(6, Vec3f{4, 4, 4});
  const ViewScene v = *make_view_scene(s, {});
  EXPECT_EQ(v.unlit, Unlit::some);
  EXPECT_FALSE(v.clusters[0].look.page);
  EXPECT_TRUE(v.clusters[1].look.page);
  EXPECT_EQ(v.unlit_vertices, (std::vector<std::uint8_t>{0, 0, 0, 1, 1, 1}));
  EXPECT_EQ(v.light_scale, 0.25);
  for (const Vec3f& light : v.illumination) EXPECT_EQ(light, (Vec3f{4, 4, 4}));
  s.illumination.assign(6, Vec3f{0, 0, 0});
  const ViewScene dark = *make_view_scene(s, {});
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(dark.illumination[i].x, float(v.unlit_vertices[i])) << i;
  s.materials[0].unlit = true;
  EXPECT_EQ(make_view_scene(s, {})->unlit, Unlit::all);
  EXPECT_TRUE(make_view_scene(s, {})->unlit_vertices.empty());
  ViewSceneOptions colours;
  colours.textures_hold_light = false;
  EXPECT_EQ(make_view_scene(s, colours)->unlit, Unlit::none);
}

TEST(ViewScene, WhatIsInvisibleIsNotDrawn) {
  Scene s = room();
  s.materials[0].alpha_mode = AlphaMode::mask;
  s.materials[0].opacity = 0.25f;
  EXPECT_EQ(make_view_scene(s, {}).status().code(), ErrorCode::bad_input);
  s.materials[0].alpha_mode = AlphaMode::blend;
  const ViewScene glass = *make_view_scene(s, {});
  EXPECT_EQ(glass.triangle_count(), s.triangle_count());
  EXPECT_TRUE(glass.caster_indices.empty());
  EXPECT_EQ(glass.bounds.high, make_view_scene(room(), {})->bounds.high);
}

TEST(ViewScene, ClustersLieCloseTogetherAlongEveryAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    Scene s;
    for (int i = 0; i < 64; ++i) {  // in an order that leaps along the row
      const auto at = float(i * 37 % 64);
      const auto corner = [&](float a, float b) {
        return axis == 0 ? Vec3f{at, a, b} : axis == 1 ? Vec3f{a, at, b} : Vec3f{a, b, at};
      };
      add_quad(s, {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)});
    }
    ViewSceneOptions o;
    o.cluster_triangles = 16;  // eight neighbours
    const ViewScene v = *make_view_scene(s, o);
    EXPECT_EQ(v.clusters.size(), 8u);
    for (const ViewScene::Cluster& c : v.clusters) EXPECT_LT(c.radius, 4);
  }
}

TEST(ViewScene, IsWhereAndWhatTheSceneSays) {
  Scene s = room();
  s.origin = {1e6, -2e6, 3};
  s.metres_per_unit = 0.25;
  ViewSceneOptions o;
  o.cluster_triangles = 0;  // as if it were 1
  o.textures_hold_light = true;
  const ViewScene v = *make_view_scene(s, o);
  EXPECT_EQ(v.origin, s.origin);
  EXPECT_EQ(v.metres_per_unit, 0.25);
  EXPECT_EQ(v.clusters.size(), s.triangle_count());
  EXPECT_EQ(v.unlit, Unlit::none) << "there are no textures";
  EXPECT_FALSE(v.baked());
}

// The extent of this scene is not a float.
TEST(ViewScene, ClustersOfAllFloatsHaveAFiniteCentre) {
  Scene s;
  s.positions = {{-3e38f, -3e38f, 0}, {3e38f, -3e38f, 0}, {3e38f, 3e38f, 0}};
  s.indices = {0, 1, 2};
  ASSERT_TRUE(complete_scene(s).ok());
  const ViewScene v = *make_view_scene(s, {});
  ASSERT_EQ(v.clusters.size(), 1u);
  EXPECT_EQ(v.clusters[0].centre, (Vec3f{0, 0, 0}));
}

TEST(ViewScene, DegenerateTrianglesGiveFiniteNormals) {
  Scene s;
  add_quad(s, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  add_quad(s, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
  const ViewScene v = *make_view_scene(s, {});
  for (const Vec3f& n : v.normals) EXPECT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-5);
}

TEST(ViewScene, ASceneWithoutTrianglesIsSaidToBeOne) {
  const Result<ViewScene> v = make_view_scene(Scene{}, {});
  ASSERT_FALSE(v.ok());
  EXPECT_NE(v.status().message().find("no triangles"), std::string::npos);
}

// Arrays of a program's own scene that do not fit together would be read past their ends.
TEST(ViewScene, ScenesOutOfStepAreRefusedByName) {
  Scene scene = room();
  scene.indices[7] = 1u << 30;
  Result<ViewScene> v = make_view_scene(scene, {});
  ASSERT_FALSE(v.ok());
  EXPECT_NE(v.status().message().find("indices[7]"), std::string::npos) << v.status().message();
  scene = room();
  scene.illumination.resize(3);
  v = make_view_scene(scene, {});
  ASSERT_FALSE(v.ok());
  EXPECT_NE(v.status().message().find("illumination"), std::string::npos) << v.status().message();
}

// Returns a row of rooms with that many triangles at least.
Scene rooms(std::size_t triangles) {
  const Scene one = room();
  Scene row = one;
  while (row.triangle_count() < triangles) {
    const auto before = std::uint32_t(row.positions.size());
    for (const Vec3f& p : one.positions)
      row.positions.push_back({p.x + 20 * float(row.triangle_count()), p.y, p.z});
    for (const std::uint32_t i : one.indices) row.indices.push_back(before + i);
    const auto repeat = [](auto& all, const auto& some) {
      all.insert(all.end(), some.begin(), some.end());
    };
    repeat(row.illumination, one.illumination);
    repeat(row.triangle_material, one.triangle_material);
    repeat(row.triangle_object, one.triangle_object);
    repeat(row.texcoord_indices, one.texcoord_indices);
  }
  return row;
}

// Scenes of millions of triangles take seconds.
TEST(ViewScene, CanBeCancelledThroughoutAndTellsItsProgress) {
  const Scene scene = rooms(50'000);
  std::vector<double> told;
  Context context;
  context.progress = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "preparing");
    told.push_back(fraction);
  };
  ASSERT_TRUE(make_view_scene(scene, {}, context).ok());
  EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
  EXPECT_EQ(told.back(), 1);
  for (std::size_t calls = 0; calls < told.size(); ++calls) {
    std::atomic<bool> stop = calls == 0;
    std::size_t after = 0, seen = 0;
    context.cancel = &stop;
    context.progress = [&](std::string_view, double) {
      after += stop;
      stop = stop || ++seen == calls;
    };
    EXPECT_EQ(make_view_scene(scene, {}, context).status().code(), ErrorCode::cancelled) << calls;
    EXPECT_LE(after, 4u) << "of " << told.size() << ", stopped at " << calls;
  }
}

TEST(ViewScene, ACancelledStartReturnsACamera) {
  const ViewScene view = *make_view_scene(room(), {});
  std::atomic<bool> stop = true;
  Context context;
  context.cancel = &stop;
  const Camera camera = start_camera(view, {0, 1, 0}, 60, context);
  EXPECT_TRUE(std::isfinite(camera.eye.x + camera.eye.y + camera.eye.z));
}

}  // namespace
}  // namespace atlas::testing
