#include "tests/charts/chart_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <unordered_map>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/predicates.h"

namespace atlas::test {
namespace {

using Triangle = std::array<Vec2d, 3>;

// Returns whether an edge of `a` (counter-clockwise) has all of `b` on its outer side.
bool separates(const Triangle& a, const Triangle& b) {
  for (int i = 0; i < 3; ++i) {
    const Vec2d p = a[i], q = a[(i + 1) % 3];
    if (orientation(p, q, b[0]) <= 0 && orientation(p, q, b[1]) <= 0 &&
        orientation(p, q, b[2]) <= 0) {
      return true;
    }
  }
  return false;
}

class Checker {
 public:
  Checker(const MeshView& mesh, const ChartSet& set) : mesh_(mesh), set_(set) {
    flipped_.assign(mesh.indices.size() / 3, false);
    for (const std::uint32_t t : set.flipped_triangles) flipped_[t] = true;
  }

  ChartFindings run() {
    if (ranges() && corners()) {
      for (std::uint32_t k = 0; k < set_.charts.size() && found_.fault.empty(); ++k) chart(k);
    }
    if (found_.fault.empty()) seams();
    return found_;
  }

 private:
  bool fail(const std::string& fault) {
    if (found_.fault.empty()) found_.fault = fault;
    return false;
  }

  bool ranges() {
    const std::size_t n = mesh_.indices.size() / 3;
    if (set_.triangle_chart.size() != n || set_.chart_triangles.size() != n ||
        set_.triangle_uv.size() != 3 * n || set_.uv_vertex.size() != set_.uvs.size()) {
      return fail("array sizes");
    }
    std::vector<int> seen(n, 0);
    std::uint32_t triangle = 0, uv = 0;
    for (std::uint32_t k = 0; k < set_.charts.size(); ++k) {
      const Chart& c = set_.charts[k];
      if (c.first_triangle != triangle || c.first_uv != uv || c.triangle_count == 0) {
        return fail("chart " + std::to_string(k) + ": range");
      }
      for (std::uint32_t i = 0; i < c.triangle_count; ++i) {
        const std::uint32_t t = set_.chart_triangles[triangle + i];
        if (t >= n || seen[t]++ || set_.triangle_chart[t] != k) return fail("triangle lists");
      }
      triangle += c.triangle_count;
      uv += c.uv_count;
    }
    return (triangle == n && uv == set_.uvs.size()) || fail("totals");
  }

  glm::dvec3 position(std::uint32_t corner) const {
    return to_dvec(mesh_.positions[mesh_.indices[corner]]);
  }
  double area(std::uint32_t t) const {
    const glm::dvec3 a = position(3 * t);
    return 0.5 * glm::length(glm::cross(position(3 * t + 1) - a, position(3 * t + 2) - a));
  }
  bool has_area(std::uint32_t t) const {
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      longest =
          std::max(longest, glm::distance(position(3 * t + i), position(3 * t + (i + 1) % 3)));
    }
    return area(t) > 1e-12 * longest * longest;
  }

  bool corners() {
    for (std::uint32_t t = 0; t < mesh_.indices.size() / 3; ++t) {
      const Chart& c = set_.charts[set_.triangle_chart[t]];
      for (std::uint32_t i = 3 * t; i < 3 * t + 3; ++i) {
        const std::uint32_t uv = set_.triangle_uv[i];
        if (uv < c.first_uv || uv >= c.first_uv + c.uv_count) return fail("uv of another chart");
        if (has_area(t) &&
            !(mesh_.positions[set_.uv_vertex[uv]] == mesh_.positions[mesh_.indices[i]])) {
          return fail("uv of another vertex");
        }
      }
    }
    return true;
  }

  Triangle uv_triangle(std::uint32_t t) const {
    const int b = flipped_[t] ? 2 : 1;
    return {set_.uvs[set_.triangle_uv[3 * t]], set_.uvs[set_.triangle_uv[3 * t + b]],
            set_.uvs[set_.triangle_uv[3 * t + 3 - b]]};
  }

