#include "libatlas/charts/mesh/border_weight.h"

#include <algorithm>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

constexpr double kHidden = 0.75;      // the share of a seam's cost that a crease hides
constexpr double kInnerWeight = 1e3;  // of edges inside polygons

}  // namespace

double border_weight(const Topology& topology, std::uint32_t h, double crease_angle) {
  const std::uint32_t o = topology.opposite[h];
  const double length = topology.seam_weight(h) * edge_length(topology, h);
  if (topology.inner(h)) return kInnerWeight * length;
  const double cosine =
      glm::dot(to_dvec(topology.calm_normal(h / 3)), to_dvec(topology.calm_normal(o / 3)));
  const double bend = portable::acos(std::clamp(cosine, -1.0, 1.0));
  return length * (1 - kHidden * std::min(1.0, bend / crease_angle));
}

}  // namespace atlas
