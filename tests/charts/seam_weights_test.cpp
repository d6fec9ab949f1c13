// Seams keep away from where the user says that they cost more.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/half_edge.h"
#include "tests/charts/chart_checks.h"

namespace atlas::test {
namespace {

ChartSet weighted_charts(const Shape& shape, const std::vector<float>& weights,
                         const ChartOptions& options = {}) {
  const Mesh mesh(shape);
  MeshView view = mesh.view();
  view.seam_weights = weights;
  Result<ChartSet> set = make_charts(view, options, {});
  EXPECT_TRUE(set.ok()) << set.status().message();
  if (!set.ok()) return {};
  EXPECT_EQ(check_charts(view, *set).fault, "") << shape.name;
  return std::move(*set);
}

// `weight` where x is above 0, else 1.
std::vector<float> heavy_half(const Shape& shape, float weight) {
  std::vector<float> weights;
  for (const Vec3f p : shape.positions) weights.push_back(p.x > 0 ? weight : 1);
  return weights;
}

// The lengths of the seams in the half where x is above 0, and in the other one.
std::pair<double, double> seams_of_halves(const Shape& shape, const ChartSet& set) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> sides;
  std::pair<double, double> lengths;
  for (std::uint32_t h = 0; h < shape.indices.size(); ++h) {
    const std::uint32_t a = shape.indices[h], b = shape.indices[next_half_edge(h)];
    sides[{a, b}] = h;
    const auto found = sides.find({b, a});
    if (found == sides.end()) continue;
    const std::uint32_t o = found->second;
    if (set.triangle_uv[h] == set.triangle_uv[next_half_edge(o)] &&
        set.triangle_uv[next_half_edge(h)] == set.triangle_uv[o])
      continue;
    const Vec3f p = shape.positions[a], q = shape.positions[b];
    (p.x + q.x > 0 ? lengths.first : lengths.second) += std::hypot(p.x - q.x, p.y - q.y, p.z - q.z);
  }
  return lengths;
}

// Charts depend on chance, so several shapes are looked at together.
TEST(SeamWeights, SeamsKeepAwayFromTheHeavyHalf) {
  double plain = 0, heavy = 0, light = 0;
  for (const Shape& shape : {geodesic_sphere(20), noisy(geodesic_sphere(16), 0.01, 5),
                             torus(60, 30), noisy(torus(40, 24), 0.01, 3)}) {
    const double one = 1 / seams_of_halves(shape, weighted_charts(shape, {})).first;
    const auto halves = seams_of_halves(shape, weighted_charts(shape, heavy_half(shape, 10)));
    plain += 1;
    heavy += one * halves.first;
    light += one * halves.second;
  }
  EXPECT_LT(heavy, 0.8 * plain);
  EXPECT_LT(heavy, 0.7 * light);
}

TEST(SeamWeights, ATubeIsCutAlongItsLightSide) {
  for (int turn = 0; turn < 8; ++turn) {
    Shape shape = cylinder(40, 20);
    const double angle = turn * 0.785398, c = std::cos(angle), s = std::sin(angle);
    for (Vec3f& p : shape.positions) p = {float(c * p.x - s * p.y), float(s * p.x + c * p.y), p.z};
    const ChartSet set = weighted_charts(shape, heavy_half(shape, 10));
    const auto [heavy, light] = seams_of_halves(shape, set);
    EXPECT_EQ(set.charts.size(), 1u) << turn;
    EXPECT_EQ(heavy, 0) << turn;
    EXPECT_GT(light, 1.99) << turn;  // the tube's length
    EXPECT_LT(light, 2.6) << turn;
  }
}

TEST(SeamWeights, TradeSeamsForStretch) {
  for (const Shape& shape : {torus(60, 30), noisy(geodesic_sphere(16), 0.01, 5)}) {
    std::vector<ChartSet> sets;
    for (const double weight : {0.2, 1.0, 5.0}) {
      ChartOptions options;
      options.seam_weight = weight;
      sets.push_back(weighted_charts(shape, {}, options));
    }
    for (std::size_t i = 1; i < sets.size(); ++i) {
      EXPECT_LT(sets[i].seam_length, 1.02 * sets[i - 1].seam_length) << shape.name;
      EXPECT_GT(sets[i].distortion.stretch_l2, sets[i - 1].distortion.stretch_l2) << shape.name;
    }
    EXPECT_LT(sets.back().seam_length, 0.9 * sets.front().seam_length) << shape.name;
    EXPECT_LT(sets.back().charts.size(), sets.front().charts.size()) << shape.name;
    EXPECT_LE(sets.back().distortion.stretch_999, 1.2501) << shape.name;
    // The same as weights that are all alike.
    const std::vector<float> all(shape.positions.size(), 5);
    EXPECT_EQ(bytes(weighted_charts(shape, all)), bytes(sets.back())) << shape.name;
  }
}

TEST(SeamWeights, OfOneChangeNothing) {
  for (const Shape& shape : {torus(40, 24), box(6), noisy(icosphere(3), 0.03, 5)})
    EXPECT_EQ(bytes(weighted_charts(shape, std::vector<float>(shape.positions.size(), 1))),
              bytes(weighted_charts(shape, {})))
        << shape.name;
}

// Parts that repeat others take their charts, but not where weights differ.
TEST(SeamWeights, CopiesWithOtherWeightsAreCutByThemselves) {
  Shape shape;
  std::vector<float> weights;
  for (int part = 0; part < 8; ++part) {
    const Shape tube = cylinder(24, 10);
    for (const Vec3f p : tube.positions) weights.push_back((part % 2 == 0) == (p.x > 0) ? 10 : 1);
    shape = together(shape, moved(tube, 1, {5.0 * part, 0, 0}));
  }
  const ChartSet set = weighted_charts(shape, weights);
  ASSERT_EQ(set.charts.size(), 8u);
  EXPECT_EQ(set.copied_pieces, 6u);
  const std::size_t triangles = shape.triangle_count() / 8, vertices = shape.positions.size() / 8;
  for (std::size_t part = 0; part < 8; ++part) {
    Shape own;
    own.positions.assign(shape.positions.begin() + part * vertices,
                         shape.positions.begin() + (part + 1) * vertices);
    for (Vec3f& p : own.positions) p.x = (part % 2 == 0 ? 1.f : -1.f) * (p.x - 5.0f * float(part));
    ChartSet uvs;
    for (std::size_t c = 3 * part * triangles; c < 3 * (part + 1) * triangles; ++c) {
      own.indices.push_back(std::uint32_t(shape.indices[c] - part * vertices));
      uvs.triangle_uv.push_back(set.triangle_uv[c]);
    }
    EXPECT_LT(seams_of_halves(own, uvs).first, 1e-3) << part;
  }
}

TEST(SeamWeights, OrdersDoNotMatterAndTheHighestOfAPlaceCounts) {
  const Shape shape = geodesic_sphere(12);
  const std::vector<float> weights = heavy_half(shape, 5);
  Shape soup;
  std::vector<float> own;
  for (std::size_t c = shape.indices.size(); c-- > 0;) {
    soup.positions.push_back(shape.positions[shape.indices[c]]);
    soup.indices.push_back(std::uint32_t(shape.indices.size() - 1 - c));
    own.push_back(c % 7 == 0 ? weights[shape.indices[c]] : 0);
  }
  for (std::size_t t = 0; t < shape.triangle_count(); ++t)
    std::swap(soup.indices[3 * t], soup.indices[3 * t + 2]);
  std::vector<float> highest(shape.positions.size(), 0);
  for (std::size_t c = 0; c < shape.indices.size(); c += 7)
    highest[shape.indices[c]] = weights[shape.indices[c]];
  const ChartSet a = weighted_charts(shape, highest), b = weighted_charts(soup, own);
  EXPECT_EQ(a.charts.size(), b.charts.size());
  EXPECT_EQ(a.seam_length, b.seam_length);
}

TEST(SeamWeights, ErrorsNameThePosition) {
  const Shape shape = box(2);
  const Mesh mesh(shape);
  const auto message = [&](std::vector<float> weights) {
    MeshView view = mesh.view();
    view.seam_weights = weights;
    const Result<ChartSet> set = make_charts(view, {}, {});
    return set.ok() ? "ok" : set.status().message();
  };
  std::vector<float> weights(shape.positions.size(), 1);
  EXPECT_EQ(message(weights), "ok");
  weights[3] = -1;
  EXPECT_NE(message(weights).find("position 3: seam weight -1"), std::string::npos);
  weights[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(message(weights).find("position 3: seam weight nan"), std::string::npos);
  weights.pop_back();
  EXPECT_NE(message(weights).find("1 a position"), std::string::npos);
}

}  // namespace
}  // namespace atlas::test
