// Internal: computes where the vertices of a glTF mesh are at rest, before any animation runs.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/scene/gltf/gltf_file.h"

namespace atlas {

// Nodes that are nested more deeply are refused.
inline constexpr int kMostNodeDepth = 512;

// Returns the accessor of an attribute, or -1 if there is none of that name.
int gltf_attribute(const std::map<std::string, int>& attributes, const std::string& name);

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

  // Returns whether the node's skin puts its mesh where that of a node of an earlier call is.
  // Transforms of nodes and instances do not move a mesh that joints place, so such meshes lie upon
  // each other.
  bool lies_on_earlier(const tinygltf::Node& node);

 private:
  // Returns the matrix of each joint from the mesh into the world; empty if no skin bends the
  // primitive.
  const std::vector<glm::dmat4>& joints(const tinygltf::Node& node,
                                        const tinygltf::Primitive& primitive);
  // Returns the first skin asked for whose joints have the same matrices, as far as floats tell.
  int first_alike(int skin, const std::vector<glm::dmat4>& matrices);
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
  std::map<int, int> alike_;                       // first_alike(), by skin
  std::map<std::string, int> skin_of_;             // by the bytes of its matrices
  std::set<std::pair<int, int>> skinned_;          // meshes that joints placed, with their skins
};

}  // namespace atlas
