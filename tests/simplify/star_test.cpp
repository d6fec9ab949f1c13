// Compares what Star finds with samples of the surfaces before and after a collapse.
#include "libatlas/simplify/star.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "libatlas/core/glm_bridge.h"

namespace atlas::simplify_test {
namespace {

using simplify::Estimate;
using simplify::Star;

constexpr double kTurn = 2 * 3.14159265358979;

// A star around the origin of uv that fills `angle`. It lies on the border unless it goes once
// around.
Star make_star(std::size_t neighbours, double angle,
               const std::function<glm::dvec3(double u, double v)>& surface,
               const std::function<double(std::size_t)>& radius) {
  Star star;
  star.vertex = 0;
  star.uv = glm::dvec2(0);
  star.position = surface(0, 0);
  star.ring.border = angle < kTurn;
  const std::size_t faces = neighbours - star.ring.border;
  for (std::size_t i = 0; i < neighbours; ++i) {
    const double a = angle * double(i) / double(faces), r = radius(i);
    star.uvs.emplace_back(r * std::cos(a), r * std::sin(a));
    star.positions.push_back(surface(star.uvs.back().x, star.uvs.back().y));
    star.ring.vertices.push_back(static_cast<std::uint32_t>(i + 1));
    if (i < faces) star.ring.faces.push_back(static_cast<std::uint32_t>(i));
  }
  star.measure_faces();
  return star;
}

using Triangle = std::array<std::pair<glm::dvec2, glm::dvec3>, 3>;

std::optional<glm::dvec3> lookup(const std::vector<Triangle>& surface, const glm::dvec2& u) {
  for (const Triangle& t : surface) {
    const glm::dvec2 a = t[1].first - t[0].first, b = t[2].first - t[0].first, d = u - t[0].first;
    const double det = a.x * b.y - a.y * b.x, x = (d.x * b.y - d.y * b.x) / det,
                 y = (a.x * d.y - a.y * d.x) / det;
    if (x < -1e-12 || y < -1e-12 || x + y > 1 + 1e-12) continue;
    return (1 - x - y) * t[0].second + x * t[1].second + y * t[2].second;
  }
  return std::nullopt;
}

// The largest distance between the surfaces before and after a collapse. Samples lie densely along
// the edges of both surfaces, where the largest distance is.
double sampled_step(const Star& star, std::size_t target) {
  std::vector<Triangle> before, after;
  const std::pair middle(star.uv, star.position), to(star.uvs[target], star.positions[target]);
  for (std::size_t i = 0; i < star.ring.faces.size(); ++i) {
    const std::size_t j = star.after(i);
    const std::pair a(star.uvs[i], star.positions[i]), b(star.uvs[j], star.positions[j]);
    before.push_back({middle, a, b});
    if (i != target && j != target) after.push_back({to, a, b});
  }
  constexpr int kSteps = 1500;
  double worst = 0;
  for (std::size_t i = 0; i < star.size(); ++i) {
    for (int s = 0; s <= kSteps; ++s) {
      const double t = double(s) / kSteps;
      const glm::dvec2 u = star.uv + t * (star.uvs[i] - star.uv);
      const auto p = lookup(before, u), q = lookup(after, u);
      if (p && q) worst = std::max(worst, glm::length(*p - *q));
    }
  }
  return worst;
}

TEST(Star, StepSlipIsTheLargestGapOfTheTwoSurfaces) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  int inner = 0, border = 0;
  while (inner < 60 || border < 60) {
    const bool at_border = random() % 2;
    const double angle = at_border ? kTurn * (0.3 + 0.5 * unit(random)) : kTurn;
    const Star star = make_star(
        4 + random() % 4, angle,
        [&](double u, double v) { return glm::dvec3(u, v, 0.5 * unit(random)); },
        [&](std::size_t) { return 0.15 + 0.85 * unit(random); });
    const std::size_t target = at_border && random() % 2 ? star.size() - 1 : 0;
    Estimate estimate;
    if (!star.judge(target, 1, 1, estimate)) continue;
    ++(at_border ? border : inner);
    const double sampled = sampled_step(star, target);
    const double found = std::max(star.step_slip(target), estimate.outside ? 0 : estimate.offset);
    EXPECT_GE(found, sampled - 1e-9);
    EXPECT_LE(found, sampled + 2e-3);
  }
}

Star hexagon(const std::function<glm::dvec3(double, double)>& surface) {
  return make_star(6, kTurn, surface, [](std::size_t) { return 1.0; });
}

TEST(Star, ATriangleMustNotTurnOverInSpace) {
  Estimate estimate;
  const Star even = hexagon([](double u, double v) { return glm::dvec3(u, v, 0); });
  EXPECT_TRUE(even.judge(0, 1, 1, estimate));
  // The target is bent back under the neighbour that lies opposite to it.
  Star bent = even;
  bent.positions[0] = glm::dvec3(-1.5, 0, 0.1);
  bent.measure_faces();
  EXPECT_FALSE(bent.judge(0, 1, 1, estimate));
}

// The four new triangles of a hexagon after its vertex has moved to neighbour 0 are 0-1-2, 0-2-3,
// 0-3-4 and 0-4-5. The first of them is made thinner by moving neighbour 1 towards the edge 0-2.
bool allows_triangle_of_height(double height, double thin_before) {
  Star star = hexagon([](double u, double v) { return glm::dvec3(u, v, 0); });
  const glm::dvec2 middle = 0.5 * (star.uvs[0] + star.uvs[2]);
  star.uvs[1] = middle + height * glm::normalize(middle);
  star.positions[1] = glm::dvec3(star.uvs[1], 0);
  if (thin_before > 0) {  // the old triangle between the neighbours 5 and 0 is thin
    star.uvs[5] = glm::dvec2(1.5, -thin_before);
    star.positions[5] = glm::dvec3(star.uvs[5], 0);
  }
  star.measure_faces();
  Estimate estimate;
  return star.judge(0, 1, 1, estimate);
}

TEST(Star, NoTriangleBecomesMuchThinnerThanTheOldOnes) {
  EXPECT_TRUE(allows_triangle_of_height(1e-2, 0));
  EXPECT_FALSE(allows_triangle_of_height(1e-5, 0));
  // Where there was a thinner one before, it may be as thin, but not without any area.
  EXPECT_TRUE(allows_triangle_of_height(1e-5, 1e-6));
  EXPECT_FALSE(allows_triangle_of_height(1e-7, 1e-6));
  EXPECT_FALSE(allows_triangle_of_height(1e-8, 1e-10));
}

// The vertex of a convex corner lies outside all triangles that are left. Its distance is then a
// matter of the border and not of the triangles.
TEST(Star, AConvexCornerIsLeftOutside) {
  Estimate estimate;
  const auto flat = [](double u, double v) { return glm::dvec3(u, v, 0); };
  const auto even = [](std::size_t) { return 1.0; };
  ASSERT_TRUE(make_star(3, 0.3 * kTurn, flat, even).judge(0, 1, 1, estimate));
  EXPECT_TRUE(estimate.outside);
  ASSERT_TRUE(make_star(3, 0.7 * kTurn, flat, even).judge(0, 1, 1, estimate));
  EXPECT_FALSE(estimate.outside);
  ASSERT_TRUE(make_star(6, kTurn, flat, even).judge(0, 1, 1, estimate));
  EXPECT_FALSE(estimate.outside);
}

TEST(Star, OfManyNeighboursTheNearestAreTried) {
  std::mt19937 random(4);
  for (std::size_t n = 3; n < 40; ++n) {
    const Star star = make_star(
        n, kTurn, [](double u, double v) { return glm::dvec3(u, v, u * v); },
        [&](std::size_t) { return 0.5 + double(random() % 1000) / 1000; });
    std::vector<std::size_t> targets;
    star.pick_targets(targets);
    ASSERT_EQ(targets.size(), n <= 14 ? n : 8);
    double farthest = 0;
    std::vector<bool> tried(n, false);
    for (const std::size_t i : targets) {
      tried[i] = true;
      farthest = std::max(farthest, glm::distance(star.positions[i], star.position));
    }
    EXPECT_EQ(std::count(tried.begin(), tried.end(), true), targets.size());
    for (std::size_t i = 0; i < n && n > 14; ++i) {
      if (tried[i]) continue;
      EXPECT_GE(glm::distance(star.positions[i], star.position), farthest);
    }
  }
}

}  // namespace
}  // namespace atlas::simplify_test
