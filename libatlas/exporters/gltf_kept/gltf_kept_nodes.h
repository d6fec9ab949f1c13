// Internal: the nodes of a glTF file that is written again. Includes tinygltf, so it is for .cpp
// files only.
#pragma once

#include <vector>

#include "libatlas/exporters/world.h"
#include "libatlas/scene/building/losses.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

// Returns for each place of the source the number of its mesh, which no other place and no other
// node has: that of the mesh that the place shows if it is free, otherwise one behind the source's
// meshes. `once`: all places of a mesh share its number.
std::vector<std::size_t> number_kept_meshes(const GltfSource& source, bool once);

// Puts meshes of these numbers, one per place, into the nodes of `document`, which are those of the
// source. Instances of a node become its children, unless the world has each mesh once
// (World::instances); a node with several parents becomes one node per parent. What instances have
// besides their places is counted. Returns the node of each place. If the world is not in metres or
// not y-up, another node is added above those that are shown.
std::vector<std::size_t> place_kept_meshes(const World& world,
                                           const std::vector<std::size_t>& meshes,
                                           nlohmann::json& document, Losses& losses);

}  // namespace atlas
