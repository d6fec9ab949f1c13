#include "libatlas/charts/piece_cuts.h"

#include <algorithm>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// The cosine of the angle from which a triangle counts as far from its cell, too.
constexpr float kFoldCosine = 0.57f;

// Calls visit(piece, t, o) for every edge between two triangles of a piece that is taken.
template <typename Visit>
void for_each_edge(const Cut& cut, const Visit& visit) {
  const Topology& topology = cut.topology;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    if (!cut.takes(t)) continue;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o != kNoIndex && o > h) visit(topology.component[t], t, o / 3);
    }
  }
}

std::vector<PieceCost> piece_costs(const Cut& cut) {
  std::vector<PieceCost> costs(cut.topology.component_count);
  const std::vector<std::uint32_t> piece = pieces_of(cut);
  for (std::uint32_t k = 0; k < cut.cells.count; ++k) {
    if (piece[k] != kNoIndex && cut.merged.chart_of_cell[k] == k) ++costs[piece[k]].charts;
  }
  for (std::size_t i = 0; i < cut.coarse.arcs.size(); ++i) {
    const CoarseArc& arc = cut.coarse.arcs[i];
    if (arc.cell[1] == kNoIndex || cut.merged.joined[i]) continue;
    if (piece[arc.cell[0]] != kNoIndex) costs[piece[arc.cell[0]]].seams += arc.weight;
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

std::vector<double> folds_in_cells(const Cut& cut) {
  const Topology& topology = cut.topology;
  const std::vector<std::uint32_t>& cell = cut.cells.of_triangle;
  std::vector<double> folds(topology.component_count, 0), triangles(folds);
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    if (cut.takes(t)) ++triangles[topology.component[t]];
  }
  for_each_edge(cut, [&](std::uint32_t piece, std::uint32_t t, std::uint32_t u) {
    if (cell[t] != cell[u]) return;
    const glm::vec3 a = to_glm(topology.calm_normal(t)), b = to_glm(topology.calm_normal(u));
    if (glm::dot(a, b) < kFoldCosine) ++folds[piece];
  });
  for (std::size_t k = 0; k < folds.size(); ++k) {
    if (triangles[k] > 0) folds[k] /= triangles[k];
  }
  return folds;
}

std::vector<double> crossed_borders(const Cut& cut, const Regions& regions) {
  const std::vector<std::uint32_t>& cell = cut.cells.of_triangle;
  std::vector<double> crossed(cut.topology.component_count, 0), all(crossed);
  for_each_edge(cut, [&](std::uint32_t piece, std::uint32_t t, std::uint32_t u) {
    if (!regions.part(t, u)) return;
    ++all[piece];
    if (cell[t] == cell[u]) ++crossed[piece];
  });
  for (std::size_t k = 0; k < crossed.size(); ++k) {
    if (all[k] > 0) crossed[k] /= all[k];
  }
  return crossed;
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

void choose(Cut& a, Cut& b, double share, bool or_shorter) {
  const std::vector<PieceCost> cost_a = piece_costs(a), cost_b = piece_costs(b);
  for (std::size_t k = 0; k < cost_a.size(); ++k) {
    if (a.left_out[k] || b.left_out[k]) continue;
    const bool few = double(cost_b[k].charts) <= share * double(cost_a[k].charts) ||
                     (or_shorter && cost_b[k].charts == cost_a[k].charts);
    (few && cost_b[k] < cost_a[k] ? a : b).left_out[k] = 1;
  }
}

}  // namespace atlas
