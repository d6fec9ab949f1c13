#include "libatlas/sheets/one_sided.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <glm/vector_relational.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/bounds.h"
#include "libatlas/core/counting_sort.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/parallel.h"
#include "libatlas/sheets/triangle_tree.h"

namespace atlas {
namespace {

constexpr std::size_t kGrain = 4096;

// The farthest that coincident layers may be apart, as a share of the mesh's size: some rounding
// errors of float coordinates. Plates that have a thickness are thicker.
constexpr double kApart = 0x1p-20;

// The least cosine between the normals of one layer and the turned ones of the other.
constexpr double kOpposite = 0.999;

// Barycentric coordinates.
using Weights = std::array<double, 3>;

// A triangle counts as covered if these points are: its centroid, which decides most cases, and
// then the centroids of the sixteen triangles into which lines parallel to its sides divide it.
std::vector<Weights> sample_weights() {
  std::vector<Weights> points{{1.0 / 3, 1.0 / 3, 1.0 / 3}};
  constexpr int kParts = 4;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; i + j < kParts; ++j) {
      for (const double third : {1.0 / 3, 2.0 / 3}) {
        const double a = (i + third) / kParts, b = (j + third) / kParts;
        if (a + b < 1) points.push_back({a, b, 1 - a - b});
      }
    }
  }
  return points;
}

struct Corners {
  glm::dvec3 a, b, c;

  glm::dvec3 normal() const { return glm::cross(b - a, c - a); }  // of twice the area's length
  glm::dvec3 at(const Weights& w) const { return w[0] * a + w[1] * b + w[2] * c; }

  // Returns whether a point is within `reach` of the triangle's box.
  bool near(const glm::dvec3& p, double reach) const {
    const glm::dvec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
    return glm::all(glm::greaterThanEqual(p, low - reach)) &&
           glm::all(glm::lessThanEqual(p, high + reach));
  }

  // Returns whether a point within `reach` of the triangle's plane is within `reach` of the
  // triangle.
  bool holds(const glm::dvec3& p, double reach) const {
    const glm::dvec3 n = normal();
    const double length = glm::length(n);
    if (!(length > 0) || std::abs(glm::dot(n, p - a)) > reach * length) return false;
    const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
      const glm::dvec3 inwards = glm::cross(n, to - from);
      return glm::dot(inwards, p - from) >= -reach * glm::length(inwards);
    };
    return inside(a, b) && inside(b, c) && inside(c, a);
  }
};

using Box = Bounds<glm::dvec3>;

double size_of(std::span<const Vec3f> positions) {
  Box box;
  for (const Vec3f& p : positions) box.add(to_dvec(p));
  return positions.empty() ? 0 : glm::length(box.size());
}

// Returns whether some normal of one chart may be opposite to one of the other. The cones of
// normals tell this; a chart without an axis may have any normals.
bool may_be_opposite(const Chart& a, const Chart& b) {
  const glm::dvec3 m = to_dvec(a.axis), n = to_dvec(b.axis);
  const double lengths = glm::length(m) * glm::length(n);
  if (!(lengths > 0)) return true;
  constexpr double kMargin = 10;  // for kOpposite and rounding
  const double apart = std::acos(std::clamp(-glm::dot(m, n) / lengths, -1.0, 1.0));
  return glm::degrees(apart) <= a.cone_degrees + b.cone_degrees + kMargin;
}

// Tells by boxes and normals of charts which triangles others may coincide with. Most scenes have
// few of them.
class Candidates {
 public:
  Candidates(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
             const ChartSet& charts)
      : positions_(positions),
        indices_(indices),
        charts_(charts),
        reach_(kApart * size_of(positions)),
        boxes_(charts.charts.size()),
        partners_(charts.charts.size()) {
    for (std::size_t k = 0; k < indices.size(); ++k)
      boxes_[charts.triangle_chart[k / 3]].add(to_dvec(positions[indices[k]]));
    all_ = !find_partners();
  }

  std::vector<std::uint32_t> triangles() const {
    std::vector<std::uint32_t> result;
    for (std::size_t t = 0; t < charts_.triangle_chart.size(); ++t)
      if (all_ || lies_in_a_partner(t)) result.push_back(std::uint32_t(t));
    return result;
  }

