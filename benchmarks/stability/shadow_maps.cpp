// Compares shadow maps with rays traced in double: under grazing light, with few bits of depth, and
// in tiny, huge and distant scenes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "benchmarks/stability/checks.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/view/context.h"
#include "libatlas/view/renderer.h"

namespace atlas::bench {
namespace {

constexpr int kWidth = 256, kHeight = 160, kMap = 1024;

// A ground with a wall and a beam above it. What a ray hits is known in closed form.
struct Stage {
  struct Box {
    glm::dvec3 low, high;
  };
  double scale;
  glm::dvec3 offset;
  double ground;
  std::vector<Box> boxes;

  // Boxes and ground are at their float coordinates. Far from the origin these are coarse, which
  // must not count as an error of the shadows.
  explicit Stage(double times = 1, const glm::dvec3& moved = glm::dvec3(0))
      : scale(times), offset(moved), ground(rounded({0, 0, 0}).y) {
    for (const Box& b : {Box{{-0.1, 0, -1.2}, {0.1, 0.6, 1.2}}, Box{{0.9, 0.9, -2}, {1.1, 1, 2}}})
      boxes.push_back({rounded(b.low), rounded(b.high)});
  }
  glm::dvec3 placed(const glm::dvec3& p) const { return p * scale + offset; }
  glm::dvec3 rounded(const glm::dvec3& p) const {
    return (glm::dvec3(glm::vec3(placed(p))) - offset) / scale;
  }
};

// A parallelogram that is divided into `cuts` parts along both sides.
struct Face {
  glm::dvec3 corner, a, b;
  int cuts;
};

void add_face(Scene& scene, const Stage& stage, const Face& face) {
  const auto& [corner, a, b, cuts] = face;
  const auto first = std::uint32_t(scene.positions.size());
  for (int j = 0; j <= cuts; ++j)
    for (int i = 0; i <= cuts; ++i) {
      const glm::dvec3 p = stage.placed(corner + a * (double(i) / cuts) + b * (double(j) / cuts));
      scene.positions.push_back({float(p.x), float(p.y), float(p.z)});
    }
  const auto n = std::uint32_t(cuts + 1);
  for (std::uint32_t j = 0; j + 1 < n; ++j)
    for (std::uint32_t i = 0; i + 1 < n; ++i) {
      const std::uint32_t v = first + j * n + i;
      for (const std::uint32_t k : {v, v + 1, v + n + 1, v, v + n + 1, v + n})
        scene.indices.push_back(k);
    }
}

Scene scene_of(const Stage& stage) {
  Scene scene;
  scene.materials.push_back({});
  add_face(scene, stage, {{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, 32});
  for (const Stage::Box& box : stage.boxes) {
    const glm::dvec3 d = box.high - box.low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    for (const auto& [a, b, c] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
      add_face(scene, stage, {box.low, b, a, 2});
      add_face(scene, stage, {box.low + c, a, b, 2});
    }
  }
  scene.triangle_material.assign(scene.triangle_count(), 0);
  return scene;
}

bool hits(const Stage::Box& box, const glm::dvec3& from, const glm::dvec3& along) {
  double near = 0, far = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    double a = (box.low[i] - from[i]) / along[i], b = (box.high[i] - from[i]) / along[i];
    if (along[i] == 0) {
      if (from[i] < box.low[i] || from[i] > box.high[i]) return false;
      continue;
    }
    if (a > b) std::swap(a, b);
    near = std::max(near, a);
    far = std::min(far, b);
  }
  return near <= far;
}

bool blocked(const Stage& stage, const glm::dvec3& from, const glm::dvec3& along) {
  return std::any_of(stage.boxes.begin(), stage.boxes.end(),
                     [&](const Stage::Box& b) { return hits(b, from, along); });
}

struct Shares {
  double acne = 0, leak = 0;  // of the lit pixels that are dark, of the shadowed ones that are lit
  int lit = 0, shadowed = 0;
};

Camera camera_of(const Stage& stage) {
  Camera camera;
  camera.eye = from_glm(stage.placed({1, 6, 5.5}));
  camera.target = from_glm(stage.placed({0, 0, 0}));
  return camera;
}

// Compares ground pixels that are further than two texels of the map from any edge of the shadow.
Shares compare(const Stage& stage, const Image8& image, const glm::dvec3& light, double texel) {
  // In the stage without scale and offset, as camera_of() places it.
  const glm::dvec3 eye(1, 6, 5.5);
  const glm::dvec3 forward = glm::normalize(-eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0)));
  const glm::dvec3 up = glm::cross(right, forward);
  const glm::dvec3 side = glm::normalize(glm::cross(light, glm::dvec3(0, 1, 0)));
  const glm::dvec3 other = glm::cross(light, side);
  const double tangent = std::tan(glm::radians(camera_of(stage).fov_degrees) / 2);
  Shares s;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const glm::dvec3 ray = forward +
                             right * (tangent * kWidth / kHeight * (2 * (x + 0.5) / kWidth - 1)) +
                             up * (tangent * (2 * (y + 0.5) / kHeight - 1));
      if (ray.y >= 0 || blocked(stage, eye, ray)) continue;
      const glm::dvec3 p = eye + ray * ((stage.ground - eye.y) / ray.y);
      if (std::max(std::abs(p.x), std::abs(p.z)) > 3.9) continue;
      const bool dark = blocked(stage, p, light);
      bool edge = false;
      for (int i = 0; i < 32 && !edge; ++i) {
        const double angle = i * 0.39269908169872414;
        const double far = i < 16 ? 2 * texel : texel;
        const glm::dvec3 o = (side * std::cos(angle) + other * std::sin(angle)) * far;
        edge = blocked(stage, p + o - light * (o.y / light.y), light) != dark;
      }
      if (edge) continue;
      const bool shown_dark = *image.at(x, y) < 128;
      (dark ? s.shadowed : s.lit)++;
      (dark ? s.leak : s.acne) += shown_dark != dark;
    }
  s.acne /= std::max(s.lit, 1);
  s.leak /= std::max(s.shadowed, 1);
  return s;
}

