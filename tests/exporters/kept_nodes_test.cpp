// Tests a World::scene that was read from glTF: its nodes, each of which shows a mesh in one place.
#include <gtest/gtest.h>

#include <set>

#include "libatlas/scene/reader.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using std::filesystem::path;

// Each place of a mesh has charts of its own, so it gets a mesh of its own.
TEST(KeptGltf, InstancesBecomeNodes) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int places = gltf.floats({0, 0, 0, 5, 0, 0, 0, 0, 9}, "VEC3", 3);
  const int scales = gltf.floats({1, 1, 1, -1, 1, 1, 2, 2, 2}, "VEC3", 3);
  const json instancing = {
      {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}, {"SCALE", scales}}}}}};
  gltf.single({{"attributes", {{"POSITION", positions}}}},
              {{"name", "tree"}, {"extensions", instancing}, {"scale", {3, 3, 3}}});
  gltf.j["extensionsRequired"] = gltf.j["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const path input = folder.write("s.glb", gltf.glb());
  EXPECT_TRUE(keep(input, folder / "w.glb").not_kept.empty());
  const GltfOracle after(folder / "w.glb");
  EXPECT_FALSE(after.document.contains("extensionsUsed") ||
               after.document.contains("extensionsRequired"));
  const auto triangles = after.triangles();
  ASSERT_EQ(triangles.size(), 3u);
  EXPECT_EQ(triangles[0].node, "tree_0");
  EXPECT_EQ(triangles[1].matrix[12], 15);
  EXPECT_EQ(triangles[1].matrix[0], -3);
  EXPECT_EQ(triangles[2].matrix[0], 6);
  EXPECT_EQ(triangles[2].matrix[14], 27);
  std::set<double> first;
  for (const auto& t : triangles) first.insert(t.attributes.at("TEXCOORD_1")[0]);
  EXPECT_EQ(first, (std::set<double>{0, 5.0 / 64, 6.0 / 64}));  // the second is mirrored
}

// Nodes cannot have attributes, so those of instances that only programs know are counted, once for
// a node that two parents show.
TEST(KeptGltf, WhatElseInstancesHaveIsCounted) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int places = gltf.floats({0, 0, 0, 5, 0, 0}, "VEC3", 3);
  const int ids = gltf.floats({1, 2}, "SCALAR", 1);
  const int colours = gltf.floats({1, 0, 0, 0, 0, 1}, "VEC3", 3);
  const json instancing = {
      {"EXT_mesh_gpu_instancing",
       {{"attributes", {{"TRANSLATION", places}, {"_ID", ids}, {"_COLOR_0", colours}}},
        {"extras", {{"species", "oak"}}}}}};
  gltf.single({{"attributes", {{"POSITION", positions}}}}, {{"extensions", instancing}});
  gltf.j["nodes"].push_back({{"children", {0}}, {"translation", {10, 0, 0}}});
  gltf.j["nodes"].push_back({{"children", {0, 1}}});
  gltf.j["scenes"][0]["nodes"] = {2};
  const WorldFile written = keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  EXPECT_EQ(written.triangles, 4u);
  EXPECT_EQ(written.not_kept,
            (std::vector<std::string>{
                "2 x attributes of instances other than their places (EXT_mesh_gpu_instancing)",
                "1 x extras of instances (EXT_mesh_gpu_instancing)"}));
}

// Weights of morph targets go with the mesh. A node without a name has instances without names, and
// an instance that stays in its place needs no matrix.
TEST(KeptGltf, InstancesHaveTheWeightsOfTheirNode) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int places = gltf.floats({0, 0, 0, 5, 0, 0}, "VEC3", 3);
  const json instancing = {
      {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}};
  gltf.single({{"attributes", {{"POSITION", positions}}},
               {"targets", json::array({{{"POSITION", positions}}})}},
              {{"weights", {0.5}}, {"extensions", instancing}});
  keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  const json nodes = GltfOracle(folder / "w.glb").document["nodes"];
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0], (json{{"children", {1, 2}}}));
  for (const std::size_t n : {1, 2}) {
    EXPECT_EQ(nodes[n]["weights"], json{0.5});
    EXPECT_FALSE(nodes[n].contains("name"));
    EXPECT_EQ(nodes[n].contains("matrix"), n == 2);
  }
}