 private:
  // Finds for each chart those whose box meets its own and whose normals may be opposite. It may be
  // one of them itself: both layers of a sheet can be one chart that is folded at an edge. Returns
  // false in a scene of so very many charts that comparing them would take longer than it saves.
  bool find_partners() {
    std::size_t comparisons = std::size_t{1} << 25;
    std::vector<std::uint32_t> order(boxes_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(boxes_[a].low.x, a) < std::pair(boxes_[b].low.x, b);
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::uint32_t a = order[i];
      for (std::size_t j = i; j < order.size(); ++j) {
        const std::uint32_t b = order[j];
        if (boxes_[b].low.x > boxes_[a].high.x + reach_) break;
        if (comparisons-- == 0) return false;
        if (!boxes_[a].meets(boxes_[b], reach_)) continue;
        if (!may_be_opposite(charts_.charts[a], charts_.charts[b])) continue;
        partners_[a].push_back(b);
        if (a != b) partners_[b].push_back(a);
      }
    }
    return true;
  }

  // Returns whether the centroid of a triangle is in the box of one of its chart's partners.
  bool lies_in_a_partner(std::size_t t) const {
    const std::vector<std::uint32_t>& partners = partners_[charts_.triangle_chart[t]];
    if (partners.empty()) return false;
    glm::dvec3 sum(0);
    for (std::size_t k = 3 * t; k < 3 * t + 3; ++k) sum += to_dvec(positions_[indices_[k]]);
    const Box centroid{sum / 3.0, sum / 3.0};
    return std::any_of(partners.begin(), partners.end(),
                       [&](std::uint32_t chart) { return boxes_[chart].meets(centroid, reach_); });
  }

  std::span<const Vec3f> positions_;
  std::span<const std::uint32_t> indices_;
  const ChartSet& charts_;
  double reach_;
  std::vector<Box> boxes_;
  std::vector<std::vector<std::uint32_t>> partners_;
  bool all_ = false;
};

// Finds the triangles of one mesh that lie back to back with others.
class Layers {
 public:
  Layers(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices)
      : positions_(positions),
        indices_(indices),
        reach_(kApart * size_of(positions)),
        samples_(sample_weights()) {}

  // Returns for each triangle of the mesh whether it belongs to a layer. Only `triangles` are
  // asked.
  std::vector<std::uint8_t> find(const std::vector<std::uint32_t>& triangles,
                                 const Context& context) const {
    const TriangleTree tree(positions_, indices_, triangles);
    std::vector<std::uint8_t> covered(indices_.size() / 3, 1);
    // In the first round any of them covers, in the second only those that are covered themselves:
    // the floor under a box is no layer of a sheet.
    for (int round = 0; round < 2; ++round) {
      std::vector<std::uint8_t> still(covered.size(), 0);
      parallel_for(context, triangles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const std::uint32_t t = triangles[i];
          still[t] = covered[t] && is_covered(t, tree, covered);
        }
      });
      covered = std::move(still);
    }
    return covered;
  }

 private:
  Corners corners(std::uint32_t t) const {
    const std::uint32_t* i = &indices_[3 * std::size_t(t)];
    return {to_dvec(positions_[i[0]]), to_dvec(positions_[i[1]]), to_dvec(positions_[i[2]])};
  }

  bool is_covered(std::uint32_t t, const TriangleTree& tree,
                  const std::vector<std::uint8_t>& by) const {
    const Corners own = corners(t);
    const glm::dvec3 normal = own.normal();
    const double length = glm::length(normal);
    if (!(length > 0)) return false;
    // The triangle that covered the last point. It often covers the next one as well, which takes a
    // tenth of the time of asking the tree.
    std::optional<Corners> last;
    return std::all_of(samples_.begin(), samples_.end(), [&](const Weights& weights) {
      const glm::dvec3 p = own.at(weights);
      if (last && last->near(p, reach_) && last->holds(p, reach_)) return true;
      return tree.any_near(from_glm(glm::vec3(p)), float(2 * reach_), [&](std::uint32_t other) {
        if (other == t || !by[other]) return false;
        const Corners there = corners(other);
        const glm::dvec3 back = there.normal();
        const double along = glm::dot(normal, back);
        if (!(along < 0) || !(along < -kOpposite * length * glm::length(back))) return false;
        if (!there.holds(p, reach_)) return false;
        last = there;
        return true;
      });
    });
  }

  std::span<const Vec3f> positions_;
  std::span<const std::uint32_t> indices_;
  double reach_;
  std::vector<Weights> samples_;
};

