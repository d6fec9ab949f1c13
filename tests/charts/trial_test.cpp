// Trials of mergers on the coarse mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/cost_classes.h"
#include "libatlas/charts/merging/fan_measure.h"
#include "libatlas/charts/merging/fan_solver.h"
#include "libatlas/charts/merging/refusal.h"
#include "libatlas/charts/merging/trial.h"
#include "libatlas/charts/mesh/topology.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/hull.h"
#include "libatlas/param/distortion.h"
#include "libatlas/param/isometric.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/coarse_shapes.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// Two charts of a coarse mesh, divided by a predicate on the centres of its cells.
struct Halves {
  std::vector<std::uint32_t> first, second, inside_first, inside_second, glue;

  template <class Side>
  Halves(const CoarseMesh& mesh, const Side& in_second) {
    std::vector<std::uint8_t> side;
    for (std::uint32_t k = 0; k < mesh.cells.size(); ++k) {
      side.push_back(in_second(mesh.cells[k].centre));
      (side[k] ? second : first).push_back(k);
    }
    for (std::uint32_t arc = 0; arc < mesh.arcs.size(); ++arc) {
      const auto& [a, b] = mesh.arcs[arc].cell;
      if (b == kNoIndex) continue;
      (side[a] != side[b] ? glue : side[a] ? inside_second : inside_first).push_back(arc);
    }
  }
  std::vector<std::uint8_t> joined(const CoarseMesh& mesh, bool both) const {
    std::vector<std::uint8_t> joined(mesh.arcs.size(), 0);
    for (const std::uint32_t arc : inside_first) joined[arc] = 1;
    for (const std::uint32_t arc : inside_second) joined[arc] = 1;
    if (both) {
      for (const std::uint32_t arc : glue) joined[arc] = 1;
    }
    return joined;
  }
};

std::vector<std::uint32_t> all_arcs(const Halves& halves) {
  std::vector<std::uint32_t> all = halves.inside_first;
  all.insert(all.end(), halves.inside_second.begin(), halves.inside_second.end());
  all.insert(all.end(), halves.glue.begin(), halves.glue.end());
  return all;
}

std::vector<std::uint32_t> all_cells(const CoarseMesh& mesh) {
  std::vector<std::uint32_t> cells(mesh.cells.size());
  std::iota(cells.begin(), cells.end(), 0u);
  return cells;
}

const auto kEast = [](const Vec3d& p) { return p.x > 0.05; };

TEST(TrialMesh, ChartsKeepWhatIsJoinedInThem) {
  const CoarseMesh mesh = coarse_of(cap(60, 20, 1.0));
  const Halves halves(mesh, kEast);
  ASSERT_FALSE(halves.first.empty() || halves.second.empty());
  TrialScratch at_once(mesh), in_turn(mesh);
  TrialMesh whole(mesh, at_once), grown(mesh, in_turn);
  const auto joined = halves.joined(mesh, true);
  whole.assemble({all_cells(mesh), {}, all_arcs(halves)}, joined);
  EXPECT_EQ(whole.euler(), 1);
  const auto apart = halves.joined(mesh, false);
  grown.assemble({halves.first, {}, halves.inside_first}, apart);
  grown.commit();
  grown.assemble({halves.second, {}, halves.inside_second}, apart);
  grown.commit();
  // A trial that is not accepted leaves nothing behind.
  grown.assemble({halves.first, halves.second, halves.glue}, joined);
  grown.assemble({halves.first, halves.second, {}}, apart);
  EXPECT_EQ(grown.euler(), 2);
  EXPECT_EQ(grown.joined_euler(1, 1, halves.glue), 1);
  EXPECT_EQ(grown.joined_euler(1, 1, {}), 2);
  grown.assemble({halves.first, halves.second, halves.glue}, joined);
  EXPECT_EQ(grown.euler(), 1);
  EXPECT_EQ(grown.vertex_count(), whole.vertex_count());
  EXPECT_EQ(grown.border().size(), whole.border().size());
}

