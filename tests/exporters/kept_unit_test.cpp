// Tests what `--unit` does to a glTF file that is written again: everything must look as before
// from places that are scaled likewise. Scales of nodes do not reach cameras and lights.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/exporters/kept_gltf.h"

namespace atlas::test {
namespace {

constexpr const char* kLights = "KHR_lights_punctual";
constexpr double kCentimetre = 0.01;

// Writes the file again with this unit, and returns its document. `not_kept`: what is expected.
json scaled(const TempFolder& folder, const Gltf& gltf, double metres,
            const std::vector<std::string>& not_kept = {}, Up up = Up::y) {
  const auto loaded = read_scene(folder.write("s.glb", gltf.glb()), kGltfRest, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  World world = world_of(loaded->scene);
  world.metres_per_unit = metres;
  world.up = up;
  const auto written = write_kept(world, folder / "w.glb");
  EXPECT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->not_kept, not_kept);
  return GltfOracle(folder / "w.glb").document;
}

// A triangle, two cameras and three lights, at node 0.
Gltf rich() {
  Gltf gltf;
  gltf.single({{"attributes", {{"POSITION", gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3)}}}},
              {{"children", {1, 2, 3, 4, 5}}, {"scale", {3, 3, 3}}});
  for (const int camera : {0, 1}) gltf.j["nodes"].push_back({{"camera", camera}});
  for (const int light : {0, 1, 2})
    gltf.j["nodes"].push_back({{"extensions", {{kLights, {{"light", light}}}}}});
  gltf.j["cameras"] = json::array(
      {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.5}, {"zfar", 80}}}},
       {{"type", "orthographic"},
        {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0}, {"zfar", 64}}}}});
  gltf.j["extensions"][kLights]["lights"] =
      json::array({{{"type", "point"}, {"intensity", 500}, {"range", 16}},
                   {{"type", "spot"}, {"spot", json::object()}},
                   {{"type", "directional"}, {"intensity", 3}}});
  gltf.j["extensionsUsed"] = {kLights};
  return gltf;
}

TEST(KeptUnit, ScalesCameras) {
  const TempFolder folder;
  const json cameras = scaled(folder, rich(), 0.25)["cameras"];
  EXPECT_EQ(cameras[0]["perspective"], (json{{"yfov", 1}, {"znear", 0.125}, {"zfar", 20.0}}));
  EXPECT_EQ(cameras[1]["orthographic"],
            (json{{"xmag", 1.0}, {"ymag", 0.5}, {"znear", 0.0}, {"zfar", 16.0}}));
}

// Candela over metres squared is what a surface gets.
TEST(KeptUnit, SurfacesGetAsMuchLightAsBefore) {
  const TempFolder folder;
  const json lights = scaled(folder, rich(), kCentimetre)["extensions"][kLights]["lights"];
  constexpr double kDistance = 7;
  const auto lux = [](double candela, double metres) { return candela / (metres * metres); };
  EXPECT_NEAR(lux(lights[0]["intensity"], kDistance * kCentimetre), lux(500, kDistance), 1e-9);
  EXPECT_NEAR(lux(lights[1]["intensity"], kDistance * kCentimetre), lux(1, kDistance), 1e-12);
  EXPECT_NEAR(lights[0]["range"].get<double>(), 16 * kCentimetre, 1e-12);
  EXPECT_FALSE(lights[1].contains("range"));
  EXPECT_EQ(lights[2], rich().j["extensions"][kLights]["lights"][2]);
}

TEST(KeptUnit, MetresChangeNothing) {
  const TempFolder folder;
  const json document = scaled(folder, rich(), 1), before = rich().j;
  EXPECT_EQ(document["cameras"], before["cameras"]);
  EXPECT_EQ(document["extensions"], before["extensions"]);
}

