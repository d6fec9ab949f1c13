// Internal: walks around the vertices of a chart that has not been cut out as a mesh of its own.
#pragma once

#include <cstdint>

#include "libatlas/charts/mesh/local_chart.h"

namespace atlas {

// Walks around vertices, within one chart.
class ChartFans {
 public:
  // Where a vertex lies: inside the chart, on its border, or at its seams with itself.
  enum class Place : std::uint8_t { inside, border, seam };

  ChartFans(const Topology& topology, const Partition& partition)
      : topology_(topology), partition_(partition) {}

  std::uint32_t from(std::uint32_t h) const { return topology_.corner_vertex[h]; }
  std::uint32_t to(std::uint32_t h) const { return topology_.corner_vertex[next_half_edge(h)]; }
  bool inner(std::uint32_t h) const {
    const std::uint32_t o = topology_.opposite[h];
    return o != kNoIndex && partition_.chart[o / 3] == partition_.chart[h / 3];
  }
  bool linked(std::uint32_t h) const { return inner(h) && !partition_.seam(h); }

  // Visits the half-edges that leave the start of h, in both directions as far as `passes(g)`
  // allows crossing g. Returns whether that led all the way around.
  template <class Passes, class Visit>
  bool around(std::uint32_t h, const Passes& passes, const Visit& visit) const {
    std::uint32_t g = h;
    do {
      visit(g);
      const std::uint32_t back = previous_half_edge(g);
      if (!passes(back)) {
        for (g = h; passes(g);) visit(g = next_half_edge(topology_.opposite[g]));
        return false;
      }
      g = topology_.opposite[back];
    } while (g != h);
    return true;
  }

  // Returns where the start of h lies.
  Place place(std::uint32_t h) const {
    bool seams = false;
    const bool closed = around(
        h, [&](std::uint32_t g) { return inner(g); },
        [&](std::uint32_t g) { seams = seams || (inner(g) && partition_.seam(g)); });
    return seams ? Place::seam : closed ? Place::inside : Place::border;
  }

 private:
  const Topology& topology_;
  const Partition& partition_;
};

}  // namespace atlas
