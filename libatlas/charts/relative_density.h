// Internal: texel densities whose common factor is near 1.
#pragma once

#include <span>
#include <vector>

namespace atlas {

// Densities are relative: a common factor scales the uvs and must change nothing else.
struct RelativeDensity {
  std::vector<float> values = {};  // the densities / factor
  double factor = 1;               // a power of two, so that the division does not round
};

// Divides densities (finite, > 0) by the power of two in the middle of their range, so that neither
// the least nor the largest float is near. Densities that differ by too much for that keep their
// factor. Linear.
RelativeDensity relative_density(std::span<const float> density);

}  // namespace atlas
