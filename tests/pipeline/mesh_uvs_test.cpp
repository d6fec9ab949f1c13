// Meshes that a glTF scene shows several times: uvs for each place from shared data, scale and
// offset for each place, or one square for each mesh.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/reader.h"
#include "tests/support/atlas_measure.h"
#include "tests/support/shapes.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

using nlohmann::json;

constexpr int kCopies = 60;

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

// A .gltf of a ball that kCopies nodes show, and of a box that two nodes show, one of them at twice
// the size. With `instanced`, one node shows the balls by EXT_mesh_gpu_instancing.
std::filesystem::path write_instances(const TempFolder& folder, bool instanced) {
  const Shape ball = icosphere(2), cube = box(2);
  json file{{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  std::string bytes;
  const auto view = [&](std::size_t begin) {
    file["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size() - begin}});
    return file["bufferViews"].size() - 1;
  };
  const auto accessor = [&](std::size_t of, int component, const char* type, std::size_t count) {
    file["accessors"].push_back(
        {{"bufferView", of}, {"componentType", component}, {"type", type}, {"count", count}});
    return file["accessors"].size() - 1;
  };
  for (const Shape& shape : {ball, cube}) {
    std::size_t begin = bytes.size();
    append(bytes, shape.positions);
    const std::size_t positions = accessor(view(begin), 5126, "VEC3", shape.positions.size());
    file["accessors"][positions]["min"] = {-1, -1, -1};
    file["accessors"][positions]["max"] = {1, 1, 1};
    begin = bytes.size();
    append(bytes, shape.indices);
    const std::size_t indices = accessor(view(begin), 5125, "SCALAR", shape.indices.size());
    file["meshes"].push_back(
        {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  }
  std::vector<Vec3f> places;
  for (int k = 0; k < kCopies; ++k) places.push_back({float(3 * k), 0, 0});
  json roots = json::array();
  const auto add_node = [&](json node) {
    roots.push_back(roots.size());
    file["nodes"].push_back(std::move(node));
  };
  if (instanced) {
    const std::size_t begin = bytes.size();
    append(bytes, places);
    const std::size_t translation = accessor(view(begin), 5126, "VEC3", places.size());
    add_node({{"mesh", 0},
              {"extensions",
               {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translation}}}}}}}});
    file["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  } else {
    for (const Vec3f& p : places) add_node({{"mesh", 0}, {"translation", {p.x, p.y, p.z}}});
  }
  add_node({{"mesh", 1}, {"translation", {0, 5, 0}}, {"extras", {{"own", 7}}}});
  add_node({{"mesh", 1}, {"translation", {5, 5, 0}}, {"scale", {2, 2, 2}}});
  file["scenes"] = {{{"nodes", roots}}};
  file["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "data.bin"}}};
  std::ofstream(folder / "data.bin", std::ios::binary) << bytes;
  std::ofstream(folder / "in.gltf") << file.dump();
  return folder / "in.gltf";
}

struct Exported {
  json file;
  std::string data;
  ExportReport report;
  std::uintmax_t bytes = 0;
};

Exported exported(const TempFolder& folder, bool instanced, MeshUvs uvs) {
  const auto scene = read_scene(write_instances(folder, instanced), {.keep_scene = true}, {});
  EXPECT_TRUE(scene.ok()) << scene.status().message();
  ExportOptions options;
  options.target = folder / "out.gltf";
  options.keep_scene = options.charts_only = true;
  options.mesh_uvs = uvs;
  options.packing = PackPreset::fast;
  options.larger_plain_page = false;
  options.atlas_size = 1024;
  auto report = export_world(*scene, options, {}, {});
  EXPECT_TRUE(report.ok()) << report.status().message();
  if (!report.ok()) return {};
  Exported out;
  std::ifstream(folder / "out.gltf") >> out.file;
  std::ifstream bin(folder / "out.bin", std::ios::binary);
  out.data.assign(std::istreambuf_iterator<char>(bin), {});
  out.bytes = std::filesystem::file_size(folder / "out.gltf") + out.data.size();
  out.report = std::move(*report);
  return out;
}

template <class T>
std::vector<T> values_of(const Exported& made, const json& accessor_number) {
  const json& accessor = made.file["accessors"][accessor_number.get<std::size_t>()];
  const json& view = made.file["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  std::vector<T> values(accessor["count"].get<std::size_t>());
  const std::size_t begin =
      view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
  std::memcpy(values.data(), made.data.data() + begin, values.size() * sizeof(T));
  return values;
}

// One mesh on the pages, at uv * scale + offset.
void draw(const Exported& made, const json& primitive, const Vec2f& scale, const Vec2f& offset,
          UvMesh& all) {
  const auto positions = values_of<Vec3f>(made, primitive["attributes"]["POSITION"]);
  const auto uvs = values_of<Vec2f>(made, primitive["attributes"]["TEXCOORD_1"]);
  const auto indices = values_of<std::uint16_t>(made, primitive["indices"]);
  const auto first = std::uint32_t(all.positions.size());
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    all.positions.push_back({positions[v].x + double(first), positions[v].y, positions[v].z});
    all.uvs.push_back({uvs[v].x * scale.x + offset.x, 1 - (uvs[v].y * scale.y + offset.y)});
  }
  for (std::size_t k = 0; k < indices.size(); k += 3) {
    UvMesh::Face face{{}, {}, 0};
    for (std::size_t c = 0; c < 3; ++c) face.position[c] = face.uv[c] = first + indices[k + c];
    all.faces.push_back(face);
  }
}

void expect_apart(const UvMesh& mesh, const Exported& made) {
  const AtlasMeasures m =
      measure_atlas(mesh, made.report.pages[0].width, made.report.pages[0].height);
  EXPECT_EQ(m.overlap, 0u);
  EXPECT_EQ(m.flipped, 0u);
  EXPECT_EQ(m.bleed, 0u);
  EXPECT_GT(m.utilization, 0.2);
}

Vec2f pair_of(const json& pair) {
  return {pair[0].get<float>(), pair[1].get<float>()};
}

TEST(MeshUvs, PlacesShareAllButTheirUvs) {
  const TempFolder folder;
  const Exported made = exported(folder, false, MeshUvs::places);
  std::set<json> positions, uvs;
  UvMesh all;
  all.pages = 1;
  for (const json& node : made.file["nodes"]) {
    if (!node.contains("mesh")) continue;
    const json& primitive = made.file["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
    positions.insert(primitive["attributes"]["POSITION"]);
    uvs.insert(primitive["attributes"]["TEXCOORD_1"]);
    draw(made, primitive, {1, 1}, {0, 0}, all);
  }
  EXPECT_EQ(uvs.size(), kCopies + 2u);
  EXPECT_LE(positions.size(), 4u);  // one of the balls, and of the boxes of two sizes
  expect_apart(all, made);
}

TEST(MeshUvs, InstancesHaveTheMeshOnceWithScaleAndOffsetInExtras) {
  const TempFolder folder;
  const Exported made = exported(folder, false, MeshUvs::instances);
  ASSERT_EQ(made.file["meshes"].size(), 2u);
  UvMesh all;
  all.pages = 1;
  std::vector<float> box_scales;
  for (const json& node : made.file["nodes"]) {
    const json& extras = node["extras"];
    const auto mesh = node["mesh"].get<std::size_t>();
    EXPECT_FALSE(extras.contains("lightmapPage"));
    draw(made, made.file["meshes"][mesh]["primitives"][0], pair_of(extras["lightmapScale"]),
         pair_of(extras["lightmapOffset"]), all);
    if (mesh == 1) box_scales.push_back(pair_of(extras["lightmapScale"]).x);
  }
  EXPECT_EQ(all.faces.size(), 320u * kCopies + 2 * 48);
  expect_apart(all, made);
  ASSERT_EQ(box_scales.size(), 2u);
  EXPECT_NEAR(box_scales[1] / box_scales[0], 2, 1e-4);
  EXPECT_EQ(made.file["nodes"][kCopies]["extras"]["own"], 7);
  EXPECT_LT(made.bytes, std::filesystem::file_size(folder / "in.gltf") +
                            std::filesystem::file_size(folder / "data.bin") + 150 * kCopies + 8000);
  // They can be read again, and unwrapped once more.
  EXPECT_TRUE(read_scene(folder / "out.gltf", {.keep_scene = true}, {}).ok());
}

TEST(MeshUvs, InstancesOfANodeHaveThemAsAttributes) {
  const TempFolder folder;
  const Exported made = exported(folder, true, MeshUvs::instances);
  ASSERT_EQ(made.file["meshes"].size(), 2u);
  const json& attributes =
      made.file["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  ASSERT_TRUE(attributes.contains("TRANSLATION"));
  const auto scales = values_of<Vec2f>(made, attributes["_LIGHTMAP_SCALE"]);
  const auto offsets = values_of<Vec2f>(made, attributes["_LIGHTMAP_OFFSET"]);
  ASSERT_EQ(scales.size(), std::size_t(kCopies));
  UvMesh all;
  all.pages = 1;
  for (std::size_t k = 0; k < scales.size(); ++k)
    draw(made, made.file["meshes"][0]["primitives"][0], scales[k], offsets[k], all);
  expect_apart(all, made);
  EXPECT_EQ(made.file["extensionsUsed"], json({"EXT_mesh_gpu_instancing"}));
  EXPECT_TRUE(made.file["nodes"][1]["extras"].contains("lightmapScale"));
}

TEST(MeshUvs, EachMeshHasASquareOfItsOwn) {
  const TempFolder folder;
  const Exported made = exported(folder, false, MeshUvs::meshes);
  ASSERT_EQ(made.file["meshes"].size(), 2u);
  ASSERT_EQ(made.report.pages.size(), 2u);
  for (const json& mesh : made.file["meshes"]) {
    UvMesh all;
    all.pages = 1;
    draw(made, mesh["primitives"][0], {1, 1}, {0, 0}, all);
    expect_apart(all, made);
  }
  for (const json& node : made.file["nodes"])
    EXPECT_FALSE(node.contains("extras") && node["extras"].contains("lightmapScale"));
}

TEST(MeshUvs, OtherScenesAndFormatsAreRefused) {
  const TempFolder folder;
  const auto scene = read_scene(write_instances(folder, false), {.keep_scene = true}, {});
  ASSERT_TRUE(scene.ok());
  ExportOptions options;
  options.keep_scene = options.charts_only = true;
  options.mesh_uvs = MeshUvs::instances;
  options.target = folder / "out.obj";
  EXPECT_EQ(export_world(*scene, options, {}, {}).status().code(), ErrorCode::bad_option);
  options.target = folder / "out.glb";
  options.keep_scene = false;
  EXPECT_EQ(export_world(*scene, options, {}, {}).status().code(), ErrorCode::bad_option);
  options.keep_scene = true;
  LoadedScene without = *scene;
  without.scene.source = nullptr;
  EXPECT_EQ(export_world(without, options, {}, {}).status().code(), ErrorCode::bad_option);
  options.mesh_uvs = MeshUvs(9);
  EXPECT_EQ(export_world(*scene, options, {}, {}).status().code(), ErrorCode::bad_option);
}

}  // namespace
}  // namespace atlas::test
