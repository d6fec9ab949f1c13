#include "libatlas/scene/gltf/gltf_pose.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>

namespace atlas {
namespace {

std::vector<glm::dvec3> vectors(const std::vector<float>& values) {
  std::vector<glm::dvec3> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return result;
}

// Returns the matrix that transforms normals where `m` transforms points: its inverse transpose
// times a positive factor, computed in a form that also exists if m is singular.
glm::dmat3 normal_matrix(const glm::dmat4& m) {
  const glm::dvec3 x(m[0]), y(m[1]), z(m[2]);
  const glm::dmat3 cofactors(glm::cross(y, z), glm::cross(z, x), glm::cross(x, y));
  return glm::dot(x, cofactors[0]) < 0 ? -1.0 * cofactors : cofactors;
}

}  // namespace

int gltf_attribute(const std::map<std::string, int>& attributes, const std::string& name) {
  const auto at = attributes.find(name);
  return at == attributes.end() ? -1 : at->second;
}

glm::dmat4 gltf_local_matrix(const tinygltf::Node& node) {
  glm::dmat4 m(1);
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[i];
    return m;
  }
  if (node.rotation.size() == 4) {
    const auto& q = node.rotation;
    const glm::dquat turn(q[3], q[0], q[1], q[2]);
    if (glm::length(turn) > 0) m = glm::mat4_cast(glm::normalize(turn));
  }
  if (node.scale.size() == 3) {
    for (int c = 0; c < 3; ++c) m[c] *= node.scale[c];
  }
  if (node.translation.size() == 3) {
    m[3] = {node.translation[0], node.translation[1], node.translation[2], 1};
  }
  return m;
}

GltfPose::GltfPose(const tinygltf::Model& model, bool normals)
    : model_(model), wants_normals_(normals) {
  parent_.assign(model.nodes.size(), -1);
  for (std::size_t i = 0; i < model.nodes.size(); ++i) {
    for (const int c : model.nodes[i].children) {
      if (c >= 0 && std::size_t(c) < parent_.size() && parent_[c] < 0) {
        parent_[c] = static_cast<int>(i);
      }
    }
  }
}

glm::dmat4 GltfPose::world_of(int node) const {
  glm::dmat4 m(1);
  // The limit only ends the loop. Cycles and chains that are too deep are refused where the scene's
  // nodes are visited, but joints need not be among those.
  for (int steps = 0; node >= 0 && steps <= kMostNodeDepth; ++steps) {
    m = gltf_local_matrix(model_.nodes[node]) * m;
    node = parent_[node];
  }
  return m;
}

const std::vector<glm::dmat4>& GltfPose::joints(const tinygltf::Node& node,
                                                const tinygltf::Primitive& primitive) {
  const bool bent = node.skin >= 0 && std::size_t(node.skin) < model_.skins.size() &&
                    gltf_attribute(primitive.attributes, "JOINTS_0") >= 0 &&
                    gltf_attribute(primitive.attributes, "WEIGHTS_0") >= 0;
  const auto [at, is_new] = joints_.try_emplace(bent ? node.skin : -1);
  std::vector<glm::dmat4>& matrices = at->second;
  if (!is_new || !bent) return matrices;
  const tinygltf::Skin& skin = model_.skins[node.skin];
  std::vector<float> inverse;
  if (skin.inverseBindMatrices >= 0) {
    auto values = gltf_floats(model_, skin.inverseBindMatrices, 16);
    if (!values.ok()) return matrices;  // treated as no skin
    inverse = std::move(*values);
  }
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const bool exists = skin.joints[j] >= 0 && std::size_t(skin.joints[j]) < model_.nodes.size();
    glm::dmat4 bind(1);
    for (std::size_t i = 0; i < 16 && 16 * j + i < inverse.size(); ++i) {
      bind[int(i / 4)][int(i % 4)] = double(inverse[16 * j + i]);
    }
    matrices.push_back(exists ? world_of(skin.joints[j]) * bind : glm::dmat4(1));
  }
  return matrices;
}

