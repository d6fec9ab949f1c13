#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/charts/assemble_charts.h"
#include "libatlas/charts/charts.h"
#include "libatlas/charts/filling/limbs.h"
#include "libatlas/charts/flattening/flatten.h"
#include "libatlas/charts/given_uvs.h"
#include "libatlas/charts/mesh/canonical_mesh.h"
#include "libatlas/charts/mesh/noise.h"
#include "libatlas/charts/mesh/welded_mesh.h"
#include "libatlas/charts/parts.h"
#include "libatlas/charts/relative_density.h"
#include "libatlas/charts/totals.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/progress.h"

namespace atlas {
namespace {

Status check_texcoords(const MeshView& mesh) {
  if (mesh.texcoord_indices.empty() && !mesh.texcoords.empty()) {
    return {ErrorCode::bad_input,
            fmt::format("mesh: {} texcoords for {} positions (one each, or give texcoord indices)",
                        mesh.texcoords.size(), mesh.positions.size())};
  }
  if (mesh.texcoord_indices.empty() || mesh.texcoord_indices.size() == mesh.indices.size()) {
    return {};
  }
  return {ErrorCode::bad_input, "mesh: texcoord indices must be empty or 3 a triangle"};
}

void count_defects(const TopologyDefects& defects, ChartSet::Repairs& repairs) {
  repairs.degenerate_triangles = defects.degenerate_triangles;
  repairs.duplicate_triangles = defects.duplicate_triangles;
  repairs.nonmanifold_edges = defects.nonmanifold_edges;
  repairs.nonmanifold_vertices = defects.nonmanifold_vertices;
  repairs.misoriented_edges = defects.misoriented_edges;
}

struct Work {
  const Topology& topology;
  const MeshView& mesh;
  const ChartOptions& options;
};

// Segments and flattens; counts and times go into `set`.
std::vector<FlatChart> cut_charts(const Work& work, const Context& context, ChartSet& set) {
  CutCharts cut = cut_into_charts(work.topology, work.mesh.density, work.options, context);
  if (context.cancelled()) return {};
  set.timing.segmentation_cpu += cut.timing.segmentation_cpu;
  add_parts(cut.timing, set.timing);
  set.repairs.split_charts = cut.split_charts;
  set.copied_pieces = cut.copied_pieces;
  Stopwatch watch(own_cpu_seconds);
  Frames none;
  const FlattenInput input{work.topology, work.mesh.density, work.options, none};
  cut_limbs(input, cut.charts, context);
  set.timing.limbs_cpu = watch.lap();
  return std::move(cut.charts);
}

// The same with the charts of the given texcoords.
std::vector<FlatChart> keep_charts(const Work& work, const Context& context, ChartSet& set) {
  Frames none;
  GivenUvsResult given =
      flatten_given_uvs({work.topology, work.mesh.density, work.options, none}, work.mesh, context);
  set.timing.segmentation_cpu += given.timing.segmentation_cpu;
  add_parts(given.timing, set.timing);
  set.repairs.split_charts = given.split_charts;
  set.repairs.kept_charts = given.kept_charts;
  set.repairs.reflattened_charts = given.reflattened;
  return std::move(given.charts);
}

// Multiplies all weights of seams.
void weigh_seams(double by, Topology& topology) {
  if (by == 1) return;
  if (topology.seam_weights.empty()) topology.seam_weights.assign(topology.points.size(), 1);
  for (float& weight : topology.seam_weights)
    weight = float(std::min(by * double{weight}, double{std::numeric_limits<float>::max()}));
}

// Length of the edges that exactly two triangles share in space, but not in uv.
double seam_length(const Topology& topology, const ChartSet& set) {
  const auto uv = [&](std::uint32_t h) { return set.triangle_uv[topology.input_corner(h)]; };
  const auto seam = [&](std::uint32_t h) {
    const std::uint32_t o = topology.opposite[h];
    if (o == kNoIndex || (uv(h) == uv(next_half_edge(o)) && uv(next_half_edge(h)) == uv(o))) {
      return 0.0;
    }
    return edge_length(topology, h);
  };
  double length = 0;
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    if (h < topology.opposite[h]) length += seam(h);
  }
  for (const std::uint32_t h : topology.fan_links) length -= seam(h);
  length = std::max(length, 0.0);  // rounding leaves less than nothing of equal sums
  return length / topology.scale + topology.cut_length;
}

// Names triangles and corners as the input does.
void number_as_given(const CanonicalMesh& mesh, ChartSet& set) {
  std::vector<std::uint32_t> values(set.triangle_chart.size());
  for (std::uint32_t t = 0; t < values.size(); ++t)
    values[mesh.input_triangle(t)] = set.triangle_chart[t];
  set.triangle_chart.swap(values);
  values.resize(set.triangle_uv.size());
  for (std::uint32_t h = 0; h < values.size(); ++h)
    values[mesh.input_corner(h)] = set.triangle_uv[h];
  set.triangle_uv.swap(values);
  for (auto* triangles : {&set.chart_triangles, &set.flipped_triangles})
    for (std::uint32_t& t : *triangles) t = mesh.input_triangle(t);
  std::sort(set.flipped_triangles.begin(), set.flipped_triangles.end());
}

}  // namespace

