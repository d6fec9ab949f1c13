// Tests the whole export with the independent evaluator: all measures are taken from the written
// file.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

ExportOptions small_pages(const TempFolder& folder) {
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 3;
  options.atlas_size = 256;
  options.simplify = false;
  return options;
}

// Positions of the corners, rotated so that the least one comes first. They are equal for equal
// oriented triangles.
using Corners = std::array<std::array<double, 3>, 3>;

Corners sorted_cyclically(Corners c) {
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}

std::vector<Corners> triangles_of(const Scene& scene) {
  std::vector<Corners> all;
  for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
    Corners corners;
    for (int k = 0; k < 3; ++k) {
      const Vec3f p = scene.positions[scene.indices[3 * t + k]];
      corners[k] = {p.x, p.y, p.z};
    }
    all.push_back(sorted_cyclically(corners));
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Corners> triangles_of(const UvMesh& mesh) {
  std::vector<Corners> all;
  for (const UvMesh::Face& face : mesh.faces) {
    Corners corners;
    for (int k = 0; k < 3; ++k) {
      // The file holds the shortest decimals of floats.
      const Vec3d p = mesh.positions[face.position[k]];
      corners[k] = {float(p.x), float(p.y), float(p.z)};
    }
    all.push_back(sorted_cyclically(corners));
  }
  std::sort(all.begin(), all.end());
  return all;
}

// Mip level m of a page has 1/2^m of its texels per side. No lookup at that level may read two
// charts.
void expect_no_neighbour_seen(const UvMesh& mesh, const ExportReport& report, int mip_levels) {
  for (int level = 0; level <= mip_levels; ++level) {
    const int width = report.pages[0].width >> level, height = report.pages[0].height >> level;
    EXPECT_EQ(measure_atlas(mesh, width, height).bleed, 0u) << "mip level " << level;
  }
}

bool same_page_sizes(const ExportReport& report) {
  return std::all_of(report.pages.begin(), report.pages.end(), [&](const PageReport& p) {
    return p.width == report.pages[0].width && p.height == report.pages[0].height;
  });
}

TEST(Export, EveryShapeOfTheZooIsPlacedWithoutOverlap) {
  const TempFolder folder;
  std::size_t shapes = 0, measured = 0, guarded = 0;
  for (const Shape& shape : zoo()) {
    SCOPED_TRACE(shape.name);
    const LoadedScene scene = lit_scene(shape);
    const ExportOptions options = small_pages(folder);
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    const auto mesh = read_uv_obj(options.target);
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    EXPECT_EQ(mesh->faces_without_uv, 0u);
    EXPECT_EQ(mesh->faces.size(), scene.scene.triangle_count());
    EXPECT_LE(report->pages.size(), 3u);
    ++shapes;
    if (!same_page_sizes(*report)) continue;  // the evaluator supports only one page size
    ++measured;
    const AtlasMeasures at_twice =
        measure_atlas(*mesh, 2 * report->pages[0].width, 2 * report->pages[0].height);
    EXPECT_EQ(at_twice.overlap, 0u);
    EXPECT_EQ(at_twice.flipped, 0u);
    EXPECT_EQ(at_twice.mirrored, 0u);
    EXPECT_EQ(at_twice.outside, 0u);
    EXPECT_GE(report->mip_levels, options.mip_levels);
    guarded += report->mip_levels > options.mip_levels;
    expect_no_neighbour_seen(*mesh, *report, report->mip_levels);
  }
  EXPECT_GE(shapes, 10u);
  EXPECT_GT(10 * measured, 9 * shapes) << measured << " of " << shapes;
  EXPECT_GT(guarded, 0u);
}

TEST(Export, KeepsEveryTriangleOnce) {
  const TempFolder folder;
  const LoadedScene scene = lit_room(10);
  const ExportOptions options = small_pages(folder);
  ASSERT_TRUE(export_world(scene, options, {}, {}).ok());
  const auto mesh = read_uv_obj(options.target);
  ASSERT_TRUE(mesh.ok());
  EXPECT_EQ(triangles_of(scene.scene), triangles_of(*mesh));
}

TEST(Export, WritesTrianglesThatFaceTheOtherWayAsTheirChartDoes) {
  const TempFolder folder;
  LoadedScene scene = lit_scene(torus(24, 12));
  for (std::size_t t = 0; t < scene.scene.triangle_count(); t += 5) {
    std::swap(scene.scene.indices[3 * t], scene.scene.indices[3 * t + 1]);
  }
  const ExportOptions options = small_pages(folder);
  const auto report = export_world(scene, options, {}, {});
  ASSERT_TRUE(report.ok());
  const auto mesh = read_uv_obj(options.target);
  ASSERT_TRUE(mesh.ok());
  const AtlasMeasures m = measure_atlas(*mesh, 256, 256);
  EXPECT_EQ(m.flipped, 0u);
  EXPECT_EQ(m.mirrored, 0u);
}

TEST(Export, FewerPagesWhereTheyAreEnough) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder);
  options.atlases = 40;
  options.atlas_size = 1024;
  options.texel_metres = 0.02;
  const auto report = export_world(lit_room(8), options, {}, {});
  ASSERT_TRUE(report.ok());
  EXPECT_EQ(report->pages.size(), 1u);
  EXPECT_EQ(report->scale, 1.0);
}

