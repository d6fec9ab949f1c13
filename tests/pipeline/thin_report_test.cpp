// Slivers that floats cannot hold, and texels that are drawn twice, are told to whoever exports or
// unwraps. What is told is compared with the uvs that result.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/pipeline/assemble_world.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/unwrap/unwrap.h"
#include "tests/pipeline/unwrap_checks.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// So many slivers on each other that no corner may move as far as all of them need.
LoadedScene hopeless_slivers() {
  const FlatMesh mesh = stack_of_slivers(1500, 2, 0, 1e-10);
  LoadedScene loaded;
  for (const Vec2d& p : mesh.uvs)
    loaded.scene.positions.push_back({float(p.x), float(p.y - 0.5), 0});
  loaded.scene.indices = mesh.corners;
  return loaded;
}

std::size_t closed_or_turned(const UvMesh& mesh) {
  return std::size_t(std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const auto& face) {
    const Vec2d a = mesh.uvs[face.uv[0]], b = mesh.uvs[face.uv[1]], c = mesh.uvs[face.uv[2]];
    return !((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0);
  }));
}

ExportOptions square_page(const TempFolder& folder) {
  ExportOptions options;
  options.target = folder / "w.obj";
  options.charts_only = options.square_plain_page = true;
  options.atlas_size = 1024;
  options.larger_plain_page = options.outlines = false;
  return options;
}

TEST(ThinReport, AnExportTellsOfThinTriangles) {
  const TempFolder folder;
  LoadedScene loaded = hopeless_slivers();
  ASSERT_TRUE(complete_scene(loaded.scene).ok());
  const ExportOptions options = square_page(folder);
  const auto report = export_world(loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  const auto written = read_uv_obj(options.target);
  ASSERT_TRUE(written.ok()) << written.status().message();
  const std::size_t closed = closed_or_turned(*written);
  EXPECT_GT(closed, 10u) << "the test is too easy";
  EXPECT_GE(report->thin_triangles, closed);
  EXPECT_LE(report->thin_triangles, 2 * closed);
  const std::string text = thin_triangles_text(report->thin_triangles, report->triangles_out);
  EXPECT_EQ(std::count(report->advice.begin(), report->advice.end(), text), 1);
}

// A strip so narrow that floats do not hold its width: the uvs written are wider. Its stretch is
// measured in the file.
TEST(ThinReport, AnExportTellsOfChartsThatRoundingStretches) {
  const TempFolder folder;
  LoadedScene loaded;
  constexpr std::uint32_t kSteps = 40;
  for (std::uint32_t i = 0; i <= kSteps; ++i) {
    for (const float y : {0.0f, 2e-10f}) loaded.scene.positions.push_back({float(i), y, 0});
    const std::uint32_t a = 2 * i;
    if (i < kSteps)
      loaded.scene.indices.insert(loaded.scene.indices.end(),
                                  {a, a + 2, a + 1, a + 1, a + 2, a + 3});
  }
  ASSERT_TRUE(complete_scene(loaded.scene).ok());
  const ExportOptions options = square_page(folder);
  const auto report = export_world(loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->charts.size(), 1u);
  EXPECT_LT(report->distortion.stretch_999, 1.25);
  const auto written = read_uv_obj(options.target);
  ASSERT_TRUE(written.ok()) << written.status().message();
  // A strip that is w times as wide as its surface, at its own scale, is stretched by the root of
  // w.
  double area = 0, length = 0;
  for (const auto& face : written->faces) {
    const Vec2d a = written->uvs[face.uv[0]], b = written->uvs[face.uv[1]],
                c = written->uvs[face.uv[2]];
    area += 0.5 * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
    for (const Vec2d& p : {b, c}) length = std::max(length, std::hypot(p.x - a.x, p.y - a.y));
  }
  const double wider = area / (length * length * kSteps * 2e-10);
  EXPECT_GT(wider, 1.5) << "the test is too easy";
  EXPECT_EQ(report->charts_beyond_bound, 1u);
  EXPECT_NEAR(report->written_stretch_999, std::sqrt(wider), 0.01 * std::sqrt(wider));
  EXPECT_NE(report->advice.front().find("1 of 1 charts are stretched more"), std::string::npos);
}

// A sheet of rows with a sliver on each, which rounding to 1/256 of a texel turns over here and
// there. Wherever the sheet is moved to, some of them cover the centre of a texel.
TEST(ThinReport, AnExportTellsOfTexelsDrawnTwice) {
  constexpr std::uint32_t kSlantedRows = 40;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> slant(0, 0.5 / kSlantedRows);
  LoadedScene loaded;
  for (std::uint32_t row = 0; row <= kSlantedRows; ++row) {
    const double left = (row + 0.1) / kSlantedRows, right = left + slant(random);
    for (const Vec2d p : {Vec2d{0, left}, {0.5, (left + right) / 2 + 3e-7}, {1, right}})
      loaded.scene.positions.push_back({float(p.x), float(p.y), 0});
    const std::uint32_t a = 3 * row, b = a + 1, c = a + 2, d = a + 3, e = a + 5;
    loaded.scene.indices.insert(loaded.scene.indices.end(), {a, c, b});
    if (row == kSlantedRows) continue;
    loaded.scene.indices.insert(loaded.scene.indices.end(), {a, b, d, b, c, e, b, e, d});
  }
  ASSERT_TRUE(complete_scene(loaded.scene).ok());
  const TempFolder folder;
  const ExportOptions options = square_page(folder);
  const auto report = export_world(loaded, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 1u);
  const auto written = read_uv_obj(options.target);
  ASSERT_TRUE(written.ok()) << written.status().message();
  const std::uint64_t overlap = measure_atlas(*written, 1024, 1024).overlap;
  EXPECT_GT(overlap, 0u) << "the test is too easy";
  EXPECT_GE(report->texels_drawn_twice, overlap);
  EXPECT_LE(report->texels_drawn_twice, overlap + 2);
}

TEST(ThinReport, UnwrappingTellsOfThinTriangles) {
  const LoadedScene loaded = hopeless_slivers();
  std::vector<std::string> said;
  Context context;
  context.warn = [&](std::string_view line) { said.emplace_back(line); };
  const auto mesh = unwrap_mesh(view_of(loaded.scene), {{.page_size = 1024}}, context);
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  std::size_t closed = 0;
  for (std::size_t t = 0; t < mesh->triangle_page.size(); ++t) closed += !(turn(*mesh, t) > 0);
  EXPECT_GT(closed, 10u) << "the test is too easy";
  EXPECT_GE(mesh->thin_triangles, closed);
  EXPECT_LE(mesh->thin_triangles, 2 * closed);
  ASSERT_EQ(said.size(), 1u);
  EXPECT_TRUE(said[0].starts_with(std::to_string(mesh->thin_triangles) + " slivers ")) << said[0];
}

}  // namespace
}  // namespace atlas::test
