// The C interface gives what the C++ calls give, refuses what is not usable, and lets no exception
// out.
#include "libatlas/c/atlas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "libatlas/unwrap/atlas.h"
#include "tests/c/c_fixture.h"
#include "tests/support/shape_view.h"

namespace atlas::test {
namespace {

TEST_F(C, GivesWhatTheAtlasGivesToTheBit) {
  Atlas expected;
  for (const Shape& shape : shapes_) ASSERT_TRUE(expected.add(view_of(shape)).ok());
  const auto result = expected.unwrap({}, {});
  ASSERT_TRUE(result.ok());
  const auto atlas = atlas_of(shapes_);
  const auto unwrapped = unwrap(atlas.get());
  for (std::uint32_t i = 0; i < shapes_.size(); ++i) {
    const UnwrappedAtlas::Mesh own = result->mesh(i);
    auto mesh = sized<libatlas_mesh_uvs>();
    ASSERT_EQ(libatlas_get_mesh(context(), unwrapped.get(), i, &mesh), LIBATLAS_OK);
    EXPECT_TRUE(same(mesh.vertices, mesh.vertex_count, own.vertices));
    EXPECT_EQ(std::memcmp(mesh.uvs, own.uvs.data(), own.uvs.size_bytes()), 0);
    EXPECT_TRUE(same(mesh.indices, 3 * mesh.triangle_count, own.indices));
    EXPECT_TRUE(same(mesh.triangle_page, mesh.triangle_count, own.triangle_page));
    EXPECT_TRUE(same(mesh.triangle_chart, mesh.triangle_count, own.triangle_chart));
    const auto seams = expected.seams(*result, i);
    std::vector<std::uint8_t> marked(3 * mesh.triangle_count, 9);
    ASSERT_EQ(libatlas_get_seams(context(), atlas.get(), unwrapped.get(), i, marked.data(),
                                 marked.size()),
              LIBATLAS_OK);
    EXPECT_EQ(marked, *seams);
  }
}

TEST_F(C, TellsTheQuality) {
  const auto unwrapped = unwrap(atlas_of(shapes_).get());  // the atlas may go before
  auto info = sized<libatlas_atlas_info>();
  ASSERT_EQ(libatlas_get_info(context(), unwrapped.get(), &info), LIBATLAS_OK);
  EXPECT_EQ(info.size, sizeof info);
  EXPECT_EQ(info.mesh_count, 3u);
  ASSERT_EQ(info.page_count, 1u);
  EXPECT_GT(std::max(info.pages[0].width, info.pages[0].height), 1024);
  EXPECT_GT(info.utilization, 0.5);
  EXPECT_GT(info.stretch_l2, 1);
  EXPECT_LT(info.stretch_l2, 1.05);
  EXPECT_LE(info.stretch_999, 1.25);
  EXPECT_GE(info.stretch_max, info.stretch_999);
  EXPECT_NEAR(info.surface_area, surface_area(shapes_[0]) + 6 + 1, 1e-3);
  EXPECT_GT(info.seam_length, 0);
  auto charts = sized<libatlas_charts>();
  ASSERT_EQ(libatlas_get_charts(context(), unwrapped.get(), &charts), LIBATLAS_OK);
  ASSERT_EQ(charts.chart_count, info.chart_count);
  double area = 0, worst = 1;
  std::size_t triangles = 0;
  for (std::size_t c = 0; c < charts.chart_count; ++c) {
    EXPECT_LT(charts.mesh[c], 3u);
    EXPECT_EQ(charts.page[c], 0u);
    area += charts.area[c];
    worst = std::max(worst, charts.stretch_999[c]);
    triangles += charts.triangle_count[c];
  }
  EXPECT_NEAR(area, info.surface_area, 1e-6 * area);
  EXPECT_EQ(worst, info.stretch_999);
  std::size_t expected = 0;
  for (const Shape& shape : shapes_) expected += shape.triangle_count();
  EXPECT_EQ(triangles, expected);
}

TEST_F(C, OptionsArePassedOn) {
  libatlas_unwrap_options options;
  ASSERT_EQ(libatlas_lightmap_options_init(&options, sizeof options, 32, 0.5), LIBATLAS_OK);
  const UnwrapOptions preset = lightmap_options(32, 0.5);
  EXPECT_EQ(options.texels_per_unit, 16);
  EXPECT_EQ(options.mip_levels, preset.mip_levels);
  EXPECT_EQ(options.padding, preset.padding);
  EXPECT_EQ(options.square, 1);
  EXPECT_EQ(options.part_gaps, 1);
  const auto atlas = atlas_of(shapes_);
  const auto unwrapped = unwrap(atlas.get(), &options);
  Atlas expected;
  for (const Shape& shape : shapes_) ASSERT_TRUE(expected.add(view_of(shape)).ok());
  const auto result = expected.unwrap(preset, {});
  auto mesh = sized<libatlas_mesh_uvs>();
  ASSERT_EQ(libatlas_get_mesh(context(), unwrapped.get(), 1, &mesh), LIBATLAS_OK);
  const auto own = result->mesh(1).uvs;
  ASSERT_EQ(mesh.vertex_count, own.size());
  EXPECT_EQ(std::memcmp(mesh.uvs, own.data(), own.size_bytes()), 0);
}

TEST_F(C, TexcoordsAreKeptIfAsked) {
  const Shape& plate = shapes_[2];
  std::vector<std::uint16_t> indices(plate.indices.begin(), plate.indices.end());
  libatlas_mesh mesh = mesh_of(plate);
  mesh.indices = indices.data();
  mesh.index_bytes = 2;
  mesh.texcoords = plate.positions.data();  // x and y
  mesh.texcoord_count = plate.positions.size();
  mesh.texcoord_stride = sizeof(Vec3f);
  mesh.density = 2;
  const auto atlas = atlas_of({});
  ASSERT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, nullptr), LIBATLAS_OK) << message();
  libatlas_unwrap_options options;
  libatlas_unwrap_options_init(&options, sizeof options);
  options.keep_uvs = 1;
  const auto unwrapped = unwrap(atlas.get(), &options);
  auto charts = sized<libatlas_charts>();
  ASSERT_EQ(libatlas_get_charts(context(), unwrapped.get(), &charts), LIBATLAS_OK);
  ASSERT_EQ(charts.chart_count, 1u);
  EXPECT_EQ(charts.kept[0], 1);
}

