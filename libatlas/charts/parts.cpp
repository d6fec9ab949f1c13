#include "libatlas/charts/parts.h"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "libatlas/charts/copies.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// Copies are treated separately if they have at least one kCopiedShare-th of the triangles.
constexpr std::size_t kCopiedShare = 4;

class Repeater {
 public:
  Repeater(const FlattenInput& mesh, const PieceCopies& copies, const Context& context)
      : mesh_(mesh), copies_(copies), context_(context), pieces_(mesh.topology) {}

  CutCharts run() {
    std::vector<std::uint32_t> originals;
    for (std::uint32_t piece = 0; piece < copies_.original.size(); ++piece) {
      if (copies_.original[piece] == piece) originals.push_back(piece);
    }
    append(cut_pieces(mesh_, originals, context_), out_);
    if (context_.cancelled()) return {};
    const std::vector<std::uint32_t> failed = copy_charts();
    if (!failed.empty()) append(cut_pieces(mesh_, failed, context_), out_);
    sort_by_triangle(out_.charts);
    return std::move(out_);
  }

 private:
  // Gives the copies their originals' charts. Returns the copies that cannot take them.
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

  // Sorts the charts by piece. Returns where those of each piece start.
  std::vector<std::uint32_t> charts_by_piece() {
    std::stable_sort(out_.charts.begin(), out_.charts.end(),
                     [&](const FlatChart& a, const FlatChart& b) {
                       return a.piece(mesh_.topology) < b.piece(mesh_.topology);
                     });
    std::vector<std::uint32_t> first(copies_.original.size() + 1, 0);
    for (const FlatChart& chart : out_.charts) ++first[chart.piece(mesh_.topology) + 1];
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
  const double start = own_cpu_seconds();
  PieceCopies copies;
  if (topology.component_count > 1) copies = find_copies(topology, density);
  const double looking = own_cpu_seconds() - start;
  CutCharts out;
  if (copies.copied_triangles > 0 &&
      kCopiedShare * copies.copied_triangles >= topology.triangle_count()) {
    out = Repeater(mesh, copies, context).run();
  } else {
    std::vector<std::uint32_t> pieces(topology.component_count);
    std::iota(pieces.begin(), pieces.end(), 0u);
    out = cut_pieces(mesh, pieces, context);
  }
  out.timing.segmentation_cpu += looking;
  return out;
}

}  // namespace atlas
