#include "libatlas/unwrap/like/lay_beside.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/relaxing/relax.h"
#include "libatlas/unwrap/like/grow_charts.h"

namespace atlas {
namespace {

// What is known of a uv.
enum class Known : std::uint8_t {
  nothing,
  start,  // where it lay when its corner lay elsewhere
  fixed,
};

// Connected triangles of one chart that have no uvs yet, or may lose theirs.
struct Region {
  std::uint32_t chart = 0;
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<std::uint32_t, 3>> corners;  // counter-clockwise, into uvs
  std::vector<std::uint32_t> source;                  // one per uv: GrownCharts::uv
  std::vector<std::uint32_t> free;                    // uvs that may move
  std::vector<Vec3d> positions;                       // one per uv, in texels
  std::vector<double> density;
  std::vector<Vec2d> uvs;
  std::vector<std::uint8_t> known;

  LocalMesh mesh() const { return {positions, corners, density, {}}; }
};

class Layer {
 public:
  Layer(const JoinedMesh& mesh, const LayLimits& limits, PageGrid& grid, TakenUvs& taken)
      : mesh_(mesh),
        limits_(limits),
        grid_(grid),
        taken_(taken),
        rounding_(rounding_of(limits.pages)),
        grown_(grow_charts(mesh, taken)),
        known_(mesh.corners.size(), Known::nothing),
        uv_(mesh.corners.size()),
        local_(mesh.corners.size(), kNoIndex),
        stretches_(taken.chart_page.size()) {}

  void run() {
    for (const TakenState state : {TakenState::moved, TakenState::same}) {
      for (std::uint32_t c = 0; c < known_.size(); ++c) {
        if (taken_.state[c / 3] != state) continue;
        known_[grown_.uv[c]] = state == TakenState::same ? Known::fixed : Known::start;
        uv_[grown_.uv[c]] = taken_.texels[c / 3][c % 3];
      }
    }
    measure_charts();
    std::vector<std::uint8_t> seen(mesh_.triangle_count(), 0);
    for (std::uint32_t t = 0; t < seen.size(); ++t) {
      if (seen[t] || !changed(t)) continue;
      Region region = region_at(t, seen);
      if (lay(region))
        accept(region);
      else
        for (const std::uint32_t u : region.triangles) {
          taken_.chart[u] = kNoIndex;
          taken_.state[u] = TakenState::none;
        }
    }
  }

 private:
  bool changed(std::uint32_t t) const {
    return taken_.state[t] == TakenState::beside || taken_.state[t] == TakenState::moved;
  }
  glm::dvec3 point(std::uint32_t corner) const {
    return to_dvec(mesh_.points[mesh_.corners[corner]]);
  }
  double density(std::uint32_t t) const { return limits_.density.empty() ? 1 : limits_.density[t]; }

  // The stretch of a triangle that stays, as its chart has it.
  TriangleStretch stretch_of(std::uint32_t t) const {
    std::array<std::uint32_t, 3> corners{0, 1, 2};
    if (grown_.sense[t] < 0) std::swap(corners[1], corners[2]);
    const std::array<Vec3d, 3> positions{from_glm(point(3 * t)), from_glm(point(3 * t + 1)),
                                         from_glm(point(3 * t + 2))};
    const double dense = density(t);
    TriangleStretch out;
    measure_triangles({PositionView(positions), {&corners, 1}, {&dense, 1}, {}}, taken_.texels[t],
                      {&out, 1});
    return out;
  }

  // Sums up the triangles of each chart that stay.
  void measure_charts() {
    for (std::uint32_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (taken_.state[t] != TakenState::same) continue;
      stretches_[taken_.chart[t]].push_back(stretch_of(t));
    }
    for (const auto& chart : stretches_) {
      const Distortion d = summarize_distortion(chart);
      area_ += d.surface_area;
      texels_ += d.uv_area;
      scales_.push_back(d.surface_area > 0 ? std::sqrt(d.uv_area / d.surface_area) : 0);
      bounds_.push_back(std::max(limits_.max_stretch, d.stretch_999));
    }
    const double all = area_ > 0 ? std::sqrt(texels_ / area_) : 1;
    for (double& scale : scales_) {
      if (!(scale > 0)) scale = all;
    }
  }

