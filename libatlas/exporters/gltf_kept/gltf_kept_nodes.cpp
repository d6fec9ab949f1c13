#include "libatlas/exporters/gltf_kept/gltf_kept_nodes.h"

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>

#include "libatlas/exporters/gltf/gltf_document.h"
#include "libatlas/exporters/gltf_kept/gltf_kept_meshes.h"
#include "libatlas/scene/gltf/gltf_check.h"
#include "libatlas/scene/gltf/gltf_instances.h"
#include "libatlas/scene/gltf/gltf_sizes.h"
#include "libatlas/scene/scene.h"

namespace atlas {
using nlohmann::json;
namespace {

// Counts what the instances of a node have besides their places: nodes cannot have attributes, and
// extras would have to be given to each of them.
void count_instance_losses(const json& node, Losses& losses) {
  const auto extensions = node.find("extensions");
  if (extensions == node.end() || !extensions->is_object()) return;
  const auto instancing = extensions->find(kGltfInstancing);
  if (instancing == extensions->end() || !instancing->is_object()) return;
  if (const auto at = instancing->find("attributes"); at != instancing->end()) {
    for (const auto& [name, accessor] : at->items()) {
      const bool place = name == "TRANSLATION" || name == "ROTATION" || name == "SCALE";
      losses.add("attributes of instances other than their places (EXT_mesh_gpu_instancing)",
                 !place);
    }
  }
  for (const char* key : {"extras", "extensions"})
    losses.add(fmt::format("{} of instances (EXT_mesh_gpu_instancing)", key),
               instancing->contains(key));
}

// Visits the nodes in the order of the reader, so that the visits have the reader's numbers.
class Walk {
 public:
  struct Target {
    json& nodes;
    Losses& losses;
    bool once;  // instances stay what they are
  };
  Walk(const GltfSource& source, const std::vector<std::size_t>& meshes, const Target& target)
      : source_(source),
        meshes_(meshes),
        nodes_(target.nodes),
        losses_(target.losses),
        once_(target.once),
        visited_(source.model.nodes.size()) {}

  // Returns the number of the node that shows what `node` shows on this visit.
  std::size_t visit(int node) {
    const auto number = static_cast<std::size_t>(node);
    std::size_t own = number;
    if (visited_[number]) {
      own = nodes_.size();
      nodes_.push_back(source_.document["nodes"][number]);
    }
    visited_[number] = true;
    json children = show(own, visits_++);
    for (const int child : source_.model.nodes[number].children) children.push_back(visit(child));
    // Where there are none, the source may have something else than a list.
    if (children.empty())
      nodes_[own].erase("children");
    else
      nodes_[own]["children"] = std::move(children);
    return own;
  }

  const InstanceNodes& instances() const { return instances_; }
  // The nodes of the places, in their order.
  std::vector<std::size_t> take_holders() { return std::move(holders_); }

 private:
  // Gives the node its mesh. If it has instances, returns the new nodes for them.
  json show(std::size_t node, std::size_t visit) {
    json instances = json::array();
    json holder;  // skin and weights, which go with the mesh
    for (; next_ < meshes_.size() && source_.places[next_].visit == visit; ++next_) {
      if (!source_.places[next_].instance || once_) {
        nodes_[node]["mesh"] = meshes_[next_];
        holders_.push_back(node);
        continue;
      }
      if (instances.empty()) {
        // A copy for another parent would count the same things again.
        if (node < visited_.size()) count_instance_losses(nodes_[node], losses_);
        holder = take_mesh(nodes_[node]);
      }
      json instance = holder;
      instance["mesh"] = meshes_[next_];
      const glm::dmat4& m = source_.places[next_].matrix;
      if (m != glm::dmat4(1)) {
        instance["matrix"] = json::array();
        for (int i = 0; i < 16; ++i) instance["matrix"].push_back(m[i / 4][i % 4]);
      }
      if (const std::string& name = source_.model.nodes[node_of(next_)].name; !name.empty())
        instance["name"] = fmt::format("{}_{}", name, instances.size());
      instances.push_back(nodes_.size());
      holders_.push_back(nodes_.size());
      instances_[node_of(next_)].push_back(nodes_.size());
      nodes_.push_back(std::move(instance));
    }
    return instances;
  }

  std::size_t node_of(std::size_t place) const {
    return static_cast<std::size_t>(source_.places[place].node);
  }

  static json take_mesh(json& node) {
    json holder = json::object();
    for (const char* key : {"skin", "weights"})
      if (node.contains(key)) holder[key] = std::move(node[key]);
    leave_mesh(node);
    json& extensions = node["extensions"];
    extensions.erase(kGltfInstancing);
    if (extensions.empty()) node.erase("extensions");
    return holder;
  }

