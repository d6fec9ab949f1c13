#include "tests/simplify/checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "libatlas/core/glm_bridge.h"

namespace atlas::simplify_test {
namespace {

using Point = std::array<float, 3>;

Point key(const Vec3f& p) {
  return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F};
}

struct Flat {
  glm::dvec2 uv[3];
  glm::dvec3 p[3];
  glm::dvec3 normal() const { return glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])); }
};

Flat flat(const ChartedMesh& mesh, const std::uint32_t* uv) {
  Flat out;
  for (int k = 0; k < 3; ++k) {
    out.uv[k] = to_glm(mesh.charts.uvs[uv[k]]);
    out.p[k] = to_dvec(mesh.positions[mesh.charts.uv_vertex[uv[k]]]);
  }
  return out;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

// Returns the point of the triangle that is nearest to u in uv, as barycentric weights.
glm::dvec3 nearest(const Flat& t, const glm::dvec2& u) {
  const glm::dvec2 a = t.uv[1] - t.uv[0], b = t.uv[2] - t.uv[0], d = u - t.uv[0];
  const double det = cross(a, b), x = cross(d, b) / det, y = cross(a, d) / det;
  if (x >= 0 && y >= 0 && x + y <= 1) return {1 - x - y, x, y};
  glm::dvec3 best(0);
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 p = t.uv[k], e = t.uv[(k + 1) % 3] - p;
    const double s = std::clamp(glm::dot(u - p, e) / glm::dot(e, e), 0.0, 1.0);
    const double far = glm::length(p + s * e - u);
    if (far >= least) continue;
    least = far;
    best = glm::dvec3(0);
    best[k] = 1 - s;
    best[(k + 1) % 3] = s;
  }
  return best;
}

// Finds coarse triangles of one chart by a grid over uv.
class Finder {
 public:
  explicit Finder(std::vector<Flat> triangles) : triangles_(std::move(triangles)) {
    low_ = glm::dvec2(INFINITY);
    glm::dvec2 high(-INFINITY);
    for (const Flat& t : triangles_) {
      for (const auto& u : t.uv) {
        low_ = glm::min(low_, u);
        high = glm::max(high, u);
      }
    }
    cell_ = std::max(high.x - low_.x, high.y - low_.y) / kCells + 1e-300;
    cells_.resize(kCells * kCells);
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const Flat& t = triangles_[i];
      const auto [x0, y0] = cell(glm::min(glm::min(t.uv[0], t.uv[1]), t.uv[2]));
      const auto [x1, y1] = cell(glm::max(glm::max(t.uv[0], t.uv[1]), t.uv[2]));
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) cells_[y * kCells + x].push_back(i);
      }
    }
  }
  // Returns the triangle that covers u, or else the one with the least distance in uv and space
  // together, and the weights of its point nearest to u. If several cover u (borders closer to each
  // other than a texel), it is the one whose point is nearest to p in space. `density` is in texels
  // per uv unit; `texel` is the size of a texel in space.
  std::pair<const Flat*, glm::dvec3> find(const glm::dvec2& u, const glm::dvec3& p, double density,
                                          double texel) const {
    const auto [cx, cy] = cell(u);
    const Flat* best = nullptr;
    glm::dvec3 weights(0);
    std::pair<double, double> least{INFINITY, INFINITY};
    for (int y = std::max(0, cy - 1); y <= std::min(kCells - 1, cy + 1); ++y) {
      for (int x = std::max(0, cx - 1); x <= std::min(kCells - 1, cx + 1); ++x) {
        for (const std::size_t i : cells_[y * kCells + x]) {
          const glm::dvec3 w = nearest(triangles_[i], u);
          const Flat& t = triangles_[i];
          const double far = glm::length(at(t, w) - u);
          const double gap = glm::length(w.x * t.p[0] + w.y * t.p[1] + w.z * t.p[2] - p) / texel;
          const std::pair<double, double> distance(far > kInside ? far * density + gap : 0, gap);
          if (distance < least) {
            least = distance;
            best = &triangles_[i];
            weights = w;
          }
        }
      }
    }
    return {best, weights};
  }
  static glm::dvec2 at(const Flat& t, const glm::dvec3& w) {
    return w.x * t.uv[0] + w.y * t.uv[1] + w.z * t.uv[2];
  }

 private:
  static constexpr int kCells = 64;
  static constexpr double kInside = 1e-12;  // tolerance for uv lengths of about 1
  std::pair<int, int> cell(const glm::dvec2& u) const {
    const auto clamp = [](double x) { return static_cast<int>(std::clamp(x, 0.0, kCells - 1.0)); };
    return {clamp((u.x - low_.x) / cell_), clamp((u.y - low_.y) / cell_)};
  }
  std::vector<Flat> triangles_;
  std::vector<std::vector<std::size_t>> cells_;
  glm::dvec2 low_;
  double cell_ = 1;
};

struct Tally {
  SampledSlip slip;
  std::size_t outside = 0, all = 0;
  double least_cosine = 0, turned = 0, area = 0;
};

// A chart's texels per uv unit, the size of a texel in space, and the chart's largest stretch.
struct Scale {
  double density, texel, stretch;
};

// A chart of the simplified mesh, by its triangles in uv.
struct SampledChart {
  const Finder& finder;
  Scale scale;
};

