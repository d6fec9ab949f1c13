// Internal: where the vertices of a glTF mesh are at rest, before any animation runs.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <vector>

#include "libatlas/scene/gltf_file.h"

namespace atlas {

// Nodes that are nested deeper are refused.
inline constexpr int kMostNodeDepth = 512;

// What a node's transform is, relative to its parent.
glm::dmat4 gltf_local_matrix(const tinygltf::Node& node);

// Vertices of a primitive in the world. Normals are perpendicular to the surface there and point
// to the side that they did; their lengths mean nothing. None where the primitive has none, or
// nobody wants them.
struct GltfVertices {
  std::vector<glm::dvec3> positions, normals;
};

class GltfPose {
 public:
  GltfPose(const tinygltf::Model& model, bool normals);

  // Vertices moved by the morph targets that have weights, then by the joints of the node's skin,
  // which replace the node's own transform, or else by `world`. Errors: bad_input.
  Result<GltfVertices> vertices(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
                                const glm::dmat4& world);

  // Whether the primitive's triangles are turned inside out on their way into the world.
  bool mirrors(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
               const glm::dmat4& world);

 private:
  // Of each joint from the mesh into the world; empty where no skin bends the primitive.
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
