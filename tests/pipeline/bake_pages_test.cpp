// Pages whose charts are too near each other are baked with a warning that names the page.
#include "libatlas/pipeline/bake_pages.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "libatlas/texture/chart_textures.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/pipeline/unwrap_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// Two squares side by side on page 0, and two in the same place on page 1.
TEST(BakePages, WarningsNameTheirPage) {
  const TempFolder folder;
  Shape squares;
  for (int i = 0; i < 4; ++i) squares = together(squares, moved(grid(1, 1), 1, {3.0 * i, 0, 0}));
  const LoadedScene scene = lit_scene(squares);
  const auto charts = make_charts(view_of(scene.scene), {}, {});
  ASSERT_TRUE(charts.ok()) << charts.status().message();
  ASSERT_EQ(charts->charts.size(), 4u);
  PageLayout layout;
  layout.pages.assign(2, Extent{64, 32});
  for (std::uint32_t c = 0; c < 4; ++c) {
    ChartPlacement placement;
    placement.chart = c;
    placement.page = c < 2 ? 0 : 1;
    placement.x = c == 1 ? 36 : 4;
    placement.y = 4;
    placement.width = placement.height = 24;
    placement.texels_per_unit = {24, 24};
    turn_in_box(placement, false);
    layout.placements.push_back(placement);
  }
  const LuminanceSampler sampler(scene.scene, Quantity::illuminance);
  const ToneMapping tone;
  const ChartLight light{sampler, *charts, tone};
  ExportOptions options;
  options.target = folder / "w.obj";
  options.measure_error = false;
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  AtomicFiles files;
  const auto baked = bake_pages({light, layout, options}, files, context, context);
  ASSERT_TRUE(baked.ok()) << baked.status().message();
  ASSERT_EQ(said.size(), 1u);
  EXPECT_TRUE(said[0].starts_with("page 1: ")) << said[0];
}

}  // namespace
}  // namespace atlas::test