Status check_options(const ChartOptions& options) {
  const auto must = [](const char* field, double value, const char* range) {
    return Status(ErrorCode::bad_option,
                  fmt::format("ChartOptions::{} is {:g}; it must {}", field, value, range));
  };
  if (!(options.cone_degrees >= 0 && options.cone_degrees <= 180))
    return must("cone_degrees", options.cone_degrees, "lie within 0..180 degrees (0: no limit)");
  if (!(options.max_stretch > 1) || !std::isfinite(options.max_stretch))
    return must("max_stretch", options.max_stretch, "be a number above 1");
  if (!(options.crease_degrees > 0 && options.crease_degrees <= 180))
    return must("crease_degrees", options.crease_degrees, "be above 0 degrees and at most 180");
  if (!(options.min_fill >= 0 && options.min_fill < 1))
    return must("min_fill", options.min_fill, "be at least 0 (never cut for it) and below 1");
  if (!(options.seam_weight >= 1e-3 && options.seam_weight <= 1e3))
    return must("seam_weight", options.seam_weight, "lie within 0.001..1000 (1: as usual)");
  if (!is_enumerator(options.preset, ChartPreset::best))
    return must("preset", int(options.preset), "be a ChartPreset");
  constexpr const char* kAspect = "be a page's width / height within 1e-6..1e6 (1: square)";
  if (!(options.uv_aspect >= 1e-6 && options.uv_aspect <= 1e6))
    return must("uv_aspect", options.uv_aspect, kAspect);
  for (const double aspect : options.material_uv_aspects)
    if (!(aspect >= 1e-6 && aspect <= 1e6)) return must("material_uv_aspects", aspect, kAspect);
  return {};
}

void add_parts(const ChartSet::Timing& parts, ChartSet::Timing& sum) {
  using T = ChartSet::Timing;
  for (const auto part : {&T::topology_cpu, &T::noise_cpu, &T::cells_cpu, &T::coarse_cpu,
                          &T::merging_cpu, &T::borders_cpu, &T::cuts_cpu, &T::solve_cpu,
                          &T::flips_cpu, &T::overlaps_cpu, &T::absorb_cpu, &T::limbs_cpu}) {
    sum.*part += parts.*part;
  }
}

Result<ChartSet> make_charts(const MeshView& mesh, const ChartOptions& options,
                             const Context& context) {
  if (Status status = check_options(options); !status.ok()) return status;
  const double start = own_cpu_seconds();
  context.report("charts", 0);
  MeshView given = mesh;
  std::vector<std::uint32_t> texcoord_indices;
  if (options.keep_uv_charts) {
    if (mesh.texcoord_indices.empty() && mesh.texcoords.size() == mesh.positions.size())
      given.texcoord_indices = mesh.indices;  // one a vertex
    if (Status status = check_texcoords(given); !status.ok()) return status;
    texcoord_indices = usable_texcoords(given);
    given.texcoord_indices = texcoord_indices;
  }
  Result<WeldedVertices> welded = weld_mesh(given);
  if (!welded.ok()) return welded.status();
  const RelativeDensity relative = relative_density(mesh.density);
  given.density = relative.values;
  CanonicalMesh canonical = canonical_mesh(given, *welded);
  welded = WeldedVertices{};
  given = canonical.view(given.texcoords);
  given.objects = mesh.objects;  // one per input vertex, as source_vertex names them
  Result<Topology> built = build_topology(
      {given, std::move(canonical.places), std::move(canonical.opposite)},
      {options.split_at_materials, options.keep_uv_charts, uv_aspects(options)}, context);
  if (!built.ok()) return built.status();
  weigh_seams(options.seam_weight, *built);
  const Topology& topology = *built;
  ChartSet set;
  count_defects(topology.defects, set.repairs);
  for (const float area : topology.areas) set.surface_area += area;
  set.surface_area /= topology.scale * topology.scale;
  set.timing.segmentation_cpu = own_cpu_seconds() - start;
  set.timing.noise_cpu = topology.noise_cpu;
  set.timing.topology_cpu = set.timing.segmentation_cpu - topology.noise_cpu;

  if (!options.keep_uv_charts) set.noise = measure_noise(topology, options.max_stretch);

  context.report("charts", 0.1);
  const Context rest = part_of_stage(context, "charts", 0.1);
  std::vector<FlatChart> charts = options.keep_uv_charts
                                      ? keep_charts({topology, given, options}, rest, set)
                                      : cut_charts({topology, given, options}, rest, set);
  if (context.cancelled()) return Status::cancelled();
  return_freed_memory();
  assemble_charts({given, topology, relative.factor}, charts, set);
  set.seam_length = seam_length(topology, set);
  number_as_given(canonical, set);
  set.distortion = total_distortion(set.charts);
  set.timing.parameterization_cpu = own_cpu_seconds() - start - set.timing.segmentation_cpu;
  context.report("charts", 1);
  return set;
}

}  // namespace atlas
