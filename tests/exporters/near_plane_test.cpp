// Tests that viewers neither cut away what a world opens with nor draw it with too coarse depths.
// VRML viewers take the near plane from the avatar: half of its width by the standard, 0.6 of it in
// Castle Game Engine. The distances are measured here on points spread over the triangles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/viewpoint.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/exporters/vrml_parser.h"
#include "tests/support/boxes.h"

namespace atlas::test {
namespace {

constexpr double kCastle = 0.6;

World world_in_metres(const Triangles& triangles, double metres_per_unit) {
  World world;
  world.up = Up::z;
  world.metres_per_unit = metres_per_unit;
  world.positions = triangles.positions;
  world.uvs = {{0, 0}};
  Page page;
  page.indices = triangles.indices;
  page.uv_indices.assign(page.indices.size(), 0);
  world.pages = {page};
  ViewpointOptions options;
  options.up = world.up;
  options.metres_per_unit = metres_per_unit;
  world.viewpoint = choose_viewpoint(world.positions, page.indices, options, {});
  return world;
}

World box_world(const glm::dvec3& size, bool room, double metres_per_unit = 1) {
  Triangles box;
  add_box(box, {0, 0, 0}, {float(size.x), float(size.y), float(size.z)}, room);
  return world_in_metres(box, metres_per_unit);
}

struct Extent {
  double nearest = INFINITY, farthest = 0;
};

// Returns the distances of the viewpoint from points on the triangles.
Extent extent_of(const World& world) {
  constexpr int kSteps = 64;
  const glm::dvec3 eye = to_glm(world.viewpoint.position);
  const std::vector<std::uint32_t>& indices = world.pages[0].indices;
  Extent extent;
  for (std::size_t k = 0; k < indices.size(); k += 3) {
    const auto corner = [&](std::size_t i) { return to_dvec(world.positions[indices[k + i]]); };
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = double(i) / kSteps, v = double(j) / kSteps;
        const glm::dvec3 p = (1 - u - v) * corner(0) + u * corner(1) + v * corner(2);
        extent.nearest = std::min(extent.nearest, glm::distance(eye, p));
        extent.farthest = std::max(extent.farthest, glm::distance(eye, p));
      }
    }
  }
  return extent;
}

struct Lens {
  std::vector<double> avatar;  // units of the world
  double speed = 0, limit = 0;
  double near = 0, far = 0;  // of glTF's camera, likewise in units of the world
};

Lens lens_of(const World& world) {
  const TempFolder folder;
  AtomicFiles files;
  EXPECT_TRUE(write_vrml(world, folder / "w.wrl", files, {}).ok());
  EXPECT_TRUE(files.commit().ok());
  Lens lens;
  const auto number = [](const VrmlNode& node, const char* name) {
    return node.has(name) ? vrml_number(node.field(name).at(0)) : 0;
  };
  for (const auto& node : parse_vrml(TempFolder::read(folder / "w.wrl"))) {
    if (node->type != "NavigationInfo") continue;
    for (const std::string& token : node->field("avatarSize"))
      lens.avatar.push_back(vrml_number(token));
    lens.speed = number(*node, "speed");
    lens.limit = number(*node, "visibilityLimit");
  }
  EXPECT_TRUE(write_kept(world, folder / "w.gltf").ok());
  const json camera = json::parse(TempFolder::read(folder / "w.gltf"))["cameras"][0]["perspective"];
  lens.near = camera["znear"].get<double>() / world.metres_per_unit;
  lens.far = camera["zfar"].get<double>() / world.metres_per_unit;
  return lens;
}

