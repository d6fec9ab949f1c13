// Internal: a glTF file, and how the scene that was read from it lies in it. Includes tinygltf, so
// it is for .cpp files only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <vector>

#include "libatlas/scene/gltf_file.h"

namespace atlas {

// One primitive of triangles where a node shows it. Its vertices are consecutive positions of the
// scene, its triangles consecutive triangles; those that were left out as defects are missing.
struct GltfShownPrimitive {
  int primitive = 0;  // of its mesh
  std::size_t first_position = 0, positions = 0;
  std::size_t first_triangle = 0, triangles = 0;
  bool mirrored = false;  // the scene has the corners of its triangles in the opposite order
};

// One mesh where a node shows it.
struct GltfPlace {
  std::size_t visit = 0;  // number of the visit to its node, see below
  int node = -1;          // -1: the file has no nodes
  int mesh = 0;
  bool instance = false;  // one of EXT_mesh_gpu_instancing
  glm::dmat4 matrix{1};   // of an instance, relative to its node
  std::vector<GltfShownPrimitive> primitives = {};
};

// The file that a Scene was read from (Scene::source).
struct GltfSource {
  nlohmann::json document;  // the file's JSON, without the data in it
  tinygltf::Model model;    // the same with its buffers; lists are as long as in `document`
  std::vector<int> roots;   // of what is shown
  // In the order of visits: depth first from the roots, a node before its children, a node of
  // several parents at each. Visits count from 0, hidden nodes included.
  std::vector<GltfPlace> places;
  std::vector<std::int32_t> image_texture;  // of each image its place in Scene::textures, or -1
  bool other_light = false;                 // Scene::illumination is from another file
};

// Of a file that has just been loaded: frees `document` of the data that `model` has, and checks
// that both have the same elements. Error: bad_input, where a parser has passed some over.
Status take_data_out(const std::filesystem::path& path, GltfSource& source);

}  // namespace atlas