// An animation of the weights moves all instances. Nodes that are animated have no matrix.
TEST(KeptGltf, AnimationsOfWeightsMoveTheInstances) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const float h = std::sqrt(0.5f);
  const json attributes = {
      {"TRANSLATION", gltf.floats({0, 0, 0, 5, 0, 0, 1, 2, 3, 0, 0, 9}, "VEC3", 3)},
      {"ROTATION", gltf.floats({0, 0, 0, 1, h, 0, 0, h, 0, h, 0, -h, 0, 0, 1, 0}, "VEC4", 4)},
      {"SCALE", gltf.floats({1, 1, 1, 2, 3, 4, 1, -2, 1, -1, -2, -3}, "VEC3", 3)}};
  gltf.single({{"attributes", {{"POSITION", positions}}},
               {"targets", json::array({{{"POSITION", positions}}})}},
              {{"weights", {0.5}},
               {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
  gltf.j["nodes"].push_back({{"mesh", 0}});
  gltf.j["scenes"][0]["nodes"] = {0, 1};
  keep(folder.write("s.glb", gltf.glb()), folder / "rest.glb");
  json by_pointer = {{"sampler", 0}, {"target", {{"path", "pointer"}}}};
  by_pointer["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = "/nodes/0/weights/0";
  const auto channel = [](int node, const char* path) {
    return json{{"sampler", 0}, {"target", {{"path", path}, {"node", node}}}};
  };
  const int times = gltf.floats({0, 1}, "SCALAR", 1);
  gltf.j["animations"] = json::array(
      {{{"samplers", json::array({{{"input", times}, {"output", times}}})},
        {"channels",
         {channel(0, "weights"), channel(1, "weights"), channel(0, "scale"), by_pointer}}}});
  EXPECT_TRUE(keep(folder.write("s.glb", gltf.glb()), folder / "w.glb").not_kept.empty());
  const GltfOracle rest(folder / "rest.glb"), after(folder / "w.glb");
  json expected = json::array();
  for (const int n : {2, 3, 4, 5}) expected.push_back(channel(n, "weights"));
  expected.insert(expected.end(), {channel(1, "weights"), channel(0, "scale")});
  for (const char* n : {"2", "3", "4", "5"}) {
    by_pointer["target"]["extensions"]["KHR_animation_pointer"]["pointer"] =
        std::string("/nodes/") + n + "/weights/0";
    expected.push_back(by_pointer);
  }
  EXPECT_EQ(after.document["animations"][0]["channels"], expected);
  for (const json& node : after.document["nodes"]) EXPECT_FALSE(node.contains("matrix"));
  EXPECT_EQ(rest.document["nodes"][3].contains("matrix"), true);
  const auto a = rest.triangles(), b = after.triangles();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t t = 0; t < a.size(); ++t)
    for (std::size_t i = 0; i < 16; ++i) EXPECT_NEAR(a[t].matrix[i], b[t].matrix[i], 1e-6);
}

// Animations may name a mesh, which becomes one for each node that shows it.
TEST(KeptGltf, AnimationsOfASharedMeshMoveItsCopies) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  gltf.single({{"attributes", {{"POSITION", positions}}},
               {"targets", json::array({{{"POSITION", positions}}})}});
  gltf.j["nodes"].push_back({{"mesh", 0}, {"translation", {5, 0, 0}}});
  gltf.j["scenes"][0]["nodes"] = {0, 1};
  const auto channel = [](const std::string& pointer) {
    json target = {{"path", "pointer"}};
    target["extensions"]["KHR_animation_pointer"]["pointer"] = pointer;
    return json{{"sampler", 0}, {"target", target}};
  };
  const int times = gltf.floats({0, 1}, "SCALAR", 1), values = gltf.floats({1, 2}, "SCALAR", 1);
  gltf.j["animations"] = json::array(
      {{{"samplers", json::array({{{"input", times}, {"output", values}}})},
        {"channels", json::array({channel("/meshes/0/weights"), channel("/nodes/0/weights"),
                                  channel("/meshes/01")})}}});
  keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  const json after = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(after["nodes"][0]["mesh"], 0);
  EXPECT_EQ(after["nodes"][1]["mesh"], 1);
  json channels = gltf.j["animations"][0]["channels"];
  channels.insert(channels.begin() + 1, channel("/meshes/1/weights"));
  EXPECT_EQ(after["animations"][0]["channels"], channels);
}

// The nodes of a file should form a tree, but many programs show a node that has two parents.
TEST(KeptGltf, NodesOfSeveralParentsBecomeSeveral) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  gltf.single({{"attributes", {{"POSITION", positions}}}}, {{"name", "leaf"}});
  gltf.j["nodes"].push_back({{"children", {0}}, {"translation", {10, 0, 0}}});
  gltf.j["nodes"].push_back({{"children", {0, 1}}, {"translation", {0, 20, 0}}});
  gltf.j["scenes"][0]["nodes"] = {2};
  const path input = folder.write("s.glb", gltf.glb());
  keep(input, folder / "w.glb");
  const auto before = GltfOracle(input).triangles(),
             after = GltfOracle(folder / "w.glb").triangles();
  expect_kept(before, after, "TEXCOORD_1");
  ASSERT_EQ(after.size(), 2u);
  EXPECT_NE(after[0].attributes.at("TEXCOORD_1"), after[1].attributes.at("TEXCOORD_1"));
}

