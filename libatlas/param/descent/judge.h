// Internal: tells whether a flattened chart is injective and within its bound.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/parameterize.h"

namespace atlas::param {

// The goal when single places are relaxed, as a share of the bound, so that rounding does not cross
// it.
inline constexpr double just_within = 1 - 1e-4;

// Whether both the stretch that 99.9 % of the area stays within and the L2 stretch are within the
// bound: beyond 99.9 % of the area there may be a sliver that is stretched without limit.
bool is_within(const Distortion& distortion, double bound);

// Scales r.uvs to the surface area, measures them, and fills in all that r says of them. `known` is
// their distortion, if it has been measured.
void judge(const LocalMesh& mesh, const ParamOptions& options, ParamResult& r,
           const Distortion* known = nullptr);

// Returns the triangles with more stretch than `bound`, worst first.
std::vector<std::uint32_t> beyond_bound(std::span<const double> stretch, double bound);

}  // namespace atlas::param
