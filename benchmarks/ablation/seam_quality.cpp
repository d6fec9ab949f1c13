#include "benchmarks/ablation/seam_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "examples/cabin/embree.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas::bench {
namespace {

using test::UvMesh;
using Ends = std::pair<std::uint32_t, std::uint32_t>;

constexpr int kRays = 32;
constexpr double kFlattest =
    1e-4;                      // twice a triangle's area / its longest edge squared, without normal
constexpr double kWindow = 8;  // mean edge lengths
constexpr double kBackAtOnce =
    0.2;  // chord / path below which a window turns back, and tells nothing

// Rays against the surface.
class Sky {
 public:
  Sky(const UvMesh& mesh, double size) : skin_(1e-5 * size) {
    device_ = rtcNewDevice(nullptr);
    scene_ = rtcNewScene(device_);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), mesh.positions.size()));
    for (const Vec3d& p : mesh.positions)
      for (const double x : {p.x, p.y, p.z}) *vertices++ = float(x);
    auto* indices = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.faces.size()));
    for (const UvMesh::Face& face : mesh.faces)
      indices = std::copy_n(face.position.begin(), 3, indices);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  Sky(const Sky&) = delete;
  Sky& operator=(const Sky&) = delete;
  ~Sky() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  // Returns the share that a point of the surface with this unit normal sees.
  double seen(const glm::dvec3& from, const glm::dvec3& normal) const {
    const glm::dvec3 other = std::abs(normal.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 u = glm::normalize(glm::cross(other, normal)), v = glm::cross(normal, u);
    const glm::dvec3 start = from + skin_ * normal;
    int open = 0;
    for (int i = 0; i < kRays; ++i) {
      const double square = (i + 0.5) / kRays, radius = std::sqrt(square);
      const double angle = 2 * std::numbers::pi * i * std::numbers::phi;
      const glm::dvec3 way =
          radius * (std::cos(angle) * u + std::sin(angle) * v) + std::sqrt(1 - square) * normal;
      RTCRay ray{};
      ray.org_x = float(start.x), ray.org_y = float(start.y), ray.org_z = float(start.z);
      ray.dir_x = float(way.x), ray.dir_y = float(way.y), ray.dir_z = float(way.z);
      ray.tnear = float(skin_), ray.tfar = INFINITY, ray.mask = ~0u;
      open += cabin::occluded(scene_, ray) ? 0 : 1;
    }
    return double(open) / kRays;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
  double skin_;
};

struct Side {
  std::uint32_t face, corner;  // the edge runs from this corner to the next
};

class Seams {
 public:
  explicit Seams(const UvMesh& mesh) : mesh_(mesh) {
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (const Vec3d& p : mesh.positions) {
      low = glm::min(low, to_glm(p));
      high = glm::max(high, to_glm(p));
    }
    size_ = glm::length(high - low);
    double edges = 0;
    for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) edges += add_face(f);
    window_ = kWindow * edges / (3 * double(mesh.faces.size()));
  }

  SeamQuality measure() {
    const Sky sky(mesh_, size_);
    SeamQuality quality;
    for (const auto& [ends, sides] : edges_) {
      if (sides.size() != 2 || !cut(sides[0], sides[1])) continue;
      const double length = glm::length(at(ends.second) - at(ends.first));
      quality.seam += length;
      quality.visible_smooth += length * weight(sky, ends, sides);
      next_[ends.first].push_back(ends.second);
      next_[ends.second].push_back(ends.first);
    }
    const double unit = std::sqrt(area_);
    quality.seam /= unit;
    quality.visible_smooth /= unit;
    quality.jag = jag();
    return quality;
  }

 private:
  glm::dvec3 at(std::uint32_t v) const { return to_glm(mesh_.positions[v]); }

  // Returns the sum of the lengths of the face's edges.
  double add_face(std::uint32_t f) {
    const auto& v = mesh_.faces[f].position;
    const glm::dvec3 normal = glm::cross(at(v[1]) - at(v[0]), at(v[2]) - at(v[0]));
    const double twice = glm::length(normal);
    double sum = 0, longest = 0;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      const double length = glm::length(at(b) - at(a));
      sum += length;
      longest = std::max(longest, length);
      if (a != b) edges_[std::minmax(a, b)].push_back({f, k});
    }
    area_ += twice / 2;
    normal_.push_back(twice > kFlattest * longest * longest ? normal / twice : glm::dvec3(0));
    return sum;
  }

  bool cut(const Side& a, const Side& b) const {
    const auto uv = [&](const Side& side, std::uint32_t vertex) {
      const UvMesh::Face& face = mesh_.faces[side.face];
      const std::uint32_t next = (side.corner + 1) % 3;
      const Vec2d place =
          mesh_.uvs[face.uv[face.position[side.corner] == vertex ? side.corner : next]];
      return std::array{double(face.page), place.x, place.y};
    };
    const UvMesh::Face& face = mesh_.faces[a.face];
    const std::uint32_t from = face.position[a.corner], to = face.position[(a.corner + 1) % 3];
    return uv(a, from) != uv(b, from) || uv(a, to) != uv(b, to);
  }

  // Slivers without normal leave the edge to their neighbour.
  double weight(const Sky& sky, const Ends& ends, const std::vector<Side>& sides) const {
    std::vector<glm::dvec3> normals;
    for (const Side& side : sides)
      if (normal_[side.face] != glm::dvec3(0)) normals.push_back(normal_[side.face]);
    if (normals.empty()) return 0;
    const double cosine = glm::dot(normals.front(), normals.back());
    const double bend = std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
    if (bend >= 60) return 0;
    double seen = 0;
    for (const double t : {0.2, 0.5, 0.8})
      for (const glm::dvec3& normal : normals)
        seen += sky.seen(glm::mix(at(ends.first), at(ends.second), t), normal);
    return seen / (3 * double(normals.size())) * (1 - bend / 60);
  }

  // Chains of seam edges run between ends and junctions; what is left then are rings.
  double jag() {
    for (const bool rings : {false, true})
      for (const auto& [start, neighbours] : next_) {
        if (!rings && neighbours.size() == 2) continue;
        for (const std::uint32_t to : neighbours)
          if (used_.insert(std::minmax(start, to)).second) add_chain(start, to);
      }
    return weight_ > 0 ? jags_ / weight_ : 1;
  }

  void add_chain(std::uint32_t start, std::uint32_t to) {
    std::vector<glm::dvec3> points{at(start), at(to)};
    for (std::uint32_t from = start, here = to; here != start && next_[here].size() == 2;) {
      const std::uint32_t ahead = next_[here][0] == from ? next_[here][1] : next_[here][0];
      if (!used_.insert(std::minmax(here, ahead)).second) break;
      points.push_back(at(ahead));
      from = here;
      here = ahead;
    }
    std::vector<double> along{0};
    for (std::size_t i = 1; i < points.size(); ++i)
      along.push_back(along.back() + glm::length(points[i] - points[i - 1]));
    const auto point = [&](double s) {
      const auto after = std::upper_bound(along.begin() + 1, along.end() - 1, s) - along.begin();
      const double length = along[after] - along[after - 1];
      return glm::mix(points[after - 1], points[after],
                      length > 0 ? (s - along[after - 1]) / length : 0);
    };
    for (double s = 0; s + window_ <= along.back(); s += window_ / 2) {
      const double chord = glm::length(point(s + window_) - point(s));
      if (chord <= kBackAtOnce * window_) continue;
      weight_ += window_;
      jags_ += window_ * window_ / chord;
    }
  }

  const UvMesh& mesh_;
  double size_ = 0, area_ = 0, window_ = 0;
  std::vector<glm::dvec3> normal_;
  std::map<Ends, std::vector<Side>> edges_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> next_;
  std::set<Ends> used_;
  double weight_ = 0, jags_ = 0;
};

}  // namespace

SeamQuality measure_seams(const test::UvMesh& mesh) {
  return Seams(mesh).measure();
}

}  // namespace atlas::bench