// Each node gets a mesh of its own and keeps its skin, whose joints place it. The node's own
// transform, which skins ignore, stays in the file.
TEST(KeptGltf, SkinnedMeshesStayWhereTheirJointsAre) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int joints = gltf.accessor({{"bufferView", gltf.view(std::vector<std::uint8_t>(12, 0))},
                                    {"componentType", 5121},
                                    {"type", "VEC4"},
                                    {"count", 3}});
  const int weights = gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  gltf.single(
      {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}},
      {{"name", "left"}, {"skin", 0}, {"translation", {3, 3, 3}}});
  gltf.j["nodes"].push_back({{"name", "right"}, {"mesh", 0}, {"skin", 1}});
  gltf.j["nodes"].push_back({{"translation", {-2, 0, 0}}});
  gltf.j["nodes"].push_back({{"translation", {0, 2, 0}}, {"scale", {2, 2, 2}}});
  gltf.j["skins"] = {{{"joints", {2}}}, {{"joints", {3}}}};
  gltf.j["scenes"][0]["nodes"] = {0, 1, 2, 3};
  const path input = folder.write("s.glb", gltf.glb());
  EXPECT_TRUE(keep(input, folder / "w.glb").not_kept.empty());
  const json after = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(after["nodes"][0]["translation"], (json{3, 3, 3}));
  for (const std::size_t n : {0, 1}) {
    EXPECT_EQ(after["nodes"][n]["mesh"], n);
    EXPECT_EQ(after["nodes"][n]["skin"], n);
    EXPECT_EQ(after["skins"][n]["joints"], json{n + 2});
  }
  const auto back = read_scene(folder / "w.glb", {}, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(back->defects.empty());
  const std::vector<Vec3f> places{{-2, 0, 0}, {-1, 0, 0}, {-2, 1, 0},
                                  {0, 2, 0},  {2, 2, 0},  {0, 4, 0}};
  EXPECT_EQ(back->scene.positions, places);
}

