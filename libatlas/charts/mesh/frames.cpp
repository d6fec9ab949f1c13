#include "libatlas/charts/mesh/frames.h"

#include "libatlas/core/glm_bridge.h"

namespace atlas {

std::uint32_t Frames::add(const Shared& map) {
  shared_.push_back(map);
  return static_cast<std::uint32_t>(shared_.size() - 1);
}

void Frames::put(std::uint32_t t, const Frame& frame) {
  if (source_[t] != kNoIndex && (source_[t] & kOwn)) {
    own_[source_[t] & ~kOwn] = frame;
    return;
  }
  source_[t] = kOwn | static_cast<std::uint32_t>(own_.size());
  own_.push_back(frame);
}

Frames::Frame Frames::turned(const std::array<Vec3d, 2>& rows, const Vec3d& from, const Vec3d& to) {
  const glm::dvec3 a = to_glm(from), b = to_glm(to);
  const double cosine = glm::dot(a, b);
  const glm::dvec3 axis = glm::cross(a, b);
  const auto turn = [&](const Vec3d& row) {
    const glm::dvec3 x = to_glm(row);
    if (cosine < -0.99) return from_glm(glm::vec3(x));
    return from_glm(
        glm::vec3(cosine * x + glm::cross(axis, x) + axis * (glm::dot(axis, x) / (1 + cosine))));
  };
  return {turn(rows[0]), turn(rows[1])};
}

Frames::Frame Frames::at(const Topology& topology, std::uint32_t t) const {
  const std::uint32_t source = source_[t];
  if (source == kNoIndex) return {};
  if (source & kOwn) return own_[source & ~kOwn];
  const Shared& map = shared_[source];
  return turned(map.rows, map.normal, from_glm(to_dvec(topology.normals[t])));
}

}  // namespace atlas