// The cells of a spherical cap as one mesh, with a solver for them and their initial uvs.
struct CapFans {
  CoarseMesh mesh;
  Halves halves{mesh, kEast};
  TrialScratch scratch{mesh};
  TrialMesh trial{mesh, scratch};
  Fans fans{mesh};
  FanSolver solver{fans};
  std::vector<Vec2d> uvs;
  std::vector<Vec3d> places;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  explicit CapFans(CoarseMesh coarse = coarse_of(cap(60, 20, 1.2))) : mesh(std::move(coarse)) {
    trial.assemble({all_cells(mesh), {}, all_arcs(halves)}, halves.joined(mesh, true));
    uvs.resize(trial.vertex_count());
    place();
    for (std::size_t v = 0; v < uvs.size(); ++v) uvs[v] = {places[v].x, places[v].y};
    for (const JoinedFans::Triangle& t : trial.triangles()) {
      triangles.push_back({t.centre, t.a, t.b});
    }
    solver.factorize(trial.fans(), uvs.size());
  }
  void place() {
    places.resize(uvs.size());
    for (const JoinedFans::Triangle& t : trial.triangles()) {
      places[t.a] = mesh.slot_position[t.slot];
      places[t.centre] = mesh.cells[trial.cells()[t.centre]].centre;
    }
  }
  LocalMesh view() const { return {places, triangles, {}}; }
  double energy() const {  // as-rigid-as-possible energy, for maps without flips
    std::vector<TriangleStretch> stretch(triangles.size());
    measure_triangles(view(), uvs, stretch);
    double sum = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const auto [a, b, c] = triangles[t];
      const glm::dvec3 p = to_glm(places[a]);
      const double area =
          0.5 * glm::length(glm::cross(to_glm(places[b]) - p, to_glm(places[c]) - p));
      sum += area * (std::pow(1 / stretch[t].s1 - 1, 2) + std::pow(1 / stretch[t].s2 - 1, 2));
    }
    return sum;
  }
};

// Two half discs, each with hundreds of small cells along its rim.
CoarseMesh wide_fans() {
  constexpr int kAround = 1400, kRings = 4, kTrianglesAStep = 2 * kRings - 1, kInner = 3;
  const Topology topology = topology_of(cap(kAround, kRings, 1.2));
  Cells cells;
  cells.count = 2 + kAround / 2;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    const std::uint32_t step = t / kTrianglesAStep;
    cells.of_triangle.push_back(t % kTrianglesAStep < kInner ? step / (kAround / 2) : 2 + step / 2);
  }
  return build_coarse(topology, 40, cells);
}

void expect_general_solution(CapFans& cap) {
  std::vector<Vec2d> expected = cap.uvs;
  ParamWorkspace workspace;
  for (int i = 0; i < 4; ++i) {  // without over-relaxation
    expected = flatten_isometric(cap.view(), {expected, {}}, {.iterations = 1, .shear_weight = 1},
                                 workspace)
                   .uvs;
  }
  for (int i = 0; i < 4; ++i) cap.solver.step(1, cap.uvs);
  for (std::size_t v = 1; v < cap.uvs.size(); ++v) {
    const double length = distance(expected[v], expected[0]);
    EXPECT_NEAR(distance(cap.uvs[v], cap.uvs[0]), length, 1e-5 * length) << v;
  }
}

TEST(FanSolver, AgreesWithTheGeneralSolver) {
  CapFans cap;
  expect_general_solution(cap);
}

// The centres of such fans are not eliminated, and the factor grows with their slots, not with the
// square of their number.
TEST(FanSolver, SolvesForTheCentresOfWideFans) {
  CapFans cap(wide_fans());
  ASSERT_GT(cap.mesh.cells[0].slot_count, 300u);
  ASSERT_GT(cap.mesh.cells[1].slot_count, 300u);
  EXPECT_LT(cap.solver.entries(), 30 * cap.uvs.size());
  expect_general_solution(cap);
}

