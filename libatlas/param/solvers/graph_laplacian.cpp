#include "libatlas/param/solvers/graph_laplacian.h"

#include <algorithm>
#include <cmath>

namespace atlas::param {

template <class Real>
double edge_couplings(const Elements& elements, const HalfEdges& half_edges,
                      std::vector<Real>& out) {
  double largest = 0;
  out.resize(3 * elements.size());
  for (std::uint32_t t = 0; t < elements.size(); ++t) {
    const Element e = elements[t];
    const auto& corners = half_edges.corners(t);
    const std::uint32_t base = 3 * t + (corners[0] == e.v[0] ? 0 : corners[1] == e.v[0] ? 1 : 2);
    // Half the cotangents of the angles opposite to the edges: to the base and to the two others.
    const double rest = e.length - e.foot, scale = 0.5 / e.altitude;
    const double behind = e.foot * scale, before = rest * scale;
    const double top = 0.5 * (e.altitude - e.foot * rest / e.altitude) / e.length;
    largest = std::max({largest, std::abs(behind), std::abs(before), std::abs(top)});
    const std::uint32_t right = next_half_edge(base), left = next_half_edge(right);
    out[base] = static_cast<Real>(-e.weight * top);
    out[right] = static_cast<Real>(-e.weight * behind);
    out[left] = static_cast<Real>(-e.weight * before);
  }
  return largest;
}

template <class Real>
void build_graph(std::span<const Real> couplings, const HalfEdges& half_edges, std::size_t vertices,
                 GraphLaplacian<Real>& out) {
  const auto count = static_cast<std::uint32_t>(couplings.size() / 3);
  const auto each = [&](auto&& body) {
    for (std::uint32_t t = 0; t < count; ++t) {
      const auto& corners = half_edges.corners(t);
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t h = 3 * t + c, o = half_edges.opposite(h);
        if (o < h) continue;  // `none` is the largest
        body(corners[c], corners[c == 2 ? 0 : c + 1],
             o == kNoIndex ? couplings[h] : couplings[h] + couplings[o]);
      }
    }
  };
  gather_edges(vertices, each, out);
}

template double edge_couplings<float>(const Elements&, const HalfEdges&, std::vector<float>&);
template double edge_couplings<double>(const Elements&, const HalfEdges&, std::vector<double>&);
template void build_graph<float>(std::span<const float>, const HalfEdges&, std::size_t,
                                 GraphLaplacian<float>&);
template void build_graph<double>(std::span<const double>, const HalfEdges&, std::size_t,
                                  GraphLaplacian<double>&);

}  // namespace atlas::param
