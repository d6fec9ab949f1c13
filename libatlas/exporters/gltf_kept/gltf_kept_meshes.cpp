#include "libatlas/exporters/gltf_kept/gltf_kept_meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
using nlohmann::json;
namespace {

constexpr const char* kPointer = "KHR_animation_pointer";
constexpr std::string_view kMeshes = "/meshes/", kNodes = "/nodes/";

using Numbers = std::vector<std::optional<std::size_t>>;  // the new one of each mesh that is left

// Calls `edit` with each channel of the animations, and with the list to which it adds what becomes
// of it. Animations of which no channel is left are left out.
void edit_channels(json& document, const std::function<void(json, json&)>& edit) {
  const auto animations = document.find("animations");
  if (animations == document.end() || !animations->is_array()) return;
  json kept = json::array();
  for (json& animation : *animations) {
    const auto channels = animation.is_object() ? animation.find("channels") : animation.end();
    if (animation.is_object() && channels != animation.end() && channels->is_array() &&
        !channels->empty()) {
      json edited = json::array();
      for (json& channel : *channels) edit(std::move(channel), edited);
      if (edited.empty()) continue;
      *channels = std::move(edited);
    }
    kept.push_back(std::move(animation));
  }
  *animations = std::move(kept);
}

std::optional<std::string> pointer_of_channel(json& channel) {
  return pointer_of(member_at(&channel, "target"));
}

// An element of a list that a pointer names, and what follows its number.
struct Place {
  std::size_t number = 0;
  std::string rest;
};

std::optional<Place> place_in(std::string_view list, const std::optional<std::string>& pointer) {
  if (!pointer || !pointer->starts_with(list)) return {};
  const char* const end = pointer->data() + pointer->size();
  Place place;
  const auto [next, error] = std::from_chars(pointer->data() + list.size(), end, place.number);
  if (error != std::errc() || (next != end && *next != '/')) return {};
  place.rest.assign(next, end);
  return place;
}

json with_pointer(json channel, std::string_view list, const Place& place) {
  channel["target"]["extensions"][kPointer]["pointer"] =
      fmt::format("{}{}{}", list, place.number, place.rest);
  return channel;
}

// Returns the node whose weights a channel moves without a pointer, or -1.
std::int64_t weights_of(json& channel) {
  const json* target = member_at(&channel, "target");
  const bool weights =
      target != nullptr && target->is_object() && target->value("path", json()) == "weights";
  return weights ? integer_at(*target, "node", -1) : -1;
}

// Replaces the matrix of an instance by what it was made of: the format allows none for a node that
// is animated. If the instance has no size, nothing shows the difference.
void divide_matrix(json& node) {
  const auto at = node.find("matrix");
  if (at == node.end()) return;
  glm::dmat4 m;
  for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = (*at)[std::size_t(i)].get<double>();
  glm::dvec3 scale(glm::length(m[0]), glm::length(m[1]), glm::length(m[2]));
  if (!(std::min({scale.x, scale.y, scale.z}) > 0)) return;
  if (glm::determinant(glm::dmat3(m)) < 0) scale.x = -scale.x;
  glm::dmat3 turn(m);
  for (int c = 0; c < 3; ++c) turn[c] /= scale[c];
  const glm::dquat q = glm::normalize(glm::quat_cast(turn));
  node.erase(at);
  node["translation"] = {m[3].x, m[3].y, m[3].z};
  node["rotation"] = {q.x, q.y, q.z, q.w};
  node["scale"] = {scale.x, scale.y, scale.z};
}

// Gives parts of extensions that name a mesh (shapes of physics, expressions of VRM) its new
// number. Returns how many name one that is gone; the name is removed.
std::size_t renumber_extensions(json& part, const Numbers& numbers, bool inside) {
  std::size_t gone = 0;
  if (!part.is_structured()) return gone;
  for (auto at = part.begin(); at != part.end();) {
    const bool keyed = part.is_object();
    const bool named = keyed && inside && at.key() == "mesh" && at->is_number_integer();
    const std::int64_t number = named ? at->get<std::int64_t>() : -1;
    if (number >= 0 && std::size_t(number) < numbers.size()) {
      if (!numbers[std::size_t(number)]) {
        at = part.erase(at);
        ++gone;
        continue;
      }
      *at = *numbers[std::size_t(number)];
    } else if (!keyed || at.key() != "extras") {
      gone += renumber_extensions(*at, numbers, inside || (keyed && at.key() == "extensions"));
    }
    ++at;
  }
  return gone;
}

void renumber_channels(json& document, const Numbers& numbers, const std::set<std::int64_t>& bare,
                       Losses& losses) {
  edit_channels(document, [&](json channel, json& to) {
    auto place = place_in(kMeshes, pointer_of_channel(channel));
    const auto node = place_in(kNodes, pointer_of_channel(channel));
    const bool known = place && place->number < numbers.size();
    if ((known && !numbers[place->number]) || bare.contains(weights_of(channel)) ||
        (node && node->rest.starts_with("/weights") && bare.contains(std::int64_t(node->number))))
      return losses.add("animations of meshes of which no primitive is left");
    if (known) {
      place->number = *numbers[place->number];
      channel = with_pointer(std::move(channel), kMeshes, *place);
    }
    to.push_back(std::move(channel));
  });
}

}  // namespace

