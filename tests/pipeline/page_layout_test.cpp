// Pages of plain uvs: how large and how full they are.
#include "libatlas/unwrap/page_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/unwrap/layout_effort.h"
#include "libatlas/unwrap/least_room.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

TEST(Layout, RefusesDensitiesThatAreMissingOrNotAboveZero) {
  ChartSet charts;
  charts.charts.resize(2);
  charts.charts[0].size = charts.charts[1].size = {2, 1};
  const auto code = [&](const std::vector<Vec2d>& densities) {
    return lay_out_pages(charts, densities, {}, {}).status().code();
  };
  EXPECT_EQ(code({{10, 10}, {10, 10}}), ErrorCode::ok);
  EXPECT_EQ(code({{10, 10}}), ErrorCode::bad_input);
  EXPECT_EQ(code({}), ErrorCode::bad_input);
  EXPECT_EQ(code({{10, 10}, {0, 10}}), ErrorCode::bad_input);
  EXPECT_EQ(code({{10, 0}, {10, 10}}), ErrorCode::bad_input);
  EXPECT_EQ(code({{10, 10}, {10, -1}}), ErrorCode::bad_input);
  EXPECT_EQ(code({{10, 10}, {10, std::nan("")}}), ErrorCode::bad_input);
}

ChartSet boxes_of(const std::vector<Vec2d>& sizes) {
  ChartSet charts;
  for (const Vec2d size : sizes) {
    Chart& chart = charts.charts.emplace_back();
    chart.size = size;
    chart.distortion.uv_area = size.x * size.y;
  }
  return charts;
}

// What is certain is never more than what packing needs, for boxes and outlines of any size.
TEST(Layout, TheLeastRoomIsNeverMoreThanPackingNeeds) {
  for (const Vec2d size : {Vec2d{1, 1}, Vec2d{40, 1}, Vec2d{40, 30}, Vec2d{500, 500}}) {
    const ChartSet charts = boxes_of(std::vector<Vec2d>(200, size));
    const std::vector<Vec2d> densities(200, {1, 1});
    LayoutOptions options{{.pages = 1, .page_size = 32, .padding = 2, .alignment = 4}};
    while (!lay_out_pages(charts, densities, options, {}).ok()) options.page_size *= 2;
    const std::vector<double> same(200, 1.0);
    EXPECT_TRUE(check_least_room(charts, same, options).ok()) << size.x << " x " << size.y;
    EXPECT_GT(least_texels(charts, same, options), 200 * 12) << "of the gutters alone";
    options.page_size /= 4;  // a sixteenth of a page that is large enough
    const Status refused = check_least_room(charts, same, options);
    if (size.y >= 30) {
      EXPECT_EQ(refused.code(), ErrorCode::no_solution) << size.x;
      EXPECT_EQ(refused.message(),
                lay_out_pages(charts, densities, options, {}).status().message());
    }
  }
}

// Neither boxes nor outlines cover more than their gutters leave, whatever the shape of the page.
TEST(Layout, GuttersBoundWhatChartsCover) {
  for (const Vec2d size : {Vec2d{300, 300}, Vec2d{300, 40}, Vec2d{3000, 2}, Vec2d{1e5, 0.5}})
    for (const std::size_t count : {1, 7, 40})
      for (const bool free_aspect : {false, true}) {
        const ChartSet charts = boxes_of(std::vector<Vec2d>(count, size));
        LayoutOptions options{{.page_size = 256}};
        options.minimum_side = 0;
        options.free_aspect = free_aspect;
        const std::vector<Vec2d> densities(count, {1, 1});
        const Result<PageLayout> layout = lay_out_pages(charts, densities, options, {});
        ASSERT_TRUE(layout.ok()) << layout.status().message();
        const double area = double(count) * size.x * size.y * layout->scale * layout->scale;
        const double covered = free_aspect ? layout->uv_utilization : area / (256 * 256);
        const double most = most_covered(charts, 1, options);
        EXPECT_LE(covered, most) << size.x << " x " << size.y << ", " << count;
        if (count == 40) {
          EXPECT_LT(most, size.y >= 40 ? 0.9 : 0.1) << size.x << " x " << size.y;
        }
      }
  EXPECT_EQ(most_covered(boxes_of({{5, 0}}), 1, {}), 0);
}

