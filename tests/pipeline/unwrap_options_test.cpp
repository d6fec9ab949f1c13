// Options of unwrap_mesh: pages to bake, their alignment, charts that must not be rotated, and more
// work.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/unwrap/unwrap.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/pipeline/unwrap_checks.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/flat_mesh.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

// Its charts and placements can be passed to bake_page. No texel of the page depends on the number
// of threads, and none is contested if the page was packed for as many mip levels.
TEST(Unwrap, PagesAreBakedWithMipLevels) {
  const LoadedScene scene = lit_scene(torus(64, 32));
  const LuminanceSampler sampler(scene.scene, Quantity::illuminance);
  const ToneMapping tone{};
  for (const int levels : {-1, 0, 2, 3}) {
    UnwrapOptions options{{.page_size = 256, .padding = 2, .preset = PackPreset::fast}};
    options.mip_levels = std::max(levels, 0);
    const auto mesh = unwrap_mesh(view_of(scene.scene), options, {});
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    ASSERT_EQ(mesh->pages.size(), 1u);
    expect_sound(view_of(scene.scene), *mesh);
    BakeOptions bake;  // -1: the baker's defaults with those of unwrap_mesh
    if (levels >= 0) bake.mip_levels = levels;
    bake.page_width = mesh->pages[0].width;
    bake.page_height = mesh->pages[0].height;
    std::vector<ChartPlacement> placements = mesh->placements;
    std::vector<std::uint8_t> reference;
    for (const int threads : {1, 4, 4, 4}) {
      Context context;
      context.threads = threads;
      const auto page = bake_page({sampler, mesh->charts, tone}, placements, bake, context);
      ASSERT_TRUE(page.ok()) << page.status().message();
      EXPECT_EQ(page->contested_texels > 0, levels < 0) << page->contested_texels;
      if (reference.empty()) reference = page->display.texels;
      EXPECT_EQ(page->display.texels, reference) << levels;
      std::reverse(placements.begin(), placements.end());
    }
  }
}

// Expects sides of the page and corners of the charts' boxes, but for their padding, at multiples
// of `cell` texels.
void expect_cells(const UnwrappedMesh& mesh, std::int32_t cell, std::int32_t padding) {
  EXPECT_EQ(mesh.pages[0].width % cell, 0);
  EXPECT_EQ(mesh.pages[0].height % cell, 0);
  for (const ChartPlacement& p : mesh.placements) {
    EXPECT_EQ((p.x - padding) % cell, 0);
    EXPECT_EQ((p.y - padding) % cell, 0);
  }
}

