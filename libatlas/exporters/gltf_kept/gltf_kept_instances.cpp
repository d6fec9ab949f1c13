#include "libatlas/exporters/gltf_kept/gltf_kept_instances.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include "libatlas/scene/gltf/gltf_instances.h"

namespace atlas {
using nlohmann::json;
namespace {

constexpr int kFloatType = 5126;

// Uvs of glTF begin at the top: v = 1 - v' on both sides of v scale + offset.
MeshInstance from_the_top(const MeshInstance& at) {
  return {at.page, at.scale, {at.offset.x, float(1.0 - double{at.scale.y} - double{at.offset.y})}};
}

// Returns a float as the shortest decimal that reads back to it.
double shortest(float value) {
  return std::stod(fmt::format("{}", value));
}

json pair_of(const Vec2f& v) {
  return {shortest(v.x), shortest(v.y)};
}

void name_in_extras(const MeshInstance& at, bool several_pages, json& node, Losses& losses) {
  json& extras = node["extras"];
  losses.add("extras of nodes that are no object", !extras.is_null() && !extras.is_object());
  if (!extras.is_object()) extras = json::object();
  extras["lightmapScale"] = pair_of(at.scale);
  extras["lightmapOffset"] = pair_of(at.offset);
  if (several_pages) extras["lightmapPage"] = at.page;
}

template <class T>
std::size_t add_values(const std::vector<T>& values, const char* type, GltfDocument& document) {
  const std::size_t view =
      document.add_view(values.data(), values.size() * sizeof(T), json::object());
  return document.add_accessor({{"bufferView", view},
                                {"componentType", kFloatType},
                                {"type", type},
                                {"count", values.size()}});
}

void name_in_attributes(const std::vector<MeshInstance>& all, bool several_pages, json& attributes,
                        GltfDocument& document) {
  std::vector<Vec2f> scales, offsets;
  std::vector<float> pages;  // readers of instances know floats
  for (const MeshInstance& at : all) {
    scales.push_back(at.scale);
    offsets.push_back(at.offset);
    pages.push_back(float(at.page));
  }
  attributes["_LIGHTMAP_SCALE"] = add_values(scales, "VEC2", document);
  attributes["_LIGHTMAP_OFFSET"] = add_values(offsets, "VEC2", document);
  if (several_pages) attributes["_LIGHTMAP_PAGE"] = add_values(pages, "SCALAR", document);
}

}  // namespace

void name_instances(const World& world, const std::vector<std::size_t>& node_of_place,
                    GltfDocument& document, Losses& losses) {
  const std::vector<MeshInstance>& instances = *world.instances;
  if (instances.empty()) return;
  const bool several =
      std::ranges::any_of(instances, [](const MeshInstance& at) { return at.page > 0; });
  std::map<std::size_t, std::vector<MeshInstance>> of_node;
  for (std::size_t p = 0; p < node_of_place.size(); ++p)
    of_node[node_of_place[p]].push_back(from_the_top(instances[p]));
  for (const auto& [number, all] : of_node) {
    json& node = document.json["nodes"][number];
    if (!node.contains("mesh")) continue;
    const auto extensions = node.find("extensions");
    const bool instanced = extensions != node.end() && extensions->contains(kGltfInstancing);
    if (instanced)
      name_in_attributes(all, several, (*extensions)[kGltfInstancing]["attributes"], document);
    else
      name_in_extras(all.front(), several, node, losses);
  }
}

}  // namespace atlas