  const GltfSource& source_;
  const std::vector<std::size_t>& meshes_;
  json& nodes_;
  Losses& losses_;
  bool once_;
  std::vector<bool> visited_;
  std::vector<std::size_t> holders_;
  InstanceNodes instances_;
  std::size_t visits_ = 0, next_ = 0;
};

// Divides root nodes: those that shall be scaled and turned, and skinned meshes. These have the
// places of their joints, whatever their own nodes do, and viewers warn of them below another node.
struct Roots {
  json moved = json::array(), skinned = json::array();
};

Roots divide_roots(const GltfSource& source, const json& nodes, const json& roots) {
  std::set<std::size_t> joints;
  for (const tinygltf::Skin& skin : source.model.skins)
    for (const int joint : skin.joints) joints.insert(static_cast<std::size_t>(joint));
  Roots result;
  for (const json& root : roots) {
    const auto number = root.get<std::size_t>();
    const json& node = nodes[number];
    const bool moves_other_things = node.contains("children") || node.contains("camera") ||
                                    node.contains("extensions") || joints.contains(number);
    const bool skinned = node.contains("mesh") && node.contains("skin") && !moves_other_things;
    (skinned ? result.skinned : result.moved).push_back(root);
  }
  return result;
}

// Takes nodes that are below another one now out of the lists of root nodes that scenes have, since
// glTF allows only root nodes there. Those of the scene that readers show are set afterwards.
void leave_out_of_scenes(const GltfSource& source, const json& moved, json& document,
                         Losses& losses) {
  const std::set<json> below(moved.begin(), moved.end());
  const std::size_t shown = gltf_shown_scene(source.model);
  for (std::size_t scene = 0; scene < source.model.scenes.size(); ++scene) {
    json* roots = member_at(&document["scenes"][scene], "nodes");
    if (scene == shown || roots == nullptr || !roots->is_array()) continue;
    json left = json::array();
    for (const json& root : *roots)
      if (!below.contains(root)) left.push_back(root);
    losses.add("root nodes of other scenes, which are scaled or turned",
               roots->size() - left.size());
    if (left.empty())
      document["scenes"][scene].erase("nodes");
    else
      *roots = std::move(left);
  }
}

// Makes `roots` the root nodes of the scene that readers show.
void set_roots(const GltfSource& source, json roots, json& document) {
  json& scenes = document["scenes"];
  if (!scenes.is_array()) scenes = json::array();
  std::size_t shown = gltf_shown_scene(source.model);
  if (shown >= scenes.size()) {
    shown = scenes.size();
    scenes.push_back(json::object());
  }
  scenes[shown]["nodes"] = std::move(roots);
  document["scene"] = shown;
}

}  // namespace

std::vector<std::size_t> number_kept_meshes(const GltfSource& source, bool once) {
  const tinygltf::Model& model = source.model;
  std::vector<bool> shows(model.nodes.size()), taken(model.meshes.size());
  for (const GltfPlace& place : source.places)
    if (place.node >= 0) shows[std::size_t(place.node)] = true;
  // Nodes that are not shown, because they are hidden or in other scenes, keep their meshes.
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    const int mesh = model.nodes[n].mesh;
    if (!shows[n] && mesh >= 0 && std::size_t(mesh) < taken.size()) taken[std::size_t(mesh)] = true;
  }
  std::vector<std::size_t> result;
  std::size_t next = model.meshes.size();
  for (const GltfPlace& place : source.places) {
    const auto mesh = static_cast<std::size_t>(place.mesh);
    result.push_back(taken[mesh] && !once ? next++ : mesh);
    taken[mesh] = true;
  }
  return result;
}

std::vector<std::size_t> place_kept_meshes(const World& world,
                                           const std::vector<std::size_t>& meshes, json& document,
                                           Losses& losses) {
  const GltfSource& source = *world.scene->source;
  json& nodes = document["nodes"];
  if (!nodes.is_array()) nodes = json::array();
  json roots = json::array();
  Walk walk(source, meshes, {nodes, losses, world.instances.has_value()});
  for (const int root : source.roots) roots.push_back(walk.visit(root));
  std::vector<std::size_t> holders = walk.take_holders();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    if (source.places[i].node >= 0) continue;
    roots.push_back(nodes.size());
    holders.push_back(nodes.size());
    nodes.push_back({{"mesh", meshes[i]}});
  }
  animate_copies(source, meshes, document);
  animate_instances(walk.instances(), document);
  if (world.up != Up::y || world.metres_per_unit != 1) {
    json top = gltf_root(world, {});  // coordinates are the file's own, without an origin
    Roots divided = divide_roots(source, nodes, roots);
    roots = std::move(divided.skinned);
    if (!divided.moved.empty()) {
      leave_out_of_scenes(source, divided.moved, document, losses);
      top["children"] = std::move(divided.moved);
      roots.insert(roots.begin(), nodes.size());
      nodes.push_back(std::move(top));
    }
  }
  set_roots(source, std::move(roots), document);
  return holders;
}

}  // namespace atlas