TEST_F(C, ProgressRisesAndMayCancel) {
  struct Seen {
    std::vector<std::pair<std::string, double>> reports;
    double stop_at = 2;
  } seen;
  libatlas_set_progress(
      context(),
      [](void* user, const char* stage, double fraction) -> int {
        auto& to = *static_cast<Seen*>(user);
        if (!to.reports.empty() && to.reports.back().first == stage) {
          EXPECT_GE(fraction, to.reports.back().second);
        }
        to.reports.emplace_back(stage, fraction);
        return fraction >= to.stop_at;
      },
      &seen);
  const auto atlas = atlas_of(shapes_);
  EXPECT_TRUE(unwrap(atlas.get()));
  EXPECT_EQ(seen.reports.front().first, "charts");
  EXPECT_EQ(seen.reports.back(), (std::pair<std::string, double>("packing", 1)));
  seen.stop_at = 0.1;
  libatlas_unwrapped* unwrapped = reinterpret_cast<libatlas_unwrapped*>(1);
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), nullptr, &unwrapped), LIBATLAS_CANCELLED);
  EXPECT_EQ(unwrapped, nullptr);
  EXPECT_EQ(message(), "cancelled");
  seen = {};
  EXPECT_TRUE(unwrap(atlas.get()));  // only that call was cancelled
}

TEST_F(C, AnotherThreadMayCancel) {
  const auto atlas = atlas_of({torus(300, 150)});
  libatlas_cancel(context());
  libatlas_unwrapped* unwrapped = nullptr;
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), nullptr, &unwrapped), LIBATLAS_CANCELLED);
  std::atomic<bool> begun = false;
  libatlas_set_progress(
      context(),
      [](void* user, const char*, double) -> int {
        *static_cast<std::atomic<bool>*>(user) = true;
        return 0;
      },
      &begun);
  std::thread other([&] {
    while (!begun) std::this_thread::yield();
    libatlas_cancel(context());
  });
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), nullptr, &unwrapped), LIBATLAS_CANCELLED);
  other.join();
}

