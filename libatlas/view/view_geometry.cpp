#include "libatlas/view/view_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// A vertex with more corners is the hub of thin triangles, which keep their own normals: comparing
// each of them with all others would take quadratic time.
constexpr std::size_t kHub = 1024;

// Returns the low 10 bits of a value with two zeros after each bit. Three such values interleave to
// a Morton code.
std::uint32_t spread(double value) {
  std::uint32_t x = std::uint32_t(value) & 1023u;
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

}  // namespace

glm::vec3 corner_normal(std::span<const std::uint32_t> corners_there,
                        const std::vector<glm::vec3>& faces, std::uint32_t own,
                        float least_cosine) {
  const glm::vec3 mine = unit_or(faces[own], glm::vec3(0, 0, 1));
  if (corners_there.size() > kHub) return mine;
  glm::vec3 sum(0);
  for (const std::uint32_t corner : corners_there) {
    const glm::vec3& other = faces[corner / 3];
    const float cosine = glm::dot(unit_or(other, mine), mine);
    if (std::abs(cosine) >= least_cosine) sum += cosine < 0 ? -other : other;
  }
  return unit_or(sum, mine);
}

std::uint32_t morton_code(const glm::dvec3& point) {
  return spread(point.x) | spread(point.y) << 1 | spread(point.z) << 2;
}

Box3 middle_of(const std::vector<Vec3f>& positions) {
  glm::dvec3 low(0), high(0);
  std::vector<float> values(positions.size());
  for (int axis = 0; axis < 3 && !values.empty(); ++axis) {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = to_glm(positions[i])[axis];
    const auto at = [&](double fraction) {
      const auto n = std::ptrdiff_t(std::lround(double(values.size() - 1) * fraction));
      std::nth_element(values.begin(), values.begin() + n, values.end());
      return double(values[std::size_t(n)]);
    };
    low[axis] = at(0.05);
    high[axis] = at(0.95);
  }
  return {from_glm(low), from_glm(high)};
}

void enclose(const ViewScene& view, ViewScene::Cluster& c) {
  constexpr float kMost = std::numeric_limits<float>::max();
  glm::vec3 low(kMost), high(-kMost);
  for (std::uint32_t i = c.first; i < c.first + c.count; ++i) {
    low = glm::min(low, to_glm(view.positions[view.indices[i]]));
    high = glm::max(high, to_glm(view.positions[view.indices[i]]));
  }
  const glm::vec3 centre = low * 0.5f + high * 0.5f;  // high - low may leave the range of float
  c.centre = from_glm(centre);
  double radius = 0;  // in double, since squares of small lengths underflow floats
  for (std::uint32_t i = c.first; i < c.first + c.count; ++i)
    radius = std::max(radius,
                      glm::length(to_dvec(view.positions[view.indices[i]]) - glm::dvec3(centre)));
  c.radius = float(radius * 1.0001);  // margin for rounding
}

}  // namespace atlas