TEST(Layout, TheFillingDensityCoversAllTexels) {
  EXPECT_DOUBLE_EQ(filling_density(boxes_of({{2, 1}, {1, 1}, {1, 1}}), 400), 10);
  EXPECT_EQ(filling_density(boxes_of({{2, 0}}), 400), 1);
  EXPECT_EQ(filling_density({}, 400), 1);
}

// A side that is short already stays as it is, and no other becomes shorter than the shortest that
// is allowed.
TEST(Layout, ScalingMakesNoSideShorterThanAllowed) {
  const ChartSet charts = boxes_of({{400, 4}, {300, 20}, {200, 100}});
  const std::vector<Vec2d> densities(3, {1, 1});
  LayoutOptions options{{.pages = 1, .page_size = 128, .padding = 1, .alignment = 1}};
  options.allow_rotation = true;
  const Result<PageLayout> layout = lay_out_pages(charts, densities, options, {});
  ASSERT_TRUE(layout.ok()) << layout.status().message();
  ASSERT_LT(layout->scale, 0.5);
  for (std::size_t c = 0; c < 3; ++c) {
    const ChartPlacement& p = layout->placements[c];
    const Vec2d size = charts.charts[c].size;
    const auto texels = [&](double side) {
      return std::max(side * layout->scale, std::min(16.0, side));
    };
    EXPECT_DOUBLE_EQ(size.x * p.texels_per_unit.x, texels(size.x)) << c;
    EXPECT_DOUBLE_EQ(size.y * p.texels_per_unit.y, texels(size.y)) << c;
  }
}

// Long boxes beside high ones: some are turned.
TEST(Layout, BoxesHoldTheirChartsWhicheverWayTheyLie) {
  const ChartSet charts = boxes_of({{120, 30}, {90, 30}, {90, 30}, {90, 30}, {90, 30}});
  const std::vector<Vec2d> densities(5, {1, 1});
  const LayoutOptions options{{.pages = 1, .page_size = 128, .padding = 0, .alignment = 1}};
  const Result<PageLayout> layout = lay_out_pages(charts, densities, options, {});
  ASSERT_TRUE(layout.ok()) << layout.status().message();
  int turned = 0;
  for (const ChartPlacement& p : layout->placements) {
    const Vec2d size = charts.charts[p.chart].size;
    const Vec2d a = page_texel(p, {0, 0}), b = page_texel(p, size);
    const double slack = 1e-9;
    EXPECT_GE(std::min(a.x, b.x), p.x - slack);
    EXPECT_GE(std::min(a.y, b.y), p.y - slack);
    EXPECT_LE(std::max(a.x, b.x), p.x + p.width + slack);
    EXPECT_LE(std::max(a.y, b.y), p.y + p.height + slack);
    EXPECT_EQ(p.width, std::ceil(std::fabs(b.x - a.x) - slack));
    EXPECT_EQ(p.height, std::ceil(std::fabs(b.y - a.y) - slack));
    turned += p.sine != 0;
  }
  EXPECT_GT(turned, 0);
}

