// Islands of given uvs are moved, turned and scaled by one factor, and lie beside each other.
#include "libatlas/unwrap/islands.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/support/atlas_measure.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

struct Uvs {
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> indices;
  IslandView view() const { return {uvs, indices}; }
};

// Plates of several sizes, all at the same place.
Uvs stacked_plates() {
  Uvs all;
  for (const double size : {1.0, 0.5, 0.7, 0.3, 0.3}) {
    const Shape plate = grid(3, 3, size, 0.5 * size);
    const auto first = std::uint32_t(all.uvs.size());
    for (const Vec3f p : plate.positions) all.uvs.push_back({p.x, p.y});
    for (const std::uint32_t v : plate.indices) all.indices.push_back(first + v);
  }
  return all;
}

AtlasMeasures measured(const Uvs& given, const PackedIslands& packed) {
  UvMesh mesh;
  mesh.pages = std::uint32_t(packed.pages.size());
  for (std::size_t v = 0; v < given.uvs.size(); ++v) {
    mesh.positions.push_back({given.uvs[v].x, given.uvs[v].y, double(v / 16)});  // 16 a plate
    mesh.uvs.push_back({packed.uvs[v].x, packed.uvs[v].y});
  }
  for (std::size_t t = 0; t < packed.triangle_island.size(); ++t) {
    const std::array<std::uint32_t, 3> corners{given.indices[3 * t], given.indices[3 * t + 1],
                                               given.indices[3 * t + 2]};
    mesh.faces.push_back({corners, corners, packed.islands[packed.triangle_island[t]].page});
  }
  return measure_atlas(mesh, packed.pages[0].width, packed.pages[0].height);
}

TEST(Islands, LieBesideEachOtherWithTheirShapes) {
  const Uvs given = stacked_plates();
  const auto packed = pack_islands(given.view(), {{.page_size = 256}}, {});
  ASSERT_TRUE(packed.ok()) << packed.status().message();
  EXPECT_EQ(packed->islands.size(), 5u);
  const AtlasMeasures measures = measured(given, *packed);
  EXPECT_EQ(measures.overlap, 0u);
  EXPECT_EQ(measures.flipped + measures.mirrored, 0u);
  EXPECT_NEAR(measures.stretch_linf, 1, 1e-4);  // one scale, no shape changed
  EXPECT_GT(packed->utilization, 0.7);
  EXPECT_NEAR(measures.utilization, packed->utilization, 0.02);
  EXPECT_NEAR(measures.scale, packed->texels_per_uv, 1e-3 * packed->texels_per_uv);
}

TEST(Islands, PlacementsTellWhereUvsGo) {
  Uvs given = stacked_plates();
  for (Vec2f& uv : given.uvs) uv = {uv.x - 3, uv.y + 5};
  const auto packed = pack_islands(given.view(), {{.page_size = 256}}, {});
  ASSERT_TRUE(packed.ok()) << packed.status().message();
  for (std::size_t i = 0; i < given.indices.size(); ++i) {
    const PackedIslands::Island& island = packed->islands[packed->triangle_island[i / 3]];
    const Vec2f p = given.uvs[given.indices[i]], uv = packed->uvs[given.indices[i]];
    const double c = std::cos(island.angle), s = std::sin(island.angle), k = packed->texels_per_uv;
    const Extent page = packed->pages[island.page];
    EXPECT_NEAR(uv.x * page.width, island.offset.x + k * (c * p.x - s * p.y), 0.01);
    EXPECT_NEAR(uv.y * page.height, island.offset.y + k * (s * p.x + c * p.y), 0.01);
  }
}

TEST(Islands, KeepAScaleThatIsAskedForAndUseSeveralPages) {
  const Uvs given = stacked_plates();
  const auto scaled = pack_islands(given.view(), {{.page_size = 256, .square = true}, 20}, {});
  ASSERT_TRUE(scaled.ok()) << scaled.status().message();
  EXPECT_DOUBLE_EQ(scaled->texels_per_uv, 20);
  EXPECT_EQ(scaled->pages[0].width, scaled->pages[0].height);
  const auto several = pack_islands(given.view(), {{.pages = 3, .page_size = 64}}, {});
  ASSERT_TRUE(several.ok()) << several.status().message();
  EXPECT_GT(several->pages.size(), 1u);
  EXPECT_EQ(measured(given, *several).overlap, 0u);
}

TEST(Islands, AreTheSameForAnyNumberOfThreads) {
  const Uvs given = stacked_plates();
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  const auto a = pack_islands(given.view(), {}, one), b = pack_islands(given.view(), {}, four);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->uvs, b->uvs);
}

TEST(Islands, UnusableOnesAreRefused) {
  Uvs beyond = stacked_plates(), far = beyond;
  beyond.indices[4] = 80;
  far.uvs[far.indices[7]].y = NAN;
  const auto first = pack_islands(beyond.view(), {}, {}), second = pack_islands(far.view(), {}, {});
  EXPECT_NE(first.status().message().find("triangle 1: index 80 names none of the 80 uvs"),
            std::string::npos)
      << first.status().message();
  EXPECT_NE(second.status().message().find("triangle 2: uv "), std::string::npos)
      << second.status().message();
  const std::vector<Vec2f> points(3, {1, 1});
  const std::vector<std::uint32_t> triangle{0, 1, 2};
  for (const IslandView& view : {IslandView{points, triangle}, IslandView{points, {}}})
    EXPECT_EQ(pack_islands(view, {}, {}).status().code(), ErrorCode::bad_input);
  const Uvs plates = stacked_plates();
  for (const IslandOptions& options : {IslandOptions{{.pages = 0}},
                                       {{.page_size = 32}},
                                       {{.padding = -1}},
                                       {{.alignment = 0}},
                                       {{}, NAN},
                                       {{.page_size = 100, .square = true}}})
    EXPECT_EQ(pack_islands(plates.view(), options, {}).status().code(), ErrorCode::bad_option);
}

}  // namespace
}  // namespace atlas::test
