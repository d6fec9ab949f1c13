// Tests glTF worlds that lie too far from zero for engines that hold single floats. They must be
// right where they are for those that hold doubles, and for others once one node is moved.
#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "tests/exporters/kept_gltf.h"
#include "tests/exporters/worlds.h"

namespace atlas::test {
namespace {

json document_of(const World& world, const std::filesystem::path& path, bool far) {
  const auto written = write_kept(world, path);
  EXPECT_TRUE(written.ok()) << written.status().message();
  EXPECT_EQ(written->far_origin, far);
  EXPECT_EQ(written->origin_left_out, Vec3d{});
  return json::parse(TempFolder::read(path));
}

// A place in a document, as matrices of floats or of doubles would have it.
template <class Number>
struct Place {
  std::string name;
  glm::mat<3, 3, Number> turn{1};
  glm::vec<3, Number> move{0};
};

// Follows the nodes as an engine does, and appends the place of each.
template <class Number>
void add_places(const json& document, const json& nodes, const Place<Number>& above,
                std::vector<Place<Number>>& places) {
  for (const json& number : nodes) {
    const json& node = document["nodes"].at(number.get<std::size_t>());
    const auto vector = [&](const char* key, Number usual) {
      const json v = node.value(key, json::array({usual, usual, usual}));
      return glm::vec<3, Number>(v[0].get<Number>(), v[1].get<Number>(), v[2].get<Number>());
    };
    const json r = node.value("rotation", json::array({0, 0, 0, 1}));
    const glm::qua<Number> rotation(r[3].get<Number>(), r[0].get<Number>(), r[1].get<Number>(),
                                    r[2].get<Number>());
    Place<Number> place{node.value("name", ""), above.turn * glm::mat3_cast(rotation),
                        above.move + above.turn * vector("translation", 0)};
    const glm::vec<3, Number> scale = vector("scale", 1);
    for (int i = 0; i < 3; ++i) place.turn[i] *= scale[i];
    places.push_back(place);
    if (node.contains("children")) add_places(document, node["children"], place, places);
  }
}

template <class Number>
Place<Number> place_of(const json& document, const std::string& name) {
  std::vector<Place<Number>> places;
  add_places<Number>(document, document["scenes"][0]["nodes"], {}, places);
  for (const Place<Number>& place : places)
    if (place.name == name) return place;
  ADD_FAILURE() << "no node " << name;
  return {};
}

World far_world(Up up) {
  World world = wavy_world(4, 1);
  for (Vec3f& p : world.positions) p = {p.x, p.y, p.z / 1e4f};
  world.pages[0].image.clear();
  world.origin = {456789.5, 120, 5412345};
  world.metres_per_unit = 0.3048;
  world.up = up;
  world.viewpoint.position = {1, 2.5, -3};
  return world;
}

TEST(GltfFarOrigin, IsAddedByANodeOfItsOwn) {
  const TempFolder folder;
  for (const Up up : {Up::y, Up::z}) {
    const World world = far_world(up);
    json document = document_of(world, folder / "w.gltf", true);
    ASSERT_EQ(document["scenes"][0]["nodes"].size(), 1u);
    const auto metres = [&](const Vec3d& v) {
      return 0.3048 * (up == Up::z ? glm::dvec3(v.x, v.z, -v.y) : glm::dvec3(v.x, v.y, v.z));
    };
    const glm::dvec3 eye = metres(world.viewpoint.position), origin = metres(world.origin);
    const glm::dvec3 point = metres({0.5, 0.25, -0.125});
    const auto at = [](const auto& place) {
      return glm::dvec3(place.turn * decltype(place.move)(0.5, 0.25, -0.125) + place.move);
    };
    const auto page = place_of<double>(document, "page0");
    EXPECT_LT(glm::distance(at(page), origin + point), 1e-8);
    EXPECT_LT(glm::distance(place_of<double>(document, "start").move, origin + eye), 1e-8);

    document["nodes"][document["scenes"][0]["nodes"][0].get<std::size_t>()]["translation"] = {0, 0,
                                                                                              0};
    EXPECT_LT(glm::distance(at(place_of<float>(document, "page0")), point), 1e-6);
    EXPECT_LT(glm::distance(glm::dvec3(place_of<float>(document, "start").move), eye), 1e-6);
  }
}

TEST(GltfFarOrigin, IsReadBack) {
  const TempFolder folder;
  const World world = far_world(Up::z);
  document_of(world, folder / "w.gltf", true);
  const auto back = read_scene(folder / "w.gltf", {}, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  const Scene& s = back->scene;
  ASSERT_EQ(s.indices.size(), world.pages[0].indices.size());
  for (std::size_t k = 0; k < s.indices.size(); ++k) {
    const glm::dvec3 p = to_glm(s.origin) + to_dvec(s.positions[s.indices[k]]);
    const glm::dvec3 q = to_glm(world.origin) + to_dvec(world.positions[world.pages[0].indices[k]]);
    ASSERT_LT(glm::distance(p, 0.3048 * glm::dvec3(q.x, q.z, -q.y)), 1e-6);
  }
}

TEST(GltfFarOrigin, OfAKeptSceneToo) {
  const TempFolder folder;
  Scene scene = small_scene();
  scene.origin = {456789, 120, 5412345};
  const json document = document_of(world_of(scene), folder / "w.gltf", true);
  ASSERT_EQ(document["scenes"][0]["nodes"].size(), 1u);
  const json& top = document["nodes"][document["scenes"][0]["nodes"][0].get<std::size_t>()];
  EXPECT_EQ(top["name"], kFarOriginNode);
  EXPECT_EQ(top["translation"], (json{456789.0, 120.0, 5412345.0}));
  EXPECT_EQ(place_of<double>(document, "back").move, glm::dvec3(456789, 120, 5412345));
}

// The limit is 128 times the diagonal of the world's box, as in VRML.
TEST(GltfFarOrigin, NearerOnesAreAddedByTheWorldsNode) {
  const TempFolder folder;
  World world = wavy_world(4, 1);
  world.pages[0].image.clear();
  for (Vec3f& p : world.positions) p = {};
  world.positions[1] = {3, 4, 0};
  for (const bool far : {false, true}) {
    world.origin = {0, far ? 641.0 : 639.0, 0};  // 128 * 5 is 640
    const json document = document_of(world, folder / "w.gltf", far);
    EXPECT_EQ(document["nodes"].size(), far ? 4u : 3u);
    EXPECT_EQ(document["scenes"][0]["nodes"], far ? json::array({3}) : json({0, 1}));
    EXPECT_EQ(document["nodes"][0]["translation"][1], far ? 0 : 639);
  }
}

}  // namespace
}  // namespace atlas::test
