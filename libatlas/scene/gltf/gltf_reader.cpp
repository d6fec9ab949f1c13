// Reads glTF 2.0: merges the nodes of a scene into one mesh in world coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <glm/mat4x4.hpp>
#include <map>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/gltf/gltf_check.h"
#include "libatlas/scene/gltf/gltf_colours.h"
#include "libatlas/scene/gltf/gltf_file.h"
#include "libatlas/scene/gltf/gltf_instances.h"
#include "libatlas/scene/gltf/gltf_lightmap.h"
#include "libatlas/scene/gltf/gltf_losses.h"
#include "libatlas/scene/gltf/gltf_materials.h"
#include "libatlas/scene/gltf/gltf_pose.h"
#include "libatlas/scene/gltf/gltf_sizes.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Limit on the visits to nodes and instances. Nodes of several parents are visited from each, so a
// hundred nodes can require 2^100 visits.
constexpr std::size_t kMaxVisits = std::size_t{1} << 20;

// Limit on vertices plus corners, some ten gigabytes. Meshes count as often as they are shown: a
// file of a few kilobytes can ask for a million times as much as it holds.
constexpr double kMaxShown = double(1 << 29);

// The sets of uvs among which the new ones of a kept scene are looked for.
constexpr int kMostUvSets = 16;

// Converts to floats, and normalises a vector that a node's scale has made too long or short.
Vec3f direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  const bool fits = length == 0 || (length > 1e-20 && length < 1e20);
  return from_glm(glm::vec3(fits ? v : v / length));
}

class GltfParser {
 public:
  GltfParser(const tinygltf::Model& model, SceneBuilder& builder, const Context& context)
      : model_(model),
        builder_(builder),
        context_(context),
        pose_(model, builder.wants_normals),
        lightmap_(model, builder) {}

  Status run() {
    if (Status s = add_gltf_materials(model_, builder_); !s.ok()) return s;
    on_path_.assign(model_.nodes.size(), false);
    const std::vector<int> shown = gltf_roots(model_);
    if (gltf_shown_size(model_, shown) > kMaxShown) return too_much();
    if (builder_.source) builder_.source->roots = shown;
    for (const int node : shown) {
      if (Status s = add_node(node, {}, 0); !s.ok()) return s;
    }
    if (model_.nodes.empty()) {  // a library of meshes
      for (std::size_t i = 0; i < model_.meshes.size(); ++i) {
        tinygltf::Node node;
        node.mesh = static_cast<int>(i);
        GltfPlace place;
        place.mesh = node.mesh;
        if (Status s = add_mesh(node, glm::dmat4(1), place); !s.ok()) return s;
      }
    }
    if (builder_.objects.empty()) return nothing_shown();
    lightmap_.load(context_);
    if (coloured_ != 0) finish_values();
    builder_.check_positions(
        [&](std::size_t i) { return fmt::format("{}: vertex {}", builder_.file, i); });
    add_faces();
    lightmap_.finish();
    return {};
  }

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

  Status malformed(const std::string& where, const std::string& what) const {
    return {ErrorCode::bad_input,
            fmt::format("{}: {}: {} (check it with a glTF validator)", builder_.file, where, what)};
  }

  Status too_much() const {
    return {ErrorCode::bad_input,
            fmt::format("{}: its meshes, each as often as it is shown, have more than {:.0f} "
                        "vertices and corners of triangles (show fewer instances)",
                        builder_.file, kMaxShown)};
  }

  Status nothing_shown() const {
    const std::string why =
        model_.meshes.empty() ? "it holds no mesh"
                              : fmt::format("scene {} shows none of its {} meshes",
                                            std::max(0, model_.defaultScene), model_.meshes.size());
    return {ErrorCode::bad_input,
            fmt::format("{}: no triangle to work on: {} (export the scene as a triangle mesh)",
                        builder_.file, why)};
  }

  // What a node inherits from the nodes above it.
  struct Above {
    glm::dmat4 matrix{1};
    bool hidden = false;
  };