// Returns the place of each camera in the world, as an engine finds it that looks through all
// nodes.
std::map<std::string, glm::dmat4> places_of_cameras(const json& document) {
  std::map<std::string, glm::dmat4> places;
  const std::function<void(const json&, glm::dmat4)> visit = [&](const json& number,
                                                                 glm::dmat4 at) {
    const json& node = document["nodes"].at(number.get<std::size_t>());
    const json t = node.value("translation", json{0, 0, 0}), s = node.value("scale", json{1, 1, 1}),
               r = node.value("rotation", json{0, 0, 0, 1});
    at = glm::translate(at, glm::dvec3(t[0], t[1], t[2]));
    at = at * glm::mat4_cast(glm::dquat(r[3], r[0], r[1], r[2]));
    at = glm::scale(at, glm::dvec3(s[0], s[1], s[2]));
    if (node.contains("camera")) places[node.value("name", "")] = at;
    for (const json& child : node.value("children", json::array())) visit(child, at);
  };
  for (const json& root : document["scenes"][0]["nodes"]) visit(root, glm::dmat4(1));
  return places;
}

// Cameras at the root, alone (g, h) or not (a, i, and k, which is animated), and below others (b,
// c).
Gltf with_cameras() {
  Gltf gltf = rich();
  json& nodes = gltf.j["nodes"];
  nodes[0]["camera"] = 0;  // beside a mesh and children
  nodes[0]["translation"] = {7, 8, 9};
  nodes.push_back({{"camera", 1}, {"translation", {1, 2, 3}}, {"rotation", {0.6, 0, 0, 0.8}}});
  nodes.push_back({{"camera", 0}, {"translation", {-5, 0, 1}}});
  nodes.push_back({{"camera", 0}, {"translation", {-5, 0, 2}}, {"children", {9}}});
  nodes.push_back({{"translation", {0, 0, 2}}});
  nodes.push_back({{"camera", 0}, {"translation", {-5, 0, 3}}});
  for (std::size_t n = 0; n < nodes.size(); ++n)
    nodes[n]["name"] = std::string(1, char('a' + int(n)));
  gltf.j["scenes"][0]["nodes"] = {0, 6, 7, 8, 10};
  const int times = gltf.floats({0, 1}, "SCALAR", 1);
  const int values = gltf.floats({5, 5, 5, 6, 6, 6}, "VEC3", 3);
  const json target = {{"path", "translation"}, {"node", 10}};
  gltf.j["animations"] =
      json::array({{{"samplers", json::array({{{"input", times}, {"output", values}}})},
                    {"channels", json::array({{{"sampler", 0}, {"target", target}}})}}});
  return gltf;
}

// Some viewers look through a scaled camera as if its planes were scaled.
TEST(KeptUnit, CamerasAreScaledInPlaceOnly) {
  const TempFolder folder;
  const Gltf gltf = with_cameras();
  const auto before = places_of_cameras(gltf.j);
  ASSERT_EQ(before.size(), 7u);
  for (const Up up : {Up::y, Up::z}) {
    const json document = scaled(folder, gltf, kCentimetre, {}, up);
    const auto after = places_of_cameras(document);
    ASSERT_EQ(after.size(), 7u);
    const glm::dmat4 turn =
        up == Up::z ? glm::rotate(glm::dmat4(1), -std::acos(-1.0) / 2, glm::dvec3(1, 0, 0))
                    : glm::dmat4(1);
    for (const auto& [name, place] : before) {
      glm::dmat4 expected = turn * place;
      for (int i = 0; i < 3; ++i) expected[3][i] *= kCentimetre;
      for (int i = 0; i < 4; ++i)
        EXPECT_LT(glm::distance(after.at(name)[i], expected[i]), 1e-9) << name << ' ' << i;
    }
    // X_ITE needs cameras without any scaled node above.
    const json& roots = document["scenes"][0]["nodes"];
    EXPECT_EQ(roots.size(), 3u);
    EXPECT_EQ(roots[1], 6);
    EXPECT_EQ(roots[2], 7);
    EXPECT_EQ(document["nodes"][10]["translation"], (json{-5, 0, 3}))
        << "the unit of its animation";
  }
}

