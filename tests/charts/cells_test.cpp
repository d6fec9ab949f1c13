// The cells that charts are assembled from, and the straightening of their borders.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/rims.h"
#include "tests/charts/chart_checks.h"
#include "tests/charts/coarse_shapes.h"

namespace atlas::test {
namespace {

std::vector<std::uint32_t> sizes(const Cells& cells) {
  std::vector<std::uint32_t> size(cells.count, 0);
  for (const std::uint32_t k : cells.of_triangle) {
    if (k != kNoIndex) ++size[k];
  }
  return size;
}

// Returns the number of the triangle's edges that border on cell k.
int edges_on(const Topology& topology, const Cells& cells, std::uint32_t t, std::uint32_t k) {
  int count = 0;
  for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
    const std::uint32_t o = topology.opposite[h];
    count += o != kNoIndex && cells.of_triangle[o / 3] == k;
  }
  return count;
}

int teeth(const Topology& topology, const Cells& cells) {
  const std::vector<std::uint32_t> size = sizes(cells);
  int count = 0;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    const std::uint32_t own = cells.of_triangle[t];
    if (own == kNoIndex || size[own] == 1) continue;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const std::uint32_t o = topology.opposite[h];
      if (o == kNoIndex || cells.of_triangle[o / 3] == own) continue;
      count += edges_on(topology, cells, t, cells.of_triangle[o / 3]) > 1;
    }
  }
  return count;
}

// Returns the number of parts that the cells' triangles form when joined over edges.
std::uint32_t parts(const Topology& topology, const Cells& cells) {
  std::vector<std::uint8_t> seen(topology.triangle_count(), 0);
  std::vector<std::uint32_t> queue;
  std::uint32_t count = 0;
  for (std::uint32_t start = 0; start < seen.size(); ++start) {
    if (seen[start] || cells.of_triangle[start] == kNoIndex) continue;
    ++count;
    queue.assign(1, start);
    seen[start] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      for (std::uint32_t h = 3 * queue[i]; h < 3 * queue[i] + 3; ++h) {
        const std::uint32_t o = topology.opposite[h];
        if (o == kNoIndex || seen[o / 3]) continue;
        if (cells.of_triangle[o / 3] != cells.of_triangle[start]) continue;
        seen[o / 3] = 1;
        queue.push_back(o / 3);
      }
    }
  }
  return count;
}

TEST(Cells, AreConnectedAndHaveNoTeeth) {
  for (const Shape& shape : {torus(72, 36), noisy(icosphere(4), 0.01, 5), box(12, {3, 2, 0.5}),
                             grid(40, 30, 4, 3), together(icosphere(3), cylinder(40, 20))}) {
    const Topology topology = topology_of(shape);
    const Cells cells = grow_cells({topology, plan_cells(topology, {})}, {}, {});
    EXPECT_EQ(teeth(topology, cells), 0) << shape.name;
    EXPECT_EQ(parts(topology, cells), cells.count) << shape.name;
    const std::vector<std::uint32_t> size = sizes(cells);
    EXPECT_EQ(std::count(size.begin(), size.end(), 0u), 0) << shape.name;
  }
}

// If cells are few, they do not resolve the surface around a hole.
TEST(Cells, AreMoreWhereTheSurfaceHasHandles) {
  const auto triangles_a_cell = [](const Shape& shape) {
    const Topology topology = topology_of(shape);
    const Cells cells = grow_cells({topology, plan_cells(topology, {})}, {}, {});
    return double(topology.triangle_count()) / cells.count;
  };
  const double without = triangles_a_cell(geodesic_sphere(30)),
               with = triangles_a_cell(plate_with_holes(12, 5));
  EXPECT_GT(without, 70);
  EXPECT_LT(with, 0.65 * without);
  EXPECT_GT(with, 30);
}

// Of n strips as long as all are wide, each at a right angle to the next, with one quad each.
Shape corrugated_sheet(int n) {
  Shape sheet = grid(n, 1, n, n);
  for (Vec3f& p : sheet.positions) {
    const int strip = static_cast<int>(std::lround(p.x));
    p.x = float((strip + 1) / 2);
    p.z = float(strip % 4 == 1 || strip % 4 == 2);
  }
  return sheet;
}

// Each quad of a corrugated sheet became a cell, although cells unroll across folds.
TEST(Cells, AreBoundedInNumberWhereASheetUnrolls) {
  const Topology topology = topology_of(corrugated_sheet(1600));
  EXPECT_LE(grow_cells({topology, plan_cells(topology, {})}, {}, {}).count,
            CellOptions{}.max_cells_per_piece);
}

// Each row of the grid is a region, so grains beyond its borders have no seed until each row has
// one.
TEST(Cells, AreGivenUpWhenCancelledAtAnyTime) {
  using Clock = std::chrono::steady_clock;
  constexpr std::uint32_t kAcross = 16;
  const Topology topology = topology_of(grid(kAcross, 4000));
  const CellPlan plan = plan_cells(topology, {});
  Regions rows;
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    rows.of_triangle.push_back(t / (2 * kAcross));
  }
  const Clock::time_point start = Clock::now();
  EXPECT_GE(grow_cells({topology, plan, &rows}, {}, {}).count, 4000u);
  const Clock::duration whole = Clock::now() - start;
  constexpr int kTimes = 24;
  for (int i = 0; i < kTimes; ++i) {
    std::atomic<bool> cancel{i == 0};
    Context context;
    context.cancel = &cancel;
    std::thread other([&] {
      std::this_thread::sleep_for(whole * i / kTimes);
      cancel = true;
    });
    const Cells cells = grow_cells({topology, plan, &rows}, {}, context);
    const bool given_up = cells.of_triangle.empty();
    other.join();
    EXPECT_TRUE(given_up || (i > 0 && cells.count >= 4000)) << i;
  }
}

TEST(Teeth, ARaggedBorderIsDrawnStraighter) {
  const Topology topology = topology_of(grid(20, 20));
  Cells cells{std::vector<std::uint32_t>(topology.triangle_count()), 2};
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    double x = 0;
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
      x += topology.points[topology.corner_vertex[h]].x / (3 * topology.scale);
    cells.of_triangle[t] = x > 0.5;
  }
  const Cells straight = cells;
  int changed = 0;  // every other triangle along the border, on one side
  for (std::uint32_t t = 0, met = 0; t < topology.triangle_count(); ++t) {
    if (straight.of_triangle[t] == 1 || edges_on(topology, straight, t, 1) != 1) continue;
    cells.of_triangle[t] = met++ % 2;
    changed += cells.of_triangle[t] == 1;
  }
  ASSERT_GE(changed, 9);
  ASSERT_GE(teeth(topology, cells), changed);
  pull_teeth(topology, nullptr, cells);
  EXPECT_EQ(cells.of_triangle, straight.of_triangle);
}

TEST(Teeth, ACellKeepsItsLastTriangle) {
  const Topology topology = topology_of(grid(4, 4));
  Cells cells{std::vector<std::uint32_t>(topology.triangle_count(), 0), 2};
  std::uint32_t inner = 0;  // an inner triangle, with neighbours on all sides
  while (edges_on(topology, cells, inner, 0) < 3) ++inner;
  cells.of_triangle[inner] = 1;
  pull_teeth(topology, nullptr, cells);
  EXPECT_EQ(sizes(cells)[1], 1u);
}

}  // namespace
}  // namespace atlas::test