  void chart(std::uint32_t k) {
    const Chart& c = set_.charts[k];
    const std::string name = "chart " + std::to_string(k);
    Vec2d low{1e300, 1e300}, high{-1e300, -1e300};
    for (std::uint32_t i = c.first_uv; i < c.first_uv + c.uv_count; ++i) {
      low = {std::min(low.x, set_.uvs[i].x), std::min(low.y, set_.uvs[i].y)};
      high = {std::max(high.x, set_.uvs[i].x), std::max(high.y, set_.uvs[i].y)};
    }
    const double slack = 1e-9 * (c.size.x + c.size.y);
    if (std::abs(low.x) > slack || std::abs(low.y) > slack || std::abs(high.x - c.size.x) > slack ||
        std::abs(high.y - c.size.y) > slack || c.size.x < c.size.y) {
      fail(name + ": box");
    }
    std::vector<std::uint32_t> list;
    for (std::uint32_t i = 0; i < c.triangle_count; ++i) {
      const std::uint32_t t = set_.chart_triangles[c.first_triangle + i];
      if (!has_area(t)) continue;
      const Triangle uv = uv_triangle(t);
      if (orientation(uv[0], uv[1], uv[2]) <= 0) fail(name + ": triangle flipped or without area");
      list.push_back(t);
    }
    overlaps(name, list, c.size);
    stretch(c, list);
  }

  void overlaps(const std::string& name, const std::vector<std::uint32_t>& list, Vec2d size) {
    const int cells = std::max(1, static_cast<int>(std::sqrt(double(list.size()))));
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> buckets;
    const auto cell = [&](double x, double extent) {
      return std::clamp(static_cast<int>(x / std::max(extent, 1e-300) * cells), 0, cells - 1);
    };
    for (const std::uint32_t t : list) {
      const Triangle uv = uv_triangle(t);
      const auto [x0, x1] = std::minmax({uv[0].x, uv[1].x, uv[2].x});
      const auto [y0, y1] = std::minmax({uv[0].y, uv[1].y, uv[2].y});
      for (int y = cell(y0, size.y); y <= cell(y1, size.y); ++y) {
        for (int x = cell(x0, size.x); x <= cell(x1, size.x); ++x) {
          std::vector<std::uint32_t>& bucket = buckets[std::uint64_t(y) * cells + x];
          for (const std::uint32_t s : bucket) {
            const Triangle other = uv_triangle(s);
            if (!separates(uv, other) && !separates(other, uv)) {
              fail(name + ": triangles " + std::to_string(s) + " and " + std::to_string(t) +
                   " overlap");
            }
          }
          bucket.push_back(t);
        }
      }
    }
  }

  // Computes singular values from the metric, that is from the lengths of the images of the uv axes
  // on the surface.
  void stretch(const Chart& c, const std::vector<std::uint32_t>& list) {
    double surface = 0, flat = 0;
    for (const std::uint32_t t : list) {
      const Triangle uv = uv_triangle(t);
      surface += area(t);
      flat += 0.5 * ((uv[1].x - uv[0].x) * (uv[2].y - uv[0].y) -
                     (uv[2].x - uv[0].x) * (uv[1].y - uv[0].y));
    }
    const double scale = surface > 0 ? std::sqrt(flat / surface) : 1;
    std::vector<std::pair<double, double>> ranked;
    for (const std::uint32_t t : list) {
      const Triangle uv = uv_triangle(t);
      const int b = flipped_[t] ? 2 : 1;
      const glm::dvec3 d1 = position(3 * t + b) - position(3 * t);
      const glm::dvec3 d2 = position(3 * t + 3 - b) - position(3 * t);
      const double a = uv[1].x - uv[0].x, e = uv[1].y - uv[0].y, f = uv[2].x - uv[0].x,
                   g = uv[2].y - uv[0].y, det = a * g - e * f;
      const glm::dvec3 du = (d1 * g - d2 * e) / det, dv = (d2 * a - d1 * f) / det;
      const double E = glm::dot(du, du), F = glm::dot(du, dv), G = glm::dot(dv, dv);
      const double root = std::sqrt((E - G) * (E - G) + 4 * F * F);
      const double s1 = std::sqrt(0.5 * (E + G + root));
      const double s2 = glm::length(glm::cross(du, dv)) / s1;
      ranked.push_back({std::max(s1 * scale, 1 / (s2 * scale)), area(t)});
      const glm::dvec3 n = glm::cross(d1, d2) / glm::length(glm::cross(d1, d2));
      const double lean = std::acos(std::clamp(glm::dot(n, to_dvec(c.axis)), -1.0, 1.0));
      found_.cone_degrees = std::max(found_.cone_degrees, lean * 180 / M_PI);
      l2_ += 0.5 * (s1 * s1 + s2 * s2) * scale * scale * area(t);
      surface_ += area(t);
    }
    std::sort(ranked.begin(), ranked.end());
    double sum = 0;
    for (const auto& [value, weight] : ranked) {
      sum += weight;
      if (sum < 0.999 * surface) continue;
      found_.stretch_999 = std::max(found_.stretch_999, value);
      break;
    }
    found_.stretch_l2 = surface_ > 0 ? std::sqrt(l2_ / surface_) : 1;
  }