TEST(Unwrap, AlignmentIsKept) {
  const LoadedScene scene = lit_room(6);
  UnwrapOptions options{{.page_size = 512}};
  options.alignment = 8;
  const auto mesh = unwrap_mesh(view_of(scene.scene), options, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  expect_sound(view_of(scene.scene), *mesh);
  expect_cells(*mesh, 8, options.padding);
}

// With mip levels, cells are as large as both multiples allow.
TEST(Unwrap, AlignmentAndMipLevelsAreKeptTogether) {
  const LoadedScene scene = lit_room(6);
  UnwrapOptions options{{.page_size = 512}};
  options.alignment = 3;
  options.mip_levels = 2;
  const auto mesh = unwrap_mesh(view_of(scene.scene), options, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status().message();
  expect_cells(*mesh, 12, options.padding);
}

// A square sheet takes a square page up to its padding.
TEST(Unwrap, PaddingIsTheWiderOfThatAskedForAndThatOfMipLevels) {
  const Shape sheet = grid(4, 4);
  MeshView view;
  view.positions = sheet.positions;
  view.indices = sheet.indices;
  struct Case {
    std::int32_t padding, mip_levels, kept;
  };
  for (const Case& c : {Case{0, 0, 0}, Case{5, 0, 5}, Case{0, 1, 1}, Case{8, 1, 8}, Case{1, 4, 8},
                        Case{16, 4, 16}}) {
    UnwrapOptions options{{.page_size = 64, .padding = c.padding, .square = true}};
    options.mip_levels = c.mip_levels;
    const auto mesh = unwrap_mesh(view, options, {});
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    const double side = (64.0 - 2 * c.kept) / 64;
    EXPECT_NEAR(mesh->utilization, side * side, 0.01) << c.padding << ' ' << c.mip_levels;
  }
}

// Compares directions of edges in uvs before and after packing.
TEST(Unwrap, ChartsAreNotTurnedWhereThatIsForbidden) {
  for (const Shape& shape : {torus(16, 8), together(grid(9, 9, 1, 3), grid(9, 2, 5, 1))}) {
    MeshView view;
    view.positions = shape.positions;
    view.indices = shape.indices;
    for (const std::uint32_t pages : {1u, 3u}) {
      for (const PackPreset packing : {PackPreset::fast, PackPreset::standard}) {
        UnwrapOptions options{{.pages = pages, .page_size = 256}};
        options.allow_rotation = false;
        options.preset = packing;
        const auto mesh = unwrap_mesh(view, options, {});
        ASSERT_TRUE(mesh.ok()) << mesh.status().message();
        expect_sound(view, *mesh);
        for (const ChartPlacement& p : mesh->placements) {
          EXPECT_EQ(p.cosine, 1) << shape.name;
          EXPECT_EQ(p.sine, 0) << shape.name;
        }
        for (std::size_t i = 0; i < mesh->indices.size(); i += 3) {
          const Extent page = mesh->pages[mesh->triangle_page[i / 3]];
          const Vec2d a = mesh->charts.uvs[mesh->charts.triangle_uv[i]],
                      b = mesh->charts.uvs[mesh->charts.triangle_uv[i + 1]];
          const Vec2f p = mesh->uvs[mesh->indices[i]], q = mesh->uvs[mesh->indices[i + 1]];
          EXPECT_NEAR((q.x - p.x) * page.width, (b.x - a.x) * mesh->texels_per_unit, 1e-2);
          EXPECT_NEAR((q.y - p.y) * page.height, (b.y - a.y) * mesh->texels_per_unit, 1e-2);
        }
      }
    }
  }
}

// A kite whose lower sides bulge by less than a float's last places, as slivers do. Most such
// charts are moved so that no texel is drawn twice.
struct Kite {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3, 0, 4, 1, 1, 5, 2};
  MeshView view;

  explicit Kite(int seed) {
    const float across = 10.0F + 0.37F * float(seed), bulge = 4e-6F;
    positions = {{-across, 0, 0},
                 {0.1F, -9, 0},
                 {across, 0.3F, 0},
                 {0, 8, 0},
                 {-across / 2 + 0.05F, -4.5F - bulge, 0},
                 {across / 2 + 0.05F, -4.35F - bulge, 0}};
    view.positions = positions;
    view.indices = indices;
  }
  Kite(const Kite&) = delete;
};

TEST(Unwrap, PlacementsSayWhereUvsLie) {
  UnwrapOptions options{{.page_size = 1024, .preset = PackPreset::fast}};
  options.charts.min_fill = 0;
  for (int seed = 0; seed < 40; ++seed) {
    const Kite kite(seed);
    const auto mesh = unwrap_mesh(kite.view, options, {});
    ASSERT_TRUE(mesh.ok()) << mesh.status().message();
    for (std::size_t i = 0; i < kite.indices.size(); ++i) {
      const ChartPlacement& p = mesh->placements[mesh->charts.triangle_chart[i / 3]];
      const Vec2d at = page_texel(p, mesh->charts.uvs[mesh->charts.triangle_uv[i]]);
      const Extent page = mesh->pages[std::size_t(p.page)];
      const Vec2f uv = mesh->uvs[mesh->indices[i]];
      EXPECT_NEAR(uv.x * page.width, at.x, 2e-3) << seed;
      EXPECT_NEAR(uv.y * page.height, at.y, 2e-3) << seed;
    }
  }
}

// Counts texels that two triangles draw with a rasteriser of its own.
std::uint64_t drawn_twice(const UnwrappedMesh& mesh) {
  UvMesh uvs;
  for (const Vec2f uv : mesh.uvs) {
    uvs.uvs.push_back({uv.x, uv.y});
    uvs.positions.push_back({uv.x, uv.y, 0});
  }
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t* c = &mesh.indices[i];
    uvs.faces.push_back({{c[0], c[1], c[2]}, {c[0], c[1], c[2]}, 0});
  }
  return measure_atlas(uvs, mesh.pages[0].width, mesh.pages[0].height).overlap;
}

