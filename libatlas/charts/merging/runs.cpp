#include "libatlas/charts/merging/runs.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace atlas {
namespace {

constexpr double kSameLength = 1e-4;  // symmetric meshes are full of ties, see cost_classes.h

}  // namespace

bool keep_longest_run(const CoarseMesh& mesh, std::span<const Vec3d> forks,
                      std::vector<std::uint32_t>& glue) {
  const std::size_t n = glue.size();
  std::vector<std::size_t> run(n);
  std::iota(run.begin(), run.end(), 0u);
  const auto find = [&](std::size_t i) {
    while (run[i] != i) i = run[i] = run[run[i]];
    return i;
  };
  const auto ends = [&](std::uint32_t arc) {
    const CoarseArc& x = mesh.arcs[arc];
    return std::pair{mesh.slot_position[x.slot[0]], mesh.slot_position[x.slot[1]]};
  };
  const auto forked = [&](const Vec3d& p) {
    return std::find(forks.begin(), forks.end(), p) != forks.end();
  };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      const auto [p, q] = ends(glue[i]);
      const auto [r, s] = ends(glue[j]);
      const bool at_p = p == r || p == s, at_q = q == r || q == s;
      if ((at_p && !forked(p)) || (at_q && !forked(q))) run[find(j)] = find(i);
    }
  }
  std::vector<double> length(n, 0);
  for (std::size_t i = 0; i < n; ++i) length[find(i)] += mesh.arcs[glue[i]].weight;
  std::size_t best = 0;
  for (std::size_t i = 1; i < n; ++i) {
    if (length[i] > length[best] * (1 + kSameLength)) best = i;
  }
  std::vector<std::uint32_t> kept;
  for (std::size_t i = 0; i < n; ++i) {
    if (find(i) == best) kept.push_back(glue[i]);
  }
  if (kept.size() == n) return false;
  glue = std::move(kept);
  return true;
}

}  // namespace atlas
