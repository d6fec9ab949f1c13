#include "libatlas/pipeline/light_seams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "tests/scene/temp_folder.h"

namespace atlas::test {
namespace {

using LightAt = std::function<double(Vec3f position)>;

// A scene of sheets, each with vertices of its own.
class Sheets {
 public:
  Sheets() { loaded_.scene.materials.push_back({"white", {1, 1, 1}, -1}); }

  // Adds n x n quads over the parallelogram at `from` along u and v, facing u x v.
  Sheets& add(Vec3f from, Vec3f u, Vec3f v, int n, const LightAt& light) {
    Scene& scene = loaded_.scene;
    const auto base = static_cast<std::uint32_t>(scene.positions.size());
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const float a = float(i) / float(n), b = float(j) / float(n);
        const Vec3f p{from.x + a * u.x + b * v.x, from.y + a * u.y + b * v.y,
                      from.z + a * u.z + b * v.z};
        const auto e = static_cast<float>(light(p));
        scene.positions.push_back(p);
        scene.illumination.push_back({e, e, e});
      }
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const auto a = base + std::uint32_t(j * (n + 1) + i), c = a + std::uint32_t(n) + 1;
        scene.indices.insert(scene.indices.end(), {a, a + 1, c + 1, a, c + 1, c});
        scene.triangle_material.insert(scene.triangle_material.end(), 2, 0);
      }
    }
    return *this;
  }

  const LoadedScene& loaded() const { return loaded_; }

  LightSeams seams(double texel = 0.001) const {
    const LuminanceSampler sampler(loaded_.scene, Quantity::illuminance);
    LightSeamOptions options;
    options.texel = texel;
    return find_light_seams(sampler, ToneMapping{}, options, {});
  }

 private:
  LoadedScene loaded_;
};

LightAt constant(double e) {
  return [e](Vec3f) { return e; };
}

// A floor over [0, 1]² and a wall at its side x = 1, of height 1.
Sheets corner(int n, const LightAt& floor, const LightAt& wall) {
  return Sheets()
      .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, n, floor)
      .add({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, n, wall);
}

TEST(LightSeams, AreTheCreasesWhereLightJumps) {
  const Sheets sheets = corner(4, constant(0.8), constant(0.3));
  const LightSeams seams = sheets.seams();
  EXPECT_NEAR(seams.length, 1, 1e-6);
  const Scene& scene = sheets.loaded().scene;
  ASSERT_EQ(seams.edges.size(), scene.indices.size());
  for (std::uint32_t h = 0; h < seams.edges.size(); ++h) {
    const std::uint32_t next = h % 3 == 2 ? h - 2 : h + 1;
    const Vec3f a = scene.positions[scene.indices[h]], b = scene.positions[scene.indices[next]];
    const bool along = a.x == 1 && b.x == 1 && a.z == 0 && b.z == 0;
    EXPECT_EQ(seams.edges[h] != 0, along) << h;
  }
}

TEST(LightSeams, AreNotWhereLightContinuesOrTheJumpIsNotVisible) {
  EXPECT_TRUE(corner(4, constant(0.5), constant(0.5)).seams().edges.empty());
  EXPECT_TRUE(corner(4, constant(0.5), constant(0.48)).seams().edges.empty());
  EXPECT_FALSE(corner(4, constant(0.5), constant(0.4)).seams().edges.empty());
  // Above white both are white.
  EXPECT_TRUE(corner(4, constant(5), constant(50)).seams().edges.empty());
  // A floor that continues as a floor, with other light.
  EXPECT_TRUE(Sheets()
                  .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.8))
                  .add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, constant(0.2))
                  .seams()
                  .edges.empty());
}

TEST(LightSeams, RunAlongAWholeCreaseOrNotAtAll) {
  const LightAt half = [](Vec3f p) { return p.y > 0.45 ? 0.2 : 0.5; };
  EXPECT_NEAR(corner(16, constant(0.5001), half).seams().length, 1, 1e-6);
  const LightAt end = [](Vec3f p) { return p.y > 0.9 ? 0.2 : 0.5; };
  EXPECT_EQ(corner(16, constant(0.5001), end).seams().length, 0);
}

