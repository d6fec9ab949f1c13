// Tests what glTF files can say in more than one way, or only in part.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Gltf;
using test::json;
using test::kSquare;
using test::load_glb;
using test::TempFolder;

// The same transform is given as numbers, as a matrix, and by a node above. A file without scenes
// shows all nodes that have no parent.
TEST(Gltf, MatricesAndScenesThatAreNotNamed) {
  const TempFolder folder;
  const auto positions_of = [&](const std::function<void(json&)>& arrange) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    g.single({{"attributes", {{"POSITION", positions}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
    arrange(g.j);
    const auto loaded = load_glb(folder, g);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 2u);
    return loaded->scene.positions;
  };
  const auto wanted = positions_of([](json& j) {
    j["nodes"][0]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};
    j["nodes"][0]["scale"] = {2, 3, 4};
    j["nodes"][0]["translation"] = {0.25, 0.5, 0.75};
  });
  const json matrix = {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 0.25, 0.5, 0.75, 1};
  const auto expect_same = [&](const std::vector<Vec3f>& got) {
    ASSERT_EQ(got.size(), wanted.size());
    for (std::size_t i = 0; i < got.size(); ++i) {
      EXPECT_NEAR(got[i].x, wanted[i].x, 1e-6);
      EXPECT_NEAR(got[i].y, wanted[i].y, 1e-6);
      EXPECT_NEAR(got[i].z, wanted[i].z, 1e-6);
    }
  };
  expect_same(positions_of([&](json& j) { j["nodes"][0]["matrix"] = matrix; }));
  expect_same(positions_of([&](json& j) {
    j["nodes"].push_back({{"children", {0}}, {"matrix", matrix}});
    j.erase("scenes");
    j.erase("scene");
  }));
}

// The first perspective camera of the scene that is shown.
TEST(Gltf, TellsWhereAViewerBegins) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
  EXPECT_FALSE(load_glb(folder, g)->view);
  const json lens = {{"yfov", 1}, {"znear", 0.1}};
  const json plan = {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 9}};
  g.j["cameras"] = {{{"type", "orthographic"}, {"orthographic", plan}},
                    {{"type", "perspective"}, {"perspective", lens}}};
  g.j["nodes"].push_back({{"camera", 1}});  // in no scene
  g.j["nodes"].push_back({{"camera", 0}});
  g.j["nodes"].push_back({{"children", {4}}, {"translation", {1, 0, 0}}, {"scale", {2, 2, 2}}});
  const double half = std::sqrt(0.5);
  g.j["nodes"].push_back(
      {{"camera", 1}, {"translation", {0, 3, 0}}, {"rotation", {0, half, 0, half}}});
  g.j["nodes"].push_back({{"camera", 1}, {"name", "above"}, {"translation", {0, 5, 0}}});
  g.j["scenes"][0]["nodes"] = {0, 2, 3, 5};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ASSERT_TRUE(loaded->view);
  EXPECT_EQ(loaded->view->position, (Vec3d{1, 6, 0}));
  EXPECT_NEAR(loaded->view->direction.x, -1, 1e-6);
  ASSERT_EQ(loaded->further_views.size(), 1u);
  EXPECT_EQ(loaded->further_views[0].name, "above");
  EXPECT_EQ(loaded->further_views[0].position, (Vec3d{0, 5, 0}));
}

