// Reads glTF 2.0: merges the nodes of a scene into one mesh in world coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <glm/mat4x4.hpp>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/gltf/gltf_check.h"
#include "libatlas/scene/gltf/gltf_colours.h"
#include "libatlas/scene/gltf/gltf_file.h"
#include "libatlas/scene/gltf/gltf_instances.h"
#include "libatlas/scene/gltf/gltf_losses.h"
#include "libatlas/scene/gltf/gltf_materials.h"
#include "libatlas/scene/gltf/gltf_pose.h"
#include "libatlas/scene/gltf/gltf_primitives.h"
#include "libatlas/scene/gltf/gltf_sizes.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Limit on the visits to nodes and instances. Nodes of several parents are visited from each, so a
// hundred nodes can require 2^100 visits.
constexpr std::size_t kMaxVisits = std::size_t{1} << 20;

// Limits on vertices plus corners, some ten gigabytes, and less of files that have few bytes.
// Meshes count as often as they are shown: a file of a few kilobytes can ask for a million times as
// much as it holds.
constexpr double kMaxShown = double(1 << 29), kFewShown = double(1 << 24),
                 kMostShownExpansion = 1024;

class GltfParser {
 public:
  GltfParser(const tinygltf::Model& model, SceneBuilder& builder, const Context& context)
      : model_(model), builder_(builder), context_(context), primitives_(model, builder, context) {}

  Status run() {
    if (Status s = add_gltf_materials(model_, builder_); !s.ok()) return s;
    on_path_.assign(model_.nodes.size(), false);
    const std::vector<int> shown = gltf_roots(model_);
    if (const double size = gltf_shown_size(model_, shown); size > most_shown())
      return too_much(size);
    if (builder_.source) builder_.source->roots = shown;
    count_shared_nodes();
    for (const int node : shown) {
      if (Status s = add_node(node, {}, 0); !s.ok()) return s;
    }
    if (model_.nodes.empty()) {  // a library of meshes
      for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
        tinygltf::Node node;
        node.mesh = static_cast<int>(i);
        GltfPlace place;
        place.mesh = node.mesh;
        if (Status s = primitives_.add(node, glm::dmat4(1), place); !s.ok()) return s;
      }
    }
    if (builder_.objects.empty()) return nothing_shown();
    primitives_.finish(kVerticesRead);
    return {};
  }

 private:
  double most_shown() const {
    const double bytes = double(gltf_buffer_bytes(model_));
    return builder_.limits ? std::min(kMaxShown, std::max(kFewShown, kMostShownExpansion * bytes))
                           : kMaxShown;
  }

  Status too_much(double size) const {
    return {ErrorCode::bad_input,
            fmt::format("{}: its meshes, each as often as it is shown, have more than {:.0f} "
                        "vertices and corners of triangles (show fewer instances{})",
                        builder_.file, most_shown(),
                        size > kMaxShown ? "" : "; ReadOptions::limits lifts the limit")};
  }

  Status too_deep(const std::string& where) const {
    return {ErrorCode::unsupported,
            fmt::format("{}: {}: is nested too deeply, below more than {} nodes (export the scene "
                        "with fewer levels)",
                        builder_.file, where, kMostNodeDepth)};
  }

  Status too_many_visits(const std::string& where) const {
    return {ErrorCode::unsupported,
            fmt::format("{}: {}: nodes and instances are shown more than {} times (show fewer)",
                        builder_.file, where, kMaxVisits)};
  }

  Status nothing_shown() const {
    const std::string why = model_.meshes.empty()
                                ? "it holds no mesh"
                                : fmt::format("scene {} shows none of its {} meshes",
                                              gltf_shown_scene(model_), model_.meshes.size());
    return {ErrorCode::bad_input,
            fmt::format("{}: no triangle to work on: {} (export the scene as a triangle mesh)",
                        builder_.file, why)};
  }

  // A node should have one parent. One with several is shown at each, as in most programs.
  void count_shared_nodes() {
    std::vector<std::size_t> parents(model_.nodes.size());
    for (const tinygltf::Node& node : model_.nodes)
      for (const int child : node.children)
        if (child >= 0 && std::size_t(child) < parents.size() && ++parents[std::size_t(child)] == 2)
          builder_.defects.add(DefectKind::node_shared,
                               [&] { return fmt::format("{}: node {}", builder_.file, child); });
  }

  // What a node inherits from the nodes above it.
  struct Above {
    glm::dmat4 matrix{1};
    bool hidden = false;
  };

  Status add_node(int index, const Above& parent, int depth) {
    const std::string where = fmt::format("node {}", index);
    if (index < 0 || std::size_t(index) >= model_.nodes.size()) {
      return gltf_malformed(builder_.file, where, "does not exist");
    }
    if (on_path_[index]) return gltf_malformed(builder_.file, where, "the nodes form no tree");
    if (depth > kMostNodeDepth) return too_deep(where);
    if (++visits_ > kMaxVisits) return too_many_visits(where);
    if (context_.cancelled()) return Status::cancelled();
    const double part = double(nodes_visited_) / double(model_.nodes.size());
    context_.report("reading", kLoaded + (kVerticesRead - kLoaded) * part);
    on_path_[index] = true;
    const tinygltf::Node& node = model_.nodes[index];
    const Above here{parent.matrix * gltf_local_matrix(node), parent.hidden || gltf_hidden(node)};
    const GltfPlace place{nodes_visited_++, index, node.mesh};
    if (!here.hidden) take_camera(node, here.matrix);
    if (node.mesh >= 0 && here.hidden) {
      builder_.defects.add(DefectKind::node_hidden,
                           [&] { return fmt::format("{}: {}", builder_.file, where); });
    } else if (node.mesh >= 0) {
      if (Status s = add_instances(node, here.matrix, place, where); !s.ok()) return s;
    }
    for (const int child : node.children) {
      if (Status s = add_node(child, here, depth + 1); !s.ok()) return s;
    }
    on_path_[index] = false;
    return {};
  }

  // Orthographic cameras show plans.
  void take_camera(const tinygltf::Node& node, const glm::dmat4& matrix) {
    if (node.camera < 0 || std::size_t(node.camera) >= model_.cameras.size()) return;
    if (model_.cameras[std::size_t(node.camera)].type != "perspective") return;
    const std::string& own = model_.cameras[std::size_t(node.camera)].name;
    builder_.take_view(from_glm(glm::dvec3(matrix[3])), from_glm(-glm::dvec3(matrix[2])),
                       own.empty() ? node.name : own);
  }

  Status add_instances(const tinygltf::Node& node, const glm::dmat4& matrix, GltfPlace place,
                       const std::string& where) {
    if (std::size_t(node.mesh) >= model_.meshes.size()) {
      return gltf_malformed(builder_.file, where, "names a mesh that does not exist");
    }
    const auto instances = gltf_instances(model_, node);
    if (!instances.ok()) return gltf_malformed(builder_.file, where, instances.status().message());
    place.instance = node.extensions.contains(kGltfInstancing);
    for (const glm::dmat4& instance : *instances) {
      if (++visits_ > kMaxVisits) return too_many_visits(where);
      if (context_.cancelled()) return Status::cancelled();
      place.matrix = instance;
      if (Status s = primitives_.add(node, matrix * instance, place); !s.ok()) return s;
    }
    return {};
  }

  // Shares of the time until the model is loaded, and until faces are added.
  static constexpr double kLoaded = 0.4, kVerticesRead = 0.7;

  const tinygltf::Model& model_;
  SceneBuilder& builder_;
  const Context& context_;
  GltfPrimitives primitives_;
  std::vector<bool> on_path_;  // 1 per node: from the root to the current one
  std::size_t visits_ = 0, nodes_visited_ = 0;
};

