#include "apps/atlas-pack/uv_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/parallel.h"
#include "libatlas/param/orient.h"
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

using CornerPair = std::array<std::uint32_t, 2>;  // indices into the corners of a chart

// Returns the sides that a single triangle of the chart has.
std::vector<CornerPair> border_of(const Scene& s, const UvCharts& charts, std::size_t chart) {
  struct Side {
    std::uint32_t low, high;  // texcoords
    CornerPair corners;
  };
  std::vector<Side> sides;
  std::uint32_t corner = 0;
  for (const std::uint32_t t : charts.members[chart]) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t next = (k + 1) % 3;
      const std::uint32_t a = charts.same[s.texcoord_indices[3 * std::size_t(t) + k]],
                          b = charts.same[s.texcoord_indices[3 * std::size_t(t) + next]];
      sides.push_back({std::min(a, b), std::max(a, b), {corner + k, corner + next}});
    }
    corner += 3;
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.corners) < std::tie(b.low, b.high, b.corners);
  });
  std::vector<CornerPair> border;
  for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
      ++end;
    if (end == i + 1) border.push_back(sides[i].corners);
  }
  return border;
}

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

void scale_charts(const Scene& s, ChartSizes sizes, double page_area, UvCharts& charts) {
  std::vector<double> factors;  // at which areas are the wanted ones, in any unit
  double total = 0;
  for (const auto& members : charts.members) {
    std::vector<Vec2d> corners;
    double flat = 0, surface = 0;
    for (std::uint32_t t : members) {
      surface += triangle_area(s, t);
      for (std::size_t k = 3 * std::size_t(t); k < 3 * std::size_t(t) + 3; ++k) {
        const Vec2f uv = s.texcoords[s.texcoord_indices[k]];
        corners.push_back({uv.x, uv.y});
      }
      flat += area_of(&corners[corners.size() - 3]);
    }
    const double wanted = sizes == ChartSizes::surface ? surface : flat;
    total += wanted;
    factors.push_back(flat > 0 ? std::sqrt(wanted / flat) : 0);
    charts.corners.push_back(std::move(corners));
  }
  const double texels = total > 0 ? std::sqrt(page_area / total) : 0;
  for (std::size_t c = 0; c < charts.corners.size(); ++c) {
    const double factor = texels * factors[c];
    charts.without_area += factor == 0;
    const Vec2d base = charts.corners[c].front();
    for (Vec2d& p : charts.corners[c]) p = {(p.x - base.x) * factor, (p.y - base.y) * factor};
  }
}

void turn_upright(const Scene& s, UvCharts& charts, const Context& context) {
  parallel_for(context, charts.corners.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      std::vector<Vec2d> turned = charts.corners[c];
      // Charts may fold over themselves and so exceed their border. Sides without length make all
      // corners count for the box.
      std::vector<CornerPair> sides = border_of(s, charts, c);
      for (std::uint32_t i = 0; i < turned.size(); ++i) sides.push_back({i, i});
      const Vec2d size = orient_for_packing(turned, sides).size;
      if (size.x < UvCharts::kFarthest) charts.corners[c] = std::move(turned);
    }
  });
}

}  // namespace atlas::app