// Without mip levels, charts are moved so that no texel is drawn twice. With them, that needs a
// texel more than their gutters have.
TEST(Unwrap, WithMipLevelsChartsMoveOnlyIfTheirPaddingIsWider) {
  struct Case {
    std::int32_t padding, mip_levels;
    bool moves;
  };
  for (const Case& c : {Case{2, 0, true}, Case{1, 1, false}, Case{2, 1, true}, Case{2, 2, false},
                        Case{3, 2, true}}) {
    UnwrapOptions options{{.page_size = 1024, .padding = c.padding, .preset = PackPreset::fast}};
    options.mip_levels = c.mip_levels;
    options.charts.min_fill = 0;
    std::uint64_t told = 0, found = 0;
    for (int seed = 0; seed < 40; ++seed) {
      const Kite kite(seed);
      const auto mesh = unwrap_mesh(kite.view, options, {});
      ASSERT_TRUE(mesh.ok()) << mesh.status().message();
      const std::uint64_t overlap = drawn_twice(*mesh);
      EXPECT_GE(mesh->texels_drawn_twice, overlap) << seed;
      told += mesh->texels_drawn_twice;
      found += overlap;
    }
    EXPECT_EQ(told == 0, c.moves) << c.padding << ' ' << c.mip_levels << ": " << told;
    EXPECT_EQ(found == 0, c.moves) << c.padding << ' ' << c.mip_levels << ": " << found;
  }
}

// Slivers that lean on each other are opened by moves of two texels of such a page. Where light is
// baked, gutters tolerate one.
TEST(Unwrap, OnPagesToBakeUvsStayWithinATexelOfTheirPlacements) {
  const FlatMesh slivers = leaning_slivers();
  std::vector<Vec3f> positions;
  for (const Vec2d& p : slivers.uvs)
    positions.push_back({float((p.x - 0.4) * 0x1p24), float((p.y - 0.5) * 0x1p24), 0});
  MeshView view;
  view.positions = positions;
  view.indices = slivers.corners;
  const auto farthest = [&](std::int32_t mip_levels) {
    UnwrapOptions options{{.page_size = 16384, .square = true, .preset = PackPreset::fast}};
    options.mip_levels = mip_levels;
    options.charts.min_fill = 0;
    const auto mesh = unwrap_mesh(view, options, {});
    EXPECT_TRUE(mesh.ok()) << mesh.status().message();
    if (!mesh.ok()) return 0.0;
    double most = 0;
    for (std::size_t i = 0; i < slivers.corners.size(); ++i) {
      const ChartPlacement& p = mesh->placements[mesh->charts.triangle_chart[i / 3]];
      const Vec2d at = page_texel(p, mesh->charts.uvs[mesh->charts.triangle_uv[i]]);
      const Vec2f uv = mesh->uvs[mesh->indices[i]];
      const Extent page = mesh->pages[std::size_t(p.page)];
      most =
          std::max({most, std::abs(uv.x * page.width - at.x), std::abs(uv.y * page.height - at.y)});
    }
    return most;
  };
  EXPECT_GT(farthest(0), 1.5) << "the test is too easy";
  for (const std::int32_t mip_levels : {1, 2, 4}) EXPECT_LE(farthest(mip_levels), 1.01);
}

TEST(Unwrap, CancelledAfterPackingGivesNoMesh) {
  const LoadedScene ring = lit_scene(torus(16, 8));
  std::atomic<bool> cancel{false};
  Context context;
  context.cancel = &cancel;
  context.progress = [&](std::string_view stage, double fraction) {
    if (stage == "packing" && fraction == 1) cancel = true;
  };
  const auto mesh = unwrap_mesh(view_of(ring.scene), {{.page_size = 64}}, context);
  EXPECT_EQ(mesh.status().code(), ErrorCode::cancelled);
}

TEST(Unwrap, MoreWorkFillsThePageNoWorse) {
  const LoadedScene ring = lit_scene(torus(24, 12));
  double fill[3];
  int k = 0;
  for (const PackPreset packing : {PackPreset::fast, PackPreset::standard, PackPreset::best}) {
    UnwrapOptions options;
    options.preset = packing;
    options.charts.cone_degrees = 40;
    const auto mesh = unwrap_mesh(view_of(ring.scene), options, {});
    ASSERT_TRUE(mesh.ok());
    fill[k++] = mesh->utilization;
  }
  EXPECT_NE(fill[0], fill[1]);
  EXPECT_GE(fill[1], fill[0]);
  EXPECT_GE(fill[2], fill[1]);
}

}  // namespace
}  // namespace atlas::test