// Steps up to twice as long as plain ones lower the energy, too.
TEST(FanSolver, LongerStepsDescend) {
  CapFans cap;
  const std::vector<Vec2d> start = cap.uvs;
  for (const double relaxation : {1.0, 1.3, 1.6, 1.95}) {
    cap.uvs = start;
    double before = cap.energy();
    for (int i = 0; i < 5; ++i) {
      cap.solver.step(relaxation, cap.uvs);
      const double now = cap.energy();
      EXPECT_LT(now, before) << relaxation << ' ' << i;
      before = now;
    }
  }
}

TEST(FanMeasure, AgreesWithTheGeneralOne) {
  CapFans cap;
  FanMeasure measure(cap.fans);
  const auto check = [&](double high) {
    std::vector<TriangleStretch> each(cap.triangles.size());
    measure_triangles(cap.view(), cap.uvs, each);
    const Distortion all = measure_distortion(cap.view(), cap.uvs);
    const double scale = std::sqrt(all.uv_area / all.surface_area);
    double above = 0;
    for (const TriangleStretch& t : each) {
      if (std::max(scale * t.s1, 1 / (scale * t.s2)) > high) above += t.area;
    }
    const FanStretch own = measure.stretch(cap.trial.fans(), cap.uvs, high);
    EXPECT_FALSE(own.flipped);
    EXPECT_NEAR(own.l2, all.stretch_l2, 1e-6);
    EXPECT_NEAR(own.energy, all.surface_area * (own.l2 * own.l2 - 1), 1e-9 * all.surface_area);
    EXPECT_NEAR(own.high_area, above, 1e-9 * all.surface_area);
    bool flipped = true;
    EXPECT_NEAR(measure.twice_area(cap.trial.fans(), cap.uvs, flipped), 2 * all.uv_area, 1e-12);
    EXPECT_FALSE(flipped);
    return above;
  };
  EXPECT_GT(check(1.1), 0);
  for (int i = 0; i < 4; ++i) cap.solver.step(1, cap.uvs);
  EXPECT_EQ(check(2), 0);
  for (Vec2d& uv : cap.uvs) uv.x = -uv.x;
  const FanStretch mirrored = measure.stretch(cap.trial.fans(), cap.uvs, 1.1);
  EXPECT_TRUE(mirrored.flipped);
  EXPECT_GT(mirrored.energy, 0);
  bool flipped = false;
  EXPECT_LT(measure.twice_area(cap.trial.fans(), cap.uvs, flipped), 0);
  EXPECT_TRUE(flipped);
}

// A ramp that winds around its axis `turns` times with a growing radius, which grows by less than
// the ramp's width per turn.
Shape ramp(double turns) {
  constexpr int around = 120, across = 6;
  Shape shape = grid(around, across);
  for (int j = 0; j <= across; ++j) {
    for (int i = 0; i <= around; ++i) {
      const double angle = turns * 2 * M_PI * i / around, r = 1 + 0.4 * j / across + 0.03 * angle;
      shape.positions[std::size_t(j * (around + 1) + i)] = {
          float(r * std::cos(angle)), float(r * std::sin(angle)), float(0.03 * angle)};
    }
  }
  return shape;
}

