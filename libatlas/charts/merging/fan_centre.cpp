#include "libatlas/charts/merging/fan_centre.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libatlas/charts/geometry/tangents.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// The smallest accepted value of twice a fan triangle's area, relative to the cell's area.
constexpr double kThinFan = 1e-3;

class FanCentre {
 public:
  FanCentre(const CoarseMesh& mesh, const CoarseCell& cell)
      : cell_(cell), plane_(to_glm(cell.normal)) {
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      const glm::dvec3 d = to_glm(mesh.slot_position[s]) - to_glm(cell.centre);
      outline_.push_back(plane_.of(d));
    }
  }

  bool seen_in_full() const {
    for (std::size_t i = 0; i < outline_.size(); ++i) {
      if (side(outline_[i], outline_[(i + 1) % outline_.size()], {0, 0}) < kThinFan * cell_.area) {
        return false;
      }
    }
    return true;
  }

  // Leaves `centre` unchanged if no point sees the whole outline.
  void find(Vec3d& centre) const {
    double reach = 0;
    for (const glm::dvec2& p : outline_) reach = std::max({reach, std::abs(p.x), std::abs(p.y)});
    std::vector<glm::dvec2> kernel{
        {-reach, -reach}, {reach, -reach}, {reach, reach}, {-reach, reach}};
    for (std::size_t i = 0; i < outline_.size() && !kernel.empty(); ++i) {
      clip(kernel, outline_[i], outline_[(i + 1) % outline_.size()]);
    }
    if (kernel.empty()) return;
    glm::dvec2 mean(0);
    for (const glm::dvec2& p : kernel) mean += p / double(kernel.size());
    centre = from_glm(to_glm(cell_.centre) + mean.x * plane_.u + mean.y * plane_.v);
  }

 private:
  // Twice the signed area of triangle a, b, p.
  static double side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
  }

  void clip(std::vector<glm::dvec2>& kernel, const glm::dvec2& a, const glm::dvec2& b) const {
    std::vector<glm::dvec2> rest;
    const double least = kThinFan * cell_.area;
    for (std::size_t i = 0; i < kernel.size(); ++i) {
      const glm::dvec2 &p = kernel[i], &q = kernel[(i + 1) % kernel.size()];
      const double at_p = side(a, b, p) - least, at_q = side(a, b, q) - least;
      if (at_p >= 0) rest.push_back(p);
      if ((at_p >= 0) != (at_q >= 0)) rest.push_back(p + (q - p) * (at_p / (at_p - at_q)));
    }
    kernel = std::move(rest);
  }

  const CoarseCell& cell_;
  Tangents plane_;
  std::vector<glm::dvec2> outline_;  // relative to the centre, in the plane of the mean normal
};

}  // namespace

void centre_fan(const CoarseMesh& mesh, CoarseCell& cell) {
  const FanCentre fan(mesh, cell);
  if (!fan.seen_in_full()) fan.find(cell.centre);
}

}  // namespace atlas