// Another scene of the file is not scaled, so it needs the camera and the light as they were.
TEST(KeptUnit, OtherScenesKeepTheirs) {
  const TempFolder folder;
  Gltf gltf = rich();
  json other = {{"camera", 0}};
  other["extensions"][kLights]["light"] = 0;
  gltf.j["nodes"].push_back(other);
  gltf.j["scenes"].push_back({{"nodes", {6}}});
  const json document = scaled(folder, gltf, 0.25);
  EXPECT_EQ(document["nodes"][6], other);
  EXPECT_EQ(document["cameras"][0], gltf.j["cameras"][0]);
  std::multiset<int> cameras;
  for (const json& node : document["nodes"])
    if (node.contains("camera")) cameras.insert(node["camera"].get<int>());
  EXPECT_EQ(cameras, (std::multiset<int>{0, 1, 2}));
  EXPECT_EQ(document["cameras"][2]["perspective"]["znear"], 0.125);
  const json& lights = document["extensions"][kLights]["lights"];
  EXPECT_EQ(lights[0]["intensity"], 500);
  EXPECT_EQ(document["nodes"][3]["extensions"][kLights]["light"], 3);
  EXPECT_EQ(lights[3]["intensity"], 500 / 16.0);
  EXPECT_EQ(lights[3]["range"], 4.0);
}

TEST(KeptUnit, ScalesDistancesWithinVolumes) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["materials"][0]["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 2},
                                                                  {"attenuationDistance", 8}};
  gltf.j["extensionsUsed"] = {"KHR_materials_volume"};
  // The thickness is in the coordinates of the mesh, which the node above scales.
  EXPECT_EQ(scaled(folder, gltf, 0.25)["materials"][0]["extensions"]["KHR_materials_volume"],
            (json{{"thicknessFactor", 2}, {"attenuationDistance", 2.0}}));
}

TEST(KeptUnit, AnimationsOfScaledValuesAreCounted) {
  const TempFolder folder;
  Gltf gltf = rich();
  const int times = gltf.floats({0, 1}, "SCALAR", 1), values = gltf.floats({1, 2}, "SCALAR", 1);
  const auto channel = [](const std::string& path) {
    json target = {{"path", "pointer"}};
    target["extensions"]["KHR_animation_pointer"]["pointer"] = path;
    return json{{"sampler", 0}, {"target", target}};
  };
  gltf.j["animations"] = json::array(
      {{{"samplers", json::array({{{"input", times}, {"output", values}}})},
        {"channels", json::array({channel("/cameras/0/perspective/znear"),
                                  channel("/cameras/0/perspective/yfov"),
                                  channel("/extensions/KHR_lights_punctual/lights/0/range"),
                                  channel("/extensions/KHR_lights_punctual/lights/0/color"),
                                  channel("/extensions/KHR_lights_punctual/lights/0/intensity"),
                                  channel("/extensions/KHR_lights_punctual/lights/2/intensity"),
                                  channel("/materials/0/alphaCutoff"),
                                  channel("/materials/0/extensions/KHR_materials_volume/"
                                          "attenuationDistance")})}}});
  scaled(folder, gltf, 0.25, {"4 x animations of cameras, lights and volumes, in another unit"});
  scaled(folder, gltf, 1);
}

