// What stays of earlier uvs. The oracles compare bits of uvs, and measure overlaps from the result
// alone.
#include "libatlas/unwrap/like.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "libatlas/unwrap/atlas.h"
#include "libatlas/unwrap/unwrap.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/shape_view.h"
#include "tests/support/shapes.h"

namespace atlas::test {
namespace {

using Corner = std::array<Vec2f, 3>;

Corner uvs_of(const UnwrappedMesh& mesh, std::size_t t) {
  return {mesh.uvs[mesh.indices[3 * t]], mesh.uvs[mesh.indices[3 * t + 1]],
          mesh.uvs[mesh.indices[3 * t + 2]]};
}

UnwrappedMesh made_of(const Shape& shape, const UnwrapOptions& options = {},
                      const Context& context = {}) {
  Result<UnwrappedMesh> made = unwrap_mesh(view_of(shape), options, context);
  EXPECT_TRUE(made.ok()) << made.status().message();
  return made.ok() ? std::move(*made) : UnwrappedMesh{};
}

// Unwraps `now` like `before`, and checks what holds of every result.
UnwrappedMesh unwrapped_like(const Shape& now, const EarlierUvs& before, UnwrapOptions options = {},
                             const Context& context = {}) {
  options.like = &before;
  UnwrappedMesh made = made_of(now, options, context);
  if (made.pages.empty()) return made;
  UvMesh mesh;
  mesh.pages = std::uint32_t(made.pages.size());
  for (const Vec3f p : now.positions) mesh.positions.push_back({p.x, p.y, p.z});
  for (const Vec2f uv : made.uvs) mesh.uvs.push_back({uv.x, uv.y});
  for (std::size_t t = 0; t < now.triangle_count(); ++t)
    mesh.faces.push_back({{now.indices[3 * t], now.indices[3 * t + 1], now.indices[3 * t + 2]},
                          {made.indices[3 * t], made.indices[3 * t + 1], made.indices[3 * t + 2]},
                          made.triangle_page[t]});
  const AtlasMeasures measures = measure_atlas(mesh, made.pages[0].width, made.pages[0].height);
  EXPECT_EQ(measures.overlap, 0u);
  EXPECT_EQ(measures.outside, 0u);
  EXPECT_EQ(measures.flipped + measures.mirrored, 0u);
  return made;
}

std::size_t count(const UnwrappedMesh& made, ChartOrigin origin) {
  return std::size_t(std::count(made.origins.begin(), made.origins.end(), origin));
}

// How many triangles have the uvs and the page of those that they were (kGone: none).
constexpr std::uint32_t kGone = 0xffffffffu;
std::size_t stayed(const UnwrappedMesh& before, const UnwrappedMesh& now,
                   const std::vector<std::uint32_t>& was) {
  std::size_t same = 0;
  for (std::size_t t = 0; t < was.size(); ++t)
    same += was[t] != kGone && uvs_of(now, t) == uvs_of(before, was[t]) &&
            now.triangle_page[t] == before.triangle_page[was[t]];
  return same;
}

// Likewise by texels, which stay where pages grow.
std::size_t stayed_in_texels(const UnwrappedMesh& before, const UnwrappedMesh& now,
                             const std::vector<std::uint32_t>& was) {
  const auto same_place = [&](Vec2f uv, const Extent& page, Vec2f earlier, const Extent& smaller) {
    return std::abs(uv.x * float(page.width) - earlier.x * float(smaller.width)) < 0.01f &&
           std::abs(uv.y * float(page.height) - earlier.y * float(smaller.height)) < 0.01f;
  };
  std::size_t same = 0;
  for (std::size_t t = 0; t < was.size(); ++t) {
    if (was[t] == kGone || now.triangle_page[t] != before.triangle_page[was[t]]) continue;
    const Corner a = uvs_of(now, t), b = uvs_of(before, was[t]);
    const std::uint32_t page = now.triangle_page[t];
    bool stays = true;
    for (std::size_t k = 0; k < 3; ++k)
      stays = stays && same_place(a[k], now.pages[page], b[k], before.pages[page]);
    same += stays;
  }
  return same;
}

std::vector<std::uint32_t> all(std::size_t n) {
  std::vector<std::uint32_t> list(n);
  std::iota(list.begin(), list.end(), 0u);
  return list;
}

TEST(Like, OwnResultStaysToTheLastBit) {
  for (const Shape& shape :
       {torus(40, 24), plate_with_holes(3, 4), together(cylinder(24, 8), sphere(24, 12))}) {
    for (const std::uint32_t pages : {1u, 3u}) {
      UnwrapOptions options;
      options.pages = pages;
      options.page_size = 256;
      const UnwrappedMesh before = made_of(shape, options);
      const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
      const UnwrappedMesh now = unwrapped_like(shape, earlier, options);
      EXPECT_EQ(stayed(before, now, all(shape.triangle_count())), shape.triangle_count())
          << shape.name << ", " << pages << " pages";
      EXPECT_EQ(now.pages, before.pages) << shape.name;
      EXPECT_EQ(count(now, ChartOrigin::kept), now.charts.charts.size()) << shape.name;
      EXPECT_NEAR(now.texels_per_unit, before.texels_per_unit, 2e-3 * before.texels_per_unit);
    }
  }
}

TEST(Like, OrdersAndNumbersDoNotMatter) {
  const Shape shape = torus(40, 24);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  std::mt19937 random(5);
  std::vector<std::uint32_t> place = all(shape.positions.size()),
                             order = all(shape.triangle_count());
  std::shuffle(place.begin(), place.end(), random);
  std::shuffle(order.begin(), order.end(), random);
  Shape other = shape;
  for (std::size_t v = 0; v < place.size(); ++v) other.positions[place[v]] = shape.positions[v];
  for (std::size_t t = 0; t < order.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      other.indices[3 * t + k] = place[shape.indices[3 * order[t] + (k + t) % 3]];
  const UnwrappedMesh now = unwrapped_like(other, earlier);
  for (std::size_t t = 0; t < order.size(); ++t) {
    const Corner was = uvs_of(before, order[t]), is = uvs_of(now, t);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_EQ(is[k], was[(k + t) % 3]) << t;
  }
}

TEST(Like, SmallMovesLeaveEverything) {
  const Shape shape = icosphere(3);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  const UnwrappedMesh now = unwrapped_like(noisy(shape, 3e-4, 3), earlier);
  EXPECT_EQ(stayed(before, now, all(shape.triangle_count())), shape.triangle_count());
}

TEST(Like, ARemovedTriangleLeavesTheOthers) {
  const Shape shape = torus(40, 24);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  Shape holed = shape;
  holed.indices.erase(holed.indices.begin() + 3 * 700, holed.indices.begin() + 3 * 701);
  std::vector<std::uint32_t> was = all(shape.triangle_count());
  was.erase(was.begin() + 700);
  const UnwrappedMesh now = unwrapped_like(holed, earlier);
  EXPECT_EQ(stayed(before, now, was), was.size());
  EXPECT_EQ(count(now, ChartOrigin::repaired), 1u);
  EXPECT_EQ(count(now, ChartOrigin::made), 0u);

  // And back: the triangle gets its place in the hole again.
  const EarlierUvs holes = earlier_uvs(view_of(holed), now);
  const UnwrappedMesh filled = unwrapped_like(shape, holes);
  EXPECT_EQ(filled.charts.charts.size(), before.charts.charts.size());
  EXPECT_EQ(uvs_of(filled, 700), uvs_of(before, 700));
}

TEST(Like, AMovedVertexIsRepairedInItsChart) {
  const Shape shape = grid(20, 20);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  Shape bent = shape;
  bent.positions[220].z = 0.01f;  // a fifth of an edge
  const UnwrappedMesh now = unwrapped_like(bent, earlier);
  std::vector<std::uint32_t> was = all(shape.triangle_count());
  std::size_t around = 0;
  for (std::size_t t = 0; t < was.size(); ++t)
    if (std::count(&shape.indices[3 * t], &shape.indices[3 * t] + 3, 220u) > 0) {
      was[t] = kGone;
      ++around;
    }
  EXPECT_EQ(stayed(before, now, was), was.size() - around);
  EXPECT_EQ(now.charts.charts.size(), 1u);
  EXPECT_EQ(count(now, ChartOrigin::repaired), 1u);
}

TEST(Like, ASubdividedFaceStaysInItsChart) {
  const Shape shape = icosphere(3);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  Shape finer = shape;
  const std::uint32_t a = shape.indices[300], b = shape.indices[301], c = shape.indices[302];
  const auto d = std::uint32_t(finer.positions.size());
  const Vec3f p = shape.positions[a], q = shape.positions[b], r = shape.positions[c];
  finer.positions.push_back({(p.x + q.x + r.x) / 3, (p.y + q.y + r.y) / 3, (p.z + q.z + r.z) / 3});
  finer.indices[302] = d;
  finer.indices.insert(finer.indices.end(), {b, c, d, c, a, d});
  const UnwrappedMesh now = unwrapped_like(finer, earlier);
  std::vector<std::uint32_t> was = all(shape.triangle_count());
  was[100] = kGone;
  EXPECT_EQ(stayed(before, now, was), was.size() - 1);
  EXPECT_EQ(now.charts.charts.size(), before.charts.charts.size());
  // The three lie where the one lay.
  const Corner whole = uvs_of(before, 100);
  const Vec2f middle = now.uvs[now.indices[302]];
  EXPECT_NEAR(middle.x, (whole[0].x + whole[1].x + whole[2].x) / 3, 1e-3);
  EXPECT_NEAR(middle.y, (whole[0].y + whole[1].y + whole[2].y) / 3, 1e-3);
  EXPECT_EQ(now.uvs[now.indices[300]], whole[0]);
}

TEST(Like, AnAddedPartTakesFreeRoomOrThePageGrows) {
  const Shape shape = torus(40, 24);
  for (const bool square : {false, true}) {
    UnwrapOptions options;
    options.square = square;
    options.page_size = 512;
    const UnwrappedMesh before = made_of(shape, options);
    const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
    for (const double size : {0.1, 3.0}) {
      Shape part = moved(box(4), size, {5, 0, 0});
      const Shape both = together(shape, part);
      const UnwrappedMesh now = unwrapped_like(both, earlier, options);
      ASSERT_FALSE(now.pages.empty());
      for (std::size_t t = 0; t < shape.triangle_count(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {  // texels stay
          const Vec2f was = uvs_of(before, t)[k], is = uvs_of(now, t)[k];
          ASSERT_NEAR(is.x * now.pages[0].width, was.x * before.pages[0].width, 1e-3);
          ASSERT_NEAR(is.y * now.pages[0].height, was.y * before.pages[0].height, 1e-3);
        }
      EXPECT_EQ(count(now, ChartOrigin::kept), before.charts.charts.size());
      EXPECT_GT(count(now, ChartOrigin::made), 0u);
      EXPECT_EQ(now.pages[0] == before.pages[0], size < 1);
      EXPECT_GE(now.pages[0].area(), before.pages[0].area());
      EXPECT_TRUE(!square || now.pages[0].width == now.pages[0].height);
      // The part has the density of the rest.
      for (const ChartPlacement& p : now.placements)
        EXPECT_NEAR(p.texels_per_unit.x, before.texels_per_unit, 0.01 * before.texels_per_unit);
    }
  }
}

TEST(Like, OfAnotherSizeOrWithoutUvsIsMadeAsNew) {
  const Shape shape = icosphere(2);
  const UnwrappedMesh before = made_of(shape), fresh = made_of(shape);
  std::vector<std::string> lines;
  Context context;
  context.warn = [&](std::string_view line) { lines.emplace_back(line); };
  const Shape large = moved(shape, 100);
  EarlierUvs earlier = earlier_uvs(view_of(large), before);
  EXPECT_EQ(unwrapped_like(shape, earlier, {}, context).uvs, fresh.uvs);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("no triangle lies where one did"), std::string::npos) << lines[0];
  earlier = earlier_uvs(view_of(shape), before);
  earlier.uvs = {};
  EXPECT_EQ(unwrapped_like(shape, earlier, {}, context).uvs, fresh.uvs);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NE(lines[1].find("no usable ones"), std::string::npos) << lines[1];
}

TEST(Like, UnusableUvsAreMadeAsNewAndTheOthersStay) {
  const Shape shape = together(torus(40, 24), moved(box(4), 1, {4, 0, 0}));
  const UnwrappedMesh before = made_of(shape);
  const std::size_t torus_triangles = torus(40, 24).triangle_count();
  const std::uint32_t bad = before.charts.triangle_chart[torus_triangles];  // of the box
  const auto spoil = [&](auto change) {
    UnwrappedMesh spoilt = before;
    std::vector<bool> done(spoilt.uvs.size(), false);
    for (std::size_t t = 0; t < shape.triangle_count(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = spoilt.indices[3 * t + k];
        if (spoilt.charts.triangle_chart[t] != bad || done[v]) continue;
        done[v] = true;
        change(spoilt.uvs[v]);
      }
    const EarlierUvs earlier = earlier_uvs(view_of(shape), spoilt);
    const UnwrappedMesh now = unwrapped_like(shape, earlier);
    std::size_t others = 0;
    std::vector<std::uint32_t> was = all(shape.triangle_count());
    for (std::size_t t = 0; t < was.size(); ++t)
      if (before.charts.triangle_chart[t] == bad)
        was[t] = kGone;
      else
        ++others;
    EXPECT_EQ(stayed_in_texels(before, now, was), others);  // the page may have grown
    EXPECT_GE(count(now, ChartOrigin::made), 1u);
  };
  spoil([](Vec2f& uv) { uv.x = std::numeric_limits<float>::quiet_NaN(); });
  spoil([](Vec2f& uv) { uv.x += 3; });          // beyond the page
  spoil([](Vec2f& uv) { uv = {0.5f, 0.5f}; });  // squeezed to a point
  const ChartPlacement& box = before.placements[bad];
  const float middle = float((box.x + box.width / 2.0) / before.pages[0].width);
  spoil([&](Vec2f& uv) { uv.x = middle - std::abs(uv.x - middle); });  // folded over
}

TEST(Like, OverlappingChartsOfAnotherProgramArePartedAndMirroredOnesStay) {
  const Shape one = grid(6, 6), shape = together(one, moved(one, 1, {3, 0, 0}));
  std::vector<Vec2f> uvs;
  for (const Vec3f p : shape.positions)  // both squares at one place
    uvs.push_back({0.4f * (p.x > 2 ? p.x - 3 : p.x), 0.4f * p.y});
  const std::vector<Extent> pages{{512, 512}};
  EarlierUvs earlier{shape.positions, shape.indices, uvs, shape.indices, {}, pages};
  const UnwrappedMesh now = unwrapped_like(shape, earlier);
  EXPECT_EQ(count(now, ChartOrigin::kept), 1u);
  EXPECT_EQ(count(now, ChartOrigin::made), 1u);
  EXPECT_EQ(now.pages, pages);

  for (std::size_t v = 0; v < uvs.size(); ++v)
    if (shape.positions[v].x > 2) uvs[v].x = 0.9f - uvs[v].x;
  earlier.uvs = uvs;
  UnwrapOptions options;
  options.like = &earlier;
  const UnwrappedMesh mirrored = made_of(shape, options);
  EXPECT_EQ(count(mirrored, ChartOrigin::kept), 2u);
  for (std::size_t i = 0; i < shape.indices.size(); ++i)
    ASSERT_EQ(mirrored.uvs[mirrored.indices[i]], uvs[shape.indices[i]]);
  EXPECT_EQ(mirrored.thin_triangles, 0u);
  EXPECT_EQ(mirrored.charts.flipped_triangles.size(), one.triangle_count());
}

TEST(Like, TrianglesThatDisagreeWithTheirNeighboursStay) {
  Shape shape = torus(40, 24);
  for (std::size_t t = 0; t < shape.triangle_count(); ++t)
    if (t % 160 < 70) std::swap(shape.indices[3 * t], shape.indices[3 * t + 1]);
  const UnwrappedMesh before = made_of(shape);
  EXPECT_GT(before.charts.flipped_triangles.size(), 100u);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  UnwrapOptions options;
  options.like = &earlier;
  const UnwrappedMesh now = made_of(shape, options);
  EXPECT_EQ(stayed(before, now, all(shape.triangle_count())), shape.triangle_count());
}

TEST(Like, AreTheSameForEveryThreadCount) {
  const Shape shape = torus(40, 24);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  const Shape changed = together(noisy(shape, 0.01, 9), moved(box(4), 0.2, {5, 0, 0}));
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  EXPECT_EQ(unwrapped_like(changed, earlier, {}, one).uvs,
            unwrapped_like(changed, earlier, {}, four).uvs);
}

TEST(Like, ABumpIsRepairedAroundIt) {
  const Shape shape = geodesic_sphere(16);
  const UnwrappedMesh before = made_of(shape);
  const EarlierUvs earlier = earlier_uvs(view_of(shape), before);
  Shape bump = shape;
  std::vector<bool> touched(shape.positions.size());
  for (std::size_t v = 0; v < touched.size(); ++v) {
    const Vec3f p = shape.positions[v];
    const double reach = std::hypot(p.x - 1, p.y, p.z) / 0.3, by = 0.1 * std::exp(-reach * reach);
    touched[v] = by > 5e-4;
    bump.positions[v] = {float(p.x * (1 + by)), float(p.y * (1 + by)), float(p.z * (1 + by))};
  }
  const UnwrappedMesh now = unwrapped_like(bump, earlier);
  std::vector<std::uint32_t> was = all(shape.triangle_count());
  std::size_t others = 0;
  for (std::size_t t = 0; t < was.size(); ++t) {
    const std::uint32_t* v = &shape.indices[3 * t];
    if (touched[v[0]] || touched[v[1]] || touched[v[2]])
      was[t] = kGone;
    else
      ++others;
  }
  EXPECT_LT(others, was.size());
  EXPECT_EQ(stayed(before, now, was), others);
  for (const Chart& chart : now.charts.charts) EXPECT_LE(chart.distortion.stretch_999, 1.2501);
}

TEST(Like, WorksForSeveralMeshesButNotForInstances) {
  const Shape a = torus(40, 24), b = moved(torus(40, 24), 1, {0.5f, 0, 0});
  const Shape both = together(a, b);
  const UnwrappedMesh before = made_of(both);
  const EarlierUvs earlier = earlier_uvs(view_of(both), before);
  UnwrapOptions options;
  options.like = &earlier;
  Atlas atlas, instanced;
  ASSERT_TRUE(atlas.add(view_of(a)).ok());
  ASSERT_TRUE(atlas.add(view_of(b)).ok());
  const Result<UnwrappedAtlas> made = atlas.unwrap(options, {});
  ASSERT_TRUE(made.ok()) << made.status().message();
  EXPECT_EQ(count(made->all(), ChartOrigin::made), 0u);
  ASSERT_TRUE(instanced.add_instances(view_of(a), 2).ok());
  const Result<UnwrappedAtlas> refused = instanced.unwrap(options, {});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.status().code(), ErrorCode::bad_option);
}

TEST(Like, MeshesThatLieOnEachOtherKeepTheirOwn) {
  const Shape a = torus(40, 24);
  Shape both = together(a, a);
  std::vector<std::uint32_t> objects(both.positions.size(), 0);
  std::fill(objects.begin() + std::ptrdiff_t(a.positions.size()), objects.end(), 1u);
  MeshView mesh = view_of(both);
  mesh.objects = objects;
  UnwrapOptions options;
  const Result<UnwrappedMesh> before = unwrap_mesh(mesh, options, {});
  ASSERT_TRUE(before.ok()) << before.status().message();
  EarlierUvs earlier = earlier_uvs(mesh, *before);
  options.like = &earlier;
  const Result<UnwrappedMesh> now = unwrap_mesh(mesh, options, {});
  ASSERT_TRUE(now.ok()) << now.status().message();
  EXPECT_EQ(stayed(*before, *now, all(both.triangle_count())), both.triangle_count());
  EXPECT_EQ(count(*now, ChartOrigin::kept), now->charts.charts.size());
  earlier.objects = earlier.objects.first(3);
  EXPECT_EQ(unwrap_mesh(mesh, options, {}).status().code(), ErrorCode::bad_input);
}

TEST(Like, ErrorsNameWhatIsWrong) {
  const Shape shape = box(2);
  const UnwrappedMesh before = made_of(shape);
  const auto message = [&](auto change) {
    EarlierUvs earlier = earlier_uvs(view_of(shape), before);
    UnwrapOptions options;
    change(earlier, options);
    options.like = &earlier;
    const Result<UnwrappedMesh> made = unwrap_mesh(view_of(shape), options, {});
    return made.ok() ? std::string("ok") : made.status().message();
  };
  EXPECT_NE(message([](EarlierUvs& e, UnwrapOptions&) { e.pages = {}; }).find("no page"),
            std::string::npos);
  EXPECT_NE(message([](EarlierUvs& e, UnwrapOptions&) { e.tolerance = -1; }).find("tolerance"),
            std::string::npos);
  EXPECT_NE(message([](EarlierUvs& e, UnwrapOptions&) {
              e.positions = e.positions.first(3);
            }).find("names none of the 3 positions"),
            std::string::npos);
  EXPECT_NE(message([](EarlierUvs&, UnwrapOptions& o) {
              o.charts.keep_uv_charts = true;
            }).find("like and keep_uv_charts"),
            std::string::npos);
}

}  // namespace
}  // namespace atlas::test
