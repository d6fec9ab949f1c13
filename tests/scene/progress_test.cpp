// What reading reports while it lasts, and where it can be cancelled.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

constexpr int kCornersASide = 250;  // corners of a grid along each side

std::string points(const char* before, const char* after) {
  std::string text;
  for (int y = 0; y < kCornersASide; ++y)
    for (int x = 0; x < kCornersASide; ++x) text += fmt::format("{}{} {} 0{}", before, x, y, after);
  return text;
}

// Calls add(a, b, c) for the triangles of the grid.
template <class Add>
void for_triangles(const Add& add) {
  for (int y = 0; y + 1 < kCornersASide; ++y) {
    for (int x = 0; x + 1 < kCornersASide; ++x) {
      const int a = y * kCornersASide + x;
      add(a, a + 1, a + kCornersASide);
      add(a + 1, a + kCornersASide + 1, a + kCornersASide);
    }
  }
}

std::string triangles(fmt::format_string<int, int, int> form, int first = 0) {
  std::string text;
  for_triangles(
      [&](int a, int b, int c) { text += fmt::format(form, a + first, b + first, c + first); });
  return text;
}

std::string text_stl() {
  std::string text = "solid s\n";
  for_triangles([&](int a, int b, int c) {
    text += "facet normal 0 0 1\nouter loop\n";
    for (const int v : {a, b, c})
      text += fmt::format("vertex {} {} 0\n", v % kCornersASide, v / kCornersASide);
    text += "endloop\nendfacet\n";
  });
  return text + "endsolid s\n";
}

std::string binary_stl() {
  std::string bytes(84, ' ');
  std::uint32_t count = 0;
  for_triangles([&](int a, int b, int c) {
    std::vector<float> n{0, 0, 1};
    for (const int v : {a, b, c})
      for (const int k : {v % kCornersASide, v / kCornersASide, 0}) n.push_back(float(k));
    bytes.append(reinterpret_cast<const char*>(n.data()), 48).append(2, '\0');
    ++count;
  });
  return bytes.replace(80, 4, reinterpret_cast<const char*>(&count), 4);
}

std::string glb() {
  Gltf g;
  std::vector<float> places;
  for (int v = 0; v < kCornersASide * kCornersASide; ++v)
    for (const int k : {v % kCornersASide, v / kCornersASide, 0}) places.push_back(float(k));
  std::vector<std::uint32_t> corners;
  for_triangles([&](int a, int b, int c) {
    for (const int v : {a, b, c}) corners.push_back(std::uint32_t(v));
  });
  g.single({{"attributes", {{"POSITION", g.floats(places, "VEC3", 3)}}},
            {"indices", g.indices(corners)}});
  return g.glb();
}

struct File {
  const char* name;
  std::string bytes;
};

std::vector<File> all_formats() {
  const int vertices = kCornersASide * kCornersASide,
            faces = 2 * (kCornersASide - 1) * (kCornersASide - 1);
  return {
      {"a.obj", points("v ", "\n") + triangles("f {} {} {}\n", 1)},
      {"a.ply", fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty "
                            "float y\nproperty float z\nelement face {}\nproperty list uchar int "
                            "vertex_indices\nend_header\n",
                            vertices, faces) +
                    points("", "\n") + triangles("3 {} {} {}\n")},
      {"a.off", fmt::format("OFF\n{} {} 0\n", vertices, faces) + points("", "\n") +
                    triangles("3 {} {} {}\n")},
      {"text.stl", text_stl()},
      {"binary.stl", binary_stl()},
      {"a.wrl", "#VRML V2.0 utf8\nShape { geometry IndexedFaceSet { coord Coordinate { point [" +
                    points("", ",") + "] } coordIndex [" + triangles("{} {} {} -1,") + "] } }\n"},
      {"a.glb", glb()}};
}

// The fractions rise from 0 to 1, with some between.
TEST(ReadingProgress, RisesInAllFormats) {
  const TempFolder folder;
  for (const auto& [name, bytes] : all_formats()) {
    const auto path = folder.write(name, bytes);
    std::vector<double> fractions;
    Context context;
    context.threads = 2;
    context.progress = [&](std::string_view stage, double fraction) {
      EXPECT_EQ(stage, "reading");
      fractions.push_back(fraction);
    };
    const auto loaded = read_scene(path, {}, context);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 2u * (kCornersASide - 1) * (kCornersASide - 1))
        << name;
    EXPECT_GE(fractions.size(), 6u) << name;
    for (std::size_t i = 1; i < fractions.size(); ++i)
      EXPECT_LE(fractions[i - 1], fractions[i]) << name;
    ASSERT_FALSE(fractions.empty());
    EXPECT_EQ(fractions.front(), 0) << name;
    EXPECT_EQ(fractions.back(), 1) << name;
  }
}

TEST(ReadingProgress, CanBeCancelledBetween) {
  const TempFolder folder;
  for (const auto& [name, bytes] : all_formats()) {
    const auto path = folder.write(name, bytes);
    for (const double when : {0.2, 0.5, 0.85}) {
      std::atomic<bool> cancelled = false;
      Context context;
      context.threads = 1;
      context.cancel = &cancelled;
      double last = 0;
      context.progress = [&](std::string_view, double fraction) {
        last = fraction;
        if (fraction >= when) cancelled = true;
      };
      EXPECT_EQ(read_scene(path, {}, context).status().code(), ErrorCode::cancelled)
          << name << " at " << when;
      EXPECT_LT(last, 1) << name;
    }
  }
}

// Light of another file is read in the same stage.
TEST(ReadingProgress, RisesThroughBothFiles) {
  const TempFolder folder;
  const std::vector<File> formats = all_formats();
  ReadOptions options;
  const std::string lit = points("v ", " 1 1 1\n") + triangles("f {} {} {}\n", 1);
  options.illumination_file = folder.write("light.obj", lit);
  std::vector<double> fractions;
  Context context;
  context.progress = [&](std::string_view, double fraction) { fractions.push_back(fraction); };
  ASSERT_TRUE(read_scene(folder.write("a.obj", formats[0].bytes), options, context).ok());
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.size(), 10u);
}

}  // namespace
}  // namespace atlas::test
