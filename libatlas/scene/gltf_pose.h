// Internal: computes where the vertices of a glTF mesh are at rest, before any animation runs.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <vector>

#include "libatlas/scene/gltf_file.h"

namespace atlas {

// Nodes that are nested more deeply are refused.
inline constexpr int kMostNodeDepth = 512;

// Returns a node's transform relative to its parent.
glm::dmat4 gltf_local_matrix(const tinygltf::Node& node);

// The vertices of a primitive in world coordinates. Normals are perpendicular to the surface and
// keep pointing to the same side of it; their lengths mean nothing. `normals` is empty if the
// primitive has none or they are not wanted.
struct GltfVertices {
  std::vector<glm::dvec3> positions, normals;
};

class GltfPose {
 public:
  GltfPose(const tinygltf::Model& model, bool normals);

  // Returns the primitive's vertices, moved by the morph targets that have weights, and then by the
  // joints of the node's skin, which replace the node's own transform, or by `world` without a
  // skin. Errors: bad_input.
  Result<GltfVertices> vertices(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
                                const glm::dmat4& world);

  // Returns whether the transform into the world turns the primitive's triangles inside out.
  bool mirrors(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
               const glm::dmat4& world);

 private:
  // Returns the matrix of each joint from the mesh into the world; empty if no skin bends the
  // primitive.
  const std::vector<glm::dmat4>& joints(const tinygltf::Node& node,
                                        const tinygltf::Primitive& primitive);
  glm::dmat4 world_of(int node) const;
  Status morph(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
               GltfVertices& vertices) const;
  Status add_moves(int accessor, double weight, std::vector<glm::dvec3>& values) const;
  Status bend(const std::vector<glm::dmat4>& joints, const tinygltf::Primitive& primitive,
              GltfVertices& vertices) const;
  Status read(const tinygltf::Primitive& primitive, GltfVertices& vertices) const;

  const tinygltf::Model& model_;
  bool wants_normals_;
  std::vector<int> parent_;                        // of each node, or -1
  std::map<int, std::vector<glm::dmat4>> joints_;  // by skin
};

}  // namespace atlas
