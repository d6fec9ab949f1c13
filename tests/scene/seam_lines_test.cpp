// Seams from the polylines of OBJ files.
#include "libatlas/scene/seam_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

// Two triangles of a square; the diagonal is their common edge.
Scene square_scene() {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}};
  scene.indices = {0, 1, 2, 4, 2, 3};  // vertex 4 lies where 0 does
  return scene;
}

Result<SeamLines> read_lines(const std::string& text, const Scene& scene = square_scene()) {
  const TempFolder folder;
  return read_seam_lines(folder.write("seams.obj", text), scene);
}

TEST(SeamLines, MarkBothSidesOfAnEdge) {
  const auto seams = read_lines("o seams\nv 1 1 0\nv 0.000001 0 0 0.5 0.5 0.5\nl 1 2\n");
  ASSERT_TRUE(seams.ok()) << seams.status().message();
  EXPECT_EQ(seams->edges, (std::vector<std::uint8_t>{0, 0, 1, 1, 0, 0}));
  EXPECT_EQ(seams->segments, 1u);
  EXPECT_EQ(seams->found, 1u);
}

TEST(SeamLines, LinesOfSeveralVerticesAndNumbersFromTheEndAreRead) {
  const auto seams =
      read_lines("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nl 1/1 2/2 -1\nl 2 1\nv 9 9 9\n");
  ASSERT_TRUE(seams.ok()) << seams.status().message();
  EXPECT_EQ(seams->edges, (std::vector<std::uint8_t>{1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(seams->segments, 3u);
}

TEST(SeamLines, SegmentsThatAreNoEdgesAreCounted) {
  const auto seams =
      read_lines("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nl 1 2\nl 3 4\nl 1 5\n");
  ASSERT_TRUE(seams.ok());
  EXPECT_EQ(seams->segments, 3u);
  EXPECT_EQ(seams->found, 1u);
}

TEST(SeamLines, AreInTheCoordinatesOfTheFile) {
  Scene scene = square_scene();
  scene.origin = {1000000, 0, 0};
  const auto seams = read_lines("v 1000000 0 0\nv 1000001 1 0\nl 1 2\n", scene);
  ASSERT_TRUE(seams.ok()) << seams.status().message();
  EXPECT_EQ(std::count(seams->edges.begin(), seams->edges.end(), 1), 2);
}

TEST(SeamLines, ErrorsNameTheLine) {
  const auto message = [](const std::string& text) {
    const auto seams = read_lines(text);
    return seams.ok() ? std::string() : seams.status().message();
  };
  EXPECT_NE(message("v 0 0 0\nv 1 1\nl 1 2\n").find(":2: three finite numbers"), std::string::npos);
  EXPECT_NE(message("v 0 0 0\nv 1 nan 1\nl 1 2\n").find(":2: "), std::string::npos);
  EXPECT_NE(message("v 0 0 0\nl 1 2\n").find(":2: a polyline names vertex 2 of 1"),
            std::string::npos);
  EXPECT_NE(message("v 0 0 0\nl 1 x\n").find(":2: numbers of vertices"), std::string::npos);
  EXPECT_NE(message("v 0 0 0\nl 1\n").find(":2: a polyline needs two"), std::string::npos);
  EXPECT_NE(message("v 0 0 0\n").find("no polyline"), std::string::npos);
  EXPECT_NE(message("v 0 0 0\nv 5 5 5\nl 1 2\n").find("none of the 1 segments"), std::string::npos);
  EXPECT_EQ(read_seam_lines("/nowhere/seams.obj", square_scene()).status().code(),
            ErrorCode::not_found);
}

}  // namespace
}  // namespace atlas
