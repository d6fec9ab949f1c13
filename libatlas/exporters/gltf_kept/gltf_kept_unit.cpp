#include "libatlas/exporters/gltf_kept/gltf_kept_unit.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <glm/gtc/quaternion.hpp>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/exporters/gltf_kept/gltf_kept_meshes.h"
#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
using nlohmann::json;
namespace {

constexpr const char* kLights = "KHR_lights_punctual";

// Calls `visit` with the target of each channel of each animation.
template <class Visit>
void for_channels(json& document, const Visit& visit) {
  json* animations = member_at(&document, "animations");
  if (animations == nullptr || !animations->is_array()) return;
  for (json& animation : *animations) {
    json* channels = member_at(&animation, "channels");
    if (channels == nullptr || !channels->is_array()) continue;
    for (json& channel : *channels)
      if (json* target = member_at(&channel, "target")) visit(*target);
  }
}

// Marks the nodes with these numbers, and those below them.
void mark(json& document, const json& numbers, std::vector<bool>& marked) {
  if (!numbers.is_array()) return;
  for (const json& number : numbers) {
    if (!number.is_number_unsigned() && !number.is_number_integer()) continue;
    const auto n = number.get<std::size_t>();
    if (n >= marked.size() || marked[n]) continue;
    marked[n] = true;
    if (const json* children = member_at(&document["nodes"][n], "children"))
      mark(document, *children, marked);
  }
}

std::vector<bool> shown_nodes(json& document) {
  std::vector<bool> shown(document["nodes"].size());
  mark(document, document["scenes"][document["scene"].get<std::size_t>()]["nodes"], shown);
  return shown;
}

json* camera_of(json& node) {
  return member_at(&node, "camera");
}

json* light_of(json& node) {
  return member_at(member_at(member_at(&node, "extensions"), kLights), "light");
}

void scale_members(json* part, std::initializer_list<const char*> keys, double factor) {
  for (const char* key : keys) {
    json* value = member_at(part, key);
    if (value != nullptr && value->is_number()) *value = value->get<double>() * factor;
  }
}

void scale_camera(json& camera, double scale) {
  scale_members(member_at(&camera, "perspective"), {"znear", "zfar"}, scale);
  scale_members(member_at(&camera, "orthographic"), {"znear", "zfar", "xmag", "ymag"}, scale);
}

void scale_light(json& light, double scale) {
  scale_members(&light, {"range"}, scale);
  const json* type = member_at(&light, "type");
  if (type == nullptr || (*type != "point" && *type != "spot")) return;
  if (!light.contains("intensity")) light["intensity"] = 1;  // the default, in candela
  scale_members(&light, {"intensity"}, scale * scale);
}

// Scales those entries of `list` that nodes of the shown scene refer to by what `reference` finds.
template <class Reference, class Scale>
void scale_shown(json& document, json* list, const Reference& reference, const Scale& scale) {
  if (list == nullptr || !list->is_array()) return;
  const std::vector<bool> shown = shown_nodes(document);
  std::vector<json*> inside;
  std::set<std::size_t> outside;
  for (std::size_t n = 0; n < shown.size(); ++n) {
    json* number = reference(document["nodes"][n]);
    if (number == nullptr || !number->is_number_integer()) continue;
    if (number->get<std::size_t>() >= list->size()) continue;
    if (shown[n])
      inside.push_back(number);
    else
      outside.insert(number->get<std::size_t>());
  }
  std::map<std::size_t, std::size_t> scaled;
  for (json* number : inside) {
    const auto before = number->get<std::size_t>();
    const auto [at, is_new] = scaled.try_emplace(before, before);
    if (is_new && outside.contains(before)) {
      at->second = list->size();
      list->push_back(json((*list)[before]));
    }
    if (is_new) scale((*list)[at->second]);
    *number = at->second;
  }
}

// Returns the nodes that animations move.
std::set<std::size_t> animated_nodes(json& document) {
  std::set<std::size_t> nodes;
  for_channels(document, [&](json& target) {
    const json* node = member_at(&target, "node");
    if (node != nullptr && node->is_number_integer()) nodes.insert(node->get<std::size_t>());
  });
  return nodes;
}

// Returns the numbers of a node's property. The reader takes one that is anything else as absent,
// and so does this, which then returns `absent`.
json numbers_of(const json& node, const char* key, const json& absent) {
  const auto at = node.find(key);
  const bool good =
      at != node.end() && at->is_array() && at->size() == absent.size() &&
      std::all_of(at->begin(), at->end(), [](const json& v) { return v.is_number(); });
  return good ? *at : absent;
}

glm::dvec3 translation_of(const json& node) {
  const json v = numbers_of(node, "translation", {0, 0, 0});
  return {v[0], v[1], v[2]};
}

glm::dquat rotation_of(const json& node) {
  const json q = numbers_of(node, "rotation", {0, 0, 0, 1});
  const glm::dquat turn(q[3], q[0], q[1], q[2]);
  return glm::length(turn) > 0 ? glm::normalize(turn) : glm::dquat(1, 0, 0, 0);
}

// Moves a node from below `top` to beside it: places it where it was, without the scale of `top`.
void place_beside(const json& top, double scale, json& node) {
  const glm::dvec3 t = scale * (rotation_of(top) * translation_of(node));
  const glm::dquat q = glm::normalize(rotation_of(top) * rotation_of(node));
  node["translation"] = {t.x, t.y, t.z};
  if (top.contains("rotation") || node.contains("rotation"))
    node["rotation"] = {q.x, q.y, q.z, q.w};
}

// Makes cameras that are alone root nodes beside `top`, if they were root nodes and rest.
void free_cameras(json& document, double metres_per_unit) {
  const std::set<std::size_t> animated = animated_nodes(document);
  json& roots = document["scenes"][document["scene"].get<std::size_t>()]["nodes"];
  json& top = document["nodes"][roots[0].get<std::size_t>()];
  json below = json::array();
  for (const json& child : top["children"]) {
    json& node = document["nodes"][child.get<std::size_t>()];
    bool alone = camera_of(node) != nullptr && !animated.contains(child.get<std::size_t>());
    for (const char* other : {"children", "mesh", "matrix", "extensions"})
      alone &= !node.contains(other);
    if (alone) place_beside(top, metres_per_unit, node);
    (alone ? roots : below).push_back(child);
  }
  top["children"] = std::move(below);
  if (top["children"].empty()) top.erase("children");
}

// Gives cameras the scale that they had. By the standard it does not matter, but Babylon.js and
// X_ITE look through a scaled camera as if its planes were scaled. Where a camera is not alone, a
// node with the inverse scale comes between; the camera itself has none, as Babylon.js replaces it.
void keep_scale_of_cameras(json& document, double metres_per_unit) {
  std::vector<bool> shown = shown_nodes(document);
  json& nodes = document["nodes"];
  const auto has_camera = [&](std::size_t n) { return shown[n] && camera_of(nodes[n]) != nullptr; };
  bool any = false;
  for (std::size_t n = 0; n < shown.size(); ++n) any |= has_camera(n);
  if (!any) return;
  free_cameras(document, metres_per_unit);
  for (const json& root : document["scenes"][document["scene"].get<std::size_t>()]["nodes"])
    shown[root.get<std::size_t>()] = false;  // nothing is above them
  for (std::size_t n = 0; n < shown.size(); ++n) {
    if (!has_camera(n)) continue;
    const double inverse = 1 / metres_per_unit;
    json camera = {{"camera", std::move(nodes[n]["camera"])}};
    if (nodes[n].contains("name")) camera["name"] = nodes[n]["name"];
    nodes[n].erase("camera");
    nodes[n]["children"].push_back(nodes.size());
    nodes.push_back({{"scale", {inverse, inverse, inverse}}, {"children", {nodes.size() + 1}}});
    nodes.push_back(std::move(camera));
  }
}

// Returns whether a pointer names a value that is scaled here.
bool is_length(json& document, const std::string& pointer) {
  const std::string name = pointer.substr(pointer.rfind('/') + 1);
  if (pointer.starts_with("/cameras/"))
    return name == "znear" || name == "zfar" || name == "xmag" || name == "ymag";
  if (pointer.starts_with("/materials/")) return name == "attenuationDistance";
  const std::string of_lights = std::string("/extensions/") + kLights + "/lights/";
  if (!pointer.starts_with(of_lights)) return false;
  if (name != "intensity") return name == "range";
  json* lights = member_at(member_at(member_at(&document, "extensions"), kLights), "lights");
  std::size_t number = 0;
  std::from_chars(pointer.data() + of_lights.size(), pointer.data() + pointer.size(), number);
  if (lights == nullptr || !lights->is_array() || number >= lights->size()) return false;
  const json* type = member_at(&(*lights)[number], "type");
  return type != nullptr && *type != "directional";  // whose unit has no length
}

// Counts animations of values that are scaled here: their own values stay.
void count_animations(json& document, Losses& losses) {
  for_channels(document, [&](json& target) {
    const auto pointer = pointer_of(&target);
    losses.add("animations of cameras, lights and volumes, in another unit",
               pointer && is_length(document, *pointer));
  });
}

}  // namespace

void scale_kept_lengths(double metres_per_unit, json& document, Losses& losses) {
  const auto camera = [&](json& part) { scale_camera(part, metres_per_unit); };
  const auto light = [&](json& part) { scale_light(part, metres_per_unit); };
  json* lights = member_at(member_at(member_at(&document, "extensions"), kLights), "lights");
  scale_shown(document, member_at(&document, "cameras"), camera_of, camera);
  scale_shown(document, lights, light_of, light);
  if (json* materials = member_at(&document, "materials"); materials && materials->is_array())
    for (json& material : *materials)
      scale_members(member_at(member_at(&material, "extensions"), "KHR_materials_volume"),
                    {"attenuationDistance"}, metres_per_unit);
  keep_scale_of_cameras(document, metres_per_unit);
  count_animations(document, losses);
}

}  // namespace atlas
