#include "libatlas/charts/given_uvs.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "libatlas/charts/cut_pieces.h"
#include "libatlas/charts/flattening/touching.h"
#include "libatlas/charts/flattening/uv_folds.h"
#include "libatlas/charts/geometry/cone.h"
#include "libatlas/charts/mesh/local_chart.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/param/injectivity.h"
#include "libatlas/param/orient.h"

namespace atlas {
namespace {

// Triangles of a smaller altitude, relative to the square root of the chart's area, may be flipped
// by the rounding of what is written.
constexpr double kMinGivenAltitude = 1e-7;

// A chart whose uvs, with its surface's area, are longer than this multiple of its border is
// flattened anew: squares squeezed by more than 4096, as by projections seen edge-on, and charts
// with a texcoord far from all others. A single one would leave its page empty, and so little to
// the other charts that rounding bends them.
constexpr double kMaxLength = 16;

using Border = std::vector<std::array<std::uint32_t, 2>>;

// Decides whether one given chart can be kept.
class GivenChart {
 public:
  GivenChart(const FlattenInput& input, const MeshView& mesh, Partition& partition)
      : input_(input), mesh_(mesh), partition_(partition) {}

  // useless: its uvs do not help to flatten it.
  enum class Verdict { kept, bad, useless };

  Verdict run(std::span<const std::uint32_t> triangles, FlatChart& flat) {
    chart_.build(input_.topology, partition_, triangles);
    chart_.take_density(input_.density);
    const std::size_t missing = take_uvs();
    if (missing > 0) return missing < 3 * triangles.size() ? Verdict::bad : Verdict::useless;
    const double surface = surface_area(), uv_area = unmirror();
    if (!(uv_area > 0) || !(surface > 0)) return Verdict::useless;
    const LocalMesh mesh = chart_.mesh();
    if (!part_touching(mesh, std::sqrt(uv_area), uvs_)) return Verdict::bad;
    const NormalCone cone = normal_cone(input_.topology.normals, triangles);
    const double limit = radians(input_.options.cone_degrees);
    if (limit > 0 && triangles.size() > 1 && cone.angle > limit * (1 + 1e-9)) return Verdict::bad;
    place(std::sqrt(surface / uv_area), flat);
    if (flat.size.x > kMaxLength * std::max(border_length_, std::sqrt(surface)))
      return Verdict::bad;
    const InjectivityOptions safe{.clearance = kMinGivenAltitude * std::sqrt(surface)};
    const Injectivity check = check_injectivity(mesh, uvs_, safe);
    const auto has_area = [&](std::uint32_t i) { return !input_.topology.thin(triangles[i]); };
    if (!check.injective || std::any_of(check.thin.begin(), check.thin.end(), has_area))
      return Verdict::bad;
    flat.distortion = measure_distortion(mesh, uvs_);
    flat.triangles.assign(triangles.begin(), triangles.end());
    flat.corners = chart_.corners;
    flat.vertex = chart_.vertex;
    flat.uvs = uvs_;
    flat.cone = cone;
    flat.kept = true;
    return Verdict::kept;
  }

 private:
  // Takes the uvs, relative to the first corner's, which loses no digit of floats. Returns the
  // number of corners without uvs.
  std::size_t take_uvs() {
    uvs_.assign(chart_.positions.size(), Vec2d{});
    const std::span<const std::uint32_t> triangles = chart_.triangles();
    const double aspect = page_aspect(triangles.front());
    Vec2f first;
    std::size_t missing = 0;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t corner = input_.topology.input_corner(3 * triangles[i] + c);
        const std::uint32_t index =
            mesh_.texcoord_indices.empty() ? kNoIndex : mesh_.texcoord_indices[corner];
        if (index == kNoIndex) {
          ++missing;
          continue;
        }
        const Vec2f uv = mesh_.texcoords[index];
        if (i == 0 && c == 0) first = uv;
        uvs_[chart_.corners[i][c]] = {aspect * (double(uv.x) - first.x), double(uv.y) - first.y};
      }
    }
    return missing;
  }

  // Returns width / height of the page of the chart with this triangle. All of its triangles have
  // pages of that shape, since the topology is cut where shapes differ.
  double page_aspect(std::uint32_t triangle) const {
    const std::uint32_t material = mesh_.materials.empty() ? 0 : mesh_.materials[triangle];
    return uv_aspects(input_.options).of(material);
  }

  // Returns the surface area, times density squared.
  double surface_area() const {
    double area = 0;
    for (std::size_t i = 0; i < chart_.corners.size(); ++i) {
      const auto& [a, b, c] = chart_.corners[i];
      const glm::dvec3 p = to_glm(chart_.positions[a]);
      const double density = chart_.density.empty() ? 1 : chart_.density[i];
      area +=
          0.5 * density * density *
          glm::length(glm::cross(to_glm(chart_.positions[b]) - p, to_glm(chart_.positions[c]) - p));
    }
    return area;
  }

