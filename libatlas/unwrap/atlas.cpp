#include "libatlas/unwrap/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "libatlas/charts/mesh/weld.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/is_finite.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

constexpr std::size_t kMostPositions = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostTriangles = std::size_t{1} << 30;

// Checks a mesh that is to be the one with this number.
class MeshCheck {
 public:
  MeshCheck(const StridedMesh& mesh, std::size_t number) : mesh_(mesh), number_(number) {}

  Status run(float density) const {
    if (!usable(density)) return bad(fmt::format("density {} ({})", density, kUsable));
    if (Status s = check_arrays(); !s.ok()) return s;
    if (Status s = check_lengths(); !s.ok()) return s;
    return check_triangles(density);
  }

 private:
  static constexpr const char* kUsable = "must be above 0 and finite";
  static bool usable(float density) { return density > 0 && std::isfinite(density); }

  Status bad(const std::string& text) const {
    return {ErrorCode::bad_input, fmt::format("mesh {}: {}", number_, text)};
  }
  Status bad(std::size_t triangle, const std::string& text) const {
    return bad(fmt::format("triangle {}: {}", triangle, text));
  }

  Status check_arrays() const {
    const std::string mesh = fmt::format("mesh {}: ", number_);
    if (Status s = check_span(mesh + "positions", mesh_.positions); !s.ok()) return s;
    if (Status s = check_span(mesh + "indices", mesh_.indices); !s.ok()) return s;
    if (Status s = check_span(mesh + "normals", mesh_.normals); !s.ok()) return s;
    if (Status s = check_span(mesh + "texcoords", mesh_.texcoords); !s.ok()) return s;
    return check_span(mesh + "texcoord indices", mesh_.texcoord_indices);
  }

  Status check_lengths() const {
    const std::size_t corners = mesh_.indices.count, triangles = corners / 3;
    if (corners < 3) return bad("no triangle (nothing to unwrap)");
    if (corners % 3 != 0) return bad(fmt::format("{} indices are not whole triangles", corners));
    const auto wrong = [](std::size_t count, std::size_t expected) {
      return count > 0 && count != expected;
    };
    if (wrong(mesh_.normals.count, mesh_.positions.count))
      return bad(fmt::format("{} normals for {} positions (one each, or none)", mesh_.normals.count,
                             mesh_.positions.count));
    if (wrong(mesh_.texcoord_indices.count, corners))
      return bad(fmt::format("{} texcoord indices for {} corners (one each, or none)",
                             mesh_.texcoord_indices.count, corners));
    if (mesh_.texcoord_indices.count == 0 && wrong(mesh_.texcoords.count, mesh_.positions.count))
      return bad(fmt::format("{} texcoords for {} positions (one each, or give texcoord indices)",
                             mesh_.texcoords.count, mesh_.positions.count));
    if (wrong(mesh_.materials.size(), triangles))
      return bad(fmt::format("{} materials for {} triangles (one each, or none)",
                             mesh_.materials.size(), triangles));
    if (wrong(mesh_.density.size(), triangles))
      return bad(fmt::format("{} densities for {} triangles (one each, or none)",
                             mesh_.density.size(), triangles));
    if (wrong(mesh_.seams.size(), corners))
      return bad(
          fmt::format("{} seams for {} edges (one each, or none)", mesh_.seams.size(), corners));
    if (wrong(mesh_.objects.size(), mesh_.positions.count))
      return bad(fmt::format("{} objects for {} positions (one each, or none)",
                             mesh_.objects.size(), mesh_.positions.count));
    return {};
  }

  Status check_triangles(float density) const {
    for (std::size_t i = 0; i < mesh_.indices.count; ++i) {
      const std::uint32_t v = mesh_.indices[i];
      if (v >= mesh_.positions.count)
        return bad(i / 3, fmt::format("vertex index {} names none of the {} positions (indices "
                                      "count from 0)",
                                      v, mesh_.positions.count));
      if (!is_finite(mesh_.positions[v]))
        return bad(i / 3, fmt::format("vertex {} has a position that is not finite", v));
      if (mesh_.normals.count > 0 && !is_finite(mesh_.normals[v]))
        return bad(i / 3, fmt::format("vertex {} has a normal that is not finite", v));
    }
    for (std::size_t t = 0; t < mesh_.density.size(); ++t)
      if (!usable(mesh_.density[t]) || !usable(density * mesh_.density[t]))
        return bad(t, fmt::format("density {} times {} ({})", mesh_.density[t], density, kUsable));
    return {};
  }

