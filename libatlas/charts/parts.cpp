#include "libatlas/charts/parts.h"

#include <algorithm>
#include <compare>
#include <iterator>

#include "libatlas/charts/copies.h"
#include "libatlas/charts/mesh/pieces.h"
#include "libatlas/charts/segment.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// Pieces that repeat others are set aside if they are at least this part of the triangles.
constexpr std::size_t kCopiedShare = 4;

// Ways to cut a mesh that ChartPreset::best tries, each from other cells.
constexpr int kBestAttempts = 4;

// What was made of a piece; the less the better.
struct Cost {
  std::size_t charts = 0;
  double seams = 0;  // length
  auto operator<=>(const Cost&) const = default;
};

std::vector<Cost> costs(const Topology& topology, const Partition& partition,
                        std::span<const FlatChart> charts) {
  std::vector<Cost> costs(topology.component_count);
  for (const FlatChart& chart : charts) ++costs[topology.component[chart.triangles.front()]].charts;
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    const std::uint32_t o = topology.opposite[h];
    if (o == kNoIndex || partition.chart[h / 3] == kNoIndex) continue;
    if (partition.chart[h / 3] == partition.chart[o / 3] && !partition.seam(h)) continue;
    costs[topology.component[h / 3]].seams += 0.5 * edge_length(topology, h);
  }
  return costs;
}

// The charts of a mesh, as one attempt after the other made them: of each piece the best so far.
class BestCharts {
 public:
  explicit BestCharts(const Topology& topology) : topology_(topology) {}

  void take(const Partition& partition, std::vector<FlatChart> charts) {
    const std::vector<Cost> made = costs(topology_, partition, charts);
    std::vector<bool> better(made.size(), least_.empty());
    for (std::size_t piece = 0; piece < least_.size(); ++piece) {
      better[piece] = made[piece] < least_[piece];
      if (better[piece]) least_[piece] = made[piece];
    }
    if (least_.empty()) least_ = made;
    const auto changes = [&](const FlatChart& chart) {
      return better[topology_.component[chart.triangles.front()]];
    };
    std::erase_if(charts_, changes);
    std::copy_if(std::move_iterator(charts.begin()), std::move_iterator(charts.end()),
                 std::back_inserter(charts_), changes);
  }

  std::vector<FlatChart> charts() && {
    std::sort(charts_.begin(), charts_.end(), [](const FlatChart& a, const FlatChart& b) {
      return a.triangles.front() < b.triangles.front();
    });
    return std::move(charts_);
  }

 private:
  const Topology& topology_;
  std::vector<FlatChart> charts_;
  std::vector<Cost> least_;  // 1 a piece
};

// Appends the charts of a mesh, without regard to copies.
void cut_mesh(const FlattenInput& mesh, const Context& context, CutCharts& out) {
  const int attempts = mesh.options.preset == ChartPreset::best ? kBestAttempts : 1;
  BestCharts best(mesh.topology);
  for (int i = 0; i < attempts; ++i) {
    const double start = cpu_seconds();
    Segmentation segmentation = segment(mesh.topology, mesh.options, double(i) / attempts, context);
    if (context.cancelled()) return;
    return_freed_memory();
    out.timing.segmentation_cpu += cpu_seconds() - start;
    context.report("charts", (i + 0.5) / attempts);
    FlattenResult flat =
        flatten_charts({mesh.topology, mesh.density, mesh.options, segmentation.frames},
                       segmentation.partition, context);
    add_parts(segmentation.timing, out.timing);
    add_parts(flat.timing, out.timing);
    out.split_charts += flat.split_charts;
    if (context.cancelled()) return;
    if (attempts == 1) {
      std::move(flat.charts.begin(), flat.charts.end(), std::back_inserter(out.charts));
    } else {
      best.take(segmentation.partition, std::move(flat.charts));
    }
  }
  if (attempts > 1) {
    std::vector<FlatChart> charts = std::move(best).charts();
    std::move(charts.begin(), charts.end(), std::back_inserter(out.charts));
  }
}

class Repeater {
 public:
  Repeater(const FlattenInput& mesh, const PieceCopies& copies, const Context& context)
      : mesh_(mesh), copies_(copies), context_(context), pieces_(mesh.topology) {}

  CutCharts run() {
    std::vector<std::uint32_t> originals;
    for (std::uint32_t piece = 0; piece < copies_.original.size(); ++piece) {
      if (copies_.original[piece] == piece) originals.push_back(piece);
    }
    cut_pieces(originals);
    if (context_.cancelled()) return {};
    const std::vector<std::uint32_t> failed = copy_charts();
    if (!failed.empty()) cut_pieces(failed);
    std::sort(out_.charts.begin(), out_.charts.end(), [](const FlatChart& a, const FlatChart& b) {
      return a.triangles.front() < b.triangles.front();
    });
    return std::move(out_);
  }

