// Internal: takes the primitives of a glTF file's meshes into a scene, in world coordinates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/gltf/gltf_file.h"
#include "libatlas/scene/gltf/gltf_lightmap.h"
#include "libatlas/scene/gltf/gltf_pose.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {

// Returns bad_input for a part of a file that does not exist, or is not what the format asks for.
Status gltf_malformed(const std::string& file, const std::string& where, const std::string& what);

// Takes vertices mesh by mesh, and all triangles at the end, since the light of vertices and the
// lightmap must be known by then.
class GltfPrimitives {
 public:
  // All must outlive the object.
  GltfPrimitives(const tinygltf::Model& model, SceneBuilder& builder, const Context& context);

  // Adds the mesh of a node, which must exist, as one object. `matrix` leads to the world.
  Status add(const tinygltf::Node& node, const glm::dmat4& matrix, const GltfPlace& place);

  // Adds the triangles of all meshes. `done` is the share of the time that has passed before.
  void finish(double done);

 private:
  // The builder's vertices from one set of attributes; if `normals` is set, with as many normals.
  struct Vertices {
    std::size_t first = 0, count = 0, first_normal = 0;
    bool normals = false;
  };

  struct Primitive {
    std::vector<std::uint32_t> corners;  // 3 per triangle, numbered within the primitive
    Vertices vertices;
    std::size_t texcoord_base = 0, texcoord_count = 0;
    bool has_texcoords = false, mirrored = false;
    std::uint32_t material = 0, object = 0;
    GltfLightmap::Part light;
    int number = 0;  // index in its mesh
    std::string name;
  };

  std::uint32_t material_of(const tinygltf::Primitive& raw, const std::string& name);
  Result<Vertices> add_vertices(const tinygltf::Node& node, const tinygltf::Primitive& raw,
                                const glm::dmat4& matrix, const std::string& where);
  int page_set(const tinygltf::Primitive& raw, std::uint32_t material) const;
  int uv_set(const tinygltf::Primitive& raw, std::uint32_t material) const;
  Status add_texcoords(const tinygltf::Primitive& raw, Primitive& primitive);
  Status add_corners(const tinygltf::Primitive& raw, int mode, Primitive& primitive);
  void finish_values();
  void add_faces(double before);
  void add_face(const Primitive& p, std::size_t t);

  const tinygltf::Model& model_;
  SceneBuilder& builder_;
  const Context& context_;
  GltfPose pose_;
  GltfLightmap lightmap_;
  std::map<int, std::pair<std::size_t, std::size_t>> texcoords_;  // first and count, by accessor
  std::vector<Primitive> primitives_;
  std::vector<std::pair<std::size_t, std::size_t>> lit_ranges_;  // ranges of vertices, ascending
  std::size_t coloured_ = 0;
};

}  // namespace atlas