  const StridedMesh& mesh_;
  std::size_t number_;
};

// Appends to an array with `before` values, which stays empty until there is something to append.
template <class T>
void append_values(std::vector<T>& to, std::size_t before, std::span<const T> values,
                   std::size_t count, T without) {
  if (values.empty() && to.empty()) return;
  to.resize(before, without);
  to.insert(to.end(), values.begin(), values.end());
  to.resize(before + count, without);
}

StridedMesh strided(const MeshView& mesh) {
  return {
      .positions = {mesh.positions.data(), mesh.positions.size(), 0},
      .indices = {mesh.indices.data(), mesh.indices.size(), 4},
      .texcoords = {mesh.texcoords.data(), mesh.texcoords.size(), 0},
      .texcoord_indices = {mesh.texcoord_indices.data(), mesh.texcoord_indices.size(), 4},
      .materials = mesh.materials,
      .density = mesh.density,
      .seams = mesh.seams,
      .objects = mesh.objects,
  };
}

// Returns `values` from the first on, without the base that they count from.
void count_from(std::span<std::uint32_t> values, std::size_t base) {
  for (std::uint32_t& value : values) value -= std::uint32_t(base);
}

template <class T>
std::span<const T> part(const std::vector<T>& values, std::size_t begin, std::size_t end) {
  return std::span(values).subspan(begin, end - begin);
}

// Returns the place of each corner; values that are equal, of one object, are one place.
std::vector<std::uint32_t> welded_corners(std::span<const Vec3f> values,
                                          std::span<const std::uint32_t> objects,
                                          std::span<const std::uint32_t> indices) {
  const WeldedVertices welded =
      weld_vertices(values, used_vertices(indices, values.size()), objects);
  std::vector<std::uint32_t> places;
  places.reserve(indices.size());
  for (const std::uint32_t v : indices) places.push_back(welded.place[v]);
  return places;
}

// A half-edge, by the places of its ends and the values there.
struct EdgeSide {
  std::uint32_t low, high, value_low, value_high, half_edge;
};

// Marks the half-edges of edges that triangles share in space, but with different values, such as
// uvs, at an end. `place` and `value`: one per corner.
std::vector<std::uint8_t> find_seams(std::span<const std::uint32_t> place,
                                     std::span<const std::uint32_t> value) {
  std::vector<EdgeSide> sides;
  sides.reserve(place.size());
  for (std::uint32_t h = 0; h < place.size(); ++h) {
    std::uint32_t a = h, b = next_half_edge(h);
    if (place[a] == place[b]) continue;
    if (place[a] > place[b]) std::swap(a, b);
    sides.push_back({place[a], place[b], value[a], value[b], h});
  }
  sort_total(sides.begin(), sides.end(), [](const EdgeSide& a, const EdgeSide& b) {
    return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
  });
  std::vector<std::uint8_t> seams(place.size(), 0);
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    const EdgeSide& first = sides[begin];
    bool alike = true;
    for (; end < sides.size() && sides[end].low == first.low && sides[end].high == first.high;
         ++end)
      alike = alike && sides[end].value_low == first.value_low &&
              sides[end].value_high == first.value_high;
    for (std::size_t i = begin; !alike && i < end; ++i) seams[sides[i].half_edge] = 1;
  }
  return seams;
}

}  // namespace

UnwrappedAtlas::UnwrappedAtlas(UnwrappedMesh all, std::span<const std::size_t> first_position,
                               std::span<const std::size_t> first_triangle)
    : all_(std::move(all)), first_triangle_(first_triangle.begin(), first_triangle.end()) {
  // Vertices come in the order of the triangles that first name them, so those of a mesh follow
  // those of the one before.
  for (const std::size_t position : first_position)
    first_vertex_.push_back(
        std::size_t(std::partition_point(all_.vertices.begin(), all_.vertices.end(),
                                         [&](std::uint32_t v) { return v < position; }) -
                    all_.vertices.begin()));
  for (std::size_t i = 0; i < mesh_count(); ++i) {
    const std::size_t v = first_vertex_[i], c = 3 * first_triangle_[i];
    count_from(std::span(all_.vertices).subspan(v, first_vertex_[i + 1] - v), first_position[i]);
    count_from(std::span(all_.indices).subspan(c, 3 * first_triangle_[i + 1] - c), v);
  }
}