void sample(const Flat& fine, const SampledChart& chart, std::mt19937& random, Tally& tally) {
  const auto [density, texel, stretch] = chart.scale;
  SampledSlip& out = tally.slip;
  std::uniform_real_distribution<double> unit(0, 1);
  double x = unit(random), y = unit(random);
  if (x + y > 1) {
    x = 1 - x;
    y = 1 - y;
  }
  if (unit(random) < 0.2) x = 0;  // some samples lie on edges and at corners
  if (unit(random) < 0.2) y = 0;
  const glm::dvec3 w(1 - x - y, x, y);
  const glm::dvec2 u = Finder::at(fine, w);
  const glm::dvec3 p = w.x * fine.p[0] + w.y * fine.p[1] + w.z * fine.p[2];
  const auto [coarse, v] = chart.finder.find(u, p, density, texel);
  if (!coarse) {
    out.outside = INFINITY;
    return;
  }
  const double shift = glm::length(Finder::at(*coarse, v) - u) * density;
  const double gap =
      glm::length(v.x * coarse->p[0] + v.y * coarse->p[1] + v.z * coarse->p[2] - p) / texel;
  if (shift > 1e-7) {
    out.outside = std::max(out.outside, (shift + gap) / stretch);
    ++tally.outside;
  } else {
    out.inside = std::max(out.inside, gap);
    if (x == 0 || y == 0) return;  // on an edge, the triangle found may be the neighbour's
    const double twice = glm::length(glm::cross(fine.p[1] - fine.p[0], fine.p[2] - fine.p[0]));
    if (twice > 0 && glm::dot(fine.normal(), coarse->normal()) < tally.least_cosine) {
      tally.turned += twice;
    }
    tally.area += twice;
  }
}

}  // namespace

OpenEdges open_edges(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices) {
  std::map<std::pair<Point, Point>, int> count;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      Point a = key(positions[indices[t + k]]), b = key(positions[indices[t + (k + 1) % 3]]);
      if (b < a) std::swap(a, b);
      ++count[{a, b}];
    }
  }
  OpenEdges open;
  for (const auto& [edge, n] : count) {
    if (n != 1) continue;
    ++open.count;
    const auto& [a, b] = edge;
    open.length += std::hypot(double(a[0]) - b[0], double(a[1]) - b[1], double(a[2]) - b[2]);
  }
  return open;
}

std::size_t broken_triangles(const ChartedMesh& mesh, const SimplifiedMesh& coarse) {
  std::size_t broken = 0;
  for (std::size_t t = 0; t < coarse.triangle_chart.size(); ++t) {
    const std::uint32_t c = coarse.triangle_chart[t];
    bool bad = mesh.charts.triangle_chart[coarse.source_triangle[t]] != c ||
               (t > 0 && coarse.triangle_chart[t - 1] > c);
    const Chart& chart = mesh.charts.charts[c];
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t uv = coarse.uv_indices[3 * t + k];
      bad =
          bad || uv < chart.first_uv || uv >= chart.first_uv + chart.uv_count ||
          !(mesh.positions[mesh.charts.uv_vertex[uv]] == mesh.positions[coarse.indices[3 * t + k]]);
    }
    if (!bad) {
      const Flat f = flat(mesh, &coarse.uv_indices[3 * t]);
      bad = !(cross(f.uv[1] - f.uv[0], f.uv[2] - f.uv[0]) > 0) ||
            !(glm::length(glm::cross(f.p[1] - f.p[0], f.p[2] - f.p[0])) > 0);
    }
    broken += bad;
  }
  return broken;
}

SampledSlip sample_slip(const ChartedMesh& mesh, const SimplifiedMesh& coarse,
                        std::span<const double> texels_per_unit, double max_turn_degrees) {
  const int samples = mesh.triangles() > 100000 ? 2 : 12;  // per triangle
  std::vector<std::vector<Flat>> triangles(mesh.charts.charts.size());
  for (std::size_t t = 0; t < coarse.triangle_chart.size(); ++t) {
    triangles[coarse.triangle_chart[t]].push_back(flat(mesh, &coarse.uv_indices[3 * t]));
  }
  Tally tally;
  tally.least_cosine = std::cos(max_turn_degrees * 3.14159265358979 / 180) - 1e-6;
  std::mt19937 random(7);
  for (std::size_t c = 0; c < triangles.size(); ++c) {
    const Finder finder(std::move(triangles[c]));
    const Chart& chart = mesh.charts.charts[c];
    std::vector<Flat> fine;
    double space = 0, area = 0;
    for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
      const std::uint32_t t = mesh.charts.chart_triangles[chart.first_triangle + i];
      Flat f = flat(mesh, &mesh.charts.triangle_uv[std::size_t{3} * t]);
      double twice = cross(f.uv[1] - f.uv[0], f.uv[2] - f.uv[0]);
      if (twice < 0) {
        std::swap(f.uv[1], f.uv[2]);
        std::swap(f.p[1], f.p[2]);
      }
      space += glm::length(glm::cross(f.p[1] - f.p[0], f.p[2] - f.p[0]));
      area += std::abs(twice);
      if (twice != 0) fine.push_back(f);
    }
    const Scale scale{texels_per_unit[c], std::sqrt(space / area) / texels_per_unit[c],
                      std::max(1.0, chart.distortion.stretch_linf)};
    for (const Flat& f : fine) {
      for (int s = 0; s < samples; ++s, ++tally.all) {
        sample(f, {finder, scale}, random, tally);
      }
    }
  }
  tally.slip.outside_share = tally.all ? double(tally.outside) / double(tally.all) : 0;
  tally.slip.turned_share = tally.area > 0 ? tally.turned / tally.area : 0;
  return tally.slip;
}

double uv_area(const ChartedMesh& mesh, const SimplifiedMesh& coarse) {
  double area = 0;
  for (std::size_t t = 0; t < coarse.triangle_chart.size(); ++t) {
    const Flat f = flat(mesh, &coarse.uv_indices[3 * t]);
    area += cross(f.uv[1] - f.uv[0], f.uv[2] - f.uv[0]) / 2;
  }
  return area;
}

}  // namespace atlas::simplify_test