TEST(Export, ScalesAllTexturesAlikeIntoASmallBudget) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder);
  options.texel_metres = 0.005;
  options.threshold = 0;
  const auto report = export_world(lit_room(8), options, {}, {});
  ASSERT_TRUE(report.ok());
  EXPECT_LT(report->scale, 0.8);
  EXPECT_LE(report->pages.size(), 3u);
  EXPECT_GT(report->fidelity.psnr, 40);
}

// The room asks for far more texels than pages hold: a million times as many as the small one.
TEST(Export, HugeScenesAreNotCutIntoCrumbs) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder);
  LoadedScene room = lit_room(8);
  const auto small = export_world(room, options, {}, {});
  room.scene.metres_per_unit = 1000;
  const auto large = export_world(room, options, {}, {});
  ASSERT_TRUE(small.ok());
  ASSERT_TRUE(large.ok()) << large.status().message();
  EXPECT_LT(large->charts.size(), 4 * small->charts.size());
  EXPECT_GT(large->fidelity.psnr, 40);
}

// If each piece took its smallest allowed box, the pieces would not fit where the whole does.
TEST(Export, SmallPagesDoNotDrownInPieces) {
  const TempFolder folder;
  const LoadedScene scene = lit_scene(grid(20, 20));
  for (const double threshold : {0.0, 2.0 / 255}) {
    ExportOptions options = small_pages(folder);
    options.atlases = 1;
    options.atlas_size = 64;
    options.threshold = threshold;
    options.texel_metres = 0.001;
    const auto report = export_world(scene, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    EXPECT_LE(report->charts.size(), 4u);
    EXPECT_GT(report->uv_utilization, 0.5);
  }
}

TEST(Export, ErrorFallsWithTheTexel) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder);
  options.atlas_size = 2048;
  double previous = 0;
  for (const double texel : {0.8, 0.4, 0.2}) {
    options.texel_metres = texel;
    options.threshold = 0;
    const auto report = export_world(lit_room(40), options, {}, {});
    ASSERT_TRUE(report.ok());
    EXPECT_GT(report->fidelity.psnr, previous) << texel;
    previous = report->fidelity.psnr;
  }
}

TEST(Export, ChartsOnlyNeedsNoLight) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder);
  options.charts_only = true;
  options.atlas_size = 1024;
  LoadedScene scene = lit_scene(torus(48, 24));
  scene.scene.illumination.clear();
  const auto report = export_world(scene, options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 1u);
  const auto mesh = read_uv_obj(options.target);
  ASSERT_TRUE(mesh.ok());
  const AtlasMeasures m = measure_atlas(*mesh, report->pages[0].width, report->pages[0].height);
  EXPECT_EQ(m.charts, report->charts.size());
  EXPECT_EQ(m.bleed, 0u);
  EXPECT_EQ(m.overlap, 0u);
  EXPECT_GT(m.utilization, 0.5);
  EXPECT_NEAR(m.stretch_l2, report->distortion.stretch_l2, 0.01);
  EXPECT_FALSE(fs::exists(folder / "world_0.png"));

  // The page's shape is seldom square and is stated in the file. It is square if that is asked for.
  const Extent page{report->pages[0].width, report->pages[0].height};
  const auto has_line = [&](const std::string& line) {
    std::stringstream text;
    text << std::ifstream(options.target).rdbuf();
    return text.str().find("# " + line + "\n") != std::string::npos;
  };
  EXPECT_NE(page.width, page.height);
  EXPECT_TRUE(has_line(plain_pages_text({&page, 1}, false)));
  options.square_plain_page = true;
  const auto square = export_world(scene, options, {}, {});
  ASSERT_TRUE(square.ok()) << square.status().message();
  EXPECT_EQ(square->pages[0].width, 1024);
  EXPECT_EQ(square->pages[0].height, 1024);
  EXPECT_TRUE(has_line("uvs of a square page, packed for 1024 x 1024 texels"));
  const AtlasMeasures s = measure_atlas(*read_uv_obj(options.target), 1024, 1024);
  EXPECT_EQ(s.bleed, 0u);
  EXPECT_EQ(s.overlap, 0u);
  EXPECT_GT(s.utilization, 0.5);
  EXPECT_NEAR(s.stretch_l2, m.stretch_l2, 0.01);
}

