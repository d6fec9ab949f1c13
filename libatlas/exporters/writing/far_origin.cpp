#include "libatlas/exporters/writing/far_origin.h"

#include "libatlas/core/bounds.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

constexpr double kFarSizes = 128;

}  // namespace

bool too_far_for_floats(const World& world) {
  Bounds<glm::dvec3> box;
  for (const Vec3f& p : world.positions) box.add(to_dvec(p));
  return !world.positions.empty() &&
         glm::length(to_glm(world.origin)) > kFarSizes * glm::length(box.size());
}

}  // namespace atlas
