// Internal: what refers to the meshes of a glTF file that is written again: animations and
// extensions. Includes tinygltf, so it is for .cpp files only.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/scene/building/losses.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

// The nodes that the instances of a node have become.
using InstanceNodes = std::map<std::size_t, std::vector<std::size_t>>;

// Returns what the target of an animation's channel, or null, names by KHR_animation_pointer.
std::optional<std::string> pointer_of(nlohmann::json* target);

// Removes the mesh from a node, and its skin and weights, which the format allows only with a mesh.
void leave_mesh(nlohmann::json& node);

// Lets animations that name a mesh by its number (KHR_animation_pointer), such as those of its
// weights, move the copies of the mesh, too. `meshes`: see number_kept_meshes().
void animate_copies(const GltfSource& source, const std::vector<std::size_t>& meshes,
                    nlohmann::json& document);

// Lets animations of a node's weights move its instances, which have its mesh now.
void animate_instances(const InstanceNodes& instances, nlohmann::json& document);

// Leaves out meshes without primitives, which the format does not allow. Their nodes stay, without
// a mesh. What refers to the others gets their new numbers, and what refers to them is left out.
void drop_empty_meshes(nlohmann::json& document, Losses& losses);

}  // namespace atlas