TEST(LightSeams, LeaveFacesTogetherThatAreFewTexelsWide) {
  const Sheets leg = Sheets()
                         .add({0, 0, 0}, {0.02f, 0, 0}, {0, 1, 0}, 4, constant(0.8))
                         .add({0.02f, 0, 0}, {0, 0, 0.02f}, {0, 1, 0}, 4, constant(0.3));
  EXPECT_NEAR(leg.seams(0.005).length, 1, 1e-6);  // width: 2 area / seam = 8 texels
  EXPECT_EQ(leg.seams(0.0101).length, 0);
}

// Floor, floor beyond and a wall between the two: the floors continue each other.
TEST(LightSeams, OfThreeSheetsAtAnEdgeThoseThatContinueEachOtherStayTogether) {
  const Sheets sheets = Sheets()
                            .add({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, constant(0.8))
                            .add({1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, constant(0.8))
                            .add({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 2, constant(0.2));
  const LightSeams seams = sheets.seams();
  EXPECT_NEAR(seams.length, 1, 1e-6);
  for (std::uint32_t h = 0; h < 2 * 8 * 3; ++h) EXPECT_EQ(seams.edges[h], 0) << h;
}

// Light that is constant per facet jumps at all edges of a smooth surface.
TEST(LightSeams, DoNotShatterSmoothSurfaces) {
  Sheets tube;
  constexpr int kSides = 32;
  for (int i = 0; i < kSides; ++i) {
    const auto at = [](int k) {
      return Vec3f{float(std::cos(2 * M_PI * k / kSides)), float(std::sin(2 * M_PI * k / kSides)),
                   0};
    };
    const Vec3f a = at(i), b = at((i + 1) % kSides);
    tube.add(a, {b.x - a.x, b.y - a.y, 0}, {0, 0, 1}, 1, constant(i % 2 ? 0.8 : 0.2));
  }
  EXPECT_TRUE(tube.seams().edges.empty());
}

TEST(LightSeams, DoNotDependOnThePlaceOfTheScene) {
  Sheets moved;
  moved.add({-1, 7, 3}, {1, 0, 0}, {0, 1, 0}, 3, constant(0.8))
      .add({0, 7, 3}, {0, 0, 1}, {0, 1, 0}, 3, constant(0.3));
  EXPECT_EQ(moved.seams().edges, corner(3, constant(0.8), constant(0.3)).seams().edges);
}

TEST(LightSeams, KeepTheJumpSharpInTheWorld) {
  const TempFolder folder;
  const LightAt floor = [](Vec3f p) { return 0.8 + 0.1 * p.y; };
  const LightAt wall = [](Vec3f p) { return 0.2 + 0.05 * p.z; };
  const Sheets sheets = corner(16, floor, wall);
  ExportOptions options;
  options.target = folder / "w.obj";
  options.atlases = 1;
  options.atlas_size = 512;
  options.texel_metres = 0.01;
  options.tone.white = 1;
  const auto apart = export_world(sheets.loaded(), options, {}, {});
  options.split_at_light = false;
  const auto together = export_world(sheets.loaded(), options, {}, {});
  ASSERT_TRUE(apart.ok()) << apart.status().message();
  ASSERT_TRUE(together.ok()) << together.status().message();
  EXPECT_EQ(apart->charts.size(), 2u);
  EXPECT_NEAR(apart->light_seam_length, 1, 1e-6);
  EXPECT_EQ(together->charts.size(), 1u);
  EXPECT_EQ(together->light_seam_length, 0);
  EXPECT_GT(apart->fidelity.psnr, together->fidelity.psnr + 10);
  EXPECT_LT(apart->fidelity.maximum, 0.01);
}

}  // namespace
}  // namespace atlas::test