// The page becomes as large as the texel's length needs, which the evaluator measures in the file.
TEST(Export, PlainUvsOfAGivenDensity) {
  const TempFolder folder;
  LoadedScene scene = lit_scene(box(8, {2, 2, 2}));
  ExportOptions options = small_pages(folder);
  options.charts_only = true;
  const auto texels_a_unit = [&](const ExportReport& report) {
    EXPECT_EQ(report.pages.size(), 1u);
    return measure_atlas(*read_uv_obj(options.target), report.pages[0].width,
                         report.pages[0].height)
        .scale;
  };
  for (const bool square : {false, true}) {
    options.square_plain_page = square;
    for (const double texel : {0.05, 0.01, 0.002}) {
      options.texel_metres = texel;
      const auto report = export_world(scene, options, {}, {});
      ASSERT_TRUE(report.ok()) << report.status().message();
      EXPECT_NEAR(texels_a_unit(*report) * texel, 1, 0.01) << square << ' ' << texel;
      // A square page has sides of a power of two, so up to three quarters of it stay empty.
      EXPECT_GT(report->uv_utilization, square ? 0.14 : 0.5) << texel;
      EXPECT_EQ(report->texel, texel);
    }
  }
  scene.scene.metres_per_unit = 0.01;  // the same length is a hundred times as many units
  options.texel_metres = 0.0001;
  const auto small = export_world(scene, options, {}, {});
  ASSERT_TRUE(small.ok()) << small.status().message();
  EXPECT_NEAR(texels_a_unit(*small), 100, 1);
}

// What one page does not hold is refused, and several pages may hold it.
TEST(Export, PlainUvsOfADensityThatDoesNotFit) {
  const TempFolder folder;
  const LoadedScene scene = lit_scene(box(8, {2, 2, 2}));
  ExportOptions options = small_pages(folder);
  options.charts_only = true;
  options.larger_plain_page = false;
  options.texel_metres = 0.01;
  const auto refused = export_world(scene, options, {}, {});
  EXPECT_EQ(refused.status().code(), ErrorCode::no_solution);
  EXPECT_NE(refused.status().message().find("ExportOptions::texel_metres: 0.01 m needs more room"),
            std::string::npos)
      << refused.status().message();
  EXPECT_FALSE(fs::exists(options.target));
  options.plain_pages = 16;
  for (const bool udim : {false, true}) {
    options.udim = udim;
    const auto several = export_world(scene, options, {}, {});
    ASSERT_TRUE(several.ok()) << several.status().message();
    EXPECT_GT(several->pages.size(), 3u);
    EXPECT_LT(several->pages.size(), 16u);
  }
}

TEST(Export, PlainUvsOnSeveralPages) {
  const TempFolder folder;
  ExportOptions options = small_pages(folder);
  options.charts_only = true;
  options.atlas_size = 512;
  options.plain_pages = 3;
  const auto report = export_world(lit_scene(torus(48, 24)), options, {}, {});
  ASSERT_TRUE(report.ok()) << report.status().message();
  ASSERT_EQ(report->pages.size(), 3u);
  for (const PageReport& page : report->pages) {
    EXPECT_EQ(page.width, 512);
    EXPECT_EQ(page.height, 512);
  }
  const auto mesh = read_uv_obj(options.target);
  ASSERT_TRUE(mesh.ok());
  const AtlasMeasures m = measure_atlas(*mesh, 512, 512);
  EXPECT_EQ(m.pages, 3u);
  EXPECT_EQ(m.triangles, 48u * 24 * 2);
  EXPECT_EQ(m.charts, report->charts.size());
  EXPECT_EQ(m.bleed + m.overlap + m.flipped + m.outside, 0u);
  EXPECT_GT(m.utilization, 0.55);
  options.keep_scene = true;
  const auto kept = export_world(lit_scene(torus(48, 24)), options, {}, {});
  EXPECT_EQ(kept.status().code(), ErrorCode::bad_option);
}