// Two right triangles take two boxes, but fit one if the second is turned. Their scale is 1 both
// ways.
TEST(Layout, OfTwoWaysAtFullSizeTheSmallerPagesWin) {
  Shape triangles;
  for (const float x : {0.0F, 2.0F}) {
    const auto first = std::uint32_t(triangles.positions.size());
    triangles.positions.insert(triangles.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    triangles.indices.insert(triangles.indices.end(), {first, first + 1, first + 2});
  }
  MeshView mesh;
  mesh.positions = triangles.positions;
  mesh.indices = triangles.indices;
  const Result<ChartSet> charts = make_charts(mesh, {}, {});
  ASSERT_TRUE(charts.ok());
  ASSERT_EQ(charts->charts.size(), 2u);
  LayoutOptions options{{.pages = 1, .page_size = 512, .padding = 1, .alignment = 1}};
  const std::vector<Vec2d> densities(2, {110, 110});
  const auto texels = [&](bool outlines) {
    options.outlines = outlines;
    const Result<PageLayout> layout = lay_out_pages(*charts, densities, options, {});
    EXPECT_TRUE(layout.ok() && layout->pages.size() == 1 && layout->scale == 1);
    return layout.ok() ? layout->pages[0].area() : 0;
  };
  EXPECT_EQ(texels(false), 256 * 128);
  EXPECT_EQ(texels(true), 128 * 128);
}

// Returns four ring sectors of three quarters of a turn each, and strips.
Shape rings_and_strips() {
  Shape all = grid(1, 1, 0.01, 0.01);
  for (int k = 0; k < 4; ++k) {
    Shape sector = grid(60, 4, 1.5 * std::numbers::pi, 0.7);
    for (Vec3f& p : sector.positions) {
      const double angle = p.x, radius = 0.3 + p.y;
      p = {float(radius * std::cos(angle) + 3 * k), float(radius * std::sin(angle)), 0};
    }
    all = together(all, sector);
  }
  for (int k = 0; k < 13; ++k)
    all = together(all, moved(grid(4, 2, 1.2, 0.03), 1, {0, 3 + 0.1 * k, 0}));
  return all;
}

Result<ChartSet> charts_of_rings_and_strips() {
  const Shape shape = rings_and_strips();
  MeshView mesh;
  mesh.positions = shape.positions;
  mesh.indices = shape.indices;
  return make_charts(mesh, {.min_fill = 0}, {});
}

TEST(Layout, PresetsThatTakeLongerFillMoreOfAPoorPage) {
  const Result<ChartSet> charts = charts_of_rings_and_strips();
  ASSERT_TRUE(charts.ok());
  LayoutOptions options{{.padding = 1}};
  options.minimum_side = 0;
  options.outlines = options.free_aspect = true;
  const auto use = [&](PackPreset preset) {
    options.preset = preset;
    const std::vector<Vec2d> densities(charts->charts.size(), Vec2d{600, 600});
    const Result<PageLayout> layout = lay_out_pages(*charts, densities, options, {});
    EXPECT_TRUE(layout.ok());
    return layout.ok() ? layout->uv_utilization : 0;
  };
  const double fast = use(PackPreset::fast), standard = use(PackPreset::standard);
  EXPECT_LT(fast, 0.66);
  EXPECT_GT(standard, fast + 0.02);
  EXPECT_GE(use(PackPreset::best), standard);
}

// Returns the sides of the page that a shape's plain uvs get if 256 texels are asked for.
std::pair<int, int> plain_page(const Shape& shape, bool may_grow) {
  TempFolder folder;
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlas_size = 256;
  options.charts_only = true;
  options.larger_plain_page = may_grow;
  options.charts.min_fill = 0;
  const auto report = export_world(lit_scene(shape), options, {}, {});
  EXPECT_TRUE(report.ok()) << report.status().message();
  if (!report.ok() || report->pages.size() != 1) return {0, 0};
  EXPECT_GT(report->charts.size(), 150u);
  return std::minmax(report->pages[0].width, report->pages[0].height);
}

TEST(PlainPage, GrowsWithItsCharts) {
  const Shape shape = soup(200, 5);
  const int grown = plain_page(shape, true).second;
  EXPECT_GT(grown, 256);  // 200 charts of 1024 texels each need 453 texels squared
  EXPECT_LE(grown, 512);
  EXPECT_LE(plain_page(shape, false).second, 256);
}

TEST(PlainPage, ChartsAreCountedOnTheirOwnPages) {
  TempFolder folder;
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlas_size = 64;
  options.charts_only = true;
  options.plain_pages = 3;
  const auto report = export_world(lit_scene(soup(9, 5)), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 3u);
  std::size_t charts = 0;
  for (const PageReport& page : report->pages) {
    EXPECT_GT(page.charts, 0u);
    charts += page.charts;
  }
  EXPECT_EQ(charts, report->charts.size());
}

TEST(PlainPage, IsLongerWhereAChartIsLong) {
  Shape shape = soup(200, 5);
  const double side = std::sqrt(surface_area(shape));
  shape = together(shape, moved(grid(90, 1, 5 * side, 0.02 * side), 1, {50, 0, 0}));
  const auto [width, length] = plain_page(shape, true);
  EXPECT_GT(length, 1024);  // the page is about twenty times as long as wide
  EXPECT_GT(double(width) * length, 200 * 1024);
}

}  // namespace
}  // namespace atlas::test
