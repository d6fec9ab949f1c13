// Chart segmentation: a triangle mesh in, charts with their own flat coordinates out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/param/distortion.h"

namespace atlas {

// A view of a triangle mesh; what it points at must outlive it.
struct MeshView {
  std::span<const Vec3f> positions = {};          // finite
  std::span<const std::uint32_t> indices = {};    // 3 a triangle
  std::span<const std::uint32_t> materials = {};  // 1 a triangle, or empty: all alike
  // Relative linear texel density, finite and > 0: 1 a triangle, or empty. A common factor scales
  // the uvs and changes nothing else.
  std::span<const float> density = {};
  std::span<const Vec2f> texcoords = {};  // only for ChartOptions::keep_uv_charts
  // 3 a triangle, likewise; empty with one texcoord a position: those of `indices`. An index out of
  // range: that corner has none.
  std::span<const std::uint32_t> texcoord_indices = {};
  // 3 a triangle, or empty: not 0 if its edge from that corner to the next is a seam, across which
  // no chart continues. The triangle on either side may say so.
  std::span<const std::uint8_t> seams = {};
  // 1 a position, or empty: positions that lie at one place are one vertex only if these are equal,
  // so that no chart continues from one object to another, wherever they lie.
  std::span<const std::uint32_t> objects = {};
  // 1 a triangle, or empty: triangles with equal numbers are one polygon, inside which no seam runs
  // unless it cannot lie flat in one piece, or given seams, materials or texcoords cut it. Nothing
  // but equality counts.
  std::span<const std::uint32_t> polygons = {};
  // At least 0 and finite, 1 a position, or empty: all are 1. A seam along an edge counts its
  // length times the mean of its ends' weights where charts are made: seams keep away from high
  // weights, and more stretch is put up with where that saves them. Of positions that are one
  // vertex, the highest counts. Cuts for the page, or of what does not flatten, do not ask.
  std::span<const float> seam_weights = {};
};

enum class ChartPreset { fast, standard, best };

struct ChartOptions {
  // Hard limit on the angle between a chart's axis and the normals of its triangles, in degrees
  // (0..180); 0: none, cones only seed and max_stretch decides.
  double cone_degrees = 0;
  // Bound on max(s1, 1/s2) at the chart's area-preserving scale over 99.9 % of its area; > 1.
  double max_stretch = 1.25;
  // A seam along an edge that bends by this angle or more costs a quarter of one on a smooth
  // surface; at smaller angles less in proportion. Degrees, above 0, at most 180.
  double crease_degrees = 60;
  bool split_at_materials = true;  // a chart holds triangles of one material only
  // Keep the charts of the given texcoords and their shapes (scaled, turned, unmirrored), whatever
  // they stretch; only what is flipped, overlapping, degenerate, squeezed to a line, missing or
  // beyond cone_degrees is flattened anew.
  bool keep_uv_charts = false;
  // Width / height of the page that the given texcoords run over from 0 to 1; 1e-6..1e6.
  double uv_aspect = 1;
  // The same, one for each id of MeshView::materials, if their pages differ in shape. Triangles of
  // other ids, and all if this is empty, have uv_aspect. No given chart continues across a border
  // of materials whose aspects differ, also where split_at_materials is off.
  std::vector<double> material_uv_aspects = {};
  ChartPreset preset = ChartPreset::standard;
  // A chart so large that its smallest rectangle decides the page's size is cut across its limbs
  // until the pieces fill this share of their rectangles; so are the most wasteful charts where all
  // together fill little of their convex hulls. unwrap_mesh() and exports also cut, where this is
  // not 0, what is too long or too large for the pages that they pack. At least 0 (never) and below
  // 1. Not with keep_uv_charts.
  double min_fill = 0.72;
  // What seams count beside stretch, times MeshView::seam_weights; 1e-3..1e3. More: fewer charts
  // and shorter seams, which stretch more within max_stretch.
  double seam_weight = 1;
};

// Whether every option lies in the range given above; the message names the field and its range.
Status check_options(const ChartOptions& options);

// One chart and how good it is.
struct Chart {
  std::uint32_t first_triangle = 0, triangle_count = 0;  // range of ChartSet::chart_triangles
  std::uint32_t first_uv = 0, uv_count = 0;              // range of ChartSet::uvs
  std::uint32_t material = 0;      // of its triangles (of the first, if split_at_materials is off)
  Vec2d size = {};                 // width >= height of the box of its uvs, whose corner is (0, 0)
  Vec3f axis = {};                 // the direction of its normal cone
  double cone_degrees = 0;         // largest angle between axis and a triangle's normal
  bool planar_projection = false;  // the cheap parameterisation was enough
  bool kept = false;               // the given uvs' shape; max_stretch was not asked of it
  Distortion distortion = {};
};

// Every triangle of the input is in exactly one chart. Uvs are in scene units: lengths on the
// surface times the relative linear density. Every chart's map is injective, positively
// oriented, starts at (0, 0), and lies with its long side along u.
struct ChartSet {
  std::vector<Chart> charts = {};
  std::vector<std::uint32_t> triangle_chart = {};   // 1 a triangle
  std::vector<std::uint32_t> chart_triangles = {};  // by chart; then as make_charts() orders
  std::vector<Vec2d> uvs = {};                      // sorted by chart
  // 1 a uv: a vertex at its position (or 10^-12 off). Of several vertices at one place, which may
  // differ in normals and the like, this is any: take attributes by the corner's own index.
  std::vector<std::uint32_t> uv_vertex = {};
  std::vector<std::uint32_t> triangle_uv = {};  // 3 a triangle, into uvs, in the corner order of
                                                // indices (a triangle whose orientation disagrees
                                                // with its chart's is listed in flipped_triangles)
  std::vector<std::uint32_t> flipped_triangles = {};  // input orientation opposite to the chart's
  Distortion distortion = {};                         // means and sums; else of the worst chart
  double seam_length = 0;           // of interior edges that are chart borders, scene units
  double surface_area = 0;          // scene units squared
  std::uint64_t copied_pieces = 0;  // pieces of the mesh that took the charts of a congruent one
  struct Repairs {
    std::uint64_t degenerate_triangles = 0, duplicate_triangles = 0, nonmanifold_edges = 0,
                  nonmanifold_vertices = 0, misoriented_edges = 0, split_charts = 0;
    // Only with keep_uv_charts; both count given charts, not those they became. A piece of the mesh
    // without usable texcoords is reflattened.
    std::uint64_t kept_charts = 0, reflattened_charts = 0;
  } repairs = {};
  // Of the pieces with scan noise: their vertices, and those of them around which the angles add up
  // to less than a full turn divided by max_stretch squared. A chart with such a peak inside
  // exceeds the bound there. Not with keep_uv_charts.
  struct Noise {
    std::uint64_t vertices = 0, peaks = 0;
  } noise = {};
  struct Timing {  // CPU seconds, all threads
    double segmentation_cpu = 0, parameterization_cpu = 0;
    // Of segmentation: welding, links and pieces; normals without scan noise; micro-cells; their
    // coarse mesh; merging with its trials; shortening the borders.
    double topology_cpu = 0, noise_cpu = 0, cells_cpu = 0, coarse_cpu = 0, merging_cpu = 0,
           borders_cpu = 0;
    // Of parameterisation: charts cut open or divided; isometric descent and squeezing; flips
    // turned; overlaps found and drawn apart; fragments joined again; limbs cut. The first four
    // leave out charts of less than 256 triangles, which are over before a clock is read.
    double cuts_cpu = 0, solve_cpu = 0, flips_cpu = 0, overlaps_cpu = 0, absorb_cpu = 0,
           limbs_cpu = 0;
  } timing = {};
};

// Cuts the mesh into charts and flattens them. Geometry is scale- and translation-free; the result
// is the same for every thread count and order of triangles. Sources: Barladian et al., stage 1
// (normal cones); Sander et al. 2001 (stretch); docs/charts-method.md. Errors: bad_option,
// see check_options(); bad_input: no triangle, an index out of range, a position or density not
// usable, an array of the wrong length; unsupported: beyond 2^30 triangles; cancelled.
Result<ChartSet> make_charts(const MeshView& mesh, const ChartOptions& options,
                             const Context& context);

}  // namespace atlas
