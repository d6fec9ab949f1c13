// Flat charts side by side: the motion that fits one to the other, and the run of the border that
// fits best.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libatlas/charts/flattening/fitting_run.h"
#include "libatlas/charts/geometry/rigid_fit.h"
#include "libatlas/core/random.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

constexpr int kRowColumns = 24;

// A strip of squares two rows high, each row a chart of its own. The upper row's uvs are moved, and
// bent by `curvature` at each column.
struct TwoRows {
  Mesh mesh{grid(kRowColumns, 2, kRowColumns, 2)};
  Topology topology = *build_topology(mesh.view(), {}, {});
  Partition partition;
  FlatChart upper, lower;
  std::vector<BorderEdge> border;  // of the upper chart

  explicit TwoRows(const std::vector<double>& curvature) {
    for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
      const bool up = t / 2 / kRowColumns == 1;
      partition.chart.push_back(up ? 1 : 0);
      add(t, up ? upper : lower);
    }
    partition.seams.assign(topology.triangle_count(), 0);
    bend(curvature);
    border = find_border(topology, partition, upper.triangles, 1);
  }

  void add(std::uint32_t t, FlatChart& chart) const {
    chart.triangles.push_back(t);
    auto& corners = chart.corners.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t v = topology.corner_vertex[3 * t + c];
      const auto known = std::find(chart.vertex.begin(), chart.vertex.end(), v);
      corners[c] = std::uint32_t(known - chart.vertex.begin());
      if (known != chart.vertex.end()) continue;
      chart.vertex.push_back(v);
      chart.uvs.push_back({topology.points[v].x, topology.points[v].y});
    }
  }

  // Lays the upper row along a path that turns by curvature[i] at column i, rotated and moved away
  // as a whole.
  void bend(const std::vector<double>& curvature) {
    const double scale = topology.scale;
    std::vector<glm::dvec2> path{{0, 0}};
    std::vector<double> direction{0};
    for (int i = 0; i < kRowColumns; ++i) {
      const double d = direction.back() + curvature[i];
      path.push_back(path.back() + scale * glm::dvec2(std::cos(d), std::sin(d)));
      direction.push_back(d);
    }
    double left = 1e300, low = 1e300;
    for (const Vec2d& p : upper.uvs) left = std::min(left, p.x), low = std::min(low, p.y);
    for (Vec2d& p : upper.uvs) {
      const auto i = std::size_t(std::lround((p.x - left) / scale));
      const double h = p.y - low, d = direction[i];
      const glm::dvec2 q = path[i] + h * glm::dvec2(-std::sin(d), std::cos(d));
      p = {0.6 * q.x - 0.8 * q.y + 5, 0.8 * q.x + 0.6 * q.y - 7};
    }
  }

  // Finds the least-squares rotation by trying many, independently of the Procrustes formula.
  double misfit(std::size_t begin, std::size_t end) const {
    std::vector<std::array<glm::dvec2, 2>> pairs;
    double length = 0;
    glm::dvec2 mean_p(0), mean_q(0);
    for (std::size_t i = begin; i < end; ++i) {
      const auto a = ends_of(upper, border[i].half_edge),
                 b = ends_of(lower, topology.opposite[border[i].half_edge]);
      for (const int k : {0, 1}) {
        pairs.push_back({to_glm(upper.uvs[a[k]]), to_glm(lower.uvs[b[1 - k]])});
        mean_p += pairs.back()[0];
        mean_q += pairs.back()[1];
      }
      length += border[i].length;
    }
    mean_p /= double(pairs.size());
    mean_q /= double(pairs.size());
    const auto spread = [&](double angle) {
      const double c = std::cos(angle), s = std::sin(angle);
      double sum = 0;
      for (const auto& [p, q] : pairs) {
        const glm::dvec2 u = p - mean_p, v = q - mean_q;
        const glm::dvec2 d = glm::dvec2(c * u.x - s * u.y, s * u.x + c * u.y) - v;
        sum += glm::dot(d, d);
      }
      return sum / double(pairs.size());
    };
    double best = 0;
    for (double angle = -3.1; angle < 3.2; angle += 0.1) {
      if (spread(angle) < spread(best)) best = angle;
    }
    for (double step = 0.05; step > 1e-12; step /= 2) {
      for (const double other : {best - step, best + step}) {
        if (spread(other) < spread(best)) best = other;
      }
    }
    return std::sqrt(spread(best)) / length;
  }
};

// The sums since some pair are those of the later pairs alone.
TEST(RigidFit, OfTheLaterPairs) {
  std::mt19937_64 random(3);
  std::vector<std::pair<glm::dvec2, glm::dvec2>> pairs;
  for (int i = 0; i < 12; ++i) {
    const glm::dvec2 p(uniform(random), uniform(random)), stray(uniform(random), uniform(random));
    pairs.emplace_back(p, glm::dvec2(3 - p.y, 5 + p.x) + 0.1 * stray);
  }
  RigidFit all(pairs[0].first, pairs[0].second), early = all;
  RigidFit later(pairs[5].first, pairs[5].second);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double weight = 1 + double(i % 3);
    all.add(pairs[i].first, pairs[i].second, weight);
    (i < 5 ? early : later).add(pairs[i].first, pairs[i].second, weight);
  }
  const Motion since = all.since(early).motion(), alone = later.motion();
  EXPECT_NEAR(glm::distance(since.turn, alone.turn), 0, 1e-12);
  EXPECT_NEAR(glm::distance(since.shift, alone.shift), 0, 1e-12);
  EXPECT_NEAR(since.misfit, alone.misfit, 1e-9);
  EXPECT_GT(alone.misfit, 1e-3);
}

