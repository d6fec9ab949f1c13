#include "tests/view/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace atlas::testing {
namespace {

void add_triangle(Scene& s, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  if (s.materials.empty()) s.materials.push_back({"white", {1, 1, 1}, -1});
  if (s.object_names.empty()) s.object_names.push_back("all");
  for (const Vec3f& p : {a, b, c}) {
    s.indices.push_back(std::uint32_t(s.positions.size()));
    s.positions.push_back(p);
  }
  s.triangle_material.push_back(0);
  s.triangle_object.push_back(0);
}

Vec3f mix(const Vec3f& a, const Vec3f& b, float t) {
  return {a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, a.z + (b.z - a.z) * t};
}

}  // namespace

void add_quad(Scene& s, const Vec3f (&q)[4], int cuts) {
  const auto at = [&](int i, int j) {
    const float u = float(i) / float(cuts), v = float(j) / float(cuts);
    return mix(mix(q[0], q[1], u), mix(q[3], q[2], u), v);
  };
  for (int j = 0; j < cuts; ++j)
    for (int i = 0; i < cuts; ++i) {
      add_triangle(s, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      add_triangle(s, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
}

void add_box(Scene& s, const Vec3f& l, const Vec3f& h) {
  add_quad(s, {{l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z}});
  add_quad(s, {{h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z}});
  add_quad(s, {{h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z}});
  add_quad(s, {{l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z}});
  add_quad(s, {{l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z}});
  add_quad(s, {{l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z}});
}

void add_sphere(Scene& s, const Vec3f& c, float r, int cuts) {
  const auto at = [&](int i, int j) {
    const float a = float(i) * 2 * std::numbers::pi_v<float> / float(2 * cuts);
    const float b = (float(j) / float(cuts) - 0.5f) * std::numbers::pi_v<float>;
    return Vec3f{c.x + r * std::cos(b) * std::cos(a), c.y + r * std::sin(b),
                 c.z - r * std::cos(b) * std::sin(a)};
  };
  for (int j = 0; j < cuts; ++j)
    for (int i = 0; i < 2 * cuts; ++i) {
      if (j > 0) add_triangle(s, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      if (j + 1 < cuts || j == 0) add_triangle(s, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
}

Scene courtyard() {
  Scene s;
  add_quad(s, {{-5, 0, 5}, {5, 0, 5}, {5, 0, -5}, {-5, 0, -5}}, 4);
  add_box(s, {-2.5f, 0, -2}, {-1, 1.5f, -0.7f});
  add_box(s, {1, 0, 1}, {1.12f, 2.2f, 1.12f});
  add_box(s, {2.5f, 0, -1.5f}, {2.6f, 1.8f, 1.3f});
  add_box(s, {-1, 1.6f, 1.5f}, {0.6f, 1.7f, 2.6f});
  add_sphere(s, {0.4f, 0.9f, -2.4f}, 0.7f, 16);
  return s;
}

Scene room() {
  Scene s;
  const float w = 3, h = 2.6f, d = 4;  // half width, height, half depth
  add_box(s, {-w, -0.1f, -d}, {w, 0, d});
  add_box(s, {-w, h, -d}, {w, h + 0.1f, d});
  add_box(s, {-w - 0.1f, -0.1f, -d}, {-w, h + 0.1f, d});
  add_box(s, {-w, 0, -d - 0.1f}, {w, h, -d});
  add_box(s, {-w, 0, d}, {w, h, d + 0.1f});
  // The wall at x = w, around a window and a doorway.
  add_box(s, {w, -0.1f, -d}, {w + 0.1f, h + 0.1f, -2.4f});
  add_box(s, {w, -0.1f, -2.4f}, {w + 0.1f, 0.8f, -0.4f});
  add_box(s, {w, 2.1f, -2.4f}, {w + 0.1f, h + 0.1f, -0.4f});
  add_box(s, {w, 0.8f, -1.45f}, {w + 0.1f, 2.1f, -1.35f});
  add_box(s, {w, -0.1f, -0.4f}, {w + 0.1f, h + 0.1f, 1.2f});
  add_box(s, {w, 2.1f, 1.2f}, {w + 0.1f, h + 0.1f, 2.2f});
  add_box(s, {w, -0.1f, 2.2f}, {w + 0.1f, h + 0.1f, d});
  add_box(s, {-0.6f, 0.7f, -1.8f}, {1.2f, 0.76f, -0.6f});
  for (float x : {-0.55f, 1.1f})
    for (float z : {-1.75f, -0.7f}) add_box(s, {x, 0, z}, {x + 0.06f, 0.7f, z + 0.06f});
  add_sphere(s, {0.2f, 1.0f, -1.2f}, 0.24f, 12);
  return s;
}

Scene pavilion() {
  Scene s;
  const auto height = [](float x, float z) { return 0.25f * std::sin(x) * std::cos(0.8f * z); };
  for (int j = 0; j < 24; ++j)
    for (int i = 0; i < 24; ++i) {
      const float x0 = -6 + 0.5f * float(i), z0 = 6 - 0.5f * float(j), x1 = x0 + 0.5f,
                  z1 = z0 - 0.5f;
      const Vec3f q[4] = {{x0, height(x0, z0), z0},
                          {x1, height(x1, z0), z0},
                          {x1, height(x1, z1), z1},
                          {x0, height(x0, z1), z1}};
      add_quad(s, q);
    }
  add_quad(s, {{-2, 2, 1.5f}, {2, 2, 1.5f}, {2, 3, -1.5f}, {-2, 3, -1.5f}}, 2);
  for (float x : {-1.9f, 1.8f}) {
    add_box(s, {x, -0.4f, 1.3f}, {x + 0.1f, 2.05f, 1.4f});
    add_box(s, {x, -0.4f, -1.4f}, {x + 0.1f, 2.95f, -1.3f});
  }
  return s;
}

namespace {

View view_of(Scene scene, const Vec3d& eye, const Vec3d& target) {
  View v{std::move(scene), {}};
  v.camera.eye = eye;
  v.camera.target = target;
  v.camera.near_plane = 0.1;
  v.camera.far_plane = 40;
  return v;
}

}  // namespace

View courtyard_view() {
  return view_of(courtyard(), {3.5, 4.5, 6.5}, {0, 0.3, 0});
}
View room_view() {
  return view_of(room(), {-2.6, 1.9, 3.4}, {1.0, 0.4, -1.4});
}
View pavilion_view() {
  return view_of(pavilion(), {5.5, 4, 6.5}, {0, 0.5, 0});
}

GlContext& test_context() {
  // Never destroyed, because its driver would be unloaded, and the leak checker could then not name
  // what the driver keeps (lsan.supp).
  static GlContext* const context = [] {
    ContextOptions options;
    options.debug = true;
    options.software = std::getenv("LIBATLAS_GPU") == nullptr;
    Result<std::unique_ptr<GlContext>> made = make_headless_context(options);
    EXPECT_TRUE(made.ok()) << made.status().message();
    return made.value().release();
  }();
  return *context;
}

Renderer must_render(const Scene& scene, const RenderOptions& options) {
  test_context();
  Result<ViewScene> view = make_view_scene(scene, {});
  EXPECT_TRUE(view.ok()) << view.status().message();
  Result<Renderer> made = Renderer::make(*view, options);
  EXPECT_TRUE(made.ok()) << made.status().message();
  return std::move(made.value());
}

FrameLight still(const Vec3d& direction) {
  return {direction, [direction](int) { return direction; }};
}

double encoded(double value) {
  const double v = std::clamp(value, 0.0, 1.0);
  return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055);
}

}  // namespace atlas::testing