// Transfers the fine triangles' layers to the triangles that are written.
class Transfer {
 public:
  Transfer(const ChartSet& charts, const std::vector<std::uint8_t>& layers)
      : charts_(charts), layers_(layers), samples_(sample_weights()) {
    uvs_.reserve(charts.uvs.size());
    for (const Vec2d& uv : charts.uvs) uvs_.push_back({float(uv.x), float(uv.y), 0});
  }

  // Sets those of the chart's written triangles (`triangles`) that belong to a layer.
  void chart(std::uint32_t chart, const WorldMesh& written,
             std::span<const std::uint32_t> triangles, std::vector<std::uint8_t>& to) const {
    const std::span<const std::uint32_t> fine = triangles_of(charts_, charts_.charts[chart]);
    const auto in_layer = [&](std::uint32_t t) { return layers_[t] != 0; };
    if (std::none_of(fine.begin(), fine.end(), in_layer)) return;
    const TriangleTree tree(uvs_, charts_.triangle_uv, {fine.begin(), fine.end()});
    for (const std::uint32_t t : triangles)
      to[t] = is_layer(corners(&written.uv_indices[3 * std::size_t(t)]), tree);
  }

 private:
  Corners corners(const std::uint32_t* uv) const {
    const auto at = [&](std::uint32_t i) {
      return glm::dvec3(charts_.uvs[i].x, charts_.uvs[i].y, 0);
    };
    return {at(uv[0]), at(uv[1]), at(uv[2])};
  }

  // A sample beside all fine triangles says nothing: borders move a little when they are
  // straightened.
  bool is_layer(const Corners& own, const TriangleTree& tree) const {
    bool some = false;
    const double reach = 1e-6 * std::sqrt(glm::length(own.normal()));
    const bool others = std::any_of(samples_.begin(), samples_.end(), [&](const Weights& weights) {
      const glm::dvec3 p = own.at(weights);
      const float near = float(reach) + 1e-6f * float(std::max(std::abs(p.x), std::abs(p.y)));
      return tree.any_near(from_glm(glm::vec3(p)), near, [&](std::uint32_t fine) {
        if (!corners(&charts_.triangle_uv[3 * std::size_t(fine)]).holds(p, reach)) return false;
        some |= layers_[fine] != 0;
        return layers_[fine] == 0;
      });
    });
    return some && !others;
  }

  const ChartSet& charts_;
  const std::vector<std::uint8_t>& layers_;
  std::vector<Weights> samples_;
  std::vector<Vec3f> uvs_;
};

}  // namespace

std::vector<bool> one_sided_triangles(const Scene& scene, const ChartSet& charts,
                                      const WorldMesh& written, const Context& context) {
  const ChartedMesh fine(scene.indices, charts);
  const std::span<const std::uint32_t> indices = fine.view().indices;
  const std::vector<std::uint32_t> triangles =
      Candidates(scene.positions, indices, charts).triangles();
  if (triangles.empty() || context.cancelled()) return {};
  const std::vector<std::uint8_t> layers =
      Layers(scene.positions, indices).find(triangles, context);
  if (std::find(layers.begin(), layers.end(), 1) == layers.end() || context.cancelled()) return {};
  const Buckets by_chart =
      sort_into_buckets(written.triangle_chart.size(), charts.charts.size(),
                        [&](std::size_t t) { return written.triangle_chart[t]; });
  const Transfer transfer(charts, layers);
  std::vector<std::uint8_t> result(written.triangle_chart.size(), 0);
  parallel_for(context, charts.charts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      transfer.chart(std::uint32_t(c), written, by_chart[c], result);
  });
  if (std::find(result.begin(), result.end(), 1) == result.end() || context.cancelled()) return {};
  return {result.begin(), result.end()};
}

}  // namespace atlas