// KHR_mesh_quantization: the most negative integer also stands for -1.
TEST(Gltf, ShortPositionsAreFractions) {
  const TempFolder folder;
  for (const bool normalized : {false, true}) {
    Gltf g;
    const int view =
        g.view(std::vector<std::int16_t>{0, 0, 0, 0, 32767, 0, 0, 0, -32768, -32767, 0, 0}, 8);
    const int positions = g.accessor({{"bufferView", view},
                                      {"componentType", 5122},
                                      {"normalized", normalized},
                                      {"type", "VEC3"},
                                      {"count", 3}});
    g.j["extensionsRequired"] = {"KHR_mesh_quantization"};
    g.single({{"attributes", {{"POSITION", positions}}}});
    const auto loaded = load_glb(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const auto& p = loaded->scene.positions;
    EXPECT_EQ(p[1], normalized ? (Vec3f{1, 0, 0}) : (Vec3f{32767, 0, 0}));
    EXPECT_EQ(p[2], normalized ? (Vec3f{-1, -1, 0}) : (Vec3f{-32768, -32767, 0}));
  }
}

// The format has no signed 32-bit integers. If a file has them all the same, they are read as such,
// and nothing after the last of them is read.
TEST(Gltf, SignedWordsAreWholeNumbers) {
  const TempFolder folder;
  Gltf g;
  const int view = g.view(std::vector<std::int32_t>{0, 0, 0, 70000, 0, 0, 0, -70000, 0});
  const int positions =
      g.accessor({{"bufferView", view}, {"componentType", 5124}, {"type", "VEC3"}, {"count", 3}});
  g.single({{"attributes", {{"POSITION", positions}}}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.positions[1], (Vec3f{70000, 0, 0}));
  EXPECT_EQ(loaded->scene.positions[2], (Vec3f{0, -70000, 0}));
}

// Of two primitives, the first is lit and lacks one texture coordinate; the second has no light and
// no defect.
TEST(Gltf, WhatOnlySomePrimitivesHave) {
  const TempFolder folder;
  Gltf g;
  const int first = g.floats(kSquare, "VEC3", 3), second = g.floats(kSquare, "VEC3", 3);
  const int light = g.floats(kSquare, "VEC3", 3);
  const int three = g.floats({0, 0, 1, 0, 1, 1}, "VEC2", 2);
  const int four = g.floats({.5f, .5f, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes", {{"POSITION", first}, {"COLOR_0", light}, {"TEXCOORD_0", three}}},
            {"indices", indices}});
  g.j["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", second}, {"TEXCOORD_0", four}}}, {"indices", indices}});
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.illumination.size(), 8u);
  EXPECT_EQ(s.illumination[2], (Vec3f{1, 1, 0}));
  EXPECT_EQ(s.illumination[6], Vec3f{});
  EXPECT_EQ(loaded->defects.count(DefectKind::illumination_missing), 4u);
  EXPECT_EQ(loaded->defects.count(DefectKind::texcoord_out_of_range), 1u);
  EXPECT_EQ(s.texcoord_indices[4], Scene::kNoTexcoord);
  EXPECT_EQ(s.texcoords[s.texcoord_indices[0]], (Vec2f{0, 1}));
  EXPECT_EQ(s.texcoords[s.texcoord_indices[9]], (Vec2f{.5f, .5f}));
}

