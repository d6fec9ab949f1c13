// Internal: records trials of mergers that failed, so that they need not be repeated.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atlas {

// What a merger would have cost over the stretch of its two charts apart. Larger charts with the
// same glue cost as much, since what flattens with less stretch as a whole does so in its parts.
struct Refusal {
  std::uint32_t cell;  // any cell of the other chart
  double energy, high_area;
  bool settled, entangled;          // as in TrialOutcome
  std::vector<std::uint32_t> glue;  // ascending
  // Of the chart that it is stored with, and of the other one, at that time.
  std::size_t own_slots = 0, other_slots = 0;
};

// Whether a trial of larger charts along `glue` (ascending) is known to fail if it may cost at most
// this energy and area over the charts apart.
inline bool fails_again(const Refusal& known, const std::vector<std::uint32_t>& glue, double energy,
                        double high_area) {
  // A trial's flattening is not quite the best one, so known costs are reduced by these factors.
  // But a descent that ran to its end along the very same glue ends there again: of 1100 trials
  // that had crossed themselves only 3 did not do so again, and of 1100 that had taken too much
  // energy only 8 (90 meshes). Area falls more easily: 56 times of 2800.
  constexpr double sure_energy = 0.6, energy_again = 0.99, sure_area = 0.4;
  const bool again = known.settled && known.glue == glue;
  if (again && known.entangled) return true;
  return ((again ? energy_again : sure_energy) * known.energy > energy ||
          sure_area * known.high_area > high_area) &&
         (again || std::includes(glue.begin(), glue.end(), known.glue.begin(), known.glue.end()));
}

}  // namespace atlas
