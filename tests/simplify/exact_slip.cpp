#include "tests/simplify/exact_slip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "libatlas/core/glm_bridge.h"

namespace atlas::simplify_test {
namespace {

struct Point {
  glm::dvec2 uv;
  glm::dvec3 at;
};

Point mix(const Point& a, const Point& b, double t) {
  return {a.uv + t * (b.uv - a.uv), a.at + t * (b.at - a.at)};
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

using Corners = std::array<Point, 3>;
using Edge = std::pair<Point, Point>;

// One chart's triangles, edges and outline. The outline is the edges with one triangle.
struct Sheet {
  std::vector<Corners> triangles;
  std::vector<Edge> edges, outline;
  double space = 0, area = 0;

  Sheet(const ChartedMesh& mesh, const std::vector<std::array<std::uint32_t, 3>>& ids) {
    const auto point = [&](std::uint32_t uv) {
      return Point{to_glm(mesh.charts.uvs[uv]), to_dvec(mesh.positions[mesh.charts.uv_vertex[uv]])};
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
    for (const auto& t : ids) {
      triangles.push_back({point(t[0]), point(t[1]), point(t[2])});
      const auto& [a, b, c] = triangles.back();
      space += glm::length(glm::cross(b.at - a.at, c.at - a.at));
      area += std::abs(cross(b.uv - a.uv, c.uv - a.uv));
      for (int k = 0; k < 3; ++k) ++count[std::minmax(t[k], t[(k + 1) % 3])];
    }
    for (const auto& [edge, n] : count) {
      edges.emplace_back(point(edge.first), point(edge.second));
      if (n == 1) outline.push_back(edges.back());
    }
  }
};

// Returns the gap in space at the uv where two edges cross, or 0.
double gap_at_crossing(const Edge& e, const Edge& f) {
  const glm::dvec2 a = e.second.uv - e.first.uv, b = f.second.uv - f.first.uv,
                   d = f.first.uv - e.first.uv;
  const double det = cross(a, b);
  if (std::abs(det) < 1e-9 * glm::length(a) * glm::length(b)) return 0;
  const double s = cross(d, b) / det, t = cross(d, a) / det;
  if (s < 0 || s > 1 || t < 0 || t > 1) return 0;
  return glm::distance(mix(e.first, e.second, s).at, mix(f.first, f.second, t).at);
}

// Returns the weights of a uv in a triangle.
glm::dvec3 weights(const Corners& t, const glm::dvec2& uv) {
  const glm::dvec2 a = t[1].uv - t[0].uv, b = t[2].uv - t[0].uv, d = uv - t[0].uv;
  const double x = cross(d, b) / cross(a, b), y = cross(a, d) / cross(a, b);
  return {1 - x - y, x, y};
}

glm::dvec3 normal(const Corners& t) {
  return glm::normalize(glm::cross(t[1].at - t[0].at, t[2].at - t[0].at));
}

// Returns the least sum of the distances in space and in uv between a point and an edge, in texels.
// The sum is convex along the edge, so a search by thirds finds it.
double from_edge(const Point& p, const Edge& e, double texel, double density) {
  const auto sum = [&](double t) {
    const Point q = mix(e.first, e.second, t);
    return glm::distance(p.at, q.at) / texel + glm::distance(p.uv, q.uv) * density;
  };
  double low = 0, high = 1;
  for (int i = 0; i < 80; ++i) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (sum(a) < sum(b) ? high : low) = sum(a) < sum(b) ? b : a;
  }
  return std::min({sum(low), sum(0), sum(1)});
}

void measure(const Sheet& fine, const Sheet& coarse, double density, ExactSlip& out) {
  const double texel = std::sqrt(fine.space / fine.area) / density;
  double gap = 0;
  for (const Edge& e : fine.edges) {
    for (const Edge& f : coarse.edges) gap = std::max(gap, gap_at_crossing(e, f));
  }
  for (const Corners& t : fine.triangles) {
    for (const Corners& c : coarse.triangles) {
      bool all = true;
      for (const Point& p : t) {
        const glm::dvec3 w = weights(c, p.uv);
        const bool over = std::min({w.x, w.y, w.z}) > -1e-9;
        all = all && over;
        if (!over) continue;
        gap = std::max(gap, glm::distance(w.x * c[0].at + w.y * c[1].at + w.z * c[2].at, p.at));
      }
      if (!all) continue;
      const double cosine = std::clamp(glm::dot(normal(t), normal(c)), -1.0, 1.0);
      out.turn = std::max(out.turn, std::acos(cosine) * 180 / std::numbers::pi);
    }
  }
  out.inside = std::max(out.inside, gap / texel);
  for (const Edge& e : fine.outline) {
    for (const Point& p : {e.first, e.second}) {
      double least = INFINITY;
      for (const Edge& f : coarse.outline) least = std::min(least, from_edge(p, f, texel, density));
      out.border = std::max(out.border, least);
    }
  }
}

}  // namespace

ExactSlip exact_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                     std::span<const double> texels_per_unit) {
  using Ids = std::vector<std::array<std::uint32_t, 3>>;
  const std::size_t charts = mesh.charts.charts.size();
  std::vector<Ids> before(charts), after(charts);
  const auto corners = [](const std::vector<std::uint32_t>& uvs, std::size_t t) {
    return std::array{uvs[3 * t], uvs[3 * t + 1], uvs[3 * t + 2]};
  };
  for (std::size_t t = 0; t < mesh.triangles(); ++t) {
    before[mesh.charts.triangle_chart[t]].push_back(corners(mesh.charts.triangle_uv, t));
  }
  for (std::size_t t = 0; t < coarse.triangle_chart.size(); ++t) {
    after[coarse.triangle_chart[t]].push_back(corners(coarse.uv_indices, t));
  }
  ExactSlip out;
  for (std::size_t c = 0; c < charts; ++c) {
    measure(Sheet(mesh, before[c]), Sheet(mesh, after[c]), texels_per_unit[c], out);
  }
  return out;
}

ExactSlip exact_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse, double density) {
  return exact_slip(mesh, coarse, std::vector<double>(mesh.charts.charts.size(), density));
}

}  // namespace atlas::simplify_test