UnwrappedAtlas::Mesh UnwrappedAtlas::mesh(std::size_t i) const {
  const std::size_t v = first_vertex_[i], v_end = first_vertex_[i + 1];
  const std::size_t t = first_triangle_[i], t_end = first_triangle_[i + 1];
  return {part(all_.vertices, v, v_end), part(all_.uvs, v, v_end),
          part(all_.indices, 3 * t, 3 * t_end), part(all_.triangle_page, t, t_end),
          part(all_.charts.triangle_chart, t, t_end)};
}

std::size_t UnwrappedAtlas::mesh_of_chart(std::size_t chart) const {
  const ChartSet& charts = all_.charts;
  const std::uint32_t t = charts.chart_triangles[charts.charts[chart].first_triangle];
  return std::size_t(std::upper_bound(first_triangle_.begin(), first_triangle_.end(), t) -
                     first_triangle_.begin() - 1);
}

Result<std::uint32_t> Atlas::add(const MeshView& mesh, float density) {
  return add(strided(mesh), density);
}

Result<std::uint32_t> Atlas::add(const StridedMesh& mesh, float density) {
  const std::size_t number = mesh_count();
  if (Status s = MeshCheck(mesh, number).run(density); !s.ok()) return s;
  if (mesh.positions.count > kMostPositions - positions_.size() ||
      mesh.texcoords.count > kMostPositions - texcoords_.size() ||
      mesh.indices.count / 3 >= kMostTriangles - first_triangle_.back())
    return Status(ErrorCode::unsupported,
                  fmt::format("mesh {}: more than 2^30 triangles or 2^32 vertices with those "
                              "before it (use another atlas)",
                              number));
  try {
    append(mesh, density);
  } catch (...) {
    cut_to_meshes();
    throw;
  }
  return std::uint32_t(number);
}

void Atlas::append(const StridedMesh& mesh, float density) {
  const std::size_t position = first_position_.back(), triangle = first_triangle_.back();
  const std::size_t corners = mesh.indices.count, triangles = corners / 3;
  for (std::size_t i = 0; i < corners; ++i)
    indices_.push_back(std::uint32_t(position + mesh.indices[i]));
  const std::uint32_t objects = append_positions(mesh);
  append_values(materials_, triangle, mesh.materials, triangles, 0u);
  append_seams(mesh);
  append_texcoords(mesh);

  std::vector<float> densities(mesh.density.begin(), mesh.density.end());
  if (densities.empty() && density != 1) densities.assign(triangles, 1);
  for (float& d : densities) d *= density;
  append_values(density_, triangle, std::span<const float>(densities), triangles, 1.0f);

  first_position_.push_back(position + mesh.positions.count);
  first_triangle_.push_back(triangle + triangles);
  object_count_ += objects;
}

// Returns how many objects the mesh consists of.
std::uint32_t Atlas::append_positions(const StridedMesh& mesh) {
  std::unordered_map<std::uint32_t, std::uint32_t> objects;
  for (std::size_t i = 0; i < mesh.positions.count; ++i) {
    positions_.push_back(mesh.positions[i]);
    const std::uint32_t own = mesh.objects.empty() ? 0 : mesh.objects[i];
    const auto next = std::uint32_t(object_count_ + objects.size());
    objects_.push_back(objects.try_emplace(own, next).first->second);
  }
  return std::uint32_t(objects.size());
}