  Region region_at(std::uint32_t first, std::vector<std::uint8_t>& seen) {
    Region region;
    region.chart = taken_.chart[first];
    region.triangles.push_back(first);
    seen[first] = 1;
    for (std::size_t i = 0; i < region.triangles.size(); ++i) {
      const std::uint32_t t = region.triangles[i];
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t o = mesh_.across[h];
        if (o == kNoIndex || taken_.seams[h] || seen[o / 3] || !changed(o / 3)) continue;
        seen[o / 3] = 1;
        region.triangles.push_back(o / 3);
      }
    }
    for (const std::uint32_t t : region.triangles) add_triangle(t, region);
    for (const std::uint32_t uv : region.source) local_[uv] = kNoIndex;
    return region;
  }

  void add_triangle(std::uint32_t t, Region& region) {
    std::array<std::uint32_t, 3> corners{3 * t, 3 * t + 1, 3 * t + 2};
    if (grown_.sense[t] < 0) std::swap(corners[1], corners[2]);
    for (std::uint32_t& corner : corners) {
      const std::uint32_t uv = grown_.uv[corner];
      if (local_[uv] == kNoIndex) {
        local_[uv] = std::uint32_t(region.source.size());
        if (known_[uv] != Known::fixed) region.free.push_back(local_[uv]);
        region.source.push_back(uv);
        region.positions.push_back(from_glm(point(corner) * scales_[region.chart]));
        region.uvs.push_back(uv_[uv]);
        region.known.push_back(known_[uv] != Known::nothing);
      }
      corner = local_[uv];
    }
    region.corners.push_back(corners);
    region.density.push_back(density(t));
  }

  bool lay(Region& region) {
    const bool placed =
        std::find(region.known.begin(), region.known.end(), 0) == region.known.end();
    if (placed && fits(region)) return true;
    if (!placed && !unfold(region)) return false;
    param::Elements elements;
    elements.build(region.mesh(), 0);
    param::CornerLists corners;
    corners.build(elements, region.uvs.size());
    param::Relaxer relaxer;
    return relaxer.settle(elements, corners, region.free, region.uvs) && fits(region);
  }

  // Gives uvs that are not known a place, round by round: where the triangles with two known ones
  // put them.
  static bool unfold(Region& region) {
    struct Sum {
      glm::dvec2 at{0};
      int count = 0;
    };
    std::vector<Sum> sums(region.uvs.size());
    const Buckets corners_at =
        sort_into_buckets(3 * region.corners.size(), region.uvs.size(),
                          [&](std::size_t i) { return region.corners[i / 3][i % 3]; });
    std::vector<std::uint32_t> front(region.corners.size()), found;
    std::iota(front.begin(), front.end(), 0u);
    while (!front.empty()) {
      found.clear();
      for (const std::uint32_t t : front) {
        const auto& corners = region.corners[t];
        const auto unknown = std::find_if(corners.begin(), corners.end(),
                                          [&](std::uint32_t v) { return !region.known[v]; });
        if (unknown == corners.end()) continue;
        const auto k = std::size_t(unknown - corners.begin());
        const std::uint32_t a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
        if (!region.known[a] || !region.known[b]) continue;
        Sum& sum = sums[*unknown];
        sum.at += unfolded(region, {a, b, *unknown});
        if (sum.count++ == 0) found.push_back(*unknown);
      }
      front.clear();
      for (const std::uint32_t v : found) {
        region.uvs[v] = from_glm(sums[v].at / double(sums[v].count));
        region.known[v] = 1;
        for (const std::uint32_t corner : corners_at[v]) front.push_back(corner / 3);
      }
      std::sort(front.begin(), front.end());
      front.erase(std::unique(front.begin(), front.end()), front.end());
    }
    return std::find(region.known.begin(), region.known.end(), 0) == region.known.end();
  }

  // The place of the third corner, left of the way from the first to the second.
  static glm::dvec2 unfolded(const Region& region, const std::array<std::uint32_t, 3>& corners) {
    const glm::dvec3 p = to_glm(region.positions[corners[0]]),
                     along = to_glm(region.positions[corners[1]]) - p,
                     to = to_glm(region.positions[corners[2]]) - p;
    const glm::dvec2 a = to_glm(region.uvs[corners[0]]), edge = to_glm(region.uvs[corners[1]]) - a;
    const double squared = glm::dot(along, along), length = glm::length(edge);
    if (!(squared > 0) || !(length > 0)) return a;
    const double foot = glm::dot(to, along) / squared,
                 height = glm::length(glm::cross(along, to)) / std::sqrt(squared);
    return a + edge * foot + glm::dvec2(-edge.y, edge.x) * (height / length);
  }

