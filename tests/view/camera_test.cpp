// The camera: its volume, its planes, how it flies, and where it starts.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/view/camera.h"
#include "libatlas/view/start_camera.h"
#include "tests/support/boxes.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

constexpr Vec3d kAxes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};

Camera slanted() {
  Camera camera;
  camera.eye = {3, -2, 5};
  camera.target = {-1, 1, 2};
  camera.up = {0.2, 0.3, 2};
  camera.fov_degrees = 50;
  camera.near_plane = 0.5;
  camera.far_plane = 20;
  return camera;
}

void expect_near(const Vec3d& got, const Vec3d& want) {
  EXPECT_NEAR(glm::length(to_glm(got) - to_glm(want)), 0, 1e-9)
      << got.x << ' ' << got.y << ' ' << got.z;
}

// The matrix takes the corners of the volume to those of OpenGL's cube.
TEST(Camera, TheCornersOfItsVolumeAreThoseOfTheCube) {
  const Camera camera = slanted();
  const Matrix4 m = view_projection(camera, 1.7);
  const std::array<Vec3d, 8> corners = view_corners(camera, 1.7, 1000);
  for (int i = 0; i < 8; ++i) {
    const Vec3d& p = corners[std::size_t(i)];
    double clip[4];
    for (std::size_t r = 0; r < 4; ++r)
      clip[r] = m[r] * p.x + m[4 + r] * p.y + m[8 + r] * p.z + m[12 + r];
    EXPECT_NEAR(clip[0] / clip[3], i & 1 ? 1 : -1, 1e-9) << i;
    EXPECT_NEAR(clip[1] / clip[3], i & 2 ? 1 : -1, 1e-9) << i;
    EXPECT_NEAR(clip[2] / clip[3], i & 4 ? 1 : -1, 1e-9) << i;
  }
  const glm::dvec3 eye = to_glm(camera.eye);
  const glm::dvec3 forward = glm::normalize(to_glm(camera.target) - eye);
  for (int i = 4; i < 8; ++i) {
    const Vec3d corner = view_corners(camera, 1.7, 7)[std::size_t(i)];
    EXPECT_NEAR(glm::dot(to_glm(corner) - eye, forward), 7, 1e-9);
  }
}

TEST(Camera, LooksAlongAnyUp) {
  for (const Vec3d& up : kAxes)
    for (const double sign : {-1.0, 1.0}) {
      Camera camera;
      camera.up = up;
      camera.target = {0, 0, 0};
      camera.eye = {5 * sign * up.x, 5 * sign * up.y, 5 * sign * up.z};
      for (const double value : view_projection(camera, 1.5)) EXPECT_TRUE(std::isfinite(value));
    }
}

TEST(Camera, PlanesEncloseTheBoxAndLittleMore) {
  const Box3 box{{-1, -2, -3}, {3, 2, 1}};
  const double radius = std::sqrt(12);  // of the sphere around the box
  for (const double distance : {3.6, 10.0, 1e5}) {
    Camera camera;
    camera.eye = {1, 0, -1 + distance};
    fit_planes(camera, box);
    EXPECT_LE(camera.near_plane, distance - radius);
    EXPECT_GE(camera.far_plane, distance + radius);
    EXPECT_NEAR(camera.near_plane, distance - radius, 0.02 * radius + 1e-4 * distance);
    EXPECT_NEAR(camera.far_plane, distance + radius, 0.02 * radius);
  }
  for (const double inside : {0.0, 1.0, 3.4}) {
    Camera camera;
    camera.eye = {1, inside, -1};
    fit_planes(camera, box);
    EXPECT_NEAR(camera.near_plane / camera.far_plane, 1e-6, 1e-11);
  }
}

TEST(Camera, LooksAtABoxFromSlightlyAboveItsSide) {
  const Box3 box{{4, 5, 6}, {5, 7, 9}};
  for (const Vec3d& up : kAxes)
    for (const double fov : {20.0, 60.0, 120.0}) {
      const Camera camera = camera_for(box, up, fov);
      const glm::dvec3 away = to_glm(camera.eye) - to_glm(camera.target);
      expect_near(camera.target, {4.5, 6, 7.5});
      expect_near(camera.up, up);
      const double height = glm::degrees(std::asin(glm::dot(glm::normalize(away), to_glm(up))));
      EXPECT_GT(height, 15);
      EXPECT_LT(height, 45);
      // The sphere around the box fits between the image's lower and upper edge.
      EXPECT_GT(glm::length(away) * std::sin(glm::radians(fov / 2)), std::sqrt(3.5));
    }
}

