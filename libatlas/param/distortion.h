// Measures how far a flattening is from an isometry.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/core/vec.h"
#include "libatlas/param/local_mesh.h"

namespace atlas {

// Distortion of a set of triangles, weighted by surface area, at the set's own area-preserving
// scale. s1 >= s2 are the singular values of the uv-to-surface map (Sander et al. 2001, whose
// Linf is the largest s1); 1 is perfect. ChartSet::distortion says what it holds of many charts.
struct Distortion {
  double stretch_l2 = 1;      // sqrt of the mean of (s1² + s2²) / 2
  double stretch_linf = 1;    // largest max(s1, 1/s2)
  double stretch_999 = 1;     // max(s1, 1/s2) that 99.9 % of the area stays within
  double conformal_mean = 1;  // mean of s1 / s2
  double conformal_max = 1;
  double area_min = 1, area_max = 1;  // extremes of s1 s2 (surface area per uv area)
  double surface_area = 0;
  double uv_area = 0;            // sum of absolute values
  std::uint64_t flips = 0;       // triangles with the wrong sign in uv
  std::uint64_t degenerate = 0;  // triangles with zero uv area but not zero surface area
};

// The distortion of one triangle, before any scale is applied.
struct TriangleStretch {
  double area = 0;     // on the surface, times density squared; >= 0
  double uv_area = 0;  // signed, negative: flipped
  float s1 = 1;        // singular values of the uv-to-surface map, s1 >= s2 >= 0
  // Both are 1 for a triangle without surface area; s1 is infinite for one without uv area.
  float s2 = 1;
};

// Fills out[t] for every triangle, of any set of triangles. out.size() must be triangles.size(),
// and uvs.size() positions.size().
void measure_triangles(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                       std::span<TriangleStretch> out);

// Sums triangles of one chart, or of many charts one after another. `scale` multiplies s1 and s2; 0
// means the area-preserving one, sqrt(uv area / surface area). Triangles of less than 1e-14 of the
// mean area count only for areas and flips (if their uv area is negative). Takes O(n). Source:
// Sander et al. 2001, section 3.
Distortion summarize_distortion(std::span<const TriangleStretch> triangles, double scale = 0);

// Both steps for one chart. per_triangle (one per triangle, or empty) receives max(s1, 1/s2) at the
// area-preserving scale; it is infinite for a flipped triangle or one without uv area.
Distortion measure_distortion(const LocalMesh& mesh, std::span<const Vec2d> uvs,
                              std::span<double> per_triangle = {});

// Returns the factor that makes uvs area-preserving, sqrt(surface area / uv area); 0 without area.
double area_preserving_scale(const Distortion& distortion);

}  // namespace atlas