TEST_F(C, NoExceptionLeavesACall) {
  const auto atlas = atlas_of(shapes_);
  libatlas_unwrapped* unwrapped = nullptr;
  libatlas_set_progress(
      context(), [](void*, const char*, double) -> int { throw std::runtime_error("mine"); },
      nullptr);
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), nullptr, &unwrapped), LIBATLAS_CALLBACK_FAILED);
  EXPECT_EQ(unwrapped, nullptr);
  libatlas_set_progress(context(), nullptr, nullptr);
  EXPECT_TRUE(unwrap(atlas.get()));
}

TEST_F(C, RectanglesAndIslandsArePacked) {
  const std::vector<libatlas_extent> rects{{100, 50}, {30, 30}, {4000, 10}, {64, 64}};
  libatlas_packed* made = nullptr;
  ASSERT_EQ(libatlas_pack_rects(context(), rects.data(), rects.size(), nullptr, &made), LIBATLAS_OK)
      << message();
  const Owned<libatlas_packed> packed(made);
  auto info = sized<libatlas_packed_info>();
  ASSERT_EQ(libatlas_get_packed(context(), packed.get(), &info), LIBATLAS_OK);
  ASSERT_EQ(info.placement_count, rects.size());
  EXPECT_EQ(info.unplaced_count, 1u);
  EXPECT_EQ(info.placements[2].page, LIBATLAS_NO_PAGE);
  EXPECT_EQ(info.page_count, 1u);
  EXPECT_EQ(info.pages[0].width, 2048);
  const auto expected =
      pack_rects(std::vector<Extent>{{100, 50}, {30, 30}, {4000, 10}, {64, 64}}, {}, {});
  for (std::size_t i = 0; i < rects.size(); ++i) {
    EXPECT_EQ(info.placements[i].x, expected->placements[i].x);
    EXPECT_EQ(info.placements[i].y, expected->placements[i].y);
  }

  libatlas_islands islands;
  libatlas_islands_init(&islands, sizeof islands);
  const Shape plates = together(grid(2, 2), moved(grid(3, 3), 2));
  islands.uvs = plates.positions.data();
  islands.uv_count = plates.positions.size();
  islands.uv_stride = sizeof(Vec3f);
  islands.indices = plates.indices.data();
  islands.index_count = plates.indices.size();
  libatlas_packed_islands* packed_islands = nullptr;
  ASSERT_EQ(libatlas_pack_islands(context(), &islands, nullptr, &packed_islands), LIBATLAS_OK)
      << message();
  const Owned<libatlas_packed_islands> owned(packed_islands);
  auto at = sized<libatlas_packed_islands_info>();
  ASSERT_EQ(libatlas_get_packed_islands(context(), owned.get(), &at), LIBATLAS_OK);
  EXPECT_EQ(at.island_count, 2u);
  EXPECT_EQ(at.uv_count, plates.positions.size());
  EXPECT_EQ(at.triangle_island[plates.triangle_count() - 1], 1u);
  EXPECT_GT(at.utilization, 0.7);
  const double c = std::cos(at.island_angle[1]), s = std::sin(at.island_angle[1]);
  const Vec3f p = plates.positions.back();
  EXPECT_NEAR(at.uvs[2 * at.uv_count - 2] * at.pages[0].width,
              at.island_offset[2] + at.texels_per_uv * (c * p.x - s * p.y), 0.01);
}

// As a program does that was compiled with a later header, and one with a wrong size.
TEST_F(C, StructsMayGrow) {
  struct Later {
    libatlas_unwrap_options known;
    double more;
  } later;
  auto* const options = reinterpret_cast<libatlas_unwrap_options*>(&later);
  ASSERT_EQ(libatlas_unwrap_options_init(options, sizeof later), LIBATLAS_OK);
  EXPECT_EQ(later.more, 0);
  EXPECT_EQ(later.known.size, sizeof later);
  EXPECT_EQ(later.known.max_stretch, 1.25);
  const auto atlas = atlas_of({shapes_[2]});
  EXPECT_TRUE(unwrap(atlas.get(), options));
  later.more = 1;
  libatlas_unwrapped* unwrapped = nullptr;
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), options, &unwrapped), LIBATLAS_UNSUPPORTED);
  for (const std::size_t size : {std::size_t{0}, offsetof(libatlas_unwrap_options, like) - 1,
                                 std::numeric_limits<std::size_t>::max()}) {
    later.known.size = size;
    EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), options, &unwrapped), LIBATLAS_BAD_OPTION);
    EXPECT_NE(message().find("libatlas_unwrap_options: size is"), std::string::npos) << message();
    EXPECT_EQ(libatlas_unwrap_options_init(options, size), LIBATLAS_BAD_OPTION);
  }
  struct LaterInfo {
    libatlas_atlas_info known;
    double more = 7;
  } info;
  info.known.size = sizeof info;
  EXPECT_EQ(libatlas_get_info(context(), unwrap(atlas.get()).get(), &info.known), LIBATLAS_OK);
  EXPECT_EQ(info.more, 0);
}

