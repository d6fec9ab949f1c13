#include "libatlas/exporters/gltf_kept/gltf_kept_rest.h"

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "libatlas/scene/building/lightmap_images.h"
#include "libatlas/scene/gltf/gltf_check.h"
#include "libatlas/scene/gltf/gltf_instances.h"
#include "libatlas/scene/uv_page.h"

namespace atlas {
using nlohmann::json;
namespace {

// Returns whether a part has a key that, in extensions, always is the number of an accessor or a
// buffer view.
bool names_data(const json& part) {
  constexpr std::string_view kKeys[] = {"accessor",    "accessors", "attributes", "bufferView",
                                        "bufferViews", "indices",   "values"};
  if (part.is_array()) return std::any_of(part.begin(), part.end(), names_data);
  if (!part.is_object()) return false;
  for (const auto& [key, value] : part.items())
    if (std::find(std::begin(kKeys), std::end(kKeys), key) != std::end(kKeys) || names_data(value))
      return true;
  return false;
}

// Collects the names of all extensions in a part of a document.
void collect_extensions(const json& part, std::set<std::string>& names) {
  if (!part.is_structured()) return;
  for (const auto& [key, value] : part.items()) {
    if (part.is_object() && key == "extras") continue;
    if (part.is_object() && key == "extensions" && value.is_object())
      for (const auto& [name, extension] : value.items()) names.insert(name);
    collect_extensions(value, names);
  }
}

// Removes extensions by name from all parts of a document, and returns how many.
std::size_t remove_extensions(json& part, const std::set<std::string>& names) {
  std::size_t removed = 0;
  if (!part.is_structured()) return removed;
  const bool object = part.is_object();
  if (object && part.contains("extensions") && part["extensions"].is_object()) {
    for (const std::string& name : names) removed += part["extensions"].erase(name);
    if (removed > 0 && part["extensions"].empty()) part.erase("extensions");
  }
  for (auto at = part.begin(); at != part.end(); ++at)
    if (!object || at.key() != "extras") removed += remove_extensions(*at, names);
  return removed;
}

// Drops the extensions of the whole file that hold data of their own, and with them what parts of
// the file say by the same extensions: it refers to that data.
void drop_file_extensions(json& document, Losses& losses) {
  std::set<std::string> before, after;
  const auto names = [](const json& of, std::set<std::string>& to) {
    if (const auto at = of.find("extensions"); at != of.end() && at->is_object())
      for (const auto& [name, extension] : at->items()) to.insert(name);
  };
  names(document, before);
  drop_data_extensions(document, losses);
  names(document, after);
  for (const std::string& name : after) before.erase(name);
  for (const std::string& name : before)
    losses.add("parts that refer to the data of " + name, remove_extensions(document, {name}));
}

std::set<std::string> listed(const json& document, const char* list) {
  std::set<std::string> names;
  const auto at = document.find(list);
  if (at == document.end() || !at->is_array()) return names;
  for (const json& name : *at)
    if (name.is_string()) names.insert(name.get<std::string>());
  return names;
}

// Lists as used the extensions that are in the document, those that it lists because the writer
// uses them, and those that the source lists as used without containing them, such as that for
// quantised values.
void list_extensions(const json& before, json& document) {
  std::set<std::string> had, has;
  collect_extensions(before, had);
  collect_extensions(document, has);
  std::set<std::string> used = has, required;
  for (const std::string& name : listed(before, "extensionsUsed"))
    if (!had.contains(name)) used.insert(name);
  for (const std::string& name : listed(before, "extensionsRequired"))
    if (used.contains(name)) required.insert(name);
  used.merge(listed(document, "extensionsUsed"));
  required.merge(listed(document, "extensionsRequired"));
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) document.erase(list);
  if (!used.empty()) document["extensionsUsed"] = used;
  if (!required.empty()) document["extensionsRequired"] = required;
}

// Renumbers the data of an animation. Returns false if some of it is missing.
bool renumber_animation(json& animation, GltfData& data) {
  const auto samplers = animation.is_object() ? animation.find("samplers") : animation.end();
  if (!animation.is_object() || samplers == animation.end() || !samplers->is_array()) return false;
  for (json& sampler : *samplers)
    if (!sampler.is_object() || !data.renumber(sampler, "input") ||
        !data.renumber(sampler, "output"))
      return false;
  return true;
}

void keep_animations(GltfData& data, json& document, Losses& losses) {
  const auto at = document.find("animations");
  if (at == document.end() || !at->is_array()) return;
  json kept = json::array();
  for (json& animation : *at) {
    if (renumber_animation(animation, data))
      kept.push_back(std::move(animation));
    else
      losses.add("animations whose data cannot be read");
  }
  document.erase("animations");
  if (!kept.empty()) document["animations"] = std::move(kept);
}

void keep_skins(GltfData& data, json& document, Losses& losses) {
  const auto at = document.find("skins");
  if (at == document.end()) return;
  for (json& skin : *at)
    if (skin.contains("inverseBindMatrices") && !data.renumber(skin, "inverseBindMatrices"))
      losses.add("matrices of skins that cannot be read");
}

// Keeps those attributes of instances that only programs know (_ID, _COLOR_0).
void keep_other_attributes(GltfData& data, json& attributes, Losses& losses) {
  std::vector<std::string> others;
  for (const auto& [name, accessor] : attributes.items())
    if (name != "TRANSLATION" && name != "ROTATION" && name != "SCALE") others.push_back(name);
  for (const std::string& name : others) {
    if (!data.renumber(attributes, name.c_str()))
      losses.add("attributes of instances whose data cannot be read");
  }
}

// The instances of nodes that are shown have become nodes by now; these are those of other nodes.
void keep_instances(GltfData& data, json& node, Losses& losses) {
  json& attributes = node["extensions"][kGltfInstancing]["attributes"];
  bool whole = attributes.is_object();
  if (whole) {
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"})
      if (attributes.contains(name)) whole &= data.renumber(attributes, name);
  }
  if (whole) return keep_other_attributes(data, attributes, losses);
  node["extensions"].erase(kGltfInstancing);
  losses.add("instances of nodes whose data cannot be read");
}

// Returns what an asset says of an earlier export's lightmap, or null.
const json* lightmap_of(const json* asset) {
  return member_at(member_at(asset, "extras"), "lightmap");
}

// Returns the lines of a source that are still true. Pages of its uvs name their set, because they
// are in one file with others now.
json true_info(json info, bool ours, const std::set<std::int64_t>& new_sets) {
  json lines = json::array();
  if (info.is_null()) return lines;
  if (!info.is_array()) info = json::array({std::move(info)});
  for (const json& line : info) {
    const auto set = line.is_string() ? uv_set_of_page(line.get<std::string>()) : std::nullopt;
    if (set && !new_sets.contains(*set)) lines.push_back(of_uv_set(*set, line));
    if (!set && !ours) lines.push_back(line);
  }
  return lines;
}

}  // namespace

