#include "libatlas/core/polygon.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "libatlas/core/clock.h"
#include "libatlas/core/glm_bridge.h"
#include "tests/support/slowness.h"

namespace atlas {
namespace {

double area2(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

double polygon_area2(const std::vector<Vec2d>& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2d &a = p[i], &b = p[(i + 1) % p.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

// Lifts a flat polygon into a random plane, triangulates it there, and checks in the plane that it
// gives n - 2 triangles of the polygon's orientation whose areas add up to the polygon's. The
// triangles then cover a simple polygon exactly.
void check(const std::vector<Vec2d>& polygon, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const glm::dvec3 u = glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)});
  const glm::dvec3 w = glm::normalize(glm::cross(u, glm::dvec3{normal(random), normal(random), 1}));
  const glm::dvec3 at{normal(random) * 50, normal(random) * 50, normal(random)};
  std::vector<Vec3d> corners;
  for (const Vec2d& p : polygon) corners.push_back(from_glm(at + u * p.x + w * p.y));
  std::vector<std::array<std::uint32_t, 3>> triangles;
  ASSERT_TRUE(triangulate(corners, triangles));
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  const double total = polygon_area2(polygon);
  double sum = 0;
  for (const auto& t : triangles) {
    const double a = area2(polygon[t[0]], polygon[t[1]], polygon[t[2]]);
    EXPECT_GE(a / total, -1e-9);
    sum += a;
  }
  EXPECT_NEAR(sum / total, 1, 1e-9);
}

TEST(Polygon, StarsOfAllSizes) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> radius(0.05, 1);
  for (int n = 3; n < 60; ++n) {
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::vector<Vec2d> p;
      for (int i = 0; i < n; ++i) {
        const double r = radius(random), a = 2 * M_PI * i / n;
        p.push_back({r * std::cos(a), r * std::sin(a)});
      }
      check(p, random);
      std::vector<Vec2d> reversed(p.rbegin(), p.rend());
      check(reversed, random);
    }
  }
}

