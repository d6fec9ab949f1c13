// Internal: the nodes of a glTF file that is written again. Includes tinygltf, so it is for .cpp
// files only.
#pragma once

#include <vector>

#include "libatlas/exporters/world.h"
#include "libatlas/scene/gltf_source.h"
#include "libatlas/scene/losses.h"

namespace atlas {

// For each place of the source the number of its own mesh: that of the mesh it shows where no other
// place or node has that number, else one behind the source's meshes.
std::vector<std::size_t> number_kept_meshes(const GltfSource& source);

// Puts meshes of these numbers, one a place, into the nodes of `document`, which are those of the
// source; instances of a node become children of it, a node of several parents one for each. Above
// the nodes that are shown stands another where the world is not in metres or not y-up.
void place_kept_meshes(const World& world, const std::vector<std::size_t>& meshes,
                       nlohmann::json& document);

// Removes meshes that have lost all of their primitives, since the format allows none without, and
// takes them from their nodes. The other meshes get new numbers.
void drop_empty_meshes(nlohmann::json& document, Losses& losses);

}  // namespace atlas