TEST_F(C, UnusableArgumentsAreRefusedByName) {
  const auto atlas = atlas_of({shapes_[2]});
  const auto refused = [&](libatlas_mesh mesh, libatlas_status status, const char* text) {
    std::uint32_t number = 99;
    EXPECT_EQ(libatlas_add_mesh(context(), atlas.get(), &mesh, &number), status);
    EXPECT_NE(message().find(text), std::string::npos) << message();
    EXPECT_EQ(number, 0u);
  };
  libatlas_mesh mesh = mesh_of(shapes_[0]);
  mesh.position_stride = 11;
  refused(mesh, LIBATLAS_BAD_INPUT, "mesh 1: positions lie 11 bytes apart");
  mesh = mesh_of(shapes_[0]);
  mesh.index_bytes = 8;
  refused(mesh, LIBATLAS_BAD_INPUT, "mesh 1: indices have 8 bytes each");
  mesh = mesh_of(shapes_[0]);
  mesh.position_count = 10;
  refused(mesh, LIBATLAS_BAD_INPUT, "names none of the 10 positions");
  mesh = mesh_of(shapes_[0]);
  mesh.density = NAN;
  refused(mesh, LIBATLAS_BAD_INPUT, "mesh 1: density nan");
  mesh.size = 3;
  refused(mesh, LIBATLAS_BAD_OPTION, "libatlas_mesh: size is 3");

  EXPECT_EQ(libatlas_add_mesh(nullptr, atlas.get(), &mesh, nullptr), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(libatlas_add_mesh(context(), nullptr, &mesh, nullptr), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(message(), "atlas is null");
  EXPECT_EQ(libatlas_add_mesh(context(), atlas.get(), nullptr, nullptr), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), nullptr, nullptr), LIBATLAS_BAD_INPUT);
  libatlas_unwrap_options options;
  libatlas_unwrap_options_init(&options, sizeof options);
  options.charts = 3;
  libatlas_unwrapped* unwrapped = nullptr;
  EXPECT_EQ(libatlas_unwrap(context(), atlas.get(), &options, &unwrapped), LIBATLAS_BAD_OPTION);
  EXPECT_EQ(message(), "libatlas_unwrap_options: charts is 3 (0: fast, 1: standard, 2: best)");
  EXPECT_EQ(libatlas_unwrap(context(), atlas_of({}).get(), nullptr, &unwrapped),
            LIBATLAS_BAD_INPUT);
  const auto good = unwrap(atlas.get());
  auto uvs = sized<libatlas_mesh_uvs>();
  EXPECT_EQ(libatlas_get_mesh(context(), good.get(), 1, &uvs), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(message(), "mesh 1: there are 1 (counted from 0)");
  const libatlas_extent negative = {-1, 3};
  libatlas_packed* packed = nullptr;
  EXPECT_EQ(libatlas_pack_rects(context(), &negative, 1, nullptr, &packed), LIBATLAS_BAD_INPUT);
  EXPECT_EQ(libatlas_pack_rects(context(), nullptr, 1, nullptr, &packed), LIBATLAS_BAD_INPUT);
  libatlas_context_destroy(nullptr);
  libatlas_atlas_destroy(nullptr);
  libatlas_unwrapped_destroy(nullptr);
  libatlas_packed_destroy(nullptr);
  libatlas_packed_islands_destroy(nullptr);
}

TEST_F(C, TheVersionOfTheHeaderIsThatOfTheLibrary) {
  EXPECT_EQ(libatlas_version(), 10000u * LIBATLAS_VERSION_MAJOR + 100u * LIBATLAS_VERSION_MINOR +
                                    LIBATLAS_VERSION_PATCH);
}

}  // namespace
}  // namespace atlas::test