TEST(Gltf, InstancesAreShownWhereTheyStand) {
  const TempFolder folder;
  Gltf g;
  json primitive = {{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
                    {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}};
  json attributes = {
      {"TRANSLATION", g.floats({0, 0, 0, 5, 0, 0, 0, 7, 0}, "VEC3", 3)},
      {"ROTATION",
       g.accessor({{"bufferView", g.view<std::int8_t>({0, 0, 0, 127, 0, 0, 127, 0, 0, 0, 0, 127})},
                   {"componentType", 5120},
                   {"normalized", true},
                   {"type", "VEC4"},
                   {"count", 3}})},
      {"SCALE", g.floats({1, 1, 1, 2, 2, 2, 1, 1, -1}, "VEC3", 3)},
      {"_ID", 0}};
  json node = {{"translation", {0, 0, 1}}};
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
  g.single(primitive, node);
  g.j["extensionsUsed"] = g.j["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  ASSERT_EQ(s.positions.size(), 12u);
  EXPECT_EQ(s.triangle_count(), 6u);
  EXPECT_EQ(s.positions[2], (Vec3f{1, 1, 1}));
  EXPECT_EQ(s.positions[6], (Vec3f{3, -2, 1}));  // half a turn about z, twice as large
  EXPECT_EQ(s.positions[10], (Vec3f{1, 8, 1}));
  EXPECT_EQ(s.indices[6], 4u);
  EXPECT_EQ(s.indices[12], 10u);  // mirrored: its corners have the opposite order
  EXPECT_EQ(s.object_names.size(), 3u);
  const auto broken = [&](const char* name, const json& value) {
    Gltf bad = g;
    bad.j["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][name] = value;
    return load_glb(folder, bad).status();
  };
  EXPECT_NE(broken("SCALE", 0).message().find("another number of SCALE"), std::string::npos);
  EXPECT_EQ(broken("TRANSLATION", 99).code(), ErrorCode::bad_input);
  EXPECT_EQ(broken("TRANSLATION", "x").code(), ErrorCode::bad_input);
}

// A mesh of 1500 vertices that is shown half a million times would take 50 GB. It is refused before
// anything is allocated.
TEST(Gltf, MeshesShownBeyondAllMemoryAreRefused) {
  const TempFolder folder;
  const auto zeros = [](Gltf& g, int count) {
    return g.accessor({{"componentType", 5126}, {"type", "VEC3"}, {"count", count}});
  };
  Gltf instances;
  json node;
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      zeros(instances, 1 << 19);
  instances.single({{"attributes", {{"POSITION", zeros(instances, 1500)}}}}, node);
  Gltf parents;
  parents.single({{"attributes", {{"POSITION", zeros(parents, 1500)}}}});
  parents.j["nodes"].push_back({{"children", json::array()}});
  parents.j["nodes"].push_back({{"children", json::array()}});
  for (int i = 0; i < 700; ++i) {
    parents.j["nodes"][1]["children"].push_back(0);
    parents.j["nodes"][2]["children"].push_back(1);
  }
  parents.j["scenes"][0]["nodes"] = {2};
  for (const Gltf* g : {&instances, &parents}) {
    const Status status = load_glb(folder, *g).status();
    EXPECT_EQ(status.code(), ErrorCode::bad_input);
    EXPECT_NE(status.message().find("as often as it is shown"), std::string::npos)
        << status.message();
  }
  EXPECT_LT(peak_memory(), std::int64_t{1} << 30);
}

// KHR_node_visibility: a hidden node hides all nodes below it, whatever they say.
TEST(Gltf, HiddenNodesAreLeftOut) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
  const auto node = [](const json& visible) {
    json n = {{"mesh", 0}};
    n["extensions"]["KHR_node_visibility"] = visible;
    return n;
  };
  g.j["nodes"] = {node({{"visible", false}}), node({{"visible", true}}), node(json::object()),
                  node({{"visible", "no"}})};
  g.j["nodes"][0]["children"] = {1};
  g.j["scenes"][0]["nodes"] = {0, 2, 3};
  g.j["extensionsUsed"] = g.j["extensionsRequired"] = {"KHR_node_visibility"};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 4u);
  ASSERT_EQ(loaded->defects.count(DefectKind::node_hidden), 2u);
  EXPECT_TRUE(loaded->defects.defects[0].first_places[1].ends_with(": node 1"));
  g.j["scenes"][0]["nodes"] = {0};
  EXPECT_NE(load_glb(folder, g).status().message().find("shows none of its 1 meshes"),
            std::string::npos);
}

// Some files require what changes no shape, so that viewers do not ignore it.
TEST(Gltf, RequiredExtensionsThatChangeNoShape) {
  const TempFolder folder;
  for (const char* name : {"KHR_animation_pointer", "KHR_xmp_json_ld", "KHR_node_selectability",
                           "KHR_node_hoverability", "EXT_mesh_features", "EXT_instance_features",
                           "EXT_structural_metadata", "EXT_lights_image_based", "EXT_lights_ies"}) {
    Gltf g;
    g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}});
    g.j["extensionsUsed"] = g.j["extensionsRequired"] = {name};
    const auto loaded = load_glb(folder, g);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  }
}