TEST(Polygon, CombsSpiralsAndCollinearRuns) {
  std::mt19937 random(2);
  std::vector<Vec2d> comb{{0, -1}, {41, -1}};
  for (int i = 40; i >= 0; --i) comb.push_back({double(i), i % 2 ? 0.1 : 10.0});
  check(comb, random);
  std::vector<Vec2d> spiral;
  for (int i = 0; i < 60; ++i) {
    spiral.push_back({(10 - i * 0.1) * std::cos(i * 0.3), (10 - i * 0.1) * std::sin(i * 0.3)});
  }
  for (int i = 59; i >= 0; --i) {
    spiral.push_back({(9.5 - i * 0.1) * std::cos(i * 0.3), (9.5 - i * 0.1) * std::sin(i * 0.3)});
  }
  check(spiral, random);
  check({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, random);
}

// A polygon with holes as one ring, with a cut to each hole: the ends of a cut occur twice.
TEST(Polygon, HolesThatCutsLeadTo) {
  std::mt19937 random(3);
  for (int holes = 1; holes <= 4; ++holes) {
    std::vector<Vec2d> p;
    for (int i = 0; i < holes; ++i) {
      const double x = 3 * i;
      p.insert(p.end(), {{x, 0},
                         {x + 1, 0},
                         {x + 1, 1},
                         {x + 1, 2},
                         {x + 2, 2},
                         {x + 2, 1},
                         {x + 1, 1},
                         {x + 1, 0}});
    }
    p.insert(p.end(), {{3.0 * holes, 0}, {3.0 * holes, 4}, {0, 4}});
    check(p, random);
  }
}

// A round outline with one dent: ears are clipped around it, and no corner belongs to all
// triangles.
TEST(Polygon, EarsAreNotAllAtOneCorner) {
  constexpr int n = 96;
  std::vector<Vec3d> corners;
  for (int i = 0; i < n; ++i) {
    const double r = i == 0 ? 0.9 : 1, a = 2 * M_PI * i / n;
    corners.push_back({r * std::cos(a), r * std::sin(a), 0});
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  ASSERT_TRUE(triangulate(corners, triangles));
  std::vector<int> at(n, 0);
  for (const auto& t : triangles) {
    for (const std::uint32_t v : t) ++at[v];
  }
  EXPECT_LE(*std::max_element(at.begin(), at.end()), 20);
}

// Returns twice the area of a triangle in units of 2^-106, without rounding. Coordinates must be
// multiples of 2^-53 below 64.
__int128 exact_area2(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto whole = [](double v) { return static_cast<__int128>(std::ldexp(v, 53)); };
  return (whole(b.x) - whole(a.x)) * (whole(c.y) - whole(a.y)) -
         (whole(b.y) - whole(a.y)) * (whole(c.x) - whole(a.x));
}

int exact_side(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const __int128 area = exact_area2(a, b, c);
  return (area > 0) - (area < 0);
}

// Returns whether segments ab and cd touch or cross.
bool meet(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const auto boxes = [](double p, double q, double r, double s) {
    return std::max(p, q) >= std::min(r, s) && std::max(r, s) >= std::min(p, q);
  };
  return boxes(a.x, b.x, c.x, d.x) && boxes(a.y, b.y, c.y, d.y) &&
         exact_side(a, b, c) * exact_side(a, b, d) <= 0 &&
         exact_side(c, d, a) * exact_side(c, d, b) <= 0;
}

// Returns whether edges meet only at their shared corners.
bool simple(const std::vector<Vec3d>& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (exact_side(p[i], p[(i + 1) % n], p[(i + 2) % n]) == 0) return false;
    for (std::size_t k = i + 2; k < n && (k + 1) % n != i; ++k)
      if (meet(p[i], p[i + 1], p[k], p[(k + 1) % n])) return false;
  }
  return true;
}

// Returns corners along a diagonal, and a corner far from it. They are closer to the diagonal than
// the rounding of products, which can move them to either side of it.
std::vector<Vec3d> near_a_line(std::mt19937& random) {
  std::vector<Vec3d> corners;
  const std::size_t count = 3 + random() % 4;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = std::array{0.5, 0.5, 12.0, 24.0}[random() % 4];
    const double step = std::ldexp(1, at < 1 ? -53 : at < 16 ? -49 : -48);
    corners.push_back({at + double(random() % 64) * step, at + double(random() % 64) * step, 0});
  }
  std::sort(corners.begin(), corners.end(),
            [](const Vec3d& a, const Vec3d& b) { return a.x + a.y < b.x + b.y; });
  corners.insert(corners.begin(), {0, 0, 0});
  corners.push_back({-5, 30, 0});
  return corners;
}

TEST(Polygon, CornersNextToALineAreCutExactly) {
  std::mt19937 random(11);
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::vector<Vec3d> corners = near_a_line(random);
    if (!simple(corners)) continue;
    ++checked;
    __int128 area = 0, sum = 0;
    for (std::size_t k = 2; k < corners.size(); ++k)
      area += exact_area2(corners[0], corners[k - 1], corners[k]);
    ASSERT_TRUE(area > 0);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    ASSERT_TRUE(triangulate(corners, triangles));
    ASSERT_EQ(triangles.size(), corners.size() - 2);
    for (const auto& t : triangles) {
      const __int128 part = exact_area2(corners[t[0]], corners[t[1]], corners[t[2]]);
      ASSERT_TRUE(part >= 0) << "polygon " << i;
      sum += part;
    }
    ASSERT_TRUE(sum == area) << "polygon " << i;
  }
  EXPECT_GT(checked, 5000);
}