TrialOutcome try_ramp(double turns) {
  const CoarseMesh mesh = coarse_of(ramp(turns));
  const Halves halves(mesh, [](const Vec3d& p) { return p.z > 0.06; });
  std::vector<std::uint8_t> joined = halves.joined(mesh, false);
  CoarseUv uv;
  uv.slot.resize(mesh.slot_position.size());
  for (const CoarseCell& cell : mesh.cells) {
    const auto flat = [&](const Vec3d& p) { return Vec2d{p.y, p.x}; };
    uv.centre.push_back(flat(cell.centre));
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      uv.slot[s] = flat(mesh.slot_position[s]);
    }
  }
  const Fans fans(mesh);
  TrialScratch scratch(mesh);
  Trial trial(mesh, fans, scratch, uv);
  TrialLimits limits;
  limits.solidity = limits.fill = 0;
  limits.stretch_l2 = 1.1;
  limits.high_area = 100;
  for (const auto& [cells, arcs] : {std::pair{&halves.first, &halves.inside_first},
                                    std::pair{&halves.second, &halves.inside_second}}) {
    trial.join_flat({*cells, {}, *arcs}, joined);
    trial.commit();
  }
  return trial.run({halves.first, halves.second, halves.glue}, joined, limits);
}

TEST(Trial, TellsWhatCrossesItselfFromWhatFits) {
  const TrialOutcome fits = try_ramp(0.7);
  EXPECT_TRUE(fits.accepted);
  EXPECT_FALSE(fits.entangled);
  const TrialOutcome crosses = try_ramp(1.3);
  EXPECT_FALSE(crosses.accepted);
  EXPECT_TRUE(crosses.settled);
  EXPECT_TRUE(crosses.entangled);
}

TEST(Refusal, SaysMoreOfTheSameGlueThanOfALonger) {
  const std::vector<std::uint32_t> glue{3, 5}, longer{2, 3, 5}, other{3, 6};
  const Refusal dear{0, 1.2, 0, true, false, glue};
  EXPECT_TRUE(fails_again(dear, glue, 1, 1));
  EXPECT_FALSE(fails_again(dear, glue, 1.3, 1));  // now it may cost more
  EXPECT_FALSE(fails_again(dear, longer, 1, 1));
  EXPECT_TRUE(fails_again(dear, longer, 0.7, 1));
  EXPECT_FALSE(fails_again(dear, other, 0.1, 1));
  const Refusal entangled{0, 0.1, 0, true, true, glue};
  EXPECT_TRUE(fails_again(entangled, glue, 1, 1));
  EXPECT_FALSE(fails_again(entangled, longer, 1, 1));
  const Refusal unsure{0, 1.2, 0, false, false, glue};
  EXPECT_FALSE(fails_again(unsure, glue, 1, 1));
}

TEST(CostClasses, NearlyEqualCostsAreEqual) {
  constexpr double tie = CostClasses::tie;
  CostClasses cost;
  EXPECT_EQ(cost(1), 1);
  EXPECT_EQ(cost(1 + 0.9 * tie), 1);
  EXPECT_EQ(cost(1 - 0.9 * tie), 1);
  EXPECT_EQ(cost(1 + 1.5 * tie), 1 + 1.5 * tie);
  EXPECT_EQ(cost(1 + 0.9 * tie), 1);  // of two neighbours, the lower one
  // Without area there is no finite cost. Other costs stay as they are.
  EXPECT_EQ(cost(std::numeric_limits<double>::quiet_NaN()), CostClasses::most);
  EXPECT_EQ(cost(std::numeric_limits<double>::infinity()), CostClasses::most);
  EXPECT_EQ(cost(-std::numeric_limits<double>::infinity()), -CostClasses::most);
  EXPECT_EQ(cost(2), 2);
}

TEST(CostClasses, OfManyEachHasTheFirstOfItsNeighbours) {
  CostClasses cost;
  std::set<double> values;
  std::uint32_t state = 1;
  for (int i = 0; i < 20000; ++i) {
    state = state * 1664525u + 1013904223u;
    const double own = (double(state >> 8) / double(1 << 24) - 0.25) * 5000 * CostClasses::tie;
    const auto at = values.lower_bound(own - CostClasses::tie);
    const bool known = at != values.end() && *at <= own + CostClasses::tie;
    EXPECT_EQ(cost(own), known ? *at : *values.insert(own).first);
  }
  EXPECT_GT(values.size(), 2000u);
}

}  // namespace
}  // namespace atlas::test