// Takes what the lines about the file say of the pages of its uvs.
void take_uv_pages(const tinygltf::Asset& asset, UvPages& pages) {
  if (!asset.extras.IsObject() || !asset.extras.Get("info").IsArray()) return;
  for (const tinygltf::Value& line : asset.extras.Get("info").Get<tinygltf::Value::Array>()) {
    if (line.IsString()) pages.take(line.Get<std::string>());
  }
}

}  // namespace

Status read_gltf(const fs::path& path, SceneBuilder& builder, const Context& context) {
  auto source = std::make_shared<GltfSource>();
  const auto may_read = [&](const fs::path& buffer) {
    return builder.may_read(buffer, builder.file);
  };
  auto model = load_gltf(path, {builder.wants_textures && !builder.wants_rest, builder.defects,
                                builder.files, builder.wants_rest ? &source->document : nullptr,
                                may_read, builder.limits, builder.wants_lightmap});
  if (!builder.refused.ok()) return builder.refused;
  if (!model.ok()) return model.status();
  source->model = std::move(*model);
  if (Status s = builder.wants_rest ? take_data_out(path, *source) : Status(); !s.ok()) return s;
  if (builder.wants_rest) {
    source->colours = find_gltf_colours(source->model);
    builder.source = source;
  }
  builder.not_read = gltf_not_read(source->model);
  take_uv_pages(source->model.asset, builder.uv_pages);
  return GltfParser(source->model, builder, context).run();
}

}  // namespace atlas
