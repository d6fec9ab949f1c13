#include "libatlas/charts/cells/faces.h"

#include <span>
#include <utility>

#include "libatlas/core/glm_bridge.h"

namespace atlas {
namespace {

// The normals of triangles in one plane differ by less than a quarter of a degree.
constexpr float kOnePlaneCosine = 1 - 1e-5f;
// A face has at least this share of the mean area of a cell in its piece. The value is not round,
// so that facets of equal size do not lie at the limit.
constexpr double kLeastArea = 0.2563;
// A plane is a facet of something round, and no face, if it bends by less than 35 degrees to its
// neighbours along more than kMostSoft of its border. Only neighbours with more than kFacet of its
// area count.
constexpr double kSoftCosine = 0.82, kMostSoft = 0.5, kFacet = 0.25;
constexpr std::uint32_t kAlone = kNoIndex - 1;  // not the name of a plane

class FaceFinder {
 public:
  FaceFinder(const Topology& topology, const CellPlan& plan, std::span<const std::uint8_t> left_out)
      : topology_(topology),
        plan_(plan),
        left_out_(left_out),
        plane_(topology.triangle_count(), kNoIndex) {}

  Regions run() {
    faces_.of_triangle.assign(topology_.triangle_count(), kNoIndex);
    for (std::uint32_t k = 0; k < plan_.pieces.count(); ++k) {
      const bool none = plan_.cells[k] == 0 || (!left_out_.empty() && left_out_[k]);
      faces_.share.push_back(none ? 0 : find_in(plan_.pieces.of(k), plan_.cells[k]));
    }
    return std::move(faces_);
  }

 private:
  // Connected triangles in one plane: a range of triangles_.
  struct Plane {
    std::uint32_t first = 0, last = 0;
    double area = 0;
  };

  // Returns the share of the piece's area that faces cover.
  double find_in(std::span<const std::uint32_t> piece, std::uint32_t cells) {
    planes_.clear();
    triangles_.clear();
    double area = 0, covered = 0;
    for (const std::uint32_t t : piece) {
      area += topology_.areas[t];
      if (plane_[t] != kNoIndex) continue;
      if (alone(t)) {
        plane_[t] = kAlone;
      } else {
        flood_plane(t);
      }
    }
    for (const Plane& plane : planes_) {
      if (plane.area < kLeastArea * area / cells || !is_face(plane)) continue;
      for (const std::uint32_t t : of(plane)) faces_.of_triangle[t] = plane_[t];
      covered += plane.area;
    }
    return covered > 0 ? covered / area : 0;
  }

  std::span<const std::uint32_t> of(const Plane& plane) const {
    return std::span(triangles_).subspan(plane.first, plane.last - plane.first);
  }

  glm::vec3 normal(std::uint32_t t) const { return to_glm(topology_.calm_normal(t)); }

  bool same_plane(std::uint32_t t, std::uint32_t u) const {
    return glm::dot(normal(t), normal(u)) >= kOnePlaneCosine;
  }

  // Whether no neighbour lies in the triangle's plane, as for most triangles of curved surfaces.
  bool alone(std::uint32_t t) const {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology_.opposite[h];
      if (o != kNoIndex && same_plane(t, o / 3)) return false;
    }
    return true;
  }

  double area_of_plane(std::uint32_t t) const {
    return plane_[t] == kAlone ? topology_.areas[t] : planes_[plane_[t]].area;
  }

  void flood_plane(std::uint32_t seed) {
    const auto name = static_cast<std::uint32_t>(planes_.size());
    Plane plane{static_cast<std::uint32_t>(triangles_.size()), 0, 0};
    triangles_.push_back(seed);
    plane_[seed] = name;
    for (std::size_t i = plane.first; i < triangles_.size(); ++i) {
      const std::uint32_t t = triangles_[i];
      plane.area += topology_.areas[t];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || plane_[o / 3] != kNoIndex) continue;
        if (!same_plane(seed, o / 3)) continue;
        plane_[o / 3] = name;
        triangles_.push_back(o / 3);
      }
    }
    plane.last = static_cast<std::uint32_t>(triangles_.size());
    planes_.push_back(plane);
  }

  // Whether the plane is a face and not a facet of something round. Such facets bend little to
  // neighbours of about their size.
  bool is_face(const Plane& plane) const {
    double border = 0, soft = 0;
    for (const std::uint32_t t : of(plane)) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = topology_.opposite[h];
        if (o == kNoIndex || plane_[o / 3] == plane_[t]) continue;
        const double length = edge_length(topology_, h);
        border += length;
        if (area_of_plane(o / 3) < kFacet * plane.area) continue;
        if (glm::dot(normal(t), normal(o / 3)) > kSoftCosine) soft += length;
      }
    }
    return soft <= kMostSoft * border;
  }

  const Topology& topology_;
  const CellPlan& plan_;
  std::span<const std::uint8_t> left_out_;
  Regions faces_;
  std::vector<std::uint32_t> plane_;  // one per triangle
  std::vector<Plane> planes_;         // of the piece
  std::vector<std::uint32_t> triangles_;
};

}  // namespace

Regions find_faces(const Topology& topology, const CellPlan& plan,
                   std::span<const std::uint8_t> left_out) {
  return FaceFinder(topology, plan, left_out).run();
}

}  // namespace atlas
