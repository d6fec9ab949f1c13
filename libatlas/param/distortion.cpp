#include "libatlas/param/distortion.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libatlas/param/mesh/percentile.h"
#include "libatlas/param/mesh/rest_shape.h"

namespace atlas {
namespace {

using param::cross;

constexpr float infinity = std::numeric_limits<float>::infinity();

constexpr double upper_share = 0.001;  // of the area, which stretch_999 leaves out

// Triangles below this share of the mean area contain nothing but rounding noise.
constexpr double negligible_area = 1e-14;

TriangleStretch measure_triangle(const LocalMesh& mesh, std::span<const Vec2d> uvs, std::size_t t) {
  const param::RestShape rest = param::rest_shape(mesh, t);
  const glm::dvec2 u0 = to_glm(uvs[rest.v[0]]), u1 = to_glm(uvs[rest.v[1]]),
                   u2 = to_glm(uvs[rest.v[2]]);
  TriangleStretch out;
  out.area = rest.area();
  out.uv_area = 0.5 * cross(u1 - u0, u2 - u0);
  if (!(out.area > 0)) return out;
  // The Jacobian times twice the area, which saves divisions.
  const glm::dvec2 base = u1 - u0;
  const param::Jacobian j{rest.altitude * base, rest.length * (u2 - u0) - rest.foot * base};
  const double large = param::largest_singular_value(j), twice_area = rest.length * rest.altitude;
  const double determinant = std::abs(j.det());
  // The smaller value is the determinant divided by the larger one, which keeps digits that a
  // difference would lose.
  out.s1 = determinant > 0 ? static_cast<float>(twice_area * large / determinant) : infinity;
  out.s2 = large > 0 ? static_cast<float>(twice_area / large) : infinity;
  return out;
}

// Infinite also if the scale is 0: the NaN of 0 times infinity must not enter the sorted values.
float stretch(const TriangleStretch& t, double scale) {
  const double worst = std::max(t.s1 * scale, 1 / (t.s2 * scale));
  return std::isnan(worst) ? infinity : static_cast<float>(worst);
}

}  // namespace

void measure_triangles(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                       std::span<TriangleStretch> out) {
  assert(uvs.size() == mesh.positions.size() && out.size() == mesh.triangles.size());
  for (std::size_t t = 0; t < out.size(); ++t) out[t] = measure_triangle(mesh, uvs, t);
}

Distortion summarize_distortion(std::span<const TriangleStretch> triangles, double scale) {
  Distortion d;
  for (const TriangleStretch& t : triangles) {
    d.surface_area += t.area;
    d.uv_area += std::abs(t.uv_area);
    d.flips += t.uv_area < 0;
  }
  if (!(d.surface_area > 0)) return d;
  if (scale == 0) scale = std::sqrt(d.uv_area / d.surface_area);
  const double least = negligible_area * d.surface_area / static_cast<double>(triangles.size());
  param::UpperTail tail(upper_share * d.surface_area);
  double sum_l2 = 0, sum_conformal = 0, sum_area = 0, largest = 1;
  d.area_min = std::numeric_limits<double>::infinity();
  d.area_max = 0;
  for (const TriangleStretch& t : triangles) {
    if (!(t.area > least)) continue;
    d.degenerate += t.uv_area == 0;
    const double s1 = t.s1 * scale, s2 = t.s2 * scale, quotient = s1 / s2;
    sum_l2 += 0.5 * (s1 * s1 + s2 * s2) * t.area;
    sum_conformal += quotient * t.area;
    sum_area += t.area;
    const float worst = stretch(t, scale);
    largest = std::max<double>(largest, worst);
    d.conformal_max = std::max(d.conformal_max, quotient);
    d.area_min = std::min(d.area_min, s1 * s2);
    d.area_max = std::max(d.area_max, s1 * s2);
    tail.add(worst, t.area);
  }
  d.stretch_l2 = std::sqrt(sum_l2 / sum_area);
  d.conformal_mean = sum_conformal / sum_area;
  d.stretch_linf = largest;
  d.stretch_999 = param::value_above_budget(tail.values(), upper_share * sum_area);
  return d;
}

Distortion measure_distortion(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              std::span<double> per_triangle) {
  std::vector<TriangleStretch> triangles(mesh.triangles.size());
  measure_triangles(mesh, uvs, triangles);
  const Distortion d = summarize_distortion(triangles);
  if (!per_triangle.empty()) {
    assert(per_triangle.size() == triangles.size());
    const double scale = d.surface_area > 0 ? std::sqrt(d.uv_area / d.surface_area) : 1;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const bool bad =
          triangles[t].uv_area < 0 || (triangles[t].uv_area == 0 && triangles[t].area > 0);
      per_triangle[t] = bad                     ? std::numeric_limits<double>::infinity()
                        : triangles[t].area > 0 ? stretch(triangles[t], scale)
                                                : 1;
    }
  }
  return d;
}

double area_preserving_scale(const Distortion& distortion) {
  if (!(distortion.uv_area > 0) || !(distortion.surface_area > 0)) return 0;
  return std::sqrt(distortion.surface_area / distortion.uv_area);
}

}  // namespace atlas
