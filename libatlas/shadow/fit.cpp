#include "libatlas/shadow/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_finite.h"

namespace atlas {
namespace {

struct Sphere {
  glm::dvec3 centre{0};
  double radius = 0;
};

Sphere around(const std::array<glm::dvec3, 8>& points) {
  Sphere s;
  for (const glm::dvec3& p : points) s.centre += p / 8.0;
  for (const glm::dvec3& p : points) s.radius = std::max(s.radius, glm::length(p - s.centre));
  return s;
}

std::array<glm::dvec3, 8> corners(const Box3& box) {
  std::array<glm::dvec3, 8> c;
  for (int i = 0; i < 8; ++i)
    c[i] = {i & 1 ? box.high.x : box.low.x, i & 2 ? box.high.y : box.low.y,
            i & 4 ? box.high.z : box.low.z};
  return c;
}

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Returns the direction of v, or NaN if v is zero or not finite. Divides by the largest coordinate
// first, since the squares of very long and very short vectors leave the range of doubles.
glm::dvec3 unit(const Vec3d& v) {
  const glm::dvec3 d = to_glm(v);
  return glm::normalize(d / largest(d));
}

// Unit vectors to the right and up in the map, and towards the light.
struct Basis {
  glm::dvec3 right, up, back;
};

Basis light_basis(const glm::dvec3& direction, const Vec3d& wanted_up) {
  glm::dvec3 up = unit(wanted_up);
  // If the light is within about 0.6 degrees of the wanted vertical, the right axis would mostly be
  // rounding noise. The coordinate axis farthest from the light is then used as the vertical, as it
  // is if there is no wanted vertical (NaN fails the comparison).
  if (!(glm::length(glm::cross(up, direction)) >= 0.01)) {
    const glm::dvec3 a = glm::abs(direction);
    up = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                                  : (a.y <= a.z ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1));
  }
  Basis b;
  b.back = direction;
  b.right = glm::normalize(glm::cross(up, direction));
  b.up = glm::cross(direction, b.right);
  return b;
}

// Returns the part of the map's side that is not border.
double free_part(const LightFitOptions& options) {
  return 1 - 2 * options.border_texels / options.resolution;
}

Status check(const glm::dvec3& low, const glm::dvec3& high, const LightFitOptions& options) {
  if (!is_finite(low) || !is_finite(high) || low.x > high.x || low.y > high.y || low.z > high.z)
    return {ErrorCode::bad_option, "shadow map: the scene's bounds are empty or not finite"};
  // Squares of the coordinates are summed later and must not overflow.
  constexpr double kFarthest = 1e150;
  if (!(std::max(largest(low), largest(high)) <= kFarthest))
    return {ErrorCode::bad_option, "shadow map: the scene's bounds reach beyond 1e150"};
  if (!(options.border_texels >= 0))
    return {ErrorCode::bad_option,
            fmt::format("shadow map: a border of {} texels (0 or more)", options.border_texels)};
  if (options.resolution < 1 || !(free_part(options) > 0))
    return {ErrorCode::bad_option,
            fmt::format("shadow map: {} texels a side are too few for a border of {} texels",
                        options.resolution, options.border_texels)};
  return {};
}

}  // namespace

Vec3d transform_point(const Matrix4& m, const Vec3d& p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12],
          m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

Matrix4 relative_to(const Matrix4& m, const Vec3d& origin) {
  Matrix4 moved = m;
  for (int r = 0; r < 4; ++r)
    moved[12 + r] += m[r] * origin.x + m[4 + r] * origin.y + m[8 + r] * origin.z;
  return moved;
}

Vec3d transform_vector(const Matrix4& m, const Vec3d& v) {
  return {m[0] * v.x + m[4] * v.y + m[8] * v.z, m[1] * v.x + m[5] * v.y + m[9] * v.z,
          m[2] * v.x + m[6] * v.y + m[10] * v.z};
}

MapAxes map_axes(const Vec3d& direction, const Vec3d& up) {
  const Basis basis = light_basis(unit(direction), up);
  return {from_glm(basis.right), from_glm(basis.up)};
}

Result<LightFit> fit_light(const Vec3d& direction, const Box3& scene,
                           const LightFitOptions& options) {
  const glm::dvec3 low = to_glm(scene.low), high = to_glm(scene.high);
  const glm::dvec3 towards = unit(direction);
  if (!is_finite(towards))
    return Status{ErrorCode::bad_option, "shadow map: the light's direction is zero or not finite"};
  if (Status status = check(low, high, options); !status.ok()) return status;

  const Basis basis = light_basis(towards, options.up);
  const Sphere whole = around(corners(scene));
  Sphere fitted = whole;
  if (options.view) {
    std::array<glm::dvec3, 8> points;
    for (int i = 0; i < 8; ++i) {
      points[i] = to_glm(options.view_corners[i]);
      if (!is_finite(points[i]))
        return Status{ErrorCode::bad_option,
                      fmt::format("shadow map: corner {} of the view is not finite", i)};
    }
    const Sphere view = around(points);
    // The radius of a point is not always 0, since the mean of eight equal corners is rounded.
    const double rounding = glm::length(view.centre) * 1e-9;
    if (view.radius > rounding && view.radius < whole.radius) fitted = view;
  }
  // A scene of one point still needs a map of some size.
  const double smallest = std::max(glm::length(fitted.centre) * 1e-9, 1e-30);
  double side = std::max(2 * fitted.radius, smallest) / free_part(options);
  if (options.snap && options.view)
    side = std::exp2(std::ceil(std::log2(side) * 8) / 8);  // steps of 9 %: steady while zooming
  const double texel = side / options.resolution;

  double x = glm::dot(basis.right, fitted.centre), y = glm::dot(basis.up, fitted.centre);
  if (options.snap) {
    // Positions are rounded relative to the scene's centre and not to the origin, so that scenes
    // far from the origin snap as finely as others.
    const double cx = glm::dot(basis.right, whole.centre), cy = glm::dot(basis.up, whole.centre);
    x = cx + std::round((x - cx) / texel) * texel;
    y = cy + std::round((y - cy) / texel) * texel;
  }
  const double range = 2 * std::max(whole.radius, smallest) * 1.0001;
  const double nearest = glm::dot(basis.back, whole.centre) + range / 2;

  LightFit fit;
  fit.direction = from_glm(basis.back);
  fit.texel = texel;
  fit.depth_range = range;
  const glm::dvec3 rows[3] = {basis.right / side, basis.up / side, -basis.back / range};
  const double shift[3] = {0.5 - x / side, 0.5 - y / side, nearest / range};
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      fit.to_texture[c * 4 + r] = rows[r][c];
      fit.to_clip[c * 4 + r] = 2 * rows[r][c];
    }
    fit.to_texture[12 + r] = shift[r];
    fit.to_clip[12 + r] = 2 * shift[r] - 1;
  }
  fit.to_texture[15] = fit.to_clip[15] = 1;
  return fit;
}

}  // namespace atlas
