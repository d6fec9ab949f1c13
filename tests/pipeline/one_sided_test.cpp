// Thin sheets of two layers, from lit scene to written file: each side shows its own light alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/gltf_oracle.h"
#include "tests/support/temp_folder.h"
#include "tests/support/two_layers.h"

namespace atlas::test {
namespace {

struct Corner {
  double x, y, z, u, v;
};
struct WrittenTriangle {
  std::array<Corner, 3> corners;
  bool double_sided;
  std::string image;
};

// Exports the scene and reads what was written with a reader of its own.
class Exported {
 public:
  Exported(const LoadedScene& loaded, bool simplify) {
    ExportOptions options;
    options.target = folder_ / "w.gltf";
    options.simplify = simplify;
    options.packing = PackPreset::fast;
    options.tone.white = 60;
    const auto report = export_world(loaded, options, {}, {});
    EXPECT_TRUE(report.ok()) << report.status().message();
    if (!report.ok()) return;
    const GltfOracle file(options.target);
    for (const OracleTriangle& t : file.triangles()) {
      const auto& p = t.attributes.at("POSITION");
      const auto& uv = t.attributes.at("TEXCOORD_0");
      const nlohmann::json& material = file.document["materials"][std::size_t(t.material)];
      const std::size_t texture = material["pbrMetallicRoughness"]["baseColorTexture"]["index"];
      const std::size_t image = file.document["textures"][texture]["source"];
      WrittenTriangle w{
          {}, material.value("doubleSided", false), file.document["images"][image]["uri"]};
      for (std::size_t k = 0; k < 3; ++k)
        w.corners[k] = {p[3 * k], p[3 * k + 1], p[3 * k + 2], uv[2 * k], uv[2 * k + 1]};
      triangles_.push_back(w);
      if (!images_.contains(w.image)) {
        auto read = read_image8(folder_ / w.image);
        EXPECT_TRUE(read.ok()) << read.status().message();
        images_[w.image] = std::move(*read);
      }
    }
  }

  std::size_t one_sided() const {
    return std::size_t(std::count_if(triangles_.begin(), triangles_.end(),
                                     [](const WrittenTriangle& t) { return !t.double_sided; }));
  }
  std::size_t count() const { return triangles_.size(); }

  // Returns what a viewer straight above or below a point sees there: the values of all triangles
  // that are not culled.
  std::vector<int> seen(double x, double y, bool from_above) const {
    std::vector<int> values;
    for (const WrittenTriangle& t : triangles_) {
      const auto& [a, b, c] = t.corners;
      const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      if (!t.double_sided && (area > 0) != from_above) continue;
      const double wb = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
      const double wc = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
      const double wa = 1 - wb - wc;
      if (std::min({wa, wb, wc}) < 0) continue;
      const Image8& image = images_.at(t.image);
      const double u = wa * a.u + wb * b.u + wc * c.u, v = 1 - (wa * a.v + wb * b.v + wc * c.v);
      values.push_back(*image.at(int(u * image.width), int(v * image.height)));
    }
    return values;
  }

 private:
  TempFolder folder_;
  std::vector<WrittenTriangle> triangles_;
  std::map<std::string, Image8> images_;
};

// Points that lie on no edge of the layers.
std::vector<std::array<double, 2>> points(double width) {
  std::vector<std::array<double, 2>> result;
  for (double y = 0.0613; y < 0.95; y += 0.0971)
    for (double x = 0.0517; x < width - 0.05; x += 0.0871) result.push_back({x, y});
  return result;
}

// Expects that bright light is all that is seen from above, and dim light from below.
void expect_own_light(const Exported& world, double width) {
  for (const auto& [x, y] : points(width)) {
    for (const bool above : {true, false}) {
      const std::vector<int> seen = world.seen(x, y, above);
      EXPECT_FALSE(seen.empty()) << "a hole at " << x << ' ' << y << ", above: " << above;
      for (const int value : seen) {
        if (above)
          EXPECT_GT(value, 200) << x << ' ' << y;
        else
          EXPECT_LT(value, 80) << x << ' ' << y;
      }
    }
  }
}

TEST(OneSided, EachSideOfASheetShowsItsOwnLight) {
  const Height flat = [](double, double) { return 0.0; };
  const Height slanted = [](double x, double y) { return 0.31 * x + 0.77 * y; };
  const Height curved = [](double x, double) { return 0.2 * std::sin(3 * x); };
  Layer other = kBelow, coarser = kBelow;
  other.other_diagonals = true;
  coarser.cells = 5;
  for (const bool simplify : {true, false}) {
    SCOPED_TRACE(simplify ? "simplified" : "fine");
    expect_own_light(Exported(sheet({}, kBelow, flat), simplify), 1);
    expect_own_light(Exported(sheet({}, other, flat), simplify), 1);
    expect_own_light(Exported(sheet({}, coarser, flat), simplify), 1);
    expect_own_light(Exported(sheet({}, other, slanted), simplify), 1);
    expect_own_light(Exported(sheet({}, coarser, slanted), simplify), 1);
    expect_own_light(Exported(sheet({}, kBelow, curved), simplify), 1);
  }
}

// Half of the layer above has nothing below it, so it must be seen from below as well.
TEST(OneSided, WhereASheetHasOneLayerBothSidesShowIt) {
  const Height flat = [](double, double) { return 0.0; };
  const Layer wide{.width = 2};
  const Exported fine(sheet(wide, kBelow, flat), false);
  expect_own_light(fine, 1);
  EXPECT_EQ(fine.one_sided(), fine.count() * 2 / 3);
  const Exported coarse(sheet(wide, kBelow, flat), true);
  for (const Exported* world : {&fine, &coarse}) {
    for (const auto& [x, y] : points(2))
      for (const bool above : {true, false})
        EXPECT_FALSE(world->seen(x, y, above).empty()) << x << ' ' << y << ' ' << above;
    EXPECT_EQ(world->seen(1.5217, 0.5131, false).size(), 1u);
  }
}

// A plate with a thickness, layers of one orientation, a box on a floor and a room with a ball.
TEST(OneSided, OtherScenesStayDoubleSided) {
  const Height flat = [](double, double) { return 0.0; };
  Layer same = kBelow;
  same.from_above = true;
  EXPECT_EQ(Exported(sheet({}, same, flat), true).one_sided(), 0u);
  LoadedScene plate = sheet({}, kBelow, flat);
  for (std::size_t i = plate.scene.positions.size() / 2; i < plate.scene.positions.size(); ++i)
    plate.scene.positions[i].z = -1e-4f;
  EXPECT_EQ(Exported(plate, true).one_sided(), 0u);
  EXPECT_EQ(Exported(lit_room(12), true).one_sided(), 0u);
  const Shape on_floor = together(grid(40, 40, 10, 10), moved(box(3), 1, {4.1, 4.1, 0}));
  EXPECT_EQ(Exported(lit_scene(on_floor), true).one_sided(), 0u);
}

}  // namespace
}  // namespace atlas::test