TEST(Camera, LooksAtAPointFarFromTheOrigin) {
  for (const Vec3d& at : {Vec3d{}, {5, 5, 5}, {-3e6, 1e6, 7e5}, {1e30, 0, 0}}) {
    const Camera camera = camera_for({at, at}, {0, 1, 0}, 60);
    EXPECT_FALSE(camera.eye == camera.target);
    EXPECT_TRUE(0 < camera.near_plane && camera.near_plane < camera.far_plane);
    for (const double value : view_projection(camera, 1.5)) EXPECT_TRUE(std::isfinite(value));
  }
}

TEST(Camera, FliesAlongItsViewAndTurnsToTheRightAndUpwards) {
  Camera camera;
  camera.eye = {0, 0, 0};
  camera.target = {0, 0, -2};
  fly(camera, {1, 2, 3}, 0, 0);
  expect_near(camera.eye, {2, 3, -1});
  expect_near(camera.target, {2, 3, -3});
  fly(camera, {}, 90, 0);
  expect_near(camera.target, {4, 3, -1});
  fly(camera, {}, 0, 30);
  expect_near(camera.target, {2 + std::sqrt(3.0), 4, -1});
  // It moves as it looked before it turned: upwards along the view, but up along its `up`.
  fly(camera, {2, 1, 5}, -90, -60);
  expect_near(camera.eye, {2 + std::sqrt(3.0), 9, 0});
  expect_near(camera.target, {2 + std::sqrt(3.0), 8, -std::sqrt(3.0)});
}

TEST(Camera, DoesNotFlyOverItsZenith) {
  for (const double pitch : {-1000.0, -100.0, 100.0, 1000.0}) {
    Camera camera;
    camera.eye = {0, 0, 0};
    camera.target = {0, 0, -2};
    fly(camera, {}, 0, pitch);
    const double limit = std::copysign(glm::radians(88.0), pitch);
    expect_near(camera.target, {0, 2 * std::sin(limit), -2 * std::cos(limit)});
    fly(camera, {}, 0, -3 * pitch);
    expect_near(camera.target, {0, -2 * std::sin(limit), -2 * std::cos(limit)});
  }
}

TEST(Camera, LooksAndTurnsWhereTheViewIsVertical) {
  for (double down : {-5.0, 5.0}) {
    Camera camera;
    camera.eye = {0, down, 0};
    for (double value : view_projection(camera, 1.5)) EXPECT_TRUE(std::isfinite(value));
    for (const Vec3d& c : view_corners(camera, 1.5, 10))
      EXPECT_TRUE(std::isfinite(c.x + c.y + c.z));
    fly(camera, {0.1, 0.1, 0.1}, 3, 3);
    EXPECT_TRUE(std::isfinite(camera.eye.x + camera.eye.y + camera.eye.z));
    EXPECT_NEAR(std::hypot(camera.target.x - camera.eye.x, camera.target.y - camera.eye.y,
                           camera.target.z - camera.eye.z),
                5, 1e-9);
  }
}

TEST(StartCamera, StandsAsHighWhicheverAxisIsUp) {
  Scene upright = room(), turned = room();
  for (Vec3f& p : turned.positions) p = {p.x, -p.z, p.y};
  const ViewScene hall = *make_view_scene(upright, {}), other = *make_view_scene(turned, {});
  const Camera y = start_camera(hall, {0, 1, 0}), z = start_camera(other, {0, 0, 1});
  EXPECT_NEAR(z.eye.z, y.eye.y, 1e-3);
  expect_near(z.up, {0, 0, 1});
  for (const Camera& camera : {y, z}) {
    EXPECT_NEAR(camera.near_plane / camera.far_plane, 1e-6, 1e-11) << "it stands inside";
    EXPECT_LT(camera.far_plane, 15) << "as far as the room's farthest corner, not farther";
  }
  EXPECT_FALSE(start_camera(hall, {1, 0, 0}).up == (Vec3d{0, 1, 0}));
}