Result<Shares> shares_of(const Stage& stage, const glm::dvec3& light, RenderOptions options) {
  options.width = kWidth;
  options.height = kHeight;
  options.map_resolution = kMap;
  options.show_visibility = true;
  const Result<ViewScene> view = make_view_scene(scene_of(stage), {});
  if (!view.ok()) return view.status();
  Result<Renderer> renderer = Renderer::make(*view, options);
  if (!renderer.ok()) return renderer.status();
  Camera camera = camera_of(stage);
  fit_planes(camera, renderer->bounds());
  // The light reaches its position over four frames of a key interval, so that the light between
  // keys is measured and not the keys themselves.
  Vec3d now = from_glm(light);
  const auto at = [&](int frame) {
    const double a = glm::radians(0.5 * (frame - 4));
    return Vec3d{light.x * std::cos(a) - light.z * std::sin(a), light.y,
                 light.x * std::sin(a) + light.z * std::cos(a)};
  };
  for (int frame = 0; frame <= 4; ++frame) {
    now = at(frame);
    const Result<FrameStats> drawn =
        renderer->draw(camera, {now, [&](int n) { return at(frame + n); }});
    if (!drawn.ok()) return drawn.status();
  }
  LightFitOptions fit;
  fit.resolution = kMap;
  fit.border_texels = kMap / 128.0;
  const Result<LightFit> map = fit_light(now, renderer->bounds(), fit);
  if (!map.ok()) return map.status();
  return compare(stage, renderer->read_image(), glm::normalize(light), map->texel / stage.scale);
}

glm::dvec3 light_at(double elevation) {
  const double e = glm::radians(elevation);
  return {std::cos(e) * 0.96, std::sin(e), std::cos(e) * 0.28};
}

// Half of what the tests allow for classic maps relative to rays, where 99 % of the pixels away
// from edges agree.
constexpr double kBound = 5e-3;

// With lower lights, shadows consist of edges only: on the ground, two texels cover 2 /
// sin(elevation) times their size.
constexpr double kLowestShadow = 0.4;

double sine_of(const glm::dvec3& light) {
  return light.y / glm::length(light);
}

struct Stress {
  std::string name;
  Stage stage = Stage();
  glm::dvec3 light = light_at(35);
  RenderOptions options = {};
};

// Adds one stress with classic maps and with the march between two keys.
void add_rows(CheckList& list, const Stress& stress) {
  const glm::dvec3& light = stress.light;
  const bool shadows = sine_of(light) > std::sin(glm::radians(kLowestShadow)) * (1 - 1e-9);
  const bool overhead = sine_of(light) > std::sin(glm::radians(85.0));  // little shadow is visible
  for (const ShadowMethod method : {ShadowMethod::classic, ShadowMethod::march}) {
    RenderOptions options = stress.options;
    options.shadows = method;
    const Result<Shares> s = shares_of(stress.stage, light, options);
    const std::string name = fmt::format("{}, {}", stress.name, name_of(method));
    const double never = std::numeric_limits<double>::quiet_NaN();
    const StressChecks at = list.at("shadow maps", name);
    at.add("lit pixels that are dark (acne)", s.ok() && s->lit > 200 ? s->acne : never, kBound,
           s.ok() ? fmt::format("{} lit pixels", s->lit) : s.status().message());
    if (shadows && !overhead)
      at.add("shadowed pixels that are lit (leak)", s.ok() && s->shadowed > 50 ? s->leak : never,
             kBound, s.ok() ? fmt::format("{} shadowed pixels", s->shadowed) : "");
  }
}

}  // namespace

void check_shadow_maps(CheckList& list) {
  ContextOptions wanted;
  wanted.software = !list.options.gpu;
  const auto gl = make_headless_context(wanted);
  if (!gl.ok()) {
    list.context.say(gl.status().message());
    return;
  }
  if (list.options.gpu) list.context.say("drawn by " + (*gl)->info().renderer);
  for (const int bits : {16, 24, 32})
    for (const double elevation :
         {0.1, 0.2, kLowestShadow, 1.0, 2.0, 5.0, 10.0, 45.0, 80.0, 89.0, 90.0}) {
      RenderOptions options;
      options.map_bits = bits;
      add_rows(list, {fmt::format("light {:g} degrees up, {} bits", elevation, bits), Stage(),
                      light_at(elevation), options});
    }
  for (const double scale : {1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12}) {
    add_rows(list, {fmt::format("scene times {:g}", scale), Stage(scale)});
  }
  for (const double offset : {1e2, 1e3, 1e4, 1e5, 1e6}) {
    add_rows(list, {fmt::format("scene {:g} sizes from the origin", offset),
                    Stage(1, glm::dvec3(1, 0.5, -1) * (8 * offset))});
  }
}

}  // namespace atlas::bench
