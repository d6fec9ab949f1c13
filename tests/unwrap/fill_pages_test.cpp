// Uvs without light on square and on several pages: long and large charts leave none of them empty.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/unwrap/fill_pages.h"
#include "libatlas/unwrap/unwrap.h"
#include "tests/support/shape_view.h"
#include "tests/support/slowness.h"

namespace atlas::test {
namespace {

UnwrappedMesh unwrap(const Shape& shape, UnwrapOptions options, double min_fill = 0.72) {
  options.charts.min_fill = min_fill;
  auto mesh = unwrap_mesh(view_of(shape), options, {});
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  return std::move(*mesh);
}

// Returns a plate, and a strip five times as long as the side of a square page of both.
Shape plate_and_strip() {
  return together(grid(9, 9, 1, 1), moved(grid(240, 2, 6, 0.05), 1, {0, 2, 0}));
}

TEST(FillPages, AStripIsCutForASquarePage) {
  const UnwrapOptions square{{.page_size = 512, .square = true}};
  const UnwrappedMesh whole = unwrap(plate_and_strip(), square, 0),
                      cut = unwrap(plate_and_strip(), square);
  EXPECT_EQ(whole.charts.charts.size(), 2u);
  EXPECT_LT(whole.utilization, 0.1);
  EXPECT_GT(cut.utilization, 0.6);
  EXPECT_EQ(cut.pages[0].width, cut.pages[0].height);
  EXPECT_LE(cut.charts.charts.size(), 9u);
  EXPECT_NEAR(cut.charts.seam_length, 0.05 * double(cut.charts.charts.size() - 2), 0.02);
}

// A page as slender as a road would leave it coarse. A less slender strip is worth no seams.
TEST(FillPages, ARoadIsCutForAPageOfFreeShape) {
  const UnwrapOptions free{{.page_size = 512}};
  const Shape road = grid(600, 3, 200, 1);
  const UnwrappedMesh whole = unwrap(road, free, 0), cut = unwrap(road, free);
  EXPECT_EQ(whole.charts.charts.size(), 1u);
  EXPECT_LT(whole.pages[0].height, 8);
  EXPECT_GT(std::min(cut.pages[0].width, cut.pages[0].height), 512 / 2);
  EXPECT_GT(cut.utilization, 0.6);
  EXPECT_GT(cut.texels_per_unit, 8 * whole.texels_per_unit);
  EXPECT_LE(cut.charts.charts.size(), 20u);
  EXPECT_EQ(unwrap(grid(60, 6, 10, 1), free).charts.charts.size(), 1u);
}

// Triangles of needles cannot be cut and keep all charts small. What can be cut of the needles
// comes in thousands of pieces, whose gutters leave nothing of the page. Laying these out for each
// way of cutting took 9 s.
TEST(FillPages, NeedlesAreNotLaidOutInPiecesInVain) {
  Shape stretched = torus(80, 24);
  for (auto& p : stretched.positions) p.y *= 1e6;
  const double begun = cpu_seconds();
  const UnwrappedMesh needles = unwrap(stretched, {{.page_size = 16384}});
  EXPECT_LT(cpu_seconds() - begun, kSlowness);
  EXPECT_LT(needles.charts.charts.size(), 100u);
}

// Several objects often get one density. Their pages are then much smaller than allowed, but no
// emptier, and nothing is cut.
TEST(FillPages, AGivenDensityIsReachedOnAFullPage) {
  const Shape ring = torus(48, 24);
  UnwrapOptions options{{.page_size = 2048}};
  const UnwrappedMesh largest = unwrap(ring, options);
  options.texels_per_unit = largest.texels_per_unit / 6;
  const UnwrappedMesh given = unwrap(ring, options);
  EXPECT_DOUBLE_EQ(given.texels_per_unit, options.texels_per_unit);
  EXPECT_EQ(given.charts.charts.size(), largest.charts.charts.size());
  EXPECT_GT(given.utilization, largest.utilization - 0.1) << "gutters take more";
  EXPECT_LT(std::max(given.pages[0].width, given.pages[0].height), 2048 / 5);
}

// A strip of two triangles that is much longer than the page that the plate fills.
TEST(FillPages, AStripThatCannotBeCutGetsAScaleOfItsOwn) {
  const Shape shape = together(grid(9, 9, 1, 1), moved(grid(1, 1, 100, 0.001), 1, {0, 2, 0}));
  for (const bool square : {false, true}) {
    UnwrapOptions options{{.page_size = 512, .square = square}};
    options.charts.min_fill = 0.72;
    std::string said;
    Context context;
    context.warn = [&](std::string_view line) { said += line; };
    auto scaled = unwrap_mesh(view_of(shape), options, context);
    ASSERT_TRUE(scaled.ok()) << scaled.status().message();
    EXPECT_GT(scaled->utilization, 0.6) << square;
    const std::uint32_t strip = scaled->charts.triangle_chart.back();
    for (const ChartPlacement& p : scaled->placements) {
      const double share = p.texels_per_unit.x / scaled->texels_per_unit;
      if (p.chart == strip) {
        EXPECT_LT(share, 0.02);
      } else {
        EXPECT_DOUBLE_EQ(share, 1);
      }
    }
    EXPECT_NE(said.find(fmt::format("charts[{}] of 2 triangles", strip)), std::string::npos)
        << said;

    options.texels_per_unit = scaled->texels_per_unit;
    const UnwrappedMesh asked = unwrap(shape, options);
    for (const ChartPlacement& p : asked.placements)
      EXPECT_DOUBLE_EQ(p.texels_per_unit.x, asked.texels_per_unit);
  }
}

// A single sheet as large as four pages.
TEST(FillPages, ASheetIsCutForSeveralPages) {
  const UnwrapOptions four{{.pages = 4, .page_size = 256}};
  const UnwrappedMesh whole = unwrap(grid(64, 64), four, 0), cut = unwrap(grid(64, 64), four);
  EXPECT_EQ(whole.pages.size(), 1u);
  EXPECT_EQ(cut.pages.size(), 4u);
  EXPECT_GT(cut.utilization, 0.65);
  EXPECT_GT(cut.texels_per_unit, 1.6 * whole.texels_per_unit);
}

// The layout on cells shows little of what a cut gains: after pressing, pages of smaller charts are
// much fuller.
TEST(FillPages, WhatPressingMakesOfCutsCounts) {
  const std::uint32_t pages[] = {4, 6};
  for (const std::uint32_t count : pages) {
    const UnwrappedMesh cut = unwrap(torus(48, 24), {{.pages = count, .page_size = 512}});
    EXPECT_EQ(cut.pages.size(), count);
    EXPECT_GT(cut.utilization, 0.62) << count;
    EXPECT_LE(cut.charts.charts.size(), 6 * count) << count;
  }
}

// Returns a prism of unit length over a star, whose sides are two triangles each.
Shape star_prism(std::uint32_t tips) {
  Shape prism;
  const std::uint32_t n = 2 * tips;
  for (const float x : {0.f, 1.f})
    for (std::uint32_t i = 0; i < n; ++i) {
      const double radius = i % 2 == 0 ? 0.15 : 0.05, angle = 2 * M_PI * i / n;
      prism.positions.push_back(
          {x, float(radius * std::cos(angle)), float(radius * std::sin(angle))});
    }
  prism.positions.insert(prism.positions.end(), {{0, 0, 0}, {1, 0, 0}});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    prism.add_quad(i, next, n + next, n + i);
    prism.indices.insert(prism.indices.end(), {2 * n, next, i, 2 * n + 1, n + i, n + next});
  }
  return prism;
}

// Triangles are too long to be cut for eight pages, of which pieces would cover too little to be
// worth their seams.
TEST(FillPages, MorePagesMakeNothingCoarser) {
  const Shape prism = star_prism(10);
  const UnwrappedMesh four = unwrap(prism, {{.pages = 4, .page_size = 512}}),
                      eight = unwrap(prism, {{.pages = 8, .page_size = 512}});
  EXPECT_GE(eight.texels_per_unit, 0.99 * four.texels_per_unit);
}

TEST(FillPages, WhatFitsAsDenseAsItIsWantedStaysWhole) {
  UnwrapOptions options{{.page_size = 1024, .square = true}};
  options.texels_per_unit = 20;
  const UnwrappedMesh mesh = unwrap(plate_and_strip(), options);
  EXPECT_EQ(mesh.charts.charts.size(), 2u);
  EXPECT_DOUBLE_EQ(mesh.texels_per_unit, 20);
}

TEST(FillPages, GivenChartsStayWhole) {
  const Shape shape = plate_and_strip();
  std::vector<Vec2f> uvs;
  for (const Vec3f& p : shape.positions) uvs.push_back({p.x / 8, p.y / 8});
  MeshView view = view_of(shape);
  view.texcoords = uvs;
  UnwrapOptions options{{.page_size = 512, .square = true}};
  options.charts.keep_uv_charts = true;
  const auto kept = unwrap_mesh(view, options, {});
  ASSERT_TRUE(kept.ok()) << kept.status().message();
  EXPECT_EQ(kept->charts.charts.size(), 2u);
}

// The page is less than 0.7 full, but no cut would let it hold enough more.
TEST(FillPages, SeamsMustBeWorthIt) {
  const UnwrapOptions square{{.page_size = 512, .square = true}};
  const UnwrappedMesh whole = unwrap(torus(64, 32), square, 0),
                      offered = unwrap(torus(64, 32), square);
  EXPECT_LT(whole.utilization, 0.7);
  EXPECT_EQ(offered.charts.charts.size(), whole.charts.charts.size());
  EXPECT_DOUBLE_EQ(offered.charts.seam_length, whole.charts.seam_length);
}

// The first sixth of the stage is for the charts as they are, the rest for layouts of cut ones.
constexpr double kWithoutCuts = 1.0 / 6;

struct Packed {
  UnwrappedMesh mesh;
  double last = 0;  // the last progress of the stage before its end
};
Packed packed(const Shape& shape) {
  Packed out;
  Context context;
  context.progress = [&](std::string_view stage, double done) {
    if (stage == "packing" && done < 1) out.last = std::max(out.last, done);
  };
  auto mesh = unwrap_mesh(view_of(shape), {{.page_size = 512, .square = true}}, context);
  EXPECT_TRUE(mesh.ok()) << mesh.status().message();
  if (mesh.ok()) out.mesh = std::move(*mesh);
  return out;
}

// The holes take 36 % of the plate.
TEST(FillPages, HolesThatNothingFitsAreNoFault) {
  constexpr std::uint32_t kSide = 50;
  const Shape plate = grid(kSide, kSide);
  Shape holed;
  holed.positions = plate.positions;
  for (std::uint32_t t = 0; t < 2 * kSide * kSide; ++t) {
    const std::uint32_t column = t / 2 % kSide, row = t / 2 / kSide;
    if (column % 5 >= 1 && column % 5 <= 3 && row % 5 >= 1 && row % 5 <= 3) continue;
    for (int k = 0; k < 3; ++k) holed.indices.push_back(plate.indices[3 * t + k]);
  }
  const Packed plain = packed(holed);
  EXPECT_EQ(plain.mesh.charts.charts.size(), 1u);
  EXPECT_NEAR(plain.mesh.utilization, 0.64, 0.03);
  EXPECT_GT(plain.last, 0);
  EXPECT_LE(plain.last, kWithoutCuts);
}

// Teeth and gaps are far narrower than gutters, and half of the page is lost to them.
TEST(FillPages, BaysThatNothingFitsAreNoFault) {
  constexpr std::uint32_t kTeeth = 1500, kRows = 4;
  const Shape plate = grid(2 * kTeeth - 1, kRows);
  Shape comb;
  comb.positions = plate.positions;
  for (std::uint32_t t = 0; t < 2 * (2 * kTeeth - 1) * kRows; ++t) {
    const std::uint32_t column = t / 2 % (2 * kTeeth - 1), row = t / 2 / (2 * kTeeth - 1);
    if (column % 2 == 1 && row > 0) continue;
    for (int k = 0; k < 3; ++k) comb.indices.push_back(plate.indices[3 * t + k]);
  }
  const Packed plain = packed(comb);
  EXPECT_EQ(plain.mesh.charts.charts.size(), 1u);
  EXPECT_GT(plain.last, 0);
  EXPECT_LE(plain.last, kWithoutCuts);
}

// If a strip of needles was cut to the side of a page, it would fall into as many separate needles.
TEST(FillPages, ACutThatEvenAFullPageWouldNotPayForIsNotLaidOut) {
  const Packed needles = packed(grid(1000, 1, 1, 100));
  EXPECT_LE(needles.mesh.charts.charts.size(), 2u);
  EXPECT_LE(needles.last, kWithoutCuts);
}

// There is space for the wide gutters of the whole charts, but not for those of pieces.
TEST(FillPages, ChartsWhosePiecesHaveNoRoomStayWhole) {
  for (const std::int32_t padding : {8, 12, 16}) {
    const UnwrapOptions wide{{.pages = 2, .page_size = 64, .padding = padding}};
    EXPECT_EQ(unwrap(grid(16, 16), wide).charts.charts.size(), 1u) << padding;
  }
}

// The time is for all ways of cutting together, and never gives less than the default.
TEST(FillPages, BestKeepsToItsTime) {
  const Shape shape = together(torus(48, 24), moved(star_prism(10), 1, {3, 0, 0}));
  constexpr double kEnough = 0.9;  // seconds
  Context one;
  one.threads = 1;
  for (const std::uint32_t pages : {1u, 2u}) {
    double standard = 0;
    for (const double budget : {0.0, 0.3, kEnough}) {
      LayoutOptions options{{.pages = pages, .page_size = 512, .square = true}};
      options.minimum_side = 0;
      options.outlines = true;
      if (budget > 0) {
        options.preset = PackPreset::best;
        options.time_budget = budget;
      }
      auto charts = make_charts(view_of(shape), {}, one);
      ASSERT_TRUE(charts.ok());
      const double density = filling_density(*charts, 512.0 * 512 * pages);
      const double begun = cpu_seconds(), wall = wall_seconds();
      const auto layout = fill_pages({view_of(shape), {}, density}, options, *charts, one);
      const double spent = cpu_seconds() - begun;
      ASSERT_TRUE(layout.ok()) << layout.status().message();
      if (budget == 0) {
        standard = layout->scale;
        continue;
      }
      EXPECT_LE(spent, 1.2 * budget + kSlowness * 0.05) << pages;
      if (budget < kEnough) continue;
      EXPECT_GE(wall_seconds() - wall, budget / 2) << pages;
      EXPECT_GE(layout->scale, standard) << pages;
    }
  }
}

TEST(FillPages, WhatFillsItsPageStaysWhole) {
  const UnwrapOptions square{{.page_size = 512, .square = true}};
  EXPECT_EQ(unwrap(cap(64, 24, 0.3), square).charts.charts.size(), 1u);
}

}  // namespace
}  // namespace atlas::test