TEST(StartCamera, StandsInARoomAndBeforeAThing) {
  const auto inside = [](const ViewScene& v, const Vec3d& p) {
    const Box3& b = v.bounds;
    return p.x > b.low.x && p.y > b.low.y && p.z > b.low.z && p.x < b.high.x && p.y < b.high.y &&
           p.z < b.high.z;
  };
  Scene ball;
  add_sphere(ball, {3, 2, 1}, 1, 12);
  const ViewScene hall = *make_view_scene(room(), {}), thing = *make_view_scene(ball, {});
  const Camera visitor = start_camera(hall, {0, 1, 0}), beholder = start_camera(thing, {0, 1, 0});
  EXPECT_TRUE(inside(hall, visitor.eye));
  EXPECT_FALSE(inside(thing, beholder.eye));
  EXPECT_FALSE(inside(hall, start_camera(hall, {1, 0, 0}).eye)) << "no floor is looked for";
  for (const auto& [v, camera] : {std::pair{&hall, visitor}, std::pair{&thing, beholder}}) {
    EXPECT_GT(camera.near_plane, 0);
    for (const Vec3f& p : v->positions)
      EXPECT_LE(std::hypot(p.x - camera.eye.x, p.y - camera.eye.y, p.z - camera.eye.z),
                camera.far_plane);
  }
}

TEST(StartCamera, AThingFillsTheViewWhateverItsFieldIs) {
  Scene ball;
  add_sphere(ball, {3, 2, 1}, 1, 12);
  const ViewScene thing = *make_view_scene(ball, {});
  for (const double fov : {1.0, 20.0, 60.0, 110.0, 170.0}) {
    const Camera camera = start_camera(thing, {0, 1, 0}, fov);
    EXPECT_EQ(camera.fov_degrees, fov);
    const glm::dvec3 eye = to_glm(camera.eye), axis = glm::normalize(to_glm(camera.target) - eye);
    double widest = 0;  // distance from the image's centre, relative to that of its edge
    for (const Vec3f& p : thing.positions) {
      const double cosine = glm::dot(axis, glm::normalize(to_dvec(p) - eye));
      widest = std::max(widest, glm::degrees(std::acos(std::min(cosine, 1.0))) / (fov / 2));
    }
    EXPECT_LT(widest, 1) << fov;
    EXPECT_GT(widest, 0.35) << fov;
    EXPECT_GT(camera.near_plane, 0);
  }
}

TEST(StartCamera, TheEyeIsAsHighInAnyUnit) {
  const double eye = start_camera(*make_view_scene(room(), {}), {0, 1, 0}).eye.y;
  for (const float units : {100.0f, 1000.0f, 0.001f}) {
    Scene scene = room();
    for (Vec3f& p : scene.positions) p = {p.x * units, p.y * units, p.z * units};
    scene.metres_per_unit = 1 / double(units);
    EXPECT_NEAR(start_camera(*make_view_scene(scene, {}), {0, 1, 0}).eye.y / units, eye, 1e-3);
  }
}

// The light is at the vertices, or on pages, the upper halves of which are white.
TEST(StartCamera, StandsInALitRoom) {
  for (const bool second_lit : {false, true}) {
    for (const bool pages : {false, true}) {
      test::Triangles rooms;
      test::add_box(rooms, {0, 0, 0}, {5, 4, 3}, true);
      test::add_box(rooms, {6, 0, 0}, {11, 4, 3}, true);
      Scene scene;
      scene.positions = rooms.positions;
      scene.indices = rooms.indices;
      if (pages) {
        scene.textures.resize(1);
        scene.textures[0].image = Image8(4, 4, 3);
        std::fill_n(scene.textures[0].image.at(0, 2), 24, std::uint8_t(255));
        scene.materials.resize(1);
        scene.materials[0].texture = 0;
        scene.materials[0].unlit = true;
      }
      for (std::size_t v = 0; v < 16; ++v) {
        const bool lit = (v >= 8) == second_lit;
        if (pages) {
          scene.texcoords.push_back({0.5f, lit ? 0.8f : 0.2f});
        } else {
          scene.illumination.push_back(lit ? Vec3f{700, 700, 700} : Vec3f{0, 0, 0});
        }
      }
      if (pages) scene.texcoord_indices = scene.indices;
      ASSERT_TRUE(complete_scene(scene).ok());
      const Camera camera = start_camera(*make_view_scene(scene, {}), {0, 0, 1});
      EXPECT_EQ(camera.eye.x > 5.5, second_lit) << pages << ' ' << camera.eye.x;
    }
  }
}

}  // namespace
}  // namespace atlas::testing