// A convex polygon with corners that hang on its sides, turned by `turn` and rounded to floats.
// With a power above 1, the hanging corners are nearer to the beginning of their side.
std::vector<Vec3d> hung(int sides, const std::vector<int>& hanging, double turn, double power = 1) {
  std::vector<Vec3d> corners;
  const auto at = [&](int side) {
    const double a = 2 * M_PI * side / sides + turn;
    return Vec2d{3 + std::cos(a), std::sin(a) - 2};
  };
  for (int side = 0; side < sides; ++side) {
    const Vec2d from = at(side), to = at(side + 1);
    const int parts = hanging[std::size_t(side) % hanging.size()] + 1;
    for (int k = 0; k < parts; ++k) {
      const double t = std::pow(double(k) / parts, power);
      corners.push_back({double(float(from.x + t * (to.x - from.x))),
                         double(float(from.y + t * (to.y - from.y))), 0});
    }
  }
  return corners;
}

// Triangles of hanging corners have the area that the corner leaves them, whichever corner is the
// first and however rounding moves them off the side. A triangle of three corners of one side would
// be a millionth as high as long.
void check_hanging(std::vector<Vec3d> corners, double least) {
  const auto area = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return area2({corners[a].x, corners[a].y}, {corners[b].x, corners[b].y},
                 {corners[c].x, corners[c].y});
  };
  for (std::size_t start = 0; start < corners.size(); ++start) {
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    double whole = 0, sum = 0;
    for (std::uint32_t k = 2; k < corners.size(); ++k) whole += area(0, k - 1, k);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    ASSERT_TRUE(triangulate(corners, triangles));
    ASSERT_EQ(triangles.size(), corners.size() - 2);
    for (const auto& t : triangles) {
      ASSERT_GT(area(t[0], t[1], t[2]), least) << corners.size() << " from " << start;
      sum += area(t[0], t[1], t[2]);
    }
    ASSERT_NEAR(sum, whole, 1e-9);
  }
}

TEST(Polygon, HangingCornersGetTrianglesWithArea) {
  for (int sides = 3; sides <= 7; ++sides) {
    for (const std::vector<int>& hanging :
         {std::vector<int>{1}, {0, 1}, {2, 0, 0}, {1, 0, 3, 0, 2}, {5}, {0, 0, 4}}) {
      for (const double turn : {0.0, M_PI / 4, M_PI / 2, 0.3, 1.1, 2.2, 4.7})
        check_hanging(hung(sides, hanging, turn), 1e-4);
    }
  }
}

TEST(Polygon, HangingCornersMayBeNearTheEndsOfTheirSides) {
  for (int sides = 3; sides <= 7; ++sides) {
    for (const std::vector<int>& hanging : {std::vector<int>{1}, {0, 1}, {2, 0, 0}}) {
      for (double turn = 0; turn < 6; turn += 0.17) {
        for (const double power : {0.01, 7.0})
          check_hanging(hung(sides, hanging, turn, power), 2e-6);
      }
    }
  }
}

TEST(Polygon, RoundOutlinesWithHangingCornersTakeLinearTime) {
  std::vector<Vec2d> round;
  constexpr int n = 100'000;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * M_PI * (i / 2) / (n / 2), b = 2 * M_PI * (i / 2 + 1) / (n / 2);
    const double t = 0.5 * (i % 2);
    round.push_back(
        {(1 - t) * std::cos(a) + t * std::cos(b), (1 - t) * std::sin(a) + t * std::sin(b)});
  }
  std::mt19937 random(5);
  const double begun = cpu_seconds();
  check(round, random);
  EXPECT_LT(cpu_seconds() - begun, 0.25 * test::kSlowness);  // takes a twentieth of a second
}

// Polygons without hanging corners are fans from their first corner.
TEST(Polygon, StrictlyConvexOnesAreFans) {
  for (const int sides : {4, 5, 40, 1000}) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    ASSERT_TRUE(triangulate(hung(sides, {0}, 0.1), triangles));
    for (std::uint32_t i = 0; i < triangles.size(); ++i)
      EXPECT_EQ(triangles[i], (std::array<std::uint32_t, 3>{0, i + 1, i + 2}));
  }
}

