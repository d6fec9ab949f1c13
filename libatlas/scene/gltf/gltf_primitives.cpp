#include "libatlas/scene/gltf/gltf_primitives.h"

#include <fmt/format.h>

#include <array>
#include <span>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/scene/gltf/gltf_colours.h"

namespace atlas {
namespace {

// The sets of uvs among which the new ones of a kept scene are looked for.
constexpr int kMostUvSets = 16;

constexpr std::uint32_t kOutside = 0xffffffffu;  // a corner that names no vertex

// Converts to floats, and normalises a vector that a node's scale has made too long or short.
Vec3f direction(const glm::dvec3& v) {
  const double length = glm::length(v);
  const bool fits = length == 0 || (length > 1e-20 && length < 1e20);
  return from_glm(glm::vec3(fits ? v : v / length));
}

// If primitives of one material differ, the page of some of them is not told.
void take_page_set(int set, RawMaterial& material) {
  const bool agrees = material.page_set < 0 || material.page_set == set;
  material.page_set = agrees ? set : material.uv_set;
}

}  // namespace

Status gltf_malformed(const std::string& file, const std::string& where, const std::string& what) {
  return {ErrorCode::bad_input,
          fmt::format("{}: {}: {} (check it with a glTF validator)", file, where, what)};
}

GltfPrimitives::GltfPrimitives(const tinygltf::Model& model, SceneBuilder& builder,
                               const Context& context)
    : model_(model),
      builder_(builder),
      context_(context),
      pose_(model, builder.wants_normals),
      lightmap_(model, builder) {}

// Returns the white material after the file's own if the primitive has none.
std::uint32_t GltfPrimitives::material_of(const tinygltf::Primitive& raw, const std::string& name) {
  const std::size_t count = model_.materials.size();
  if (raw.material >= 0 && std::size_t(raw.material) < count) return std::uint32_t(raw.material);
  if (raw.material >= 0)
    builder_.defects.add(DefectKind::material_unknown, [&] {
      return fmt::format("{}: {}: material {} of {}", builder_.file, name, raw.material, count);
    });
  return std::uint32_t(count);
}

Status GltfPrimitives::add(const tinygltf::Node& node, const glm::dmat4& matrix,
                           const GltfPlace& place) {
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

Result<GltfPrimitives::Vertices> GltfPrimitives::add_vertices(const tinygltf::Node& node,
                                                              const tinygltf::Primitive& raw,
                                                              const glm::dmat4& matrix,
                                                              const std::string& where) {
  if (gltf_attribute(raw.attributes, "POSITION") < 0)
    return gltf_malformed(builder_.file, where, "has no POSITION");
  auto posed = pose_.vertices(node, raw, matrix);
  if (!posed.ok()) return gltf_malformed(builder_.file, where, posed.status().message());
  const std::size_t count = posed->positions.size(), base = builder_.positions.size();
  for (const glm::dvec3& p : posed->positions) builder_.positions.push_back(from_glm(p));
  const Vertices added{base, count, builder_.normals.size(), !posed->normals.empty()};
  for (const glm::dvec3& n : posed->normals) builder_.normals.push_back(direction(n));
  const auto lit = add_gltf_light(model_, raw, {base, count}, builder_);
  if (!lit.ok()) return gltf_malformed(builder_.file, where, lit.status().message());
  if (*lit) {
    lit_ranges_.emplace_back(base, base + count);
    coloured_ += count;
  }
  return added;
}

// Returns the set whose page is that of the primitive's uvs. In kept scenes, sets that a
// primitive lacks refer to the data of the new uvs, and only the set of these has its page told.
int GltfPrimitives::page_set(const tinygltf::Primitive& raw, std::uint32_t material) const {
  const RawMaterial& m = builder_.materials[material];
  const int uvs = gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", m.uv_set));
  const auto told = [&](int set) { return builder_.uv_pages.aspect_of(m.name, set) > 0; };
  if (told(m.uv_set)) return m.uv_set;
  for (int set = 0; set < kMostUvSets; ++set)
    if (told(set) && gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", set)) == uvs)
      return set;
  return m.uv_set;
}

// Returns the set whose uvs are read: that of the material's textures, or with
// ReadOptions::told_uvs the last one whose page is told.
int GltfPrimitives::uv_set(const tinygltf::Primitive& raw, std::uint32_t material) const {
  const RawMaterial& m = builder_.materials[material];
  for (int set = kMostUvSets - 1; set >= 0 && builder_.wants_told_uvs; --set)
    if (builder_.uv_pages.aspect_of(m.name, set) > 0 &&
        gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", set)) >= 0)
      return set;
  return m.uv_set;
}

Status GltfPrimitives::add_texcoords(const tinygltf::Primitive& raw, Primitive& primitive) {
  const int set = uv_set(raw, primitive.material);
  const int accessor = gltf_attribute(raw.attributes, fmt::format("TEXCOORD_{}", set));
  if (accessor < 0) return {};
  take_page_set(builder_.wants_told_uvs ? set : page_set(raw, primitive.material),
                builder_.materials[primitive.material]);
  const auto [at, is_new] = texcoords_.try_emplace(accessor);
  if (is_new) {
    auto uvs = gltf_floats(model_, accessor, 2);
    if (!uvs.ok()) return gltf_malformed(builder_.file, primitive.name, uvs.status().message());
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

Status GltfPrimitives::add_corners(const tinygltf::Primitive& raw, int mode, Primitive& primitive) {
  const std::size_t vertices = primitive.vertices.count;
  std::vector<std::uint32_t> list;
  if (raw.indices >= 0) {
    auto indices = gltf_integers(model_, raw.indices);
    if (!indices.ok())
      return gltf_malformed(builder_.file, primitive.name, indices.status().message());
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
void GltfPrimitives::finish_values() {
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

void GltfPrimitives::finish(double done) {
  lightmap_.load(context_);
  if (coloured_ != 0) finish_values();
  builder_.check_positions(
      [&](std::size_t i) { return fmt::format("{}: vertex {}", builder_.file, i); });
  add_faces(done);
  lightmap_.finish();
}

void GltfPrimitives::add_faces(double before) {
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
        context_.report("reading", before + (1 - before) * done);
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

void GltfPrimitives::add_face(const Primitive& p, std::size_t t) {
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

}  // namespace atlas