  std::uint32_t page(const Region& region) const { return taken_.chart_page[region.chart]; }

  TexelCorners texels_of(const Region& region, std::size_t i) const {
    const auto& c = region.corners[i];
    return {region.uvs[c[0]], region.uvs[c[1]], region.uvs[c[2]]};
  }

  // Whether the region's uvs can be taken, after they were rounded to floats.
  bool fits(Region& region) {
    const Extent extent = limits_.pages[page(region)];
    const auto round = [](double texel, std::int32_t side) {
      return double(float(texel / side)) * side;
    };
    for (const std::uint32_t v : region.free) {
      Vec2d& uv = region.uvs[v];
      if (!(uv.x >= 0 && uv.x <= extent.width && uv.y >= 0 && uv.y <= extent.height)) return false;
      uv = {round(uv.x, extent.width), round(uv.y, extent.height)};
    }
    return within_bound(region) && finds_room(region);
  }

  bool within_bound(const Region& region) const {
    std::vector<TriangleStretch> own(region.triangles.size());
    measure_triangles(region.mesh(), region.uvs, own);
    const double unit = scales_[region.chart];
    bool close = true;
    for (std::size_t i = 0; i < own.size(); ++i) {
      TriangleStretch& s = own[i];
      if (s.area > 0 && s.uv_area <= rounding_ * std::sqrt(s.uv_area + s.area)) return false;
      // Within a hair of what is asked, so that the chart's own scale makes no difference.
      close = close && s.s1 < limits_.max_stretch && 1 / s.s2 < limits_.max_stretch;
      s.area /= unit * unit;
      s.s1 = float(s.s1 / unit);
      s.s2 = float(s.s2 / unit);
    }
    if (close) return true;
    own.insert(own.end(), stretches_[region.chart].begin(), stretches_[region.chart].end());
    return summarize_distortion(own).stretch_999 <= bounds_[region.chart];
  }

  bool finds_room(const Region& region) {
    const auto gap = [&](std::uint32_t owner) {
      return owner == region.chart ? -rounding_ : 2 * limits_.padding;
    };
    std::vector<std::uint32_t> added;
    bool room = true;
    for (std::size_t i = 0; i < region.triangles.size() && room; ++i) {
      const PageGrid::Place place{page(region), texels_of(region, i)};
      if (twice_area(place.corners) <= rounding_ * rounding_) continue;
      room = !grid_.meets(place, gap, 2 * limits_.padding);
      if (room) added.push_back(grid_.add(place, region.chart));
    }
    if (!room) {
      for (const std::uint32_t number : added) grid_.remove(number);
    }
    return room;
  }

  void accept(const Region& region) {
    for (std::uint32_t v = 0; v < region.uvs.size(); ++v) {
      known_[region.source[v]] = Known::fixed;
      uv_[region.source[v]] = region.uvs[v];
    }
    for (const std::uint32_t t : region.triangles) {
      for (std::uint32_t k = 0; k < 3; ++k) taken_.texels[t][k] = uv_[grown_.uv[3 * t + k]];
    }
  }

  const JoinedMesh& mesh_;
  const LayLimits& limits_;
  PageGrid& grid_;
  TakenUvs& taken_;
  double rounding_;
  GrownCharts grown_;
  std::vector<Known> known_;  // by GrownCharts::uv
  std::vector<Vec2d> uv_;     // likewise, in texels
  std::vector<std::uint32_t> local_;
  std::vector<std::vector<TriangleStretch>> stretches_;  // of the triangles of a chart that stay
  std::vector<double> scales_, bounds_;                  // one per chart
  double area_ = 0, texels_ = 0;
};

}  // namespace

void lay_beside(const JoinedMesh& mesh, const LayLimits& limits, PageGrid& grid, TakenUvs& taken) {
  Layer(mesh, limits, grid, taken).run();
}

}  // namespace atlas