// A file without nodes is a library. Each mesh is read once, without a transform.
TEST(Gltf, MeshesWithoutNodes) {
  const TempFolder folder;
  for (const bool empty_scene : {false, true}) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    g.single({{"attributes", {{"POSITION", positions}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
    g.j["meshes"].push_back(g.j["meshes"][0]);
    g.j["meshes"][1]["name"] = "second";
    g.j.erase("nodes");
    g.j.erase("scene");
    g.j.erase("scenes");
    if (empty_scene) g.j["scenes"] = json::array({json::object()});
    const auto loaded = load_glb(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 4u);
    EXPECT_EQ(loaded->scene.object_names, (std::vector<std::string>{"", "second"}));
  }
}

// Some exporters share a node between parents, which the format forbids but viewers show.
TEST(Gltf, NodesOfSeveralParents) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  g.single({{"attributes", {{"POSITION", positions}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
  g.j["nodes"].push_back({{"children", {0}}, {"translation", {0, 0, 1}}});
  g.j["nodes"].push_back({{"children", {0}}, {"scale", {2, 2, 2}}});
  g.j["scenes"][0]["nodes"] = {1, 2};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  ASSERT_EQ(loaded->scene.positions.size(), 8u);
  EXPECT_EQ(loaded->scene.positions[2], (Vec3f{1, 1, 1}));
  EXPECT_EQ(loaded->scene.positions[6], (Vec3f{2, 2, 0}));
  ASSERT_EQ(loaded->defects.count(DefectKind::node_shared), 1u);
  EXPECT_EQ(loaded->defects.defects[0].first_places[0],
            (folder / "scene.glb").string() + ": node 0");
  // In a ladder of 60 nodes, each with the next one twice as its child, the last is reached 2^60
  // times.
  for (int i = 3; i < 63; ++i) g.j["nodes"].push_back({{"children", {i + 1, i + 1}}});
  g.j["nodes"].push_back({{"mesh", 0}});
  g.j["scenes"][0]["nodes"] = {3};
  const auto ladder = load_glb(folder, g);
  EXPECT_EQ(ladder.status().code(), ErrorCode::bad_input);
}

// Only its joints move the node of a skinned mesh. Weights need not add up to 1.
TEST(Gltf, SkinsAndMorphTargetsAtRest) {
  const TempFolder folder;
  for (const bool mirrored : {false, true}) {
    Gltf g;
    const int positions = g.floats(kSquare, "VEC3", 3);
    const int up = g.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
    const int joints = g.accessor(
        {{"bufferView",
          g.view(std::vector<std::uint8_t>{0, 9, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 7, 0, 0, 0})},
         {"componentType", 5121},
         {"type", "VEC4"},
         {"count", 4}});
    const int weights = g.floats({1, 1, 0, 0, 0.5, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    const int inverse = g.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1,  //
                                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1},
                                 "MAT4", 16);
    g.single(
        {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}},
         {"targets", json::array({{{"POSITION", up}}, {{"POSITION", up}}})},
         {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
    g.j["meshes"][0]["weights"] = {0.5, 0};
    g.j["skins"] = {{{"joints", {1, 3}}, {"inverseBindMatrices", inverse}}};
    g.j["nodes"][0]["skin"] = 0;
    g.j["nodes"][0]["translation"] = {100, 100, 100};
    g.j["nodes"].push_back({{"translation", {0, 2, 0}}});
    g.j["nodes"].push_back({{"children", {1, 3}}, {"scale", {mirrored ? -1 : 1, 1, 1}}});
    g.j["nodes"].push_back({{"translation", {0, 0, 4}}});
    g.j["scenes"][0]["nodes"] = {0, 2};
    const auto loaded = load_glb(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    const Scene& s = loaded->scene;
    const float side = mirrored ? -1 : 1;
    const std::vector<Vec3f> wanted{
        {-side, 2, .5f}, {side, 0, 4.5f}, {side / 2, 2, 2.5f}, {-side, 3, .5f}};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const Vec3f p = s.positions[i];
      EXPECT_EQ(Vec3f({float(s.origin.x + p.x), float(s.origin.y + p.y), float(s.origin.z + p.z)}),
                wanted[i])
          << i;
    }
    EXPECT_EQ(s.indices[0], mirrored ? 2u : 0u);
  }
}

// Joints place a skinned mesh, not its node. Nodes and instances that share joints therefore show
// it at one place, which is told. Skins with joints of their own, here nodes 5 and 6, part them.
TEST(Gltf, SkinnedMeshesThatLieUponEachOtherAreTold) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
  const int joints = g.accessor({{"bufferView", g.view(std::vector<std::uint8_t>(12, 0))},
                                 {"componentType", 5121},
                                 {"type", "VEC4"},
                                 {"count", 3}});
  const int weights = g.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  g.single(
      {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}},
      {{"name", "first"}, {"skin", 0}});
  const auto add = [&](json node) { g.j["nodes"].push_back(std::move(node)); };
  add({{"name", "other skin"}, {"mesh", 0}, {"skin", 1}, {"translation", {9, 0, 0}}});
  add({{"name", "same skin"}, {"mesh", 0}, {"skin", 0}, {"translation", {5, 0, 0}}});
  add({{"name", "same joint"}, {"mesh", 0}, {"skin", 2}});
  const int moves = g.floats({0, 0, 0, 7, 0, 0}, "VEC3", 3);
  const json instancing = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}}}}}};
  add({{"name", "instances"}, {"mesh", 0}, {"skin", 3}, {"extensions", instancing}});
  for (const int x : {10, 20, 30}) add({{"translation", {x, 0, 0}}});
  g.j["skins"] = {{{"joints", {5}}}, {{"joints", {6}}}, {{"joints", {5}}}, {{"joints", {7}}}};
  g.j["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const Scene& s = loaded->scene;
  std::vector<double> places;
  for (std::size_t i = 0; i < s.positions.size(); i += 3)
    places.push_back(s.origin.x + double(s.positions[i].x));
  EXPECT_EQ(places, (std::vector<double>{10, 20, 10, 10, 30, 30}));
  ASSERT_EQ(loaded->defects.count(DefectKind::skin_repeated), 3u);
  const std::string file = (folder / "scene.glb").string();
  EXPECT_EQ(loaded->defects.defects[0].first_places,
            (std::vector<std::string>{file + ": node 2 'same skin'", file + ": node 3 'same joint'",
                                      file + ": node 4 'instances'"}));
}