int GltfPose::first_alike(int skin, const std::vector<glm::dmat4>& matrices) {
  const auto [at, is_new] = alike_.try_emplace(skin, skin);
  if (!is_new) return at->second;
  std::string bytes;
  for (const glm::dmat4& m : matrices) {
    for (int i = 0; i < 16; ++i) {
      const float value = float(m[i / 4][i % 4]) + 0.f;  // -0 becomes 0
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  return at->second = skin_of_.try_emplace(std::move(bytes), skin).first->second;
}

bool GltfPose::lies_on_earlier(const tinygltf::Node& node) {
  for (const tinygltf::Primitive& primitive : model_.meshes[std::size_t(node.mesh)].primitives) {
    const auto& bent = joints(node, primitive);
    if (!bent.empty()) return !skinned_.emplace(node.mesh, first_alike(node.skin, bent)).second;
  }
  return false;
}

bool GltfPose::mirrors(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
                       const glm::dmat4& world) {
  const auto& bent = joints(node, primitive);
  return glm::determinant(glm::dmat3(bent.empty() ? world : bent[0])) < 0;
}

Status GltfPose::add_moves(int accessor, double weight, std::vector<glm::dvec3>& values) const {
  auto moves = gltf_floats(model_, accessor, 3);
  if (!moves.ok()) return moves.status();
  if (moves->size() != 3 * values.size()) {
    return {ErrorCode::bad_input, "has another number of values than one of its morph targets"};
  }
  const auto by = vectors(*moves);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += weight * by[i];
  return {};
}

Status GltfPose::morph(const tinygltf::Node& node, const tinygltf::Primitive& primitive,
                       GltfVertices& vertices) const {
  const auto& weights =
      node.weights.empty() ? model_.meshes[std::size_t(node.mesh)].weights : node.weights;
  for (std::size_t t = 0; t < std::min(weights.size(), primitive.targets.size()); ++t) {
    if (weights[t] == 0) continue;
    const int position = gltf_attribute(primitive.targets[t], "POSITION");
    if (position >= 0) {
      if (Status s = add_moves(position, weights[t], vertices.positions); !s.ok()) return s;
    }
    const int normal = gltf_attribute(primitive.targets[t], "NORMAL");
    if (normal >= 0 && !vertices.normals.empty()) {
      if (Status s = add_moves(normal, weights[t], vertices.normals); !s.ok()) return s;
    }
  }
  return {};
}

Status GltfPose::bend(const std::vector<glm::dmat4>& joints, const tinygltf::Primitive& primitive,
                      GltfVertices& vertices) const {
  std::vector<glm::dvec3>& points = vertices.positions;
  std::vector<glm::dmat4> blend(points.size(), glm::dmat4(0));
  std::vector<double> total(points.size(), 0);
  for (int set = 0;; ++set) {
    const int which = gltf_attribute(primitive.attributes, fmt::format("JOINTS_{}", set));
    const int weight = gltf_attribute(primitive.attributes, fmt::format("WEIGHTS_{}", set));
    if (which < 0 || weight < 0) break;
    auto ids = gltf_floats(model_, which, 4), weights = gltf_floats(model_, weight, 4);
    if (!ids.ok()) return ids.status();
    if (!weights.ok()) return weights.status();
    if (ids->size() != 4 * points.size() || weights->size() != 4 * points.size()) {
      return {ErrorCode::bad_input, "has another number of joints or weights than of positions"};
    }
    for (std::size_t k = 0; k < ids->size(); ++k) {
      const double w = double((*weights)[k]), joint = double((*ids)[k]);
      if (!(w > 0) || !(joint >= 0 && joint < double(joints.size()))) continue;
      blend[k / 4] += w * joints[std::size_t(joint)];
      total[k / 4] += w;
    }
  }
  // Weights are rounded, so their sum may not be 1.
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dmat4& m = total[i] > 0 ? blend[i] / total[i] : joints[0];
    points[i] = glm::dvec3(m * glm::dvec4(points[i], 1));
    if (!vertices.normals.empty()) vertices.normals[i] = normal_matrix(m) * vertices.normals[i];
  }
  return {};
}

Status GltfPose::read(const tinygltf::Primitive& primitive, GltfVertices& vertices) const {
  auto positions = gltf_floats(model_, gltf_attribute(primitive.attributes, "POSITION"), 3);
  if (!positions.ok()) return positions.status();
  vertices.positions = vectors(*positions);
  const int normal = gltf_attribute(primitive.attributes, "NORMAL");
  if (!wants_normals_ || normal < 0) return {};
  auto normals = gltf_floats(model_, normal, 3);
  if (!normals.ok()) return normals.status();
  if (normals->size() != positions->size()) {
    return {ErrorCode::bad_input, "has another number of normals than of positions"};
  }
  vertices.normals = vectors(*normals);
  return {};
}

Result<GltfVertices> GltfPose::vertices(const tinygltf::Node& node,
                                        const tinygltf::Primitive& primitive,
                                        const glm::dmat4& world) {
  GltfVertices vertices;
  if (Status s = read(primitive, vertices); !s.ok()) return s;
  if (Status s = morph(node, primitive, vertices); !s.ok()) return s;
  const auto& bent = joints(node, primitive);
  if (!bent.empty()) {
    if (Status s = bend(bent, primitive, vertices); !s.ok()) return s;
    return vertices;
  }
  for (glm::dvec3& p : vertices.positions) p = glm::dvec3(world * glm::dvec4(p, 1));
  const glm::dmat3 turn = normal_matrix(world);
  for (glm::dvec3& n : vertices.normals) n = turn * n;
  return vertices;
}

}  // namespace atlas
