#include "apps/atlas-pack/uv_charts.h"

#include <array>
#include <cmath>
#include <functional>
#include <unordered_map>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/scene/triangle_area.h"

namespace atlas::app {
namespace {

double area_of(const Vec2d* p) {
  return std::abs((p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x)) /
         2;
}

// Finds corners that have the same position and the same texcoord.
class CornerPlaces {
 public:
  explicit CornerPlaces(const Scene& s) : scene_(s) { first_.reserve(s.texcoords.size()); }

  // Returns the texcoord that was first seen with this corner's position and value.
  std::uint32_t first_at(std::size_t corner) {
    const std::uint32_t texcoord = scene_.texcoord_indices[corner];
    const Vec3f p = scene_.positions[scene_.indices[corner]];
    const Vec2f uv = scene_.texcoords[texcoord];
    return first_.try_emplace({p.x, p.y, p.z, uv.x, uv.y}, texcoord).first->second;
  }

 private:
  using Key = std::array<float, 5>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::size_t hash = 0;
      for (const float f : key) hash = hash * 0x9e3779b97f4a7c15u + std::hash<float>()(f);
      return hash ^ hash >> 32;
    }
  };
  const Scene& scene_;
  std::unordered_map<Key, std::uint32_t, Hash> first_;
};

}  // namespace

UvCharts find_charts(const Scene& s) {
  UvCharts charts;
  charts.chart.assign(s.triangle_count(), UvCharts::kNone);
  charts.same.assign(s.texcoords.size(), UvCharts::kNone);
  DisjointSets sets(s.texcoords.size());
  CornerPlaces places(s);
  const auto has_uv = [&](std::size_t t) {
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k)
      if (s.texcoord_indices[k] == Scene::kNoTexcoord) return false;
    return true;
  };
  for (std::size_t t = 0; t < s.triangle_count(); ++t) {
    if (!has_uv(t)) continue;
    sets.join(s.texcoord_indices[3 * t], s.texcoord_indices[3 * t + 1]);
    sets.join(s.texcoord_indices[3 * t], s.texcoord_indices[3 * t + 2]);
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) {
      const std::uint32_t texcoord = s.texcoord_indices[k], first = places.first_at(k);
      sets.join(texcoord, first);
      if (charts.same[texcoord] == UvCharts::kNone) charts.same[texcoord] = first;
    }
  }
  std::vector<std::uint32_t> number(s.texcoords.size(), UvCharts::kNone);
  for (std::size_t t = 0; t < s.triangle_count(); ++t) {
    if (!has_uv(t)) {
      ++charts.without_uv;
      continue;
    }
    std::uint32_t& id = number[sets.find(s.texcoord_indices[3 * t])];
    if (id == UvCharts::kNone) {
      id = static_cast<std::uint32_t>(charts.members.size());
      charts.members.emplace_back();
    }
    charts.chart[t] = id;
    charts.members[id].push_back(static_cast<std::uint32_t>(t));
  }
  return charts;
}

void make_uniform(const Scene& s, double page_area, UvCharts& charts) {
  double total = 0;
  for (const auto& members : charts.members)
    for (std::uint32_t t : members) total += triangle_area(s, t);
  const double texels = total > 0 ? std::sqrt(page_area / total) : 0;
  for (const auto& members : charts.members) {
    std::vector<Vec2d> corners;
    double flat = 0, real = 0;
    for (std::uint32_t t : members) {
      real += triangle_area(s, t);
      for (std::size_t k = 3 * std::size_t(t); k < 3 * std::size_t(t) + 3; ++k) {
        const Vec2f uv = s.texcoords[s.texcoord_indices[k]];
        corners.push_back({uv.x, uv.y});
      }
      flat += area_of(&corners[corners.size() - 3]);
    }
    const double factor = flat > 0 ? texels * std::sqrt(real / flat) : 0;
    charts.without_area += factor == 0;
    const Vec2d base = corners.front();
    for (Vec2d& p : corners) p = {(p.x - base.x) * factor, (p.y - base.y) * factor};
    charts.corners.push_back(std::move(corners));
  }
}

}  // namespace atlas::app
