// Internal: how much a glTF file shows, told before any of it is read.
#pragma once

#include <span>

#include "libatlas/scene/gltf_file.h"

namespace atlas {

// Whether KHR_node_visibility hides the node, and with it all below it.
bool gltf_hidden(const tinygltf::Node& node);

// Vertices and corners of triangles of all meshes, each as often as `roots` and what is below them
// show it; of all meshes once where the file has no nodes. As many as the accessors announce, but
// for those that announce more than there is: these are refused when they are read, and so are
// nodes that form no tree. Linear in the file's size, however often nodes are shared.
double gltf_shown_size(const tinygltf::Model& model, std::span<const int> roots);

}  // namespace atlas