  Status add_node(int index, const Above& parent, int depth) {
    const std::string where = fmt::format("node {}", index);
    if (index < 0 || std::size_t(index) >= model_.nodes.size()) {
      return malformed(where, "does not exist");
    }
    // A node should have one parent. One with several is shown at each, as in most programs.
    if (on_path_[index] || depth > kMostNodeDepth || ++visits_ > kMaxVisits) {
      return malformed(where, "the nodes form no tree");
    }
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
    builder_.take_view(from_glm(glm::dvec3(matrix[3])), from_glm(-glm::dvec3(matrix[2])));
  }

  Status add_instances(const tinygltf::Node& node, const glm::dmat4& matrix, GltfPlace place,
                       const std::string& where) {
    if (std::size_t(node.mesh) >= model_.meshes.size()) {
      return malformed(where, "names a mesh that does not exist");
    }
    const auto instances = gltf_instances(model_, node);
    if (!instances.ok()) return malformed(where, instances.status().message());
    place.instance = node.extensions.contains(kGltfInstancing);
    for (const glm::dmat4& instance : *instances) {
      if (++visits_ > kMaxVisits) return malformed(where, "has more instances than can be read");
      if (context_.cancelled()) return Status::cancelled();
      place.matrix = instance;
      if (Status s = add_mesh(node, matrix * instance, place); !s.ok()) return s;
    }
    return {};
  }

  // Returns the white material after the file's own if the primitive has none.
  std::uint32_t material_of(const tinygltf::Primitive& raw, const std::string& name) {
    const std::size_t count = model_.materials.size();
    if (raw.material >= 0 && std::size_t(raw.material) < count) return std::uint32_t(raw.material);
    if (raw.material >= 0)
      builder_.defects.add(DefectKind::material_unknown, [&] {
        return fmt::format("{}: {}: material {} of {}", builder_.file, name, raw.material, count);
      });
    return std::uint32_t(count);
  }

