#include "libatlas/scene/gltf/gltf_sizes.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "libatlas/scene/gltf/gltf_instances.h"
#include "libatlas/scene/gltf/gltf_pose.h"

namespace atlas {
namespace {

class ShownSize {
 public:
  explicit ShownSize(const tinygltf::Model& model) : model_(model) {
    for (const tinygltf::Mesh& mesh : model.meshes) meshes_.push_back(size_of(mesh));
    nodes_.assign(model.nodes.size(), kUnknown);
  }

  double of_all_meshes() const {
    double sum = 0;
    for (const double size : meshes_) sum += size;
    return sum;
  }

  // Returns the size of a node and all below it. A node that is below itself, or deeper than nodes
  // are read, adds 0 there.
  double of_node(int index, int depth = 0) {
    if (index < 0 || std::size_t(index) >= nodes_.size() || depth > kMostNodeDepth) return 0;
    double& known = nodes_[std::size_t(index)];
    if (known != kUnknown) return known;
    known = 0;
    const tinygltf::Node& node = model_.nodes[std::size_t(index)];
    if (gltf_hidden(node)) return 0;
    double sum = 0;
    if (node.mesh >= 0 && std::size_t(node.mesh) < meshes_.size())
      sum = instances(node) * meshes_[std::size_t(node.mesh)];
    for (const int child : node.children) sum += of_node(child, depth + 1);
    return known = sum;
  }

 private:
  static constexpr double kUnknown = -1;

  // Returns the accessor's count, or 0 if its data hold less.
  double count(int accessor) const {
    if (accessor < 0 || std::size_t(accessor) >= model_.accessors.size()) return 0;
    const tinygltf::Accessor& a = model_.accessors[std::size_t(accessor)];
    const bool in_view = a.bufferView >= 0 && std::size_t(a.bufferView) < model_.bufferViews.size();
    const std::size_t most =
        in_view ? model_.bufferViews[std::size_t(a.bufferView)].byteLength : kMostGltfZeros;
    return a.count <= most ? double(a.count) : 0;
  }

  // Vertices that several primitives share count once.
  double size_of(const tinygltf::Mesh& mesh) const {
    using Attributes = std::map<std::string, int>;
    std::set<std::pair<Attributes, std::vector<Attributes>>> known;
    double size = 0;
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
      if (mode < TINYGLTF_MODE_TRIANGLES) continue;  // points and lines are left out
      const auto at = primitive.attributes.find("POSITION");
      const double vertices = at == primitive.attributes.end() ? 0 : count(at->second);
      if (known.emplace(primitive.attributes, primitive.targets).second) size += vertices;
      const double indices = primitive.indices >= 0 ? count(primitive.indices) : vertices;
      size += (mode == TINYGLTF_MODE_TRIANGLES ? 1 : 3) * indices;
    }
    return size;
  }

  double instances(const tinygltf::Node& node) const {
    const auto at = node.extensions.find(kGltfInstancing);
    if (at == node.extensions.end() || !at->second.IsObject()) return 1;
    const tinygltf::Value& attributes = at->second.Get("attributes");
    double most = 1;
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"})
      if (attributes.IsObject() && attributes.Get(name).IsInt())
        most = std::max(most, count(attributes.Get(name).GetNumberAsInt()));
    return most;
  }

  const tinygltf::Model& model_;
  std::vector<double> meshes_, nodes_;  // 1 per mesh, 1 per node
};

}  // namespace

bool gltf_hidden(const tinygltf::Node& node) {
  const auto at = node.extensions.find("KHR_node_visibility");
  if (at == node.extensions.end() || !at->second.IsObject()) return false;
  const tinygltf::Value& visible = at->second.Get("visible");
  return visible.IsBool() && !visible.Get<bool>();
}

std::size_t gltf_shown_scene(const tinygltf::Model& model) {
  return model.defaultScene >= 0 ? std::size_t(model.defaultScene) : 0;
}

std::vector<int> gltf_roots(const tinygltf::Model& model) {
  const std::size_t shown = gltf_shown_scene(model);
  if (shown < model.scenes.size()) return model.scenes[shown].nodes;
  std::vector<bool> child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes)
    for (const int c : node.children)
      if (c >= 0 && std::size_t(c) < child.size()) child[std::size_t(c)] = true;
  std::vector<int> result;
  for (std::size_t i = 0; i < child.size(); ++i)
    if (!child[i]) result.push_back(static_cast<int>(i));
  return result;
}

double gltf_shown_size(const tinygltf::Model& model, std::span<const int> roots) {
  ShownSize size(model);
  if (model.nodes.empty()) return size.of_all_meshes();
  double sum = 0;
  for (const int node : roots) sum += size.of_node(node);
  return sum;
}

}  // namespace atlas