  // Mirrors the uvs if their area is negative. Returns the sum of the triangles' absolute areas.
  double unmirror() {
    double twice = 0, absolute = 0;
    for (const auto& [a, b, c] : chart_.corners) {
      const glm::dvec2 p = to_glm(uvs_[a]), e = to_glm(uvs_[b]) - p, f = to_glm(uvs_[c]) - p;
      const double cross = e.x * f.y - e.y * f.x;
      twice += cross;
      absolute += std::abs(cross);
    }
    if (twice < 0) {
      for (Vec2d& uv : uvs_) uv.x = -uv.x;
    }
    return 0.5 * absolute;
  }

  // Scales the uvs, turns them for packing, and measures the border.
  void place(double scale, FlatChart& flat) {
    for (Vec2d& uv : uvs_) uv = {uv.x * scale, uv.y * scale};
    border_.clear();
    border_length_ = 0;
    for (std::uint32_t h = 0; h < chart_.opposite.size(); ++h) {
      if (chart_.opposite[h] != kNoIndex) continue;
      const std::uint32_t next = next_half_edge(h);
      const std::uint32_t a = chart_.corners[h / 3][h % 3], b = chart_.corners[next / 3][next % 3];
      border_.push_back({a, b});
      const double density = chart_.density.empty() ? 1 : chart_.density[h / 3];
      border_length_ +=
          density * glm::length(to_glm(chart_.positions[b]) - to_glm(chart_.positions[a]));
    }
    flat.size = orient_for_packing(uvs_, border_).size;
  }

  const FlattenInput& input_;
  const MeshView& mesh_;
  Partition& partition_;
  LocalChart chart_;
  std::vector<Vec2d> uvs_;
  Border border_;
  double border_length_ = 0;  // on the surface, times density
};

using Verdict = GivenChart::Verdict;

// The triangles of each label below `count`, ascending.
struct Lists {
  std::vector<std::uint32_t> first, triangles;

  Lists(std::span<const std::uint32_t> labels, std::size_t count) : first(count + 2, 0) {
    for (const std::uint32_t k : labels) {
      if (k != kNoIndex) ++first[k + 2];
    }
    for (std::size_t k = 2; k < first.size(); ++k) first[k] += first[k - 1];
    triangles.resize(first.back());
    for (std::uint32_t t = 0; t < labels.size(); ++t) {
      if (labels[t] != kNoIndex) triangles[first[labels[t] + 1]++] = t;
    }
    first.pop_back();
  }
  std::span<const std::uint32_t> of(std::size_t k) const {
    return std::span(triangles).subspan(first[k], first[k + 1] - first[k]);
  }
  std::size_t size() const { return first.size() - 1; }
};

class GivenSet {
 public:
  GivenSet(const FlattenInput& input, const MeshView& mesh, const Context& context)
      : input_(input), mesh_(mesh), context_(context), topology_(input.topology) {}

  GivenUvsResult run() {
    take_over();
    if (!context_.cancelled() && result_.reflattened > 0) flatten_anew();
    if (context_.cancelled()) return {};
    sort_total(result_.charts.begin(), result_.charts.end(),
               [](const FlatChart& a, const FlatChart& b) {
                 return a.triangles.front() < b.triangles.front();
               });
    return std::move(result_);
  }

 private:
  void take_over() {
    const Lists lists(topology_.component, topology_.component_count);
    partition_.chart = topology_.component;
    partition_.seams.assign(topology_.triangle_count(), 0);
    partition_.local.resize(topology_.triangle_count());
    std::vector<FlatChart> flats;
    verdicts_ = judge(lists, flats);
    if (context_.cancelled()) return;
    for (std::size_t k = 0; k < flats.size(); ++k) {
      if (verdicts_[k] == Verdict::kept) result_.charts.push_back(std::move(flats[k]));
    }
    take_over_folded(lists);
    result_.kept_charts = result_.charts.size();
    for (const Verdict verdict : verdicts_) result_.reflattened += verdict != Verdict::kept;
  }

  std::vector<Verdict> judge(const Lists& lists, std::vector<FlatChart>& flats) {
    const std::size_t n = lists.size();
    std::vector<Verdict> verdicts(n, Verdict::bad);
    flats.resize(n);
    parallel_for(context_, n, n > 512 ? 16 : 1, [&](std::size_t begin, std::size_t end) {
      GivenChart trial(input_, mesh_, partition_);
      for (std::size_t k = begin; k < end; ++k) verdicts[k] = trial.run(lists.of(k), flats[k]);
    });
    return verdicts;
  }