// A tube of two joints, bent. `at_root`: whether the node of the skin is a root.
Gltf skinned(bool at_root) {
  Gltf gltf;
  const int positions = gltf.floats({0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3", 3);
  const int joints = gltf.accessor(
      {{"bufferView", gltf.view(std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0})},
       {"componentType", 5121},
       {"type", "VEC4"},
       {"count", 3}});
  const int weights = gltf.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  gltf.single(
      {{"attributes", {{"POSITION", positions}, {"JOINTS_0", joints}, {"WEIGHTS_0", weights}}}},
      {{"skin", 0}, {"translation", {5, 5, 5}}});
  gltf.j["nodes"].push_back({{"children", {2}}, {"translation", {1, 2, 3}}});
  gltf.j["nodes"].push_back({{"rotation", {0, 0, 0.6, 0.8}}});
  gltf.j["skins"] = json::array({{{"joints", {1, 2}}}});
  gltf.j["scenes"][0]["nodes"] = {0, 1};
  if (!at_root) {
    gltf.j["nodes"].push_back({{"children", {0, 1}}});
    gltf.j["scenes"][0]["nodes"] = {3};
  }
  return gltf;
}

// The format ignores the place of a node that has a skin. Viewers warn of nodes above it.
TEST(KeptUnit, SkinnedMeshesAtTheRootStayThere) {
  for (const bool at_root : {true, false}) {
    const TempFolder folder;
    const Gltf gltf = skinned(at_root);
    const json document = scaled(folder, gltf, 0.5);
    const json& roots = document["scenes"][0]["nodes"];
    const std::size_t above = at_root ? 3 : 4;
    EXPECT_EQ(roots, at_root ? json({3, 0}) : json::array({4}));
    EXPECT_EQ(document["nodes"][above]["scale"], (json{0.5, 0.5, 0.5}));
    EXPECT_EQ(document["nodes"][above]["children"], at_root ? json::array({1}) : json::array({3}));
    const auto before = read_scene(folder / "s.glb", {}, {}),
               after = read_scene(folder / "w.glb", {}, {});
    ASSERT_TRUE(before.ok() && after.ok());
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f &p = before->scene.positions[before->scene.indices[k]],
                  &q = after->scene.positions[after->scene.indices[k]];
      EXPECT_NEAR(q.x, p.x / 2, 1e-6);
      EXPECT_NEAR(q.y, p.y / 2, 1e-6);
      EXPECT_NEAR(q.z, p.z / 2, 1e-6);
    }
  }
}

// What hangs on such a node moves with it.
TEST(KeptUnit, SkinnedMeshesThatMoveOtherThingsAreScaled) {
  const TempFolder folder;
  Gltf gltf = skinned(true);
  gltf.j["nodes"].push_back({{"name", "hat"}, {"translation", {0, 1, 0}}});
  gltf.j["nodes"][0]["children"] = {3};
  const json document = scaled(folder, gltf, 0.5);
  EXPECT_EQ(document["scenes"][0]["nodes"], json::array({4}));
  EXPECT_EQ(document["nodes"][4]["children"], (json{0, 1}));
}

// The reader takes properties of the wrong type as absent. Cameras of such nodes are placed
// likewise.
TEST(KeptUnit, NodesWithWrongPropertiesHaveNone) {
  const json cases[] = {{{"translation", {1}}},     {{"translation", {1, "x", 2}}},
                        {{"translation", "x"}},     {{"translation", json::object()}},
                        {{"translation", nullptr}}, {{"rotation", {0, 0, 1}}},
                        {{"rotation", nullptr}},    {{"rotation", {0, 0, 0, 0}}},
                        {{"children", nullptr}},    {{"children", json::object()}},
                        {{"children", "x"}},        {{"children", json::array()}}};
  for (const json& wrong : cases) {
    for (const bool shows : {false, true}) {
      const TempFolder folder;
      Gltf gltf = rich();
      json node = {{"camera", 0}, {"name", "bad"}};
      if (shows) node["mesh"] = 0;
      node.update(wrong);
      gltf.j["nodes"].push_back(std::move(node));
      gltf.j["scenes"][0]["nodes"] = {0, 6};
      const json document = scaled(folder, gltf, kCentimetre, {}, Up::z);
      if (!shows) {  // it is beside the node that scales
        const glm::dmat4 place = places_of_cameras(document).at("bad");
        EXPECT_EQ(glm::dvec3(place[3]), glm::dvec3(0)) << wrong;
        EXPECT_NEAR(glm::determinant(place), 1, 1e-9) << wrong;
      }
      for (const json& kept : document["nodes"])
        EXPECT_TRUE(!kept.contains("children") || !kept["children"].empty()) << wrong;
    }
  }
}

}  // namespace
}  // namespace atlas::test
