#include "libatlas/raster/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "libatlas/raster/sampling.h"
#include "tests/raster/random_triangles.h"

namespace atlas {
namespace {

struct Covered {
  double area = 0;
  Vec2d centroid;
};
using Cover = std::map<std::pair<int, int>, Covered>;

Cover cover(const TexelTriangle& t, const Rect& clip) {
  Cover out;
  cover_triangle(t, clip, [&](int x, int y, double area, Vec2d c) {
    EXPECT_TRUE(out.emplace(std::pair{x, y}, Covered{area, c}).second) << "twice";
    EXPECT_GT(area, 0);
    EXPECT_LE(area, 1 + 1e-12);
    EXPECT_TRUE(x >= clip.x && x < clip.right() && y >= clip.y && y < clip.top());
    EXPECT_TRUE(c.x > x - 1e-6 && c.x < x + 1 + 1e-6 && c.y > y - 1e-6 && c.y < y + 1 + 1e-6);
  });
  return out;
}

TEST(CoverTriangle, AreasAndCentroidsAddUpToTheTriangle) {
  for (const TexelTriangle& t : random_triangles(5000, 4, 40)) {
    const Cover c = cover(t, {-200, -200, 600, 600});
    double area = 0, x = 0, y = 0;
    for (const auto& [at, part] : c) {
      area += part.area;
      x += part.area * part.centroid.x;
      y += part.area * part.centroid.y;
    }
    const double want = 0.5 * std::fabs(cross_area(t));
    ASSERT_NEAR(area, want, 1e-9 * (1 + want));
    if (want < 1e-6) continue;
    ASSERT_NEAR(x / area, (t[0].x + t[1].x + t[2].x) / 3, 1e-5);
    ASSERT_NEAR(y / area, (t[0].y + t[1].y + t[2].y) / 3, 1e-5);
  }
}

TEST(CoverTriangle, EachTexelsShareAgreesWithSupersampling) {
  constexpr int kSide = 64;
  const Rect clip{2, 3, 9, 8};
  int texels = 0;
  for (const TexelTriangle& t : random_triangles(150, 5, 12)) {
    if (cross_area(t) == 0) continue;
    const Cover c = cover(t, clip);
    for (int y = clip.y; y < clip.top(); ++y)
      for (int x = clip.x; x < clip.right(); ++x) {
        int inside = 0;
        for (int j = 0; j < kSide; ++j)
          for (int i = 0; i < kSide; ++i) {
            const Vec2d p{x + (i + 0.5) / kSide, y + (j + 0.5) / kSide};
            int sign[2] = {0, 0};
            for (int k = 0; k < 3; ++k) ++sign[cross_area({t[k], t[(k + 1) % 3], p}) > 0];
            inside += sign[0] == 0 || sign[1] == 0;
          }
        const auto it = c.find({x, y});
        const double got = it == c.end() ? 0 : it->second.area;
        // A straight edge crosses about 2 * kSide of the samples' cells at most.
        ASSERT_NEAR(got, inside / double(kSide * kSide), 3.0 / kSide) << x << ' ' << y;
        ++texels;
      }
  }
  EXPECT_GT(texels, 1000);
}

TEST(CoverTriangle, TrianglesOfATessellationFillEachTexelOnce) {
  // A jittered grid of triangles that are much finer than texels, about as fine, or much coarser.
  for (const double cell : {0.13, 0.9, 5.7}) {
    const int n = static_cast<int>(std::ceil(20 / cell));
    std::mt19937 random(6);
    std::vector<Vec2d> v;
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const bool rim = i == 0 || j == 0 || i == n || j == n;
        const auto jitter = [&] {
          return rim ? 0.0 : cell * 0.15 * ((random() % 1000) / 500.0 - 1);
        };
        v.push_back({20.0 * i / n + jitter(), 20.0 * j / n + jitter()});
      }
    std::map<std::pair<int, int>, double> sum;
    const auto add = [&](int a, int b, int c) {
      cover_triangle({v[a], v[b], v[c]}, {0, 0, 20, 20}, [&](int x, int y, double area, Vec2d) {
        sum[{x, y}] += area;
      });
    };
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = j * (n + 1) + i;
        add(a, a + 1, a + n + 2);
        add(a, a + n + 2, a + n + 1);
      }
    EXPECT_EQ(sum.size(), 400u);
    for (const auto& [at, area] : sum) ASSERT_NEAR(area, 1, 1e-9);
  }
}

TEST(CoverTriangle, TrianglesWithoutAreaCoverNothing) {
  const Rect clip{0, 0, 8, 8};
  EXPECT_TRUE(cover({Vec2d{1, 1}, {5, 5}, {3, 3}}, clip).empty());
  EXPECT_TRUE(cover({Vec2d{1, 1}, {1, 1}, {1, 1}}, clip).empty());
  EXPECT_TRUE(cover({Vec2d{0, 2}, {7, 2}, {4, 2}}, clip).empty());
  EXPECT_TRUE(cover({Vec2d{20, 20}, {30, 20}, {20, 30}}, clip).empty());
}

}  // namespace
}  // namespace atlas
