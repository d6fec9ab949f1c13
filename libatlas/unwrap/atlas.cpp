#include "libatlas/unwrap/atlas.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "libatlas/charts/mesh/weld.h"
#include "libatlas/core/half_edge.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/unwrap/blocks.h"
#include "libatlas/unwrap/join_unwrapped.h"
#include "libatlas/unwrap/mesh_check.h"
#include "libatlas/unwrap/mesh_polygons.h"

namespace atlas {
namespace {

constexpr std::size_t kMostPositions = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostTriangles = std::size_t{1} << 30;

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
      .seam_weights = mesh.seam_weights,
      .polygons = mesh.polygons,
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

std::span<const std::uint32_t> UnwrappedAtlas::triangles(std::size_t i) const {
  return part(all_.indices, 3 * first_triangle_[i], 3 * first_triangle_[i + 1]);
}

UnwrappedAtlas::Mesh UnwrappedAtlas::mesh(std::size_t i) const {
  const std::size_t v = first_vertex_[i], v_end = first_vertex_[i + 1];
  const std::size_t t = first_triangle_[i], t_end = first_triangle_[i + 1];
  return {part(all_.vertices, v, v_end),
          part(all_.uvs, v, v_end),
          triangles(i),
          part(all_.triangle_page, t, t_end),
          part(all_.charts.triangle_chart, t, t_end),
          triangle_polygon_[i],
          polygon_uvs_[i].corners,
          polygon_uvs_[i].cut,
          instances_.empty() ? std::span<const MeshInstance>() : instances_[i]};
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
  if (Status s = check_mesh(mesh, number, density); !s.ok()) return s;
  const std::size_t polygons = mesh.polygon_sizes.size(),
                    triangles =
                        polygons > 0 ? mesh.indices.count - 2 * polygons : mesh.indices.count / 3;
  if (mesh.positions.count > kMostPositions - positions_.size() ||
      mesh.texcoords.count > kMostPositions - texcoords_.size() ||
      triangles >= kMostTriangles - first_triangle_.back())
    return Status(ErrorCode::unsupported,
                  fmt::format("mesh {}: more than 2^30 triangles or 2^32 vertices with those "
                              "before it (use another atlas)",
                              number));
  try {
    mesh_polygons_.emplace_back();
    instances_.emplace_back();
    if (polygons > 0) {
      if (Status s = add_polygons(mesh, density); !s.ok()) {
        cut_to_meshes();
        return s;
      }
    } else {
      append(mesh, density);
    }
  } catch (...) {
    cut_to_meshes();
    throw;
  }
  return std::uint32_t(number);
}

Result<std::uint32_t> Atlas::add_instances(const MeshView& mesh, std::size_t count,
                                           std::span<const float> densities) {
  return add_instances(strided(mesh), count, densities);
}

Result<std::uint32_t> Atlas::add_instances(const StridedMesh& mesh, std::size_t count,
                                           std::span<const float> densities) {
  if (Status s = check_instances(mesh_count(), count, densities); !s.ok()) return s;
  std::vector<float> own(densities.begin(), densities.end());
  own.resize(count, 1);
  Result<std::uint32_t> added = add(mesh);
  if (added.ok()) instances_.back() = std::move(own);
  return added;
}

Status Atlas::add_polygons(const StridedMesh& mesh, float density) {
  Result<TriangulatedMesh> triangulated = triangulate_mesh(mesh, mesh_count());
  if (!triangulated.ok()) return triangulated.status();
  append(triangulated->view(mesh), density);
  mesh_polygons_.back() = std::move(triangulated->polygons);
  return {};
}

void Atlas::append(const StridedMesh& mesh, float density) {
  const std::size_t position = first_position_.back(), triangle = first_triangle_.back();
  const std::size_t corners = mesh.indices.count, triangles = corners / 3;
  for (std::size_t i = 0; i < corners; ++i)
    indices_.push_back(std::uint32_t(position + mesh.indices[i]));
  const std::uint32_t objects = append_positions(mesh);
  append_values(materials_, triangle, mesh.materials, triangles, 0u);
  append_values(seam_weights_, position, mesh.seam_weights, mesh.positions.count, 1.0f);
  append_seams(mesh);
  append_texcoords(mesh);
  append_polygons(mesh);

  std::vector<float> densities(mesh.density.begin(), mesh.density.end());
  if (densities.empty() && density != 1) densities.assign(triangles, 1);
  for (float& d : densities) d *= density;
  append_values(density_, triangle, std::span<const float>(densities), triangles, 1.0f);

  first_position_.push_back(position + mesh.positions.count);
  first_triangle_.push_back(triangle + triangles);
  object_count_ += objects;
}

// Each triangle without a polygon gets a number of its own.
void Atlas::append_polygons(const StridedMesh& mesh) {
  const std::size_t before = first_triangle_.back(), triangles = mesh.indices.count / 3;
  if (mesh.polygons.empty() && polygons_.empty()) return;
  for (std::size_t t = polygons_.size(); t < before; ++t) polygons_.push_back(std::uint32_t(t));
  std::unordered_map<std::uint32_t, std::uint32_t> numbers;  // of this mesh
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::uint32_t own = mesh.polygons.empty() ? std::uint32_t(t) : mesh.polygons[t];
    const auto next = std::uint32_t(before + numbers.size());
    polygons_.push_back(numbers.try_emplace(own, next).first->second);
  }
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
  cut(seam_weights_, positions);
  for (auto* corners : {&indices_, &texcoord_indices_}) cut(*corners, 3 * triangles);
  cut(seams_, 3 * triangles);
  cut(materials_, triangles);
  cut(density_, triangles);
  cut(polygons_, triangles);
  cut(mesh_polygons_, mesh_count());
  cut(instances_, mesh_count());
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
  view.polygons = polygons_;
  view.seam_weights = seam_weights_;
  if (object_count_ > 1) view.objects = objects_;
  const bool blocks = std::any_of(instances_.begin(), instances_.end(),
                                  [](const auto& densities) { return !densities.empty(); });
  if (blocks && options.like)
    return Status(ErrorCode::bad_option,
                  "atlas: like is given, but meshes are instanced (leave one of them out)");
  std::vector<std::vector<MeshInstance>> instances;
  Result<UnwrappedMesh> all =
      blocks ? unwrap_in_blocks(options, context, instances) : unwrap_mesh(view, options, context);
  if (!all.ok()) return all.status();
  UnwrappedAtlas unwrapped(std::move(*all), first_position_, first_triangle_);
  unwrapped.instances_ = std::move(instances);
  for (std::size_t i = 0; i < mesh_count(); ++i) {
    unwrapped.triangle_polygon_.push_back(mesh_polygons_[i].polygon);
    unwrapped.polygon_uvs_.push_back(polygon_uvs(mesh_polygons_[i], unwrapped.triangles(i)));
  }
  return unwrapped;
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
  std::vector<std::uint8_t> seams =
      find_seams(place, part(unwrapped.all_.charts.triangle_uv, c, c_end));
  const PolygonCorners& polygons = mesh_polygons_[mesh];
  return polygons.count() > 0 ? seams_of_sides(seams, polygons) : seams;
}

}  // namespace atlas