// Once positions and indices are there.
void Atlas::append_seams(const StridedMesh& mesh) {
  const std::size_t position = first_position_.back(), corner = 3 * first_triangle_.back();
  const std::size_t corners = mesh.indices.count;
  std::vector<std::uint8_t> seams(mesh.seams.begin(), mesh.seams.end());
  if (mesh.normals.count > 0) {
    std::vector<std::uint32_t> own;
    own.reserve(corners);
    for (std::size_t i = 0; i < corners; ++i) own.push_back(mesh.indices[i]);
    std::vector<Vec3f> normals;
    normals.reserve(mesh.normals.count);
    for (std::size_t i = 0; i < mesh.normals.count; ++i) normals.push_back(mesh.normals[i]);
    const std::vector<std::uint8_t> hard =
        find_seams(welded_corners(part(positions_, position, positions_.size()),
                                  part(objects_, position, objects_.size()), own),
                   welded_corners(normals, {}, own));
    seams.resize(corners, 0);
    for (std::size_t h = 0; h < corners; ++h) seams[h] |= hard[h];
  }
  append_values(seams_, corner, std::span<const std::uint8_t>(seams), corners, std::uint8_t{0});
}

void Atlas::append_texcoords(const StridedMesh& mesh) {
  const std::size_t texcoord = texcoords_.size(), corners = mesh.indices.count;
  for (std::size_t i = 0; i < mesh.texcoords.count; ++i) texcoords_.push_back(mesh.texcoords[i]);
  const IndexSpan& own = mesh.texcoord_indices.count > 0 ? mesh.texcoord_indices : mesh.indices;
  std::vector<std::uint32_t> named;
  for (std::size_t i = 0; mesh.texcoords.count > 0 && i < corners; ++i)
    named.push_back(own[i] < mesh.texcoords.count ? std::uint32_t(texcoord + own[i]) : kNoIndex);
  append_values(texcoord_indices_, 3 * first_triangle_.back(),
                std::span<const std::uint32_t>(named), corners, kNoIndex);
}

// Removes what append() left when memory ran out.
void Atlas::cut_to_meshes() {
  first_position_.resize(first_triangle_.size());
  const std::size_t positions = first_position_.back(), triangles = first_triangle_.back();
  const auto cut = [](auto& values, std::size_t count) {
    values.resize(std::min(values.size(), count));
  };
  cut(positions_, positions);
  cut(objects_, positions);
  for (auto* corners : {&indices_, &texcoord_indices_}) cut(*corners, 3 * triangles);
  cut(seams_, 3 * triangles);
  cut(materials_, triangles);
  cut(density_, triangles);
}

Result<UnwrappedAtlas> Atlas::unwrap(const UnwrapOptions& options, const Context& context) const {
  if (mesh_count() == 0)
    return Status(ErrorCode::bad_input, "atlas: no mesh (add one before unwrapping)");
  MeshView view;
  view.positions = positions_;
  view.indices = indices_;
  view.materials = materials_;
  view.density = density_;
  view.texcoords = texcoords_;
  view.texcoord_indices = texcoord_indices_;
  view.seams = seams_;
  if (object_count_ > 1) view.objects = objects_;
  Result<UnwrappedMesh> all = unwrap_mesh(view, options, context);
  if (!all.ok()) return all.status();
  return UnwrappedAtlas(std::move(*all), first_position_, first_triangle_);
}

Result<std::vector<std::uint8_t>> Atlas::seams(const UnwrappedAtlas& unwrapped,
                                               std::size_t mesh) const {
  if (unwrapped.first_triangle_ != first_triangle_)
    return Status(ErrorCode::bad_input,
                  "atlas: it has other meshes than those that were unwrapped");
  if (mesh >= mesh_count())
    return Status(ErrorCode::bad_input,
                  fmt::format("mesh {}: there are {} (counted from 0)", mesh, mesh_count()));
  const std::size_t v = first_position_[mesh], v_end = first_position_[mesh + 1];
  const std::size_t c = 3 * first_triangle_[mesh], c_end = 3 * first_triangle_[mesh + 1];
  std::vector<std::uint32_t> place(indices_.begin() + std::ptrdiff_t(c),
                                   indices_.begin() + std::ptrdiff_t(c_end));
  count_from(place, v);
  place = welded_corners(part(positions_, v, v_end), part(objects_, v, v_end), place);
  return find_seams(place, part(unwrapped.all_.charts.triangle_uv, c, c_end));
}

}  // namespace atlas
