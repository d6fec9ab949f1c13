// VRML97: what DEF and USE repeat, and how much of it a file may.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/scene/vrml_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Places;
using test::places;
using test::read;
using test::scene_of;
using test::shape;
using test::TempFolder;

TEST(Vrml, UseRepeatsWhatTheLastDefBeforeItNames) {
  const TempFolder folder;
  EXPECT_EQ(places(folder, "DEF a " + shape(1) + "Transform { translation 5 0 0 children USE a }"),
            (Places{1, 6}));
  EXPECT_EQ(places(folder, "DEF a " + shape(1) + "DEF g Group { children [ USE a DEF a " +
                               shape(2) + "USE a ] } USE a USE g"),
            (Places{1, 1, 2, 2, 2, 1, 2, 2}))
      << "what stands in g is what it was when it was read";
  const std::string face_set =
      "IndexedFaceSet { coord USE c texCoord USE t coordIndex [ 0 1 2 -1 ] }";
  const Scene scene = scene_of(
      folder,
      "Shape { geometry IndexedLineSet { coord DEF c Coordinate { point [ 7 0 0 7 1 0 7 0 1 ] } } "
      "}\n"
      "Shape { geometry IndexedFaceSet { texCoord DEF t TextureCoordinate { point [ 1 2 3 4 5 6 ] "
      "} } }\n"
      "Shape { geometry DEF f " +
          face_set + " } Shape { geometry USE f }");
  EXPECT_EQ(places(scene), (Places{7, 7}));
  EXPECT_EQ(scene.texcoords[scene.texcoord_indices[4]], (Vec2f{3, 4}));
}

TEST(Vrml, UseOfNothingOrWithoutEndIsRefused) {
  const TempFolder folder;
  const auto message = [&](const std::string& nodes) {
    const auto loaded = read(folder, nodes);
    EXPECT_FALSE(loaded.ok());
    EXPECT_EQ(loaded.status().code(), ErrorCode::bad_input);
    return loaded.status().message();
  };
  const std::string early = message("Group { children\nUSE a }\nDEF a " + shape(0));
  EXPECT_NE(early.find("a.wrl:3: USE of 'a', which no DEF before it names"), std::string::npos)
      << early;
  const std::string circle = message("DEF a Group { children [ USE a USE a ] }");
  EXPECT_NE(circle.find("nested too deeply"), std::string::npos) << circle;
  std::string bomb = "DEF a0 Group { }";
  for (int i = 0; i < 100; ++i)
    bomb += fmt::format(
        "DEF a{} Switch {{ whichChoice 0 choice Group {{ children [ USE a{} USE "
        "a{} ] }} }}\n",
        i + 1, i, i);
  const double begun = cpu_seconds();
  const std::string much = message("Switch { choice [\n" + bomb + "] } USE a100");
  EXPECT_NE(much.find("a.wrl:103: USE repeats more than the 64 MiB of text that are read of "
                      "this file (make several files of it, or show less by USE; "
                      "ReadOptions::limits lifts the limit)"),
            std::string::npos)
      << much;
  EXPECT_LT(cpu_seconds() - begun, 1);
}

// A thousand triangles, repeated 131 072 times, would take 10 GB of memory.
TEST(Vrml, SmallFilesCannotFillTheMemoryWithUse) {
  const TempFolder folder;
  std::string nodes =
      "Switch { choice [ DEF a0 Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 "
      "1 0 0 0 1 0 ] } "
      "coordIndex [ ";
  for (int i = 0; i < 1000; ++i) nodes += "0 1 2 -1 ";
  nodes += "] } }\n";
  for (int i = 0; i < 17; ++i)
    nodes += fmt::format("DEF a{} Group {{ children [ USE a{} USE a{} ] }}\n", i + 1, i, i);
  const double begun = cpu_seconds();
  const auto loaded = read(folder, nodes + "] } USE a17");
  ASSERT_FALSE(loaded.ok());
  const std::string& message = loaded.status().message();
  EXPECT_NE(message.find("USE repeats more than the 64 MiB"), std::string::npos) << message;
  EXPECT_LT(cpu_seconds() - begun, 1);
}

// A scene of 150 MB, had it been written out. Sixteen million triangles are about as much.
TEST(Vrml, SmallFilesMayMeanLargeScenes) {
  const TempFolder folder;
  std::string nodes = "DEF a Group { children [ " + shape(0) + " WorldInfo { info \"" +
                      std::string(100'000, 'x') + "\" } ] }\n";
  for (int i = 0; i < 1500; ++i) nodes += "USE a ";
  ASSERT_FALSE(read(folder, nodes).ok());
  const auto loaded =
      read_scene(folder.write("a.wrl", "#VRML V2.0 utf8\n" + nodes), {.limits = false}, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1501u);
}

// What is repeated is counted before any of it is copied, also where single nodes repeat little.
TEST(Vrml, RepetitionsAreCountedBeforeTheyAreRead) {
  const TempFolder folder;
  std::string nodes = "DEF a0 " + shape(0);
  for (int i = 0; i < 9; ++i)
    nodes += fmt::format("DEF a{0} Group {{ children [ USE a{1} USE a{1} USE a{1} USE a{1} ] }}\n",
                         i + 1, i);
  for (int i = 0; i < 20; ++i) nodes += "USE a8 Shape { appearance NULL geometry USE a0 }\n";
  const double begun = cpu_seconds();
  EXPECT_FALSE(read(folder, nodes).ok());
  EXPECT_LT(cpu_seconds() - begun, 0.3);
}

// Brackets within brackets are passed over once, not once for each pair around them.
TEST(Vrml, DeepGroupsTakeNoLonger) {
  const TempFolder folder;
  const auto seconds = [&](int depth) {
    std::string nodes;
    for (int i = 0; i < depth; ++i) nodes += "Group { children [\n";
    nodes += "WorldInfo { info [ ";
    for (int i = 0; i < 100'000; ++i) nodes += "\"a\" \"b\"\n";
    nodes += "] } " + shape(0);
    for (int i = 0; i < depth; ++i) nodes += "] }";
    const double begun = cpu_seconds();
    EXPECT_TRUE(read(folder, nodes).ok());
    return cpu_seconds() - begun;
  };
  seconds(1);
  EXPECT_LT(seconds(190), 10 * seconds(1));
}

// A hidden node may repeat without end, and it does not hide how much other nodes repeat.
TEST(Vrml, WhatUseRepeatsIsCountedForEachNode) {
  const TempFolder folder;
  std::string nodes = "Switch { choice [ DEF a0 Group { children [ Group { } ] }\n";
  for (int i = 0; i < 2000; ++i)
    nodes += fmt::format("DEF a{} Group {{ children [ USE a{} USE a{} ] }}\n", i + 1, i, i);
  nodes += "DEF b0 " + shape(0) + "\n";
  for (int i = 0; i < 30; ++i)
    nodes += fmt::format("DEF b{} Group {{ children [ USE b{} USE b{} ] }}\n", i + 1, i, i);
  nodes += "] }\n";
  const auto few = read(folder, nodes + "USE b3");
  ASSERT_TRUE(few.ok()) << few.status().message();
  EXPECT_EQ(few->scene.triangle_count(), 8u);
  EXPECT_FALSE(read(folder, nodes + "USE b30").ok());
  EXPECT_FALSE(read(folder, nodes + "USE a2000").ok());
  EXPECT_FALSE(read(folder, nodes + "USE b3 DEF c Group { children [ USE a2000 ] } USE c").ok());
}

}  // namespace
}  // namespace atlas