 private:
  std::uint32_t piece_of(const FlatChart& chart) const {
    return mesh_.topology.component[chart.triangles.front()];
  }

  // Appends the charts of these pieces.
  void cut_pieces(std::span<const std::uint32_t> pieces) {
    const PieceMesh part = PieceCutter(mesh_.topology).cut(pieces);
    std::vector<float> density;
    if (!mesh_.density.empty()) {
      for (const std::uint32_t t : part.triangles) density.push_back(mesh_.density[t]);
    }
    Frames none;
    const std::size_t before = out_.charts.size();
    cut_mesh({part.topology, density, mesh_.options, none}, context_, out_);
    for (std::size_t k = before; k < out_.charts.size(); ++k) {
      FlatChart& chart = out_.charts[k];
      for (std::uint32_t& t : chart.triangles) t = part.triangles[t];
      for (std::uint32_t& v : chart.vertex) v = part.topology.source_vertex[v];
    }
  }

  // Gives the copies their originals' charts; returns those that cannot take them.
  std::vector<std::uint32_t> copy_charts() {
    const std::vector<std::uint32_t> first = charts_by_piece();
    std::vector<std::uint32_t> copies, place;
    std::size_t charts = out_.charts.size();
    for (std::uint32_t piece = 0; piece < copies_.original.size(); ++piece) {
      const std::uint32_t original = copies_.original[piece];
      if (original == piece) continue;
      copies.push_back(piece);
      place.push_back(static_cast<std::uint32_t>(charts));
      charts += first[original + 1] - first[original];
    }
    std::vector<std::uint8_t> broken(copies.size(), 0);
    out_.charts.resize(charts);
    const ChartCopier copier(mesh_, pieces_);
    parallel_for(context_, copies.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const std::uint32_t original = copies_.original[copies[i]];
        for (std::uint32_t k = first[original]; k < first[original + 1] && !broken[i]; ++k) {
          FlatChart& own = out_.charts[place[i] + k - first[original]];
          broken[i] = !copier.copy(out_.charts[k], original, copies[i], own);
        }
      }
    });
    return drop_broken(copies, place, broken);
  }

  std::vector<std::uint32_t> drop_broken(const std::vector<std::uint32_t>& copies,
                                         const std::vector<std::uint32_t>& place,
                                         const std::vector<std::uint8_t>& broken) {
    std::vector<std::uint32_t> failed;
    for (std::size_t i = 0; i < copies.size(); ++i) {
      out_.copied_pieces += !broken[i];
      if (!broken[i]) continue;
      failed.push_back(copies[i]);
      const std::size_t end = i + 1 < copies.size() ? place[i + 1] : out_.charts.size();
      for (std::size_t k = place[i]; k < end; ++k) out_.charts[k].triangles.clear();
    }
    if (failed.empty()) return failed;
    std::erase_if(out_.charts, [](const FlatChart& chart) { return chart.triangles.empty(); });
    return failed;
  }

  // Sorts the charts by piece; returns where those of each start.
  std::vector<std::uint32_t> charts_by_piece() {
    std::stable_sort(
        out_.charts.begin(), out_.charts.end(),
        [&](const FlatChart& a, const FlatChart& b) { return piece_of(a) < piece_of(b); });
    std::vector<std::uint32_t> first(copies_.original.size() + 1, 0);
    for (const FlatChart& chart : out_.charts) ++first[piece_of(chart) + 1];
    for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
    return first;
  }

  const FlattenInput& mesh_;
  const PieceCopies& copies_;
  const Context& context_;
  PieceList pieces_;
  CutCharts out_;
};

}  // namespace

CutCharts cut_into_charts(const Topology& topology, std::span<const float> density,
                          const ChartOptions& options, const Context& context) {
  Frames none;
  const FlattenInput mesh{topology, density, options, none};
  if (topology.component_count > 1) {
    const double start = cpu_seconds();
    const PieceCopies copies = find_copies(topology, density);
    const double looking = cpu_seconds() - start;
    CutCharts out;
    if (kCopiedShare * copies.copied_triangles >= topology.triangle_count()) {
      out = Repeater(mesh, copies, context).run();
    } else {
      cut_mesh(mesh, context, out);
    }
    out.timing.segmentation_cpu += looking;
    return out;
  }
  CutCharts out;
  cut_mesh(mesh, context, out);
  return out;
}

}  // namespace atlas
