#include "libatlas/charts/piece_cuts.h"

#include <algorithm>

namespace atlas {
namespace {

std::vector<PieceCost> piece_costs(const Cut& cut) {
  std::vector<PieceCost> costs(cut.topology.component_count);
  const std::vector<std::uint32_t> piece = pieces_of(cut);
  for (std::uint32_t k = 0; k < cut.cells.count; ++k) {
    if (piece[k] != kNoIndex && cut.merged.chart_of_cell[k] == k) ++costs[piece[k]].charts;
  }
  for (std::size_t i = 0; i < cut.coarse.arcs.size(); ++i) {
    const CoarseArc& arc = cut.coarse.arcs[i];
    if (arc.cell[1] == kNoIndex || cut.merged.joined[i]) continue;
    if (piece[arc.cell[0]] != kNoIndex) costs[piece[arc.cell[0]]].seams += arc.length;
  }
  return costs;
}

}  // namespace

bool takes_any(std::span<const std::uint8_t> left_out) {
  return std::find(left_out.begin(), left_out.end(), 0) != left_out.end();
}

std::vector<std::uint32_t> pieces_of(const Cut& cut) {
  std::vector<std::uint32_t> piece(cut.cells.count, kNoIndex);
  for (std::uint32_t t = 0; t < cut.cells.of_triangle.size(); ++t) {
    if (cut.takes(t)) piece[cut.cells.of_triangle[t]] = cut.topology.component[t];
  }
  return piece;
}

std::vector<double> fan_errors(const Cut& cut) {
  const std::size_t n = cut.topology.component_count;
  std::vector<double> error(n, 0), area(n, 0);
  const std::vector<std::uint32_t> piece = pieces_of(cut);
  for (std::uint32_t k = 0; k < cut.cells.count; ++k) {
    if (piece[k] == kNoIndex) continue;
    const CoarseCell& cell = cut.coarse.cells[k];
    error[piece[k]] += cell.area * fan_error(cut.coarse, cell);
    area[piece[k]] += cell.area;
  }
  for (std::size_t k = 0; k < n; ++k) {
    if (area[k] > 0) error[k] /= area[k];
  }
  return error;
}

std::vector<PieceCost> chosen_costs(std::span<const Cut> cuts) {
  std::vector<PieceCost> least;
  for (const Cut& cut : cuts) {
    const std::vector<PieceCost> costs = piece_costs(cut);
    least.resize(costs.size());
    for (std::size_t k = 0; k < costs.size(); ++k) {
      if (!cut.left_out[k]) least[k] = costs[k];
    }
  }
  return least;
}

void choose(Cut& a, Cut& b, double share) {
  const std::vector<PieceCost> cost_a = piece_costs(a), cost_b = piece_costs(b);
  for (std::size_t k = 0; k < cost_a.size(); ++k) {
    if (a.left_out[k] || b.left_out[k]) continue;
    const bool fewer = double(cost_b[k].charts) <= share * double(cost_a[k].charts);
    (fewer && cost_b[k] < cost_a[k] ? a : b).left_out[k] = 1;
  }
}

}  // namespace atlas
