// Internal: trials of mergers that failed, so that they need not be repeated.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace atlas {

// What a merger would have cost over the stretch of its charts apart. Larger charts around the same
// glue cost as much: what is flat with less stretch as a whole is so in its parts.
struct Refusal {
  std::uint32_t cell;  // one of the other chart
  double energy, high_area;
  bool settled, entangled;          // TrialOutcome
  std::vector<std::uint32_t> glue;  // ascending
};

// Whether a trial of larger charts along `glue` (ascending) would fail by what is known, if they
// may cost no more than so much over the charts apart.
inline bool fails_again(const Refusal& known, const std::vector<std::uint32_t>& glue, double energy,
                        double high_area) {
  // A trial's flattening is not quite the best one, so the costs count by less than all. But along
  // the very same glue a descent that came to its end comes to it again: of 1100 that had crossed
  // themselves and 1100 that had taken too much energy 3 and 8 did not (90 meshes). Area falls more
  // easily, 56 times of 2800.
  constexpr double sure_energy = 0.6, energy_again = 0.99, sure_area = 0.4;
  const bool again = known.settled && known.glue == glue;
  if (again && known.entangled) return true;
  return ((again ? energy_again : sure_energy) * known.energy > energy ||
          sure_area * known.high_area > high_area) &&
         (again || std::includes(glue.begin(), glue.end(), known.glue.begin(), known.glue.end()));
}

}  // namespace atlas
