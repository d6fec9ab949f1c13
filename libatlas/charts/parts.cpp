#include "libatlas/charts/parts.h"

#include <algorithm>

#include "libatlas/charts/copies.h"
#include "libatlas/charts/pieces.h"
#include "libatlas/charts/segment.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// Pieces that repeat others are set aside if they are at least this part of the triangles.
constexpr std::size_t kCopiedShare = 4;

// Appends the charts of a mesh, without regard to copies.
void cut_mesh(const FlattenInput& mesh, const Context& context, CutCharts& out) {
  const double start = cpu_seconds();
  Segmentation segmentation = segment(mesh.topology, mesh.options, context);
  if (context.cancelled()) return;
  return_freed_memory();
  out.timing.segmentation_cpu += cpu_seconds() - start;
  context.report("charts", 0.5);
  FlattenResult flat =
      flatten_charts({mesh.topology, mesh.density, mesh.options, segmentation.frames},
                     segmentation.partition, context);
  add_parts(segmentation.timing, out.timing);
  add_parts(flat.timing, out.timing);
  out.split_charts += flat.split_charts;
  std::move(flat.charts.begin(), flat.charts.end(), std::back_inserter(out.charts));
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
