#include "libatlas/charts/flattening/fitting_run.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "libatlas/charts/geometry/rigid_fit.h"

namespace atlas {
namespace {

constexpr std::size_t none = std::size_t(-1);

// An edge of the common border in both charts' uvs, with its two ends in the order of the first
// chart.
struct Link {
  std::array<std::uint32_t, 2> own, other;
  std::size_t next = none, previous = none;
};

std::vector<Link> link_edges(const Topology& topology, const ChartPair& pair,
                             std::span<const BorderEdge> edges) {
  std::vector<Link> links;
  std::map<std::uint32_t, std::size_t> leaving;  // by the first chart's vertex
  for (const BorderEdge& edge : edges) {
    const auto [to, from] = ends_of(pair.b, topology.opposite[edge.half_edge]);
    links.push_back({ends_of(pair.a, edge.half_edge), {from, to}});
    leaving[links.back().own[0]] = links.size() - 1;
  }
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto next = leaving.find(links[i].own[1]);
    if (next == leaving.end() || links[next->second].other[0] != links[i].other[1]) continue;
    links[i].next = next->second;
    links[next->second].previous = i;
  }
  return links;
}

// Lists all maximal runs. The edges of a closed run are listed twice in a row, without the last
// one.
std::vector<std::vector<std::size_t>> list_runs(std::span<const Link> links) {
  std::vector<std::vector<std::size_t>> runs;
  std::vector<bool> seen(links.size(), false);
  for (const bool closed : {false, true}) {
    for (std::size_t start = 0; start < links.size(); ++start) {
      if (seen[start] || (!closed && links[start].previous != none)) continue;
      std::vector<std::size_t> run;
      for (std::size_t i = start; i != none && !seen[i]; i = links[i].next) {
        seen[i] = true;
        run.push_back(i);
      }
      const std::size_t length = run.size();
      for (std::size_t i = 0; closed && i + 1 < length; ++i) run.push_back(run[i]);
      runs.push_back(std::move(run));
    }
  }
  return runs;
}

}  // namespace

std::vector<BorderEdge> find_fitting_run(const Topology& topology, const ChartPair& pair,
                                         std::span<const BorderEdge> edges, double most_misfit) {
  const std::vector<Link> links = link_edges(topology, pair, edges);
  const double whole = length_of(edges);
  std::vector<BorderEdge> best;
  double best_share = 0;
  for (const std::vector<std::size_t>& run : list_runs(links)) {
    std::vector<RigidFit> fits;  // of all edges before
    const Link& first = links[run[0]];
    fits.emplace_back(to_glm(pair.a.uvs[first.own[0]]), to_glm(pair.b.uvs[first.other[0]]));
    for (const std::size_t i : run) {
      fits.push_back(fits.back());
      for (const int end : {0, 1}) {
        fits.back().add(to_glm(pair.a.uvs[links[i].own[end]]),
                        to_glm(pair.b.uvs[links[i].other[end]]), 0.5 * edges[i].length);
      }
    }
    for (std::size_t begin = 0; begin < run.size(); ++begin) {
      for (std::size_t end = std::min(begin + edges.size(), run.size()); end > begin; --end) {
        const RigidFit fit = fits[end].since(fits[begin]);
        const double share = std::round(kBorderParts * fit.weight() / whole);
        if (share <= best_share) break;
        if (fit.motion().misfit > most_misfit) continue;
        best_share = share;
        best.clear();
        for (std::size_t i = begin; i < end; ++i) best.push_back(edges[run[i]]);
        break;
      }
    }
  }
  return best;
}

}  // namespace atlas