// From a coin to a town. Someone may come ten times as near before anything is cut away.
TEST(NearPlane, ObjectsOfAnySizeLieBehindIt) {
  for (const double metres : {1.0, 0.001}) {
    for (const double size : {1e-3, 0.02, 0.2, 2.0, 50.0, 5000.0}) {
      const double s = size / metres;
      const World world = box_world({s, 0.6 * s, 0.4 * s}, false, metres);
      ASSERT_FALSE(world.viewpoint.inside);
      const Extent extent = extent_of(world);
      const Lens lens = lens_of(world);
      ASSERT_EQ(lens.avatar.size(), 3u);
      for (const double near : {lens.near, kCastle * lens.avatar[0]}) {
        EXPECT_LT(10 * near, extent.nearest) << size;
        // A step of 24 bits of depth, at the far side.
        const double step = extent.farthest * extent.farthest / near / std::exp2(24);
        EXPECT_LT(step, 1e-4 * s) << size;
      }
      EXPECT_GT(lens.far, extent.farthest);
      EXPECT_NEAR(lens.avatar[1] / lens.avatar[0], 6.4, 1e-5);
      EXPECT_NEAR(lens.avatar[2] / lens.avatar[0], 3, 1e-5);
    }
  }
}

TEST(NearPlane, NoCornerOfItIsBehindTheWallsOfASmallRoom) {
  for (const double size : {0.01, 0.2, 1.0}) {
    const World world = box_world({size, 1.25 * size, 0.65 * size}, true);
    ASSERT_TRUE(world.viewpoint.inside) << size;
    const Lens lens = lens_of(world);
    const double tangent = std::tan(world.viewpoint.fov / 2);  // of the window's smaller side
    const double corner = std::hypot(1, tangent, 2 * tangent);
    const double nearest = extent_of(world).nearest;
    EXPECT_LT(corner * kCastle * lens.avatar[0], nearest) << size;
    EXPECT_LT(corner * lens.near, nearest) << size;
    // Gravity must not lift the eye through the ceiling.
    EXPECT_NEAR(lens.avatar[1], world.viewpoint.position.z, 1e-6 * size);
    EXPECT_LE(lens.avatar[0], lens.avatar[1]) << "the Castle Game Engine expects this";
    EXPECT_NEAR(lens.speed / lens.avatar[1], 1.5 / 1.6, 1e-6);
  }
}

TEST(NearPlane, PeopleWalkThroughRooms) {
  for (const double metres : {1.0, 0.01, 1000.0}) {
    const World world = box_world(glm::dvec3(6, 9, 2.6) / metres, true, metres);
    ASSERT_TRUE(world.viewpoint.inside);
    const Lens lens = lens_of(world);
    const double expected[] = {0.25, 1.6, 0.75};
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(metres * lens.avatar.at(i), expected[i], 1e-6) << metres;
    EXPECT_NEAR(metres * lens.speed, 1.5, 1e-6);
    EXPECT_LE(metres * lens.near, 0.02) << "noses are cut off";
    EXPECT_LT(lens.near, 1e-3 * lens.far);
    EXPECT_EQ(lens.limit, 0);
  }
}

// In a passage people are narrower, but as tall as ever.
TEST(NearPlane, PassagesAreNarrow) {
  World world = box_world({0.6, 9, 2.6}, true);
  world.viewpoint = {{0.3, 1, 1.7}, {0, 1, 0}, 1, true};
  const Lens lens = lens_of(world);
  EXPECT_NEAR(lens.avatar.at(0), 0.15, 1e-6);
  EXPECT_NEAR(lens.avatar.at(1), 1.6, 1e-6);
}

TEST(NearPlane, ViewpointsOnASurfaceHaveOne) {
  World world = box_world({2, 2, 2}, true);
  for (const Vec3d& eye : {Vec3d{1, 1, 0}, Vec3d{0, 0, 0}, Vec3d{1, 1, -1e-12}}) {
    world.viewpoint = {eye, {0, 1, 0}, 1, false};
    const Lens lens = lens_of(world);
    for (const double length : lens.avatar) EXPECT_GT(length, 1e-5);
    EXPECT_GT(lens.near, 1e-6);
  }
}

// X_ITE draws nothing farther than 100 000 units, unless there is a limit.
TEST(NearPlane, LargeNumbersGetALimitOfVisibility) {
  const World world = box_world({50000, 40000, 10000}, false, 0.001);
  const Lens lens = lens_of(world);
  const double farthest = extent_of(world).farthest;
  EXPECT_NEAR(lens.limit, 4 * farthest, 1e-4 * farthest);
  EXPECT_EQ(lens_of(box_world({500, 400, 100}, false)).limit, 0);
}

}  // namespace
}  // namespace atlas::test
