// Compares slip and turn of single coarse triangles with samples along the fine edges.
#include "libatlas/simplify/slip_measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libatlas/core/glm_bridge.h"
#include "tests/simplify/shapes.h"

namespace atlas::simplify_test {
namespace {

using simplify::FineChart;
using simplify::SlipLimits;

struct Point {
  glm::dvec2 uv;
  glm::dvec3 at;
};

double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

class Measured {
 public:
  explicit Measured(const ChartedMesh& mesh)
      : mesh_(mesh),
        view_(mesh_.view()),
        geometry_{&view_, &mesh_.charts},
        fine_(simplify::build_fine_chart(geometry_, 0, std::vector<bool>(mesh.triangles()))),
        points_(geometry_, fine_),
        measure_(fine_, points_) {}

  const FineChart& fine() const { return fine_; }
  Point point(std::uint32_t v) const {
    return {to_glm(geometry_.uv(fine_.vertex_uv[v])),
            to_dvec(geometry_.position(fine_.vertex_uv[v]))};
  }
  bool operator()(const std::array<std::uint32_t, 3>& t, const SlipLimits& limits,
                  SlipLimits& found) {
    return measure_.measure(t, limits, found);
  }
  // Returns twice the area of a triangle in uv.
  double area(const std::array<std::uint32_t, 3>& t) const {
    const Point a = point(t[0]), b = point(t[1]), c = point(t[2]);
    return cross(b.uv - a.uv, c.uv - a.uv);
  }
  bool touches_border(const std::array<std::uint32_t, 3>& t) const {
    return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return fine_.border(v); });
  }
  std::array<std::uint32_t, 3> corners(std::uint32_t f) const {
    return {fine_.corners[3 * f], fine_.corners[3 * f + 1], fine_.corners[3 * f + 2]};
  }

 private:
  ChartedMesh mesh_;
  MeshView view_;
  simplify::Geometry geometry_;
  FineChart fine_;
  simplify::VertexPoints points_;
  simplify::SlipMeasure measure_;
};

// A triangle in space, parameterised by uv.
struct Plane {
  Point p[3];

  glm::dvec3 normal() const {
    return glm::normalize(glm::cross(p[1].at - p[0].at, p[2].at - p[0].at));
  }
  glm::dvec3 weights(const glm::dvec2& uv) const {
    const double whole = cross(p[1].uv - p[0].uv, p[2].uv - p[0].uv);
    const double b = cross(uv - p[0].uv, p[2].uv - p[0].uv) / whole;
    const double c = cross(p[1].uv - p[0].uv, uv - p[0].uv) / whole;
    return {1 - b - c, b, c};
  }
  bool holds(const glm::dvec2& uv, double margin) const {
    const glm::dvec3 w = weights(uv);
    return std::min({w.x, w.y, w.z}) >= margin;
  }
  glm::dvec3 at(const glm::dvec2& uv) const {
    const glm::dvec3 w = weights(uv);
    return w.x * p[0].at + w.y * p[1].at + w.z * p[2].at;
  }
};

Plane plane(const Measured& m, const std::array<std::uint32_t, 3>& t) {
  return {{m.point(t[0]), m.point(t[1]), m.point(t[2])}};
}

// The largest gap at samples of fine edges, and the largest turn of fine triangles: of those that
// lie entirely over the coarse one (sure), and of all that share a point with it (possible).
struct Oracle {
  double slip = 0, sure_turn = 0, possible_turn = 0;
};

Oracle strew(const Measured& m, const std::array<std::uint32_t, 3>& t) {
  constexpr int kSteps = 60;
  const Plane coarse = plane(m, t);
  const glm::dvec3 normal = coarse.normal();
  Oracle out;
  for (std::uint32_t f = 0; f < m.fine().triangle_count(); ++f) {
    const Plane fine = plane(m, m.corners(f));
    bool all = true, any = false;
    for (int k = 0; k < 3; ++k) {
      const Point &a = fine.p[k], &b = fine.p[(k + 1) % 3];
      for (int s = 0; s < kSteps; ++s) {
        const double w = double(s) / kSteps;
        const glm::dvec2 uv = (1 - w) * a.uv + w * b.uv;
        all = all && coarse.holds(uv, -1e-9);
        if (!coarse.holds(uv, -1e-9)) continue;
        any = true;
        out.slip = std::max(out.slip, glm::distance(coarse.at(uv), (1 - w) * a.at + w * b.at));
      }
    }
    for (const Point& p : coarse.p) any = any || fine.holds(p.uv, 1e-9);
    const double turn = std::acos(std::clamp(glm::dot(normal, fine.normal()), -1.0, 1.0));
    if (all) out.sure_turn = std::max(out.sure_turn, turn);
    if (any) out.possible_turn = std::max(out.possible_turn, turn);
  }
  return out;
}