json merge_assets(const json& source, const json& own, const std::set<std::int64_t>& new_sets) {
  if (!source.is_object()) return own;
  const bool ours = source.value("generator", json()) == own["generator"];
  json merged = source;
  json& extras = merged["extras"];
  if (!extras.is_null() && !extras.is_object()) extras = {{"source", std::move(extras)}};
  if (extras.is_null()) extras = json::object();
  json& info = extras["info"];
  info = true_info(std::move(info), ours, new_sets);
  const json added = own.value("extras", json::object());
  if (added.contains("title") && !extras.contains("title")) extras["title"] = added["title"];
  for (const json& line : added.value("info", json::array())) info.push_back(line);
  // An earlier lightmap whose uvs are replaced is none any more. Others than ours keep what is none
  // of ours.
  if (const auto map = extras.find("lightmap"); map != extras.end()) {
    const json* set = member_at(&*map, "texCoord");
    const bool named = set != nullptr && set->is_number_integer();
    if (named ? new_sets.contains(set->get<std::int64_t>()) : ours) extras.erase(map);
  }
  if (added.contains("lightmap")) extras["lightmap"] = added["lightmap"];
  merged["version"] = own["version"];
  merged["generator"] = own["generator"];
  return merged;
}

void count_absent_images(const json& asset, const std::filesystem::path& file, Losses& losses) {
  std::error_code error;  // a file that cannot be examined is not there
  for (const char* list : {"images", "linear"}) {
    const json* names = member_at(lightmap_of(&asset), list);
    if (names == nullptr) continue;
    for (const json& name : *names)
      if (name.is_string() && !std::filesystem::exists(lightmap_path(name, file), error))
        losses.add("images of the lightmap, which are not beside the file (copy them there)");
  }
}

std::int64_t lightmap_set(const json& source) {
  const json* map = lightmap_of(member_at(&source, "asset"));
  return map == nullptr ? -1 : integer_at(*map, "texCoord", -1);
}

void drop_lightmap_page(json& primitive) {
  const auto extras = primitive.find("extras");
  if (extras == primitive.end() || !extras->is_object()) return;
  extras->erase("lightmap");
  if (extras->empty()) primitive.erase("extras");
}

void drop_data_extensions(json& part, Losses& losses) {
  const auto extensions = part.find("extensions");
  if (extensions == part.end() || !extensions->is_object()) return;
  for (auto at = extensions->begin(); at != extensions->end();) {
    const bool drop =
        at.key() != kGltfInstancing && (names_data(*at) || at.key() == "EXT_structural_metadata");
    if (drop) losses.add(at.key() + " (an extension with data of its own)");
    at = drop ? extensions->erase(at) : std::next(at);
  }
  if (extensions->empty()) part.erase("extensions");
}

void keep_rest(const GltfSource& source, GltfData& data, json& document, Losses& losses) {
  keep_animations(data, document, losses);
  keep_skins(data, document, losses);
  for (json& node : document["nodes"]) {
    drop_data_extensions(node, losses);
    const auto extensions = node.find("extensions");
    if (extensions != node.end() && extensions->is_object() &&
        extensions->contains(kGltfInstancing))
      keep_instances(data, node, losses);
  }
  drop_file_extensions(document, losses);
  list_extensions(source.document, document);
}

}  // namespace atlas