// Chunks without padding or bytes or of other kinds, and buffer files longer than their buffer.
TEST(Gltf, ContainersThatManyWrite) {
  const TempFolder folder;
  Gltf g;
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}});
  folder.write("a.bin", g.bytes + "more");
  const auto word = [](std::size_t v) {
    const auto bits = std::uint32_t(v);
    return std::string(reinterpret_cast<const char*>(&bits), 4);
  };
  const auto load = [&](bool external, const std::string& before, const std::string& binary) {
    json file = g.j;
    file["buffers"] = {{{"byteLength", g.bytes.size()}}};
    if (external) file["buffers"][0]["uri"] = "a.bin";
    std::string text = file.dump();
    while (text.size() % 4 != 1) text += ' ';
    const std::string rest = word(text.size()) + "JSON" + text + before + word(binary.size()) +
                             std::string("BIN\0", 4) + binary;
    const auto loaded =
        read_scene(folder.write("a.glb", "glTF" + word(2) + word(12 + rest.size()) + rest), {}, {});
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return loaded.ok() ? loaded->scene.triangle_count() : 0;
  };
  EXPECT_EQ(load(false, "", g.bytes), 1u);
  EXPECT_EQ(load(false, "", g.bytes + "x"), 1u);
  EXPECT_EQ(load(true, "", ""), 1u);
  EXPECT_EQ(load(false, word(4) + "KINDdata", g.bytes), 1u);
}

// A chain is a tree. That it is not read is a limit of the reader, and said to be one.
TEST(Gltf, DeepChainsOfNodesAreToldAsDeep) {
  const TempFolder folder;
  const auto message = [&](int nodes, int last_child) {
    Gltf g;
    g.single({{"attributes", {{"POSITION", g.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}}});
    json chain = json::array();
    for (int i = 0; i < nodes; ++i) chain.push_back({{"children", {i + 1}}});
    chain.push_back({{"mesh", 0}});
    if (last_child >= 0) chain.back()["children"] = {last_child};
    g.j["nodes"] = chain;
    const auto loaded = load_glb(folder, g);
    return loaded.ok() ? std::string() : loaded.status().message();
  };
  EXPECT_EQ(message(500, -1), "");
  for (const int nodes : {600, 100000})
    EXPECT_NE(message(nodes, -1).find("node 513: is nested too deeply, below more than 512 nodes"),
              std::string::npos)
        << message(nodes, -1);
  EXPECT_NE(message(3, 1).find("the nodes form no tree"), std::string::npos) << message(3, 1);
}

}  // namespace
}  // namespace atlas