TEST(SlipMeasure, AgreesWithPointsAlongTheFineEdges) {
  std::mt19937 random(6);
  for (const double amplitude : {0.002, 0.03, 0.1}) {
    Measured measured(bumpy(8, amplitude));
    const std::uint32_t n = measured.fine().vertex_count();
    int judged = 0;
    while (judged < 60) {
      const std::array<std::uint32_t, 3> t{std::uint32_t(random() % n), std::uint32_t(random() % n),
                                           std::uint32_t(random() % n)};
      if (measured.area(t) < 0.02) continue;
      ++judged;
      const Oracle oracle = strew(measured, t);
      // Strips of fine triangles count from a width of a tenth of the slip limit, so entire
      // triangles do.
      const SlipLimits wide{0.3, 3};
      SlipLimits found;
      ASSERT_TRUE(measured(t, wide, found));
      EXPECT_GE(found.slip, oracle.slip - 1e-9);
      EXPECT_LE(found.slip, 1.05 * oracle.slip + 1e-9);
      EXPECT_GE(found.turn, oracle.sure_turn - 1e-9);
      EXPECT_LE(found.turn, oracle.possible_turn + 1e-6);
      EXPECT_TRUE(measured(t, {found.slip * (1 + 1e-9), 3}, found));
      const SlipLimits exact = found;
      EXPECT_FALSE(measured(t, {0.9 * exact.slip, 3}, found));
      if (oracle.sure_turn > 0.01) {
        EXPECT_FALSE(measured(t, {0.3, 0.9 * oracle.sure_turn}, found));
      }
    }
  }
}

// A roof: a coarse triangle that spans the ridge turns every fine triangle by the slope of its
// side.
TEST(SlipMeasure, OfARoofIsItsHeightAndSlope) {
  for (const double slope : {0.1, 0.5, 1.0}) {
    ChartedMeshBuilder builder;
    builder.add_grid(2, 1, [&](double s, double t) {
      const double x = 2 * s - 1;
      return ChartedMeshBuilder::Vertex{{float(x), float(t), float(slope * (1 - std::abs(x)))},
                                        {2 * s, t}};
    });
    Measured measured(builder.build());
    const auto at = [&](double x, double y) {
      for (std::uint32_t v = 0; v < measured.fine().vertex_count(); ++v) {
        const Point p = measured.point(v);
        if (p.at.x == x && p.at.y == y) return v;
      }
      return 0u;
    };
    SlipLimits found;
    ASSERT_TRUE(measured({at(-1, 0), at(1, 0), at(1, 1)}, {1.5, 3}, found));
    EXPECT_NEAR(found.slip, slope, 1e-7);
    EXPECT_NEAR(found.turn, std::atan(slope), 1e-6);
    ASSERT_TRUE(measured({at(0, 0), at(1, 0), at(1, 1)}, {1.5, 3}, found));
    EXPECT_NEAR(found.slip, 0, 1e-9);
    EXPECT_NEAR(found.turn, 0, 1e-6);
  }
}

std::uint32_t vertex_at(const Measured& m, double u, double v) {
  for (std::uint32_t i = 0; i < m.fine().vertex_count(); ++i) {
    if (glm::distance(m.point(i).uv, {u, v}) < 1e-12) return i;
  }
  ADD_FAILURE() << "no vertex at " << u << ", " << v;
  return 0;
}