  Status add_mesh(const tinygltf::Node& node, const glm::dmat4& matrix, const GltfPlace& place) {
    const tinygltf::Mesh& mesh = model_.meshes[node.mesh];
    const auto object = static_cast<std::uint32_t>(builder_.objects.size());
    builder_.objects.push_back(!node.name.empty() ? node.name : mesh.name);
    if (pose_.lies_on_earlier(node))
      builder_.defects.add(DefectKind::skin_repeated, [&] {
        return fmt::format("{}: node {} '{}'", builder_.file, place.node, node.name);
      });
    if (builder_.source) builder_.source->places.push_back(place);
    // Primitives often share one set of vertices and differ in their indices and materials.
    using Attributes = std::map<std::string, int>;
    std::map<std::pair<Attributes, std::vector<Attributes>>, Vertices> shared;
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const tinygltf::Primitive& raw = mesh.primitives[p];
      Primitive primitive;
      primitive.name = fmt::format("mesh {} primitive {}", node.mesh, p);
      primitive.number = static_cast<int>(p);
      primitive.object = object;
      primitive.mirrored = pose_.mirrors(node, raw, matrix);
      primitive.material = material_of(raw, primitive.name);
      const int mode = raw.mode < 0 ? TINYGLTF_MODE_TRIANGLES : raw.mode;
      if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP &&
          mode != TINYGLTF_MODE_TRIANGLE_FAN) {
        builder_.defects.add(DefectKind::element_ignored, [&] {
          return fmt::format("{}: {} (points or lines)", builder_.file, primitive.name);
        });
        continue;
      }
      const auto [at, is_new] = shared.try_emplace({raw.attributes, raw.targets});
      if (is_new) {
        auto added = add_vertices(node, raw, matrix, primitive.name);
        if (!added.ok()) return added.status();
        at->second = *added;
      }
      primitive.vertices = at->second;
      const RawMaterial& m = builder_.materials[primitive.material];
      primitive.light = lightmap_.part_of(raw, m.unlit, primitive.name);
      if (m.unlit && m.texture >= 0)
        add_gltf_unlit_colours(model_, raw, {at->second.first, at->second.count}, builder_);
      if (Status s = add_texcoords(raw, primitive); !s.ok()) return s;
      if (Status s = add_corners(raw, mode, primitive); !s.ok()) return s;
      primitives_.push_back(std::move(primitive));
    }
    return {};
  }

  Result<Vertices> add_vertices(const tinygltf::Node& node, const tinygltf::Primitive& raw,
                                const glm::dmat4& matrix, const std::string& where) {
    if (gltf_attribute(raw.attributes, "POSITION") < 0) return malformed(where, "has no POSITION");
    auto posed = pose_.vertices(node, raw, matrix);
    if (!posed.ok()) return malformed(where, posed.status().message());
    const std::size_t count = posed->positions.size(), base = builder_.positions.size();
    for (const glm::dvec3& p : posed->positions) builder_.positions.push_back(from_glm(p));
    const Vertices added{base, count, builder_.normals.size(), !posed->normals.empty()};
    for (const glm::dvec3& n : posed->normals) builder_.normals.push_back(direction(n));
    const auto lit = add_gltf_light(model_, raw, {base, count}, builder_);
    if (!lit.ok()) return malformed(where, lit.status().message());
    if (*lit) {
      lit_ranges_.emplace_back(base, base + count);
      coloured_ += count;
    }
    return added;
  }

  // Returns the set whose page is that of the primitive's uvs. In kept scenes, sets that a
  // primitive lacks refer to the data of the new uvs, and only the set of these has its page told.
  int page_set(const tinygltf::Primitive& raw, std::uint32_t material) const {
    const RawMaterial& m = builder_.materials[material];
    const int uvs = gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", m.uv_set));
    const auto told = [&](int set) { return builder_.uv_pages.aspect_of(m.name, set) > 0; };
    if (told(m.uv_set)) return m.uv_set;
    for (int set = 0; set < kMostUvSets; ++set)
      if (told(set) && gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", set)) == uvs)
        return set;
    return m.uv_set;
  }

  // If primitives of one material differ, the page of some of them is not told.
  static void take_page_set(int set, RawMaterial& material) {
    const bool agrees = material.page_set < 0 || material.page_set == set;
    material.page_set = agrees ? set : material.uv_set;
  }

  Status add_texcoords(const tinygltf::Primitive& raw, Primitive& primitive) {
    const int set = builder_.materials[primitive.material].uv_set;
    const int accessor = gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", set));
    if (accessor < 0) return {};
    take_page_set(page_set(raw, primitive.material), builder_.materials[primitive.material]);
    const auto [at, is_new] = texcoords_.try_emplace(accessor);
    if (is_new) {
      auto uvs = gltf_floats(model_, accessor, 2);
      if (!uvs.ok()) return malformed(primitive.name, uvs.status().message());
      at->second = {builder_.texcoords.size(), uvs->size() / 2};
      for (std::size_t i = 0; i + 1 < uvs->size(); i += 2) {
        builder_.texcoords.push_back({(*uvs)[i], 1 - (*uvs)[i + 1]});
      }
    }
    primitive.texcoord_base = at->second.first;
    primitive.texcoord_count = at->second.second;
    primitive.has_texcoords = true;
    return {};
  }

  Status add_corners(const tinygltf::Primitive& raw, int mode, Primitive& primitive) {
    const std::size_t vertices = primitive.vertices.count;
    std::vector<std::uint32_t> list;
    if (raw.indices >= 0) {
      auto indices = gltf_integers(model_, raw.indices);
      if (!indices.ok()) return malformed(primitive.name, indices.status().message());
      list = std::move(*indices);
    } else {
      for (std::size_t i = 0; i < vertices; ++i) list.push_back(static_cast<std::uint32_t>(i));
    }
    for (std::uint32_t& i : list) {  // an index out of range must not reach other primitives
      if (i >= vertices) i = kOutside;
    }
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      if (list.size() % 3 != 0) {
        builder_.defects.add(DefectKind::too_few_corners, [&] {
          return fmt::format("{}: {}: its end", builder_.file, primitive.name);
        });
        ++builder_.defects.triangles_left_out;
        list.resize(list.size() / 3 * 3);
      }
      primitive.corners = std::move(list);
      return {};
    }
    for (std::size_t i = 2; i < list.size(); ++i) {
      const bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN;
      const std::size_t odd = i % 2;  // every other triangle of a strip is reversed
      const std::uint32_t a = fan ? list[0] : list[i - 2 + odd];
      const std::uint32_t b = fan ? list[i - 1] : list[i - 1 - odd];
      primitive.corners.insert(primitive.corners.end(), {a, b, list[i]});
    }
    return {};
  }

  // Sets vertices without values to 0 in a scene where others have some.
  void finish_values() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < builder_.illumination.size(); ++i) {
      while (next < lit_ranges_.size() && i >= lit_ranges_[next].second) ++next;
      if (next < lit_ranges_.size() && i >= lit_ranges_[next].first) continue;
      builder_.illumination[i] = {};
      if (lightmap_.loaded()) continue;  // it holds the light, or says where it is missing
      builder_.defects.add(DefectKind::illumination_missing,
                           [&] { return fmt::format("{}: vertex {}", builder_.file, i); });
    }
  }

  void add_faces() {
    if (coloured_ == 0) builder_.illumination.clear();
    std::size_t triangles = 0;
    for (const Primitive& p : primitives_) triangles += p.corners.size() / 3;
    builder_.reserve_triangles(triangles, !builder_.texcoords.empty());
    for (Primitive& p : primitives_) {
      builder_.material = p.material;
      builder_.object = p.object;
      const std::size_t first = builder_.triangle_count();
      for (std::size_t t = 0; t < p.corners.size() / 3; ++t) {
        if (t % 65536 == 0) {
          if (context_.cancelled()) return;  // so says SceneBuilder::finish()
          const double done = double(builder_.triangle_count()) / double(triangles);
          context_.report("reading", kVerticesRead + (1 - kVerticesRead) * done);
        }
        add_face(p, t);
      }
      std::vector<std::uint32_t>().swap(p.corners);
      if (builder_.source) {  // each object has one place
        builder_.source->places[p.object].primitives.push_back(
            {p.number, p.vertices.first, p.vertices.count, first, builder_.triangle_count() - first,
             p.mirrored});
      }
    }
  }

  void add_face(const Primitive& p, std::size_t t) {
    std::int64_t vertices[3], uvs[3], normals[3];
    std::array<std::uint32_t, 3> corners;
    for (int c = 0; c < 3; ++c) {
      const std::uint32_t local = p.corners[3 * t + (p.mirrored ? 2 - c : c)];
      corners[std::size_t(c)] = local;
      vertices[c] = local == kOutside ? -1 : static_cast<std::int64_t>(p.vertices.first + local);
      normals[c] = static_cast<std::int64_t>(p.vertices.first_normal + local);
      // A larger index would reach the texture coordinates of other primitives.
      uvs[c] = local < p.texcoord_count ? static_cast<std::int64_t>(p.texcoord_base + local)
                                        : static_cast<std::int64_t>(builder_.texcoords.size());
    }
    const std::span<const std::int64_t> all_uvs(uvs), all_normals(normals);
    const std::size_t before = builder_.triangle_count();
    builder_.add_face({vertices, p.has_texcoords ? all_uvs : all_uvs.first(0),
                       p.vertices.normals ? all_normals : all_normals.first(0)},
                      [&] { return fmt::format("{}: {} triangle {}", builder_.file, p.name, t); });
    if (builder_.triangle_count() > before) lightmap_.add_triangle(p.light, corners);
  }

  // Shares of the time until the model is loaded, and until faces are added.
  static constexpr double kLoaded = 0.4, kVerticesRead = 0.7;
  static constexpr std::uint32_t kOutside = 0xffffffffu;

  const tinygltf::Model& model_;
  SceneBuilder& builder_;
  const Context& context_;
  GltfPose pose_;
  GltfLightmap lightmap_;
  std::vector<bool> on_path_;  // 1 per node: from the root to the current one
  std::size_t visits_ = 0, nodes_visited_ = 0;
  std::map<int, std::pair<std::size_t, std::size_t>> texcoords_;  // first and count, by accessor
  std::vector<Primitive> primitives_;
  std::vector<std::pair<std::size_t, std::size_t>> lit_ranges_;  // ranges of vertices, ascending
  std::size_t coloured_ = 0;
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
  auto model = load_gltf(path, {builder.wants_textures || builder.wants_rest, builder.defects,
                                builder.files, builder.wants_rest ? &source->document : nullptr});
  if (!model.ok()) return model.status();
  source->model = std::move(*model);
  if (Status s = builder.wants_rest ? take_data_out(path, *source) : Status(); !s.ok()) return s;
  if (builder.wants_rest) builder.source = source;
  builder.not_read = gltf_not_read(source->model);
  take_uv_pages(source->model.asset, builder.uv_pages);
  return GltfParser(source->model, builder, context).run();
}

}  // namespace atlas