TEST(Polygon, DegenerateOnesStillGiveTriangles) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  EXPECT_TRUE(triangulate(std::vector<Vec3d>(7, Vec3d{1, 2, 3}), triangles));
  EXPECT_EQ(triangles.size(), 5u);
  const std::vector<Vec3d> bow_tie{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
  triangulate(bow_tie, triangles);
  EXPECT_EQ(triangles.size(), 2u);
}

// Coastlines, contour maps and floors of whole towns occur as one polygon.
TEST(Polygon, ManyCornersTakeNoLongerEach) {
  std::mt19937 random(4);
  constexpr int n = 100'000;
  std::vector<Vec2d> star, spiral, saw, rough;
  std::uniform_real_distribution<double> radius(0.9, 1);
  for (int i = 0; i < n; ++i) {
    const double a = 2 * M_PI * i / n, r = 1 + 0.5 * (i % 2), q = radius(random);
    star.push_back({r * std::cos(a), r * std::sin(a)});
    rough.push_back({q * std::cos(a), q * std::sin(a)});
    saw.push_back({double(n - i), i % 2 ? 1.0 : 2.0});
  }
  saw.push_back({-1, -1});
  saw.push_back({n + 1.0, -1});
  for (const double inner : {10.0, 13.0}) {
    for (int i = 0; i < n / 2; ++i) {
      const double a = 40 * M_PI * (inner == 10 ? i : n / 2 - 1 - i) / (n / 2), r = inner + a;
      spiral.push_back({r * std::cos(a), r * std::sin(a)});
    }
  }
  const double begun = cpu_seconds();
  for (const auto& polygon : {star, spiral, saw, rough}) check(polygon, random);
  // Testing all corners for each ear would take hours.
  EXPECT_LT(cpu_seconds() - begun, test::kSlowness);
}

TEST(Polygon, BeyondAMillionCornersAFanIsCut) {
  std::vector<Vec3d> saw;
  for (int i = 0; i <= 1 << 20; ++i) saw.push_back({double(i), i % 2 ? 1.0 : 2.0, 0});
  saw.push_back({double(1 << 20), -1, 0});
  std::vector<std::array<std::uint32_t, 3>> triangles;
  EXPECT_FALSE(triangulate(saw, triangles));
  EXPECT_EQ(triangles.size(), saw.size() - 2);
}

// Outlines that cross themselves everywhere have few ears, and each corner blocks the others.
TEST(Polygon, KnotsTakeNoLonger) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(0, 1);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (const bool few : {false, true}) {
    std::vector<Vec3d> corners;
    for (int i = 0; i < 100'000; ++i)
      corners.push_back(few ? Vec3d{double(random() % 20), double(random() % 20), 0}
                            : Vec3d{place(random), place(random), 0});
    const double begun = cpu_seconds();
    triangulate(corners, triangles);
    EXPECT_LT(cpu_seconds() - begun, 1e-4 * 100'000 * test::kSlowness) << few;
    EXPECT_EQ(triangles.size(), corners.size() - 2);
  }
}

TEST(Polygon, OutlinesDoNotGoRoundAndRound) {
  std::vector<std::int64_t> ring, twice, often;
  for (int i = 0; i < 1000; ++i) ring.push_back(i);
  for (int i = 0; i < 1000; ++i) twice.push_back(i < 500 ? i : 999 - i);  // there and back
  for (int i = 0; i < 1000; ++i) often.push_back(i % 3);
  EXPECT_FALSE(goes_round_and_round(ring));
  EXPECT_FALSE(goes_round_and_round(twice));
  EXPECT_TRUE(goes_round_and_round(often));
  EXPECT_FALSE(goes_round_and_round(std::vector<std::int64_t>{0, 1, 2, 0, 1, 2}));
}

}  // namespace
}  // namespace atlas