  // Keeps folded charts all of whose parts can be kept.
  void take_over_folded(const Lists& lists) {
    UvFolds folds;
    for (std::uint32_t k = 0; k < verdicts_.size(); ++k) {
      if (verdicts_[k] == Verdict::bad) divide_at_folds({topology_, mesh_}, k, lists.of(k), folds);
    }
    if (folds.owner.empty()) return;
    for (std::size_t t = 0; t < folds.part.size(); ++t) {
      if (folds.part[t] != kNoIndex) partition_.chart[t] = folds.part[t];
    }
    std::vector<FlatChart> flats;
    const std::vector<Verdict> parts = judge({folds.part, folds.owner.size()}, flats);
    for (std::size_t i = 0, end = 0; i < parts.size(); i = end) {
      bool good = true;
      for (; end < parts.size() && folds.owner[end] == folds.owner[i]; ++end) {
        good = good && parts[end] == Verdict::kept;
      }
      if (!good) continue;
      verdicts_[folds.owner[i]] = Verdict::kept;
      for (std::size_t part = i; part < end; ++part) {
        result_.charts.push_back(std::move(flats[part]));
      }
    }
  }

  void flatten_anew() {
    std::vector<std::uint8_t> wanted(verdicts_.size(), 0);
    for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k] = verdicts_[k] == Verdict::bad;
    std::vector<FlatChart> whole = flatten_outlines(wanted);
    std::vector<std::uint32_t> count(verdicts_.size(), 0), other(verdicts_.size(), 0);
    for (const FlatChart& chart : whole) ++count[chart.piece(topology_)];
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      wanted[k] = verdicts_[k] == Verdict::useless || count[k] > 1;
    }
    if (context_.cancelled()) return;
    std::vector<FlatChart> parts = flatten_segments(wanted);
    for (const FlatChart& chart : parts) ++other[chart.piece(topology_)];
    // Whether the segments are better than the chart as a whole.
    const auto better = [&](std::uint32_t k) {
      return other[k] > 0 && (count[k] == 0 || other[k] < count[k]);
    };
    for (FlatChart& chart : whole) {
      if (!better(chart.piece(topology_))) result_.charts.push_back(std::move(chart));
    }
    for (FlatChart& chart : parts) {
      if (better(chart.piece(topology_))) result_.charts.push_back(std::move(chart));
    }
    for (std::uint32_t k = 0; k < count.size(); ++k) {
      result_.split_charts += verdicts_[k] == Verdict::bad && (count[k] > 1 || better(k));
    }
  }

  static bool any(const std::vector<std::uint8_t>& wanted) {
    return std::find(wanted.begin(), wanted.end(), 1) != wanted.end();
  }

  // Flattens each wanted component as one chart, which is divided where necessary.
  std::vector<FlatChart> flatten_outlines(const std::vector<std::uint8_t>& wanted) {
    if (!any(wanted)) return {};
    Partition partition;
    partition.chart = topology_.component;
    for (std::uint32_t& k : partition.chart) {
      if (k != kNoIndex && !wanted[k]) k = kNoIndex;
    }
    return flatten(partition, {});
  }

  // Segments and flattens each wanted component as if there were no uvs.
  std::vector<FlatChart> flatten_segments(const std::vector<std::uint8_t>& wanted) {
    std::vector<std::uint32_t> pieces;
    for (std::uint32_t k = 0; k < wanted.size(); ++k) {
      if (wanted[k]) pieces.push_back(k);
    }
    if (pieces.empty()) return {};
    CutCharts cut = cut_pieces(input_, pieces, context_);
    result_.timing.segmentation_cpu += cut.timing.segmentation_cpu;
    add_parts(cut.timing, result_.timing);
    return std::move(cut.charts);
  }

  std::vector<FlatChart> flatten(Partition& partition, Frames frames) {
    FlattenResult flat =
        flatten_charts({topology_, input_.density, input_.options, frames}, partition, context_);
    add_parts(flat.timing, result_.timing);
    return std::move(flat.charts);
  }

  const FlattenInput& input_;
  const MeshView& mesh_;
  const Context& context_;
  const Topology& topology_;
  Partition partition_;            // of the trials
  std::vector<Verdict> verdicts_;  // one per component
  GivenUvsResult result_;
};

}  // namespace

std::vector<std::uint32_t> usable_texcoords(const MeshView& mesh) {
  std::vector<std::uint32_t> indices(mesh.texcoord_indices.begin(), mesh.texcoord_indices.end());
  for (std::uint32_t& i : indices) {
    const bool usable = i < mesh.texcoords.size() && std::isfinite(mesh.texcoords[i].x) &&
                        std::isfinite(mesh.texcoords[i].y);
    if (!usable) i = kNoIndex;
  }
  return indices;
}

GivenUvsResult flatten_given_uvs(const FlattenInput& input, const MeshView& mesh,
                                 const Context& context) {
  return GivenSet(input, mesh, context).run();
}

}  // namespace atlas
