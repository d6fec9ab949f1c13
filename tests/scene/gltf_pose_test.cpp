// Where the vertices of glTF meshes are at rest, and what damaged poses give.
#include <gtest/gtest.h>

#include <cmath>

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

// Joints and weights of four vertices; `joint` is the first one of each.
int joints(Gltf& g, std::uint8_t joint) {
  std::vector<std::uint8_t> values(16, 0);
  for (std::size_t v = 0; v < 4; ++v) values[4 * v] = joint;
  return g.accessor(
      {{"bufferView", g.view(values)}, {"componentType", 5121}, {"type", "VEC4"}, {"count", 4}});
}
int weights(Gltf& g, float weight) {
  std::vector<float> values(16, 0);
  for (std::size_t v = 0; v < 4; ++v) values[4 * v] = weight;
  return g.floats(values, "VEC4", 4);
}

// A square under node 0, bent by joints at nodes 1 and 2 with weights that add up to 4.
Gltf skinned() {
  Gltf g;
  g.single({{"attributes",
             {{"POSITION", g.floats(kSquare, "VEC3", 3)},
              {"JOINTS_0", joints(g, 0)},
              {"WEIGHTS_0", weights(g, 1)},
              {"JOINTS_1", joints(g, 1)},
              {"WEIGHTS_1", weights(g, 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
  g.j["skins"] = {{{"joints", {1, 2}}}};
  g.j["nodes"][0]["skin"] = 0;
  g.j["nodes"][0]["translation"] = {0, 0, 0.5};
  g.j["nodes"].push_back({{"translation", {0, 1, 0}}});
  g.j["nodes"].push_back({{"translation", {1, 0, 0}}});
  g.j["scenes"][0]["nodes"] = {0, 1, 2};
  return g;
}

Vec3f first_position(const TempFolder& folder, const Gltf& g) {
  const auto loaded = load_glb(folder, g);
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  if (!loaded.ok()) return {};
  const Vec3d& o = loaded->scene.origin;
  const Vec3f& p = loaded->scene.positions.at(0);
  return {float(o.x + p.x), float(o.y + p.y), float(o.z + p.z)};
}

TEST(GltfPose, EverySetOfJointsCounts) {
  const TempFolder folder;
  EXPECT_EQ(first_position(folder, skinned()), (Vec3f{0.75f, 0.25f, 0}));
}

// A weight below 0 is none.
TEST(GltfPose, NegativeWeightsBendNothing) {
  const TempFolder folder;
  Gltf g = skinned();
  g.j["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_1"] = weights(g, -0.5f);
  EXPECT_EQ(first_position(folder, g), (Vec3f{0, 1, 0}));
}

// What is no skin leaves the mesh at its node.
TEST(GltfPose, SkinsThatDoNotExistBendNothing) {
  const TempFolder folder;
  const Vec3f at_node{0, 0, 0.5f};
  Gltf beyond = skinned();
  beyond.j["nodes"][0]["skin"] = 7;
  EXPECT_EQ(first_position(folder, beyond), at_node);
  Gltf weightless = skinned();
  for (const char* name : {"WEIGHTS_0", "WEIGHTS_1"})
    weightless.j["meshes"][0]["primitives"][0]["attributes"].erase(name);
  EXPECT_EQ(first_position(folder, weightless), at_node);
  Gltf skinless = skinned();
  skinless.j["nodes"][0].erase("skin");
  EXPECT_EQ(first_position(folder, skinless), at_node);
  // A joint that does not exist moves nothing; the other one moves by its share.
  Gltf jointless = skinned();
  jointless.j["skins"][0]["joints"] = {9, 2};
  EXPECT_EQ(first_position(folder, jointless), (Vec3f{0.75f, 0, 0}));
}

TEST(GltfPose, NumbersOfValuesMustAgree) {
  const TempFolder folder;
  const auto says = [&](const Gltf& g, const char* wanted) {
    const Status status = load_glb(folder, g).status();
    EXPECT_EQ(status.code(), ErrorCode::bad_input) << wanted;
    EXPECT_NE(status.message().find(wanted), std::string::npos) << status.message();
  };
  for (const char* name : {"JOINTS_0", "WEIGHTS_0"}) {
    for (const int count : {3, 5}) {
      Gltf g = skinned();
      auto& attributes = g.j["meshes"][0]["primitives"][0]["attributes"];
      const bool of_joints = std::string(name) == "JOINTS_0";
      const std::size_t values = std::size_t(4 * count);
      const int view = of_joints ? g.view(std::vector<std::uint8_t>(values, 0))
                                 : g.view(std::vector<float>(values, 1));
      attributes[name] = g.accessor({{"bufferView", view},
                                     {"componentType", of_joints ? 5121 : 5126},
                                     {"type", "VEC4"},
                                     {"count", count}});
      says(g, "another number of joints or weights than of positions");
    }
  }
  for (const std::size_t count : {3u, 5u}) {
    Gltf g = skinned();
    const int moves = g.floats(std::vector<float>(3 * count, 1), "VEC3", 3);
    g.j["meshes"][0]["primitives"][0]["targets"] = json::array({{{"POSITION", moves}}});
    g.j["meshes"][0]["weights"] = {1};
    says(g, "another number of values than one of its morph targets");
  }
}

// Nodes may have weights of their own, which may be negative. Primitives that share their vertices
// do not share them if they morph differently.
TEST(GltfPose, MorphTargetsMoveByTheirWeights) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const auto by = [&](float z) {
    return g.floats({0, 0, z, 0, 0, z, 0, 0, z, 0, 0, z}, "VEC3", 3);
  };
  const int corners = g.indices(std::vector<std::uint16_t>{0, 1, 2});
  const auto primitive = [&](float z) {
    return json{{"attributes", {{"POSITION", positions}}},
                {"targets", json::array({{{"POSITION", by(z)}}})},
                {"indices", corners}};
  };
  g.single(primitive(1));
  g.j["meshes"][0]["primitives"].push_back(primitive(2));
  g.j["meshes"][0]["weights"] = {0.5};
  g.j["nodes"].push_back({{"mesh", 0}, {"weights", {-1}}});
  g.j["scenes"][0]["nodes"] = {0, 1};
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  std::vector<float> heights;
  for (std::size_t k = 0; k < loaded->scene.indices.size(); k += 3)
    heights.push_back(loaded->scene.positions[loaded->scene.indices[k]].z);
  EXPECT_EQ(heights, (std::vector<float>{0.5f, 1, -1, -2}));
}

// Rotations should have length 1. Those of length 0 turn nothing.
TEST(GltfPose, RotationsOfAnyLength) {
  const TempFolder folder;
  const auto second = [&](const json& rotation, bool of_instance) {
    Gltf g;
    json node = json::object();
    if (of_instance) {
      json attributes = {{"ROTATION", g.floats(rotation, "VEC4", 4)}};
      node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    } else {
      node["rotation"] = rotation;
    }
    g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
              {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}},
             node);
    const auto loaded = load_glb(folder, g);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return loaded.ok() ? loaded->scene.positions.at(1) : Vec3f{};
  };
  for (const bool of_instance : {false, true}) {
    EXPECT_EQ(second({0, 0, 3, 3}, of_instance), (Vec3f{0, 1, 0}));
    EXPECT_EQ(second({3, 0, 0, 3}, of_instance), (Vec3f{1, 0, 0}));
    EXPECT_EQ(second({0, 3, 0, 3}, of_instance), (Vec3f{0, 0, -1}));
    EXPECT_EQ(second({0, 0, 0, 0}, of_instance), (Vec3f{1, 0, 0}));
  }
}

TEST(GltfPose, InstancesWithoutAPlaceAreOne) {
  const TempFolder folder;
  Gltf g;
  json node = {{"translation", {0, 0, 2}}};
  node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"_ID", g.floats({1, 2, 3}, "SCALAR", 1)}};
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}},
           node);
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.triangle_count(), 1u);
  EXPECT_EQ(loaded->scene.origin.z + loaded->scene.positions[0].z, 2);
}

TEST(GltfPose, OnlyTheChosenSceneIsShown) {
  const TempFolder folder;
  Gltf g;
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2})}});
  g.j["meshes"][0]["name"] = "a node's name comes first";
  g.j["nodes"].push_back({{"mesh", 0}, {"name", "second"}});
  g.j["scenes"].push_back({{"nodes", {1}}});
  g.j["scene"] = 1;
  const auto loaded = load_glb(folder, g);
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  EXPECT_EQ(loaded->scene.object_names, std::vector<std::string>{"second"});
}

}  // namespace
}  // namespace atlas