TEST(Joint, TakesOneChartToTheOther) {
  const TwoRows rows(std::vector<double>(kRowColumns, 0.0));
  ASSERT_EQ(rows.border.size(), std::size_t(kRowColumns));
  const Joint joint(rows.topology, {rows.upper, rows.lower}, rows.border);
  EXPECT_LT(joint.motion().misfit, 1e-7);  // it is the square root of differences
  EXPECT_EQ(joint.triangles().size(), rows.topology.triangle_count());
  const std::vector<Vec2d> uvs = joint.uvs();
  for (std::uint32_t t = 0; t < rows.topology.triangle_count(); ++t) {
    for (int c = 0; c < 3; ++c) {  // the strip must have its original shape
      const Vec3f& p = rows.topology.points[rows.topology.corner_vertex[3 * t + c]];
      EXPECT_NEAR(uvs[3 * t + c].x, p.x, 1e-6);
      EXPECT_NEAR(uvs[3 * t + c].y, p.y, 1e-6);
    }
  }
  const double area = 2 * kRowColumns * rows.topology.scale * rows.topology.scale;
  const Outline upper = outline_of(rows.topology, rows.partition, rows.upper),
                lower = outline_of(rows.topology, rows.partition, rows.lower);
  EXPECT_NEAR(joint.box(upper, lower), area, 1e-5 * area);
  EXPECT_EQ(joint.overlap(upper, lower, 100), 0u);
}

bool cross(glm::dvec2 a, glm::dvec2 b, glm::dvec2 c, glm::dvec2 d) {
  const auto side = [](glm::dvec2 p, glm::dvec2 q, glm::dvec2 r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) > 0;
  };
  return side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b);
}

// The rows are joined along their first edges. A bent row then overlaps the other one or leads away
// from it.
TEST(Joint, OverlapCountsSidesOnTheOther) {
  for (const double turn : {-0.1, -0.02, 0.03, 0.1}) {
    const TwoRows rows(std::vector<double>(kRowColumns, turn));
    const std::span<const BorderEdge> glue = std::span(rows.border).first(3);
    const Joint joint(rows.topology, {rows.upper, rows.lower}, glue);
    const auto glued = [&](std::uint32_t h) {
      return std::any_of(glue.begin(), glue.end(), [&](const BorderEdge& e) {
        return h == e.half_edge || h == rows.topology.opposite[e.half_edge];
      });
    };
    std::size_t expected = 0;
    for (const std::uint32_t t : rows.upper.triangles) {
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        for (std::uint32_t g = 0; g < 3 * rows.topology.triangle_count(); ++g) {
          const std::uint32_t o = rows.topology.opposite[g];
          const bool border = rows.partition.chart[g / 3] == 0 &&
                              (o == kNoIndex || rows.partition.chart[o / 3] != 0);
          if (!border || glued(h) || glued(g)) continue;
          const auto [a, b] = ends_of(rows.upper, h);
          const auto [c, d] = ends_of(rows.lower, g);
          const Motion& m = joint.motion();
          expected += cross(m(to_glm(rows.upper.uvs[a])), m(to_glm(rows.upper.uvs[b])),
                            to_glm(rows.lower.uvs[c]), to_glm(rows.lower.uvs[d]));
        }
      }
    }
    const Outline upper = outline_of(rows.topology, rows.partition, rows.upper),
                  lower = outline_of(rows.topology, rows.partition, rows.lower);
    EXPECT_EQ(joint.overlap(upper, lower, 1000), expected) << turn;
    EXPECT_EQ(joint.overlap(upper, lower, 5), std::min<std::size_t>(expected, 5)) << turn;
    if (turn < 0) {
      EXPECT_GT(expected, 10u) << turn;
    } else {
      EXPECT_LE(expected, 2u) << turn;  // next to the joined edges
    }
  }
}

TEST(Joint, TheLongestRunThatFitsIsFound) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(-0.4, 0.4);
  std::bernoulli_distribution straight(0.7);
  std::size_t parts = 0;
  for (int round = 0; round < 30; ++round) {
    std::vector<double> curvature(kRowColumns, 0.0);
    for (double& c : curvature) c = straight(random) ? 0 : turn(random);
    TwoRows rows(curvature);
    for (const double most : {0.001, 0.01, 0.03}) {
      const auto found =
          find_fitting_run(rows.topology, {rows.upper, rows.lower}, rows.border, most);
      // The border is in ascending order and its edges are equally long, so runs are intervals.
      std::size_t longest = 0;
      for (std::size_t i = 0; i < rows.border.size(); ++i) {
        for (std::size_t j = i + 1; j <= rows.border.size(); ++j) {
          if (j - i > longest && rows.misfit(i, j) < most * (1 - 1e-6)) longest = j - i;
        }
      }
      EXPECT_EQ(found.size(), longest) << round << ' ' << most;
      const Joint joint(rows.topology, {rows.upper, rows.lower}, found);
      EXPECT_LE(joint.motion().misfit, most * (1 + 1e-9));
      parts += found.size() < rows.border.size();
    }
  }
  EXPECT_GT(parts, 30u);  // the runs were not just all or nothing
}

}  // namespace
}  // namespace atlas::test
