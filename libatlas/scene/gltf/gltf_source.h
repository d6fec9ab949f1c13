// Internal: a glTF file, and where the scene that was read from it has its parts. Includes
// tinygltf, so only .cpp files may include it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <vector>

#include "libatlas/scene/gltf/gltf_file.h"
#include "libatlas/scene/gltf/gltf_kept_colours.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// One primitive of triangles where a node shows it. Its vertices are consecutive positions of the
// scene, and its triangles are consecutive triangles, without those that were left out as defects.
struct GltfShownPrimitive {
  int primitive = 0;  // index in its mesh
  std::size_t first_position = 0, positions = 0;
  std::size_t first_triangle = 0, triangles = 0;
  bool mirrored = false;  // the scene has the corners of its triangles in the opposite order
};

// One mesh where a node shows it.
struct GltfPlace {
  std::size_t visit = 0;  // number of the visit to its node, see GltfSource::places
  int node = -1;          // -1: the file has no nodes
  int mesh = 0;
  bool instance = false;  // whether it is an instance of EXT_mesh_gpu_instancing
  glm::dmat4 matrix{1};   // of an instance, relative to its node
  std::vector<GltfShownPrimitive> primitives = {};
};

// The file that a Scene was read from (Scene::source).
struct GltfSource {
  nlohmann::json document;  // the file's JSON, without the data in it
  tinygltf::Model model;    // the parsed file with its buffers; lists are as long as in `document`
  std::vector<int> roots;   // root nodes of what is shown
  // In the order of visits: depth first from the roots, each node before its children, and a node
  // of several parents once at each. Visits count from 0 and include hidden nodes.
  std::vector<GltfPlace> places;
  std::vector<std::int32_t> image_texture;  // index of each image in Scene::textures, or -1
  // The files of images in formats that glTF holds only by extensions (EXT_texture_webp,
  // KHR_texture_basisu), which are written as they are. Empty: the image is none of these, or there
  // is none. Empty as a whole, like image_texture, if no texture was asked for.
  std::vector<std::vector<std::uint8_t>> image_files;
  bool other_light = false;  // whether Scene::illumination is from another file
  KeptColours colours;
  std::uint64_t positions_mark = 0;  // positions_mark() of the scene as it was read
};

// Returns a number that tells by 64 bits whether positions and origin of a scene have changed.
std::uint64_t positions_mark(const Scene& scene);

// For a file that has just been loaded: removes from `document` the data that `model` holds, and
// checks that both have the same elements. Error: bad_input if a parser has skipped some.
Status take_data_out(const std::filesystem::path& path, GltfSource& source);

}  // namespace atlas