std::optional<std::string> pointer_of(json* target) {
  const json* pointer = member_at(member_at(member_at(target, "extensions"), kPointer), "pointer");
  if (pointer == nullptr || !pointer->is_string()) return {};
  return pointer->get<std::string>();
}

void leave_mesh(json& node) {
  for (const char* key : {"mesh", "skin", "weights"}) node.erase(key);
}

void animate_copies(const GltfSource& source, const std::vector<std::size_t>& meshes,
                    json& document) {
  std::multimap<std::size_t, std::size_t> copies;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const auto mesh = static_cast<std::size_t>(source.places[i].mesh);
    if (meshes[i] != mesh) copies.emplace(mesh, meshes[i]);
  }
  if (copies.empty()) return;
  edit_channels(document, [&](json channel, json& to) {
    to.push_back(channel);
    const auto place = place_in(kMeshes, pointer_of_channel(channel));
    if (!place) return;
    const auto [begin, end] = copies.equal_range(place->number);
    for (auto at = begin; at != end; ++at)
      to.push_back(with_pointer(channel, kMeshes, {at->second, place->rest}));
  });
}

void animate_instances(const InstanceNodes& instances, json& document) {
  if (instances.empty()) return;
  edit_channels(document, [&](json channel, json& to) {
    const auto place = place_in(kNodes, pointer_of_channel(channel));
    const bool by_pointer = place && place->rest.starts_with("/weights");
    const std::int64_t node =
        by_pointer ? static_cast<std::int64_t>(place->number) : weights_of(channel);
    const auto found = instances.find(static_cast<std::size_t>(node));
    if (node < 0 || found == instances.end()) return to.push_back(std::move(channel));
    for (const std::size_t instance : found->second) {
      divide_matrix(document["nodes"][instance]);
      json copy = by_pointer ? with_pointer(channel, kNodes, {instance, place->rest}) : channel;
      if (!by_pointer) copy["target"]["node"] = instance;
      to.push_back(std::move(copy));
    }
  });
}

void drop_empty_meshes(json& document, Losses& losses) {
  json meshes = json::array();
  Numbers numbers;
  for (json& mesh : document["meshes"]) {
    const bool empty = mesh["primitives"].empty();
    losses.add("meshes of which no primitive is left", empty);
    numbers.push_back(empty ? std::nullopt : std::optional(meshes.size()));
    if (!empty) meshes.push_back(std::move(mesh));
  }
  const bool all = meshes.size() == numbers.size();
  document["meshes"] = std::move(meshes);
  std::set<std::int64_t> bare;  // nodes that have lost their mesh
  json& nodes = document["nodes"];
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto at = nodes[n].find("mesh");
    if (at == nodes[n].end() || !at->is_number_integer()) continue;
    const auto number = at->get<std::size_t>();
    if (number < numbers.size() && numbers[number]) {
      *at = *numbers[number];
    } else {
      leave_mesh(nodes[n]);
      bare.insert(std::int64_t(n));
    }
  }
  if (all) return;
  renumber_channels(document, numbers, bare, losses);
  losses.add("parts of extensions that name a mesh of which no primitive is left",
             renumber_extensions(document, numbers, false));
}

}  // namespace atlas