TEST(Export, CancelledBeforeItBeganWritesNothing) {
  const TempFolder folder;
  const std::atomic<bool> cancel{true};
  Context context;
  context.cancel = &cancel;
  const auto report = export_world(lit_room(8), small_pages(folder), {}, context);
  ASSERT_FALSE(report.ok());
  EXPECT_EQ(report.status().code(), ErrorCode::cancelled);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Export, CancelledInAnyStageWritesNothing) {
  const LoadedScene room = lit_room(8);
  for (const char* stage :
       {"charts", "exposure", "downsizing", "packing", "baking", "simplify", "writing"}) {
    const TempFolder folder;
    std::atomic<bool> cancel{false};
    Context context;
    context.threads = 3;
    context.cancel = &cancel;
    context.progress = [&](std::string_view at, double) {
      if (at == stage) cancel = true;
    };
    ExportOptions options = small_pages(folder);
    options.simplify = true;
    const auto report = export_world(room, options, {}, context);
    ASSERT_FALSE(report.ok()) << stage;
    EXPECT_EQ(report.status().code(), ErrorCode::cancelled) << stage;
    EXPECT_TRUE(fs::is_empty(folder.path())) << stage;
  }
}

// The ranges of its own options are those of export_options_test.cpp.
TEST(Export, RefusesOptionsOutOfRangeBeforeItWrites) {
  using OptionChange = std::function<void(ExportOptions&)>;
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<const char*, OptionChange>> changes{
      {"ExportOptions::atlases", [](ExportOptions& o) { o.atlases = 0; }},
      {"ChartOptions::cone_degrees", [=](ExportOptions& o) { o.charts.cone_degrees = nan; }},
      {"ChartOptions::max_stretch", [](ExportOptions& o) { o.charts.max_stretch = 1; }},
      {"ChartOptions::crease_degrees", [](ExportOptions& o) { o.charts.crease_degrees = 0; }},
      {"ChartOptions::uv_aspect", [=](ExportOptions& o) { o.charts.uv_aspect = nan; }},
      {"ChartOptions::material_uv_aspects",
       [=](ExportOptions& o) {
         o.charts.material_uv_aspects = {1, nan};
       }},
      {"ToneOptions::white", [](ExportOptions& o) { o.tone.white = -1; }},
      {"ToneOptions::exposure_stops", [=](ExportOptions& o) { o.tone.exposure_stops = nan; }},
      {"ChartOptions::min_fill", [](ExportOptions& o) { o.charts.min_fill = 1; }},
      {"ToneOptions::bias", [](ExportOptions& o) { o.tone.bias = 1; }},
      {"world.xyz", [](ExportOptions& o) { o.target.replace_extension(".xyz"); }},
  };
  const TempFolder folder;
  const LoadedScene scene = lit_room(4);
  for (const auto& [name, change] : changes) {
    ExportOptions options = small_pages(folder);
    change(options);
    const Status status = export_world(scene, options, {}, {}).status();
    EXPECT_FALSE(status.ok()) << name;
    EXPECT_NE(status.message().find(name), std::string::npos) << name << ": " << status.message();
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

// Of two equal rooms, a world opens in the one that is lit.
TEST(Export, OpensInALitRoom) {
  for (const bool second_lit : {false, true}) {
    LoadedScene rooms = lit_room(8);
    Scene& scene = rooms.scene;
    const Scene other = scene;
    const auto count = std::uint32_t(scene.positions.size());
    for (Vec3f p : other.positions) scene.positions.push_back({p.x + 5, p.y, p.z});
    for (const std::uint32_t i : other.indices) scene.indices.push_back(i + count);
    scene.triangle_material.resize(scene.triangle_count(), 0);
    scene.triangle_object.resize(scene.triangle_count(), 0);
    const Vec3f dark{0, 0, 0};
    for (std::uint32_t v = 0; v < count; ++v)
      scene.illumination.push_back(second_lit ? scene.illumination[v] : dark);
    if (second_lit) std::fill_n(scene.illumination.begin(), count, dark);
    const TempFolder folder;
    ExportOptions options = small_pages(folder);
    options.target = folder / "world.wrl";
    options.up = Up::z;
    const auto report = export_world(rooms, options, {}, {});
    ASSERT_TRUE(report.ok()) << report.status().message();
    std::ifstream file(options.target);
    std::stringstream text;
    text << file.rdbuf();
    const std::size_t at = text.str().find("position ");
    ASSERT_NE(at, std::string::npos);
    const double x = std::stod(text.str().substr(at + 9));
    EXPECT_EQ(x > 4.5 + scene.origin.x, second_lit) << x;
  }
}

}  // namespace
}  // namespace atlas::test