TEST(KeptGltf, ANodeAboveTurnsAndScales) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 0, 1}, "VEC3", 3);
  gltf.single({{"attributes", {{"POSITION", positions}}}}, {{"translation", {2e6, 0, 0}}});
  const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
  ASSERT_TRUE(loaded.ok());
  World world = world_of(loaded->scene);
  world.up = Up::z;
  world.metres_per_unit = 0.5;
  ASSERT_TRUE(write_kept(world, folder / "w.glb").ok());
  const auto triangles = GltfOracle(folder / "w.glb").triangles();
  ASSERT_EQ(triangles.size(), 1u);
  EXPECT_TRUE(near(triangles[0].matrix, {0.5, 0, 0, 0, 0, 0, -0.5, 0, 0, 0.5, 0, 0, 1e6, 0, 0, 1}));
  // Its own coordinates, without an origin.
  EXPECT_EQ(triangles[0].attributes.at("POSITION")[8], 1);
}

// Either of both needs a node.
TEST(KeptGltf, ANodeAboveTurnsOrScales) {
  const TempFolder folder;
  const auto loaded = read_scene(folder.write("s.glb", textured(folder).glb()), kGltfRest, {});
  ASSERT_TRUE(loaded.ok());
  World turned = world_of(loaded->scene), scaled = turned;
  turned.up = Up::z;
  scaled.metres_per_unit = 0.5;
  for (const World& world : {turned, scaled}) {
    ASSERT_TRUE(write_kept(world, folder / "w.glb").ok());
    const auto triangles = GltfOracle(folder / "w.glb").triangles();
    ASSERT_EQ(triangles.size(), 1u);
    EXPECT_TRUE(near(triangles[0].matrix,
                     world.up == Up::z
                         ? std::vector<double>{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}
                         : std::vector<double>{.5, 0, 0, 0, 0, .5, 0, 0, 0, 0, .5, 0, 0, 0, 0, 1}));
  }
}

// What a scene lists must be root nodes (glTF 2.0, 3.5), and the shown scene gets a node above
// them.
TEST(KeptGltf, ANodeBelowAnotherIsNoRootOfOtherScenes) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["nodes"].push_back({{"name", "elsewhere"}});
  gltf.j["scenes"].push_back({{"nodes", {0, 1}}});
  gltf.j["scenes"].push_back({{"nodes", {0}}});
  const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
  ASSERT_TRUE(loaded.ok());
  World world = world_of(loaded->scene);
  const auto same = write_kept(world, folder / "same.glb");
  ASSERT_TRUE(same.ok());
  EXPECT_EQ(same->not_kept, std::vector<std::string>{});
  EXPECT_EQ(GltfOracle(folder / "same.glb").document["scenes"], gltf.j["scenes"]);
  world.metres_per_unit = 0.5;
  const auto written = write_kept(world, folder / "w.glb");
  ASSERT_TRUE(written.ok());
  EXPECT_EQ(written->not_kept,
            std::vector<std::string>{"2 x root nodes of other scenes, which are scaled or turned"});
  const json document = GltfOracle(folder / "w.glb").document;
  EXPECT_EQ(document["nodes"][2]["children"], json{0});
  EXPECT_EQ(document["scenes"], json({{{"nodes", {2}}}, {{"nodes", {1}}}, json::object()}));
}

// The file is a library of meshes, without nodes and scenes.
TEST(KeptGltf, MeshesWithoutNodesGetSome) {
  const TempFolder folder;
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const json mesh = {{"primitives", {{{"attributes", {{"POSITION", positions}}}}}}};
  gltf.j["meshes"] = json::array({mesh, mesh});
  keep(folder.write("s.glb", gltf.glb()), folder / "w.glb");
  EXPECT_EQ(GltfOracle(folder / "w.glb").triangles().size(), 2u);
  EXPECT_EQ(GltfOracle(folder / "w.glb").document["scene"], 0);
}

}  // namespace
}  // namespace atlas::test