// A strip of the given width rises beside a flat rectangle, and one coarse triangle spans both. The
// strip's turn counts only if it is wider than a tenth of the slip's limit.
TEST(SlipMeasure, NarrowStripsDoNotCountForTheTurn) {
  constexpr double kWidth = 0.001, kSlope = 0.5;
  ChartedMeshBuilder builder;
  const auto vertex = [](double x, double y) {
    const double u = x > 1 ? 1 + kWidth : x;
    return ChartedMeshBuilder::Vertex{{float(u), float(y), float(x > 1 ? kSlope * kWidth : 0)},
                                      {u, y}};
  };
  builder.add_chart({vertex(0, 0), vertex(1, 0), vertex(1, 1), vertex(2, 0), vertex(2, 1)},
                    {0, 1, 2, 1, 3, 4, 1, 4, 2});
  Measured measured(builder.build());
  const auto at = [&](double u, double v) { return vertex_at(measured, u, v); };
  const std::array<std::uint32_t, 3> spanning{at(0, 0), at(1 + kWidth, 0), at(1 + kWidth, 1)};
  // The strip consists of two triangles. Each has half a rectangle's area, so it counts as a strip
  // of half the width.
  for (const double factor : {0.5, 0.9, 1.1, 2.0}) {
    SlipLimits found;
    ASSERT_TRUE(measured(spanning, {factor * 10 * kWidth / 2, 3}, found));
    const double turn = factor < 1 ? std::atan(kSlope) : 0;
    EXPECT_NEAR(found.turn, turn, 2 * kSlope * kWidth) << factor;
  }
}

// A pyramid that is tiny against the coarse triangle still has its height.
TEST(SlipMeasure, ASpikeOnATinyPatchCounts) {
  constexpr double kSmall = 1e-7;
  ChartedMeshBuilder builder;
  const auto vertex = [](double u, double v, double z) {
    return ChartedMeshBuilder::Vertex{{float(u), float(v), float(z)}, {u, v}};
  };
  builder.add_chart(
      {vertex(0, 0, 0), vertex(4, 0, 0), vertex(0, 4, 0), vertex(1, 1, 0), vertex(1 + kSmall, 1, 0),
       vertex(1, 1 + kSmall, 0), vertex(1 + kSmall / 3, 1 + kSmall / 3, 0.25)},
      {0, 1, 3, 1, 4, 3, 1, 2, 4, 2, 5, 4, 2, 0, 5, 0, 3, 5, 3, 4, 6, 4, 5, 6, 5, 3, 6});
  Measured measured(builder.build());
  SlipLimits found;
  const auto at = [&](double u, double v) { return vertex_at(measured, u, v); };
  ASSERT_TRUE(measured({at(0, 0), at(4, 0), at(0, 4)}, {1, 3}, found));
  EXPECT_NEAR(found.slip, 0.25, 1e-6);
}

// Returns the distance of a point from the middle third of the unit square, which the plate leaves
// out. It is negative inside.
double from_hole(const glm::dvec2& uv) {
  return std::max(std::abs(uv.x - 0.5), std::abs(uv.y - 0.5)) - 1.0 / 6;
}

// A triangle away from the border must have the chart under it everywhere.
TEST(SlipMeasure, WhatSpansAHoleIsRefused) {
  Measured measured(plate_with_hole(12));
  const std::uint32_t n = measured.fine().vertex_count();
  std::mt19937 random(8);
  int over = 0, beside = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::array<std::uint32_t, 3> t{std::uint32_t(random() % n), std::uint32_t(random() % n),
                                         std::uint32_t(random() % n)};
    if (measured.area(t) < 0.01 || measured.touches_border(t)) continue;
    const Plane coarse = plane(measured, t);
    double nearest = 1;
    constexpr int kSteps = 60;
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const double u = double(a) / kSteps, v = double(b) / kSteps;
        nearest = std::min(nearest, from_hole((1 - u - v) * coarse.p[0].uv + u * coarse.p[1].uv +
                                              v * coarse.p[2].uv));
      }
    }
    SlipLimits found;
    if (nearest < -0.01) {
      EXPECT_FALSE(measured(t, {1, 3}, found));
      ++over;
    } else if (nearest > 0.03) {
      EXPECT_TRUE(measured(t, {1, 3}, found));
      EXPECT_NEAR(found.slip, 0, 1e-6);
      ++beside;
    }
  }
  EXPECT_GT(over, 20);
  EXPECT_GT(beside, 20);
}

}  // namespace
}  // namespace atlas::simplify_test