  // Finds edges by their positions. An edge is a seam if its two triangles have different uvs
  // there.
  void seams() {
    using Place = std::array<float, 3>;
    struct Side {
      std::uint32_t low, high;
    };
    std::map<std::pair<Place, Place>, std::vector<Side>> edges;
    const auto place = [&](std::uint32_t i) {
      const Vec3f& p = mesh_.positions[mesh_.indices[i]];
      return Place{p.x + 0.0f, p.y + 0.0f, p.z + 0.0f};
    };
    for (std::uint32_t t = 0; t < mesh_.indices.size() / 3; ++t) {
      if (!has_area(t)) continue;
      for (std::uint32_t i = 0; i < 3; ++i) {
        std::uint32_t a = 3 * t + i, b = 3 * t + (i + 1) % 3;
        if (place(b) < place(a)) std::swap(a, b);
        edges[{place(a), place(b)}].push_back({set_.triangle_uv[a], set_.triangle_uv[b]});
      }
    }
    for (const auto& [ends, sides] : edges) {
      if (sides.size() != 2) continue;
      if (sides[0].low == sides[1].low && sides[0].high == sides[1].high) continue;
      found_.seam += glm::distance(glm::dvec3(ends.first[0], ends.first[1], ends.first[2]),
                                   glm::dvec3(ends.second[0], ends.second[1], ends.second[2]));
    }
  }

  const MeshView& mesh_;
  const ChartSet& set_;
  std::vector<bool> flipped_;
  ChartFindings found_;
  double l2_ = 0, surface_ = 0;
};

template <class T>
void append(std::string& out, const std::vector<T>& values) {
  if (values.empty()) return;
  out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

}  // namespace

ChartFindings check_charts(const MeshView& mesh, const ChartSet& set) {
  return Checker(mesh, set).run();
}

ChartSet checked_charts(const Mesh& mesh, double min_fill) {
  ChartOptions options;
  options.min_fill = min_fill;
  Result<ChartSet> set = make_charts(mesh.view(), options, {});
  EXPECT_TRUE(set.ok()) << set.status().message();
  if (!set.ok()) return {};
  EXPECT_EQ(check_charts(mesh.view(), *set).fault, "");
  return std::move(*set);
}

Topology topology_of(const Mesh& mesh) {
  Result<Topology> result = build_topology(mesh.view(), {}, {});
  EXPECT_TRUE(result.ok());
  return std::move(*result);
}

double box_fill(const ChartSet& set) {
  double area = 0, boxes = 0;
  for (const Chart& chart : set.charts) {
    area += chart.distortion.uv_area;
    boxes += chart.size.x * chart.size.y;
  }
  return area / boxes;
}

std::string bytes(const ChartSet& set) {
  std::string out;
  append(out, set.triangle_chart);
  append(out, set.chart_triangles);
  append(out, set.uvs);
  append(out, set.uv_vertex);
  append(out, set.triangle_uv);
  append(out, set.flipped_triangles);
  for (const Chart& c : set.charts) {
    for (const double v : {c.size.x, c.size.y, c.cone_degrees, c.distortion.stretch_l2,
                           c.distortion.stretch_999, c.distortion.stretch_linf}) {
      out.append(reinterpret_cast<const char*>(&v), sizeof v);
    }
  }
  return out;
}

}  // namespace atlas::test
