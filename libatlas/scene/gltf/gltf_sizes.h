// Internal: finds what a glTF file shows, and how much that is, before its data are read.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

// Returns whether KHR_node_visibility hides the node, and with it all nodes below it.
bool gltf_hidden(const tinygltf::Node& node);

// Returns the number of the scene that is shown: the default scene, or the first. The file may have
// fewer scenes.
std::size_t gltf_shown_scene(const tinygltf::Model& model);

// Returns the root nodes of the scene that is shown; without scenes, all nodes without a parent.
std::vector<int> gltf_roots(const tinygltf::Model& model);

// Returns the sum of vertices and triangle corners of all meshes, each counted as often as `roots`
// and the nodes below them show it, or once if the file has no nodes. Takes the counts that the
// accessors announce. An accessor that announces more than its data hold counts 0, because it is
// refused when it is read, and so are nodes that do not form a tree. Takes time linear in the
// file's size, however often nodes are shared.
double gltf_shown_size(const tinygltf::Model& model, std::span<const int> roots);

}  // namespace atlas
