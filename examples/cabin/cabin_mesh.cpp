#include "examples/cabin/cabin_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace cabin {
namespace {

using Key = std::array<std::int64_t, 4>;

struct KeyHash {
  std::size_t operator()(const Key& key) const {
    std::uint64_t h = 0;
    for (std::int64_t k : key) h = (h ^ std::uint64_t(k)) * 0x9E3779B97F4A7C15ull + (h >> 29);
    return h;
  }
};

// The odd offset keeps round coordinates, of which the cabin has many, away from the borders of
// cells.
std::int64_t cell(double x, double size) {
  return std::int64_t(std::floor(x / size + 0.37));
}

std::uint16_t index_of(std::vector<std::string>& names, const std::string& name) {
  auto it = std::find(names.begin(), names.end(), name);
  if (it != names.end()) return std::uint16_t(it - names.begin());
  names.push_back(name);
  return std::uint16_t(names.size() - 1);
}

}  // namespace

Shell shell_of(const Mesh& mesh) {
  Shell shell;
  for (const Vertex& v : mesh.vertices) shell.positions.push_back(v.position);
  for (const Triangle& t : mesh.triangles) shell.triangles.push_back(t.vertex);
  return shell;
}

int Builder::segments(double length, int least) const {
  return std::max(least, int(std::ceil(length / edge_length_ - 1e-9)));
}

void Builder::begin(const std::string& object, const std::string& material) {
  current_object_ = index_of(object_names_, object);
  current_material_ = index_of(material_names_, material);
}

void Builder::triangle(const Corner& a, const Corner& b, const Corner& c) {
  const glm::dvec3 area = glm::cross(b.position - a.position, c.position - a.position);
  const double longest =
      std::max({glm::distance(a.position, b.position), glm::distance(b.position, c.position),
                glm::distance(c.position, a.position)});
  if (glm::length(area) < 1e-6 * longest * longest) return;
  const bool turned = glm::dot(area, a.normal + b.normal + c.normal) < 0;
  corners_.push_back(a);
  corners_.push_back(turned ? c : b);
  corners_.push_back(turned ? b : c);
  object_.push_back(current_object_);
  material_.push_back(current_material_);
}

void Builder::quad(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  if (glm::distance(a.position, c.position) <= glm::distance(b.position, d.position) * 1.000001) {
    triangle(a, b, c);
    triangle(a, c, d);
  } else {
    triangle(a, b, d);
    triangle(b, c, d);
  }
}

Mesh Builder::finish(std::vector<SurfaceMaterial> materials) const {
  Mesh mesh;
  mesh.objects = object_names_;
  mesh.materials = std::move(materials);
  std::vector<std::uint16_t> material_index;
  for (const std::string& name : material_names_) {
    auto it = std::find_if(mesh.materials.begin(), mesh.materials.end(),
                           [&](const SurfaceMaterial& m) { return m.name == name; });
    if (it == mesh.materials.end()) throw std::logic_error("no material called " + name);
    material_index.push_back(std::uint16_t(it - mesh.materials.begin()));
  }
  std::unordered_map<Key, Id, KeyHash> points, vertices, texcoords;
  std::vector<glm::vec3> point_position;
  for (std::size_t t = 0; t < triangle_count(); ++t) {
    Triangle triangle{};
    triangle.object = object_[t];
    triangle.material = material_index[material_[t]];
    for (int k = 0; k < 3; ++k) {
      const Corner& c = corners_[3 * t + k];
      const Key place{cell(c.position.x, 1e-6), cell(c.position.y, 1e-6), cell(c.position.z, 1e-6),
                      0};
      const auto [point, new_point] = points.emplace(place, Id(points.size()));
      if (new_point) point_position.push_back(glm::vec3(c.position));
      const Key sheet{point->second, cell(c.normal.x, 1e-3) * 4096 + cell(c.normal.y, 1e-3),
                      cell(c.normal.z, 1e-3), triangle.object};
      const auto [vertex, new_vertex] = vertices.emplace(sheet, Id(vertices.size()));
      if (new_vertex) {
        const glm::vec3 position = point_position[point->second];
        mesh.vertices.push_back(
            {position, position, glm::vec3(glm::normalize(c.normal)), point->second});
      }
      const Key uv{cell(c.texcoord.x, 1e-6), cell(c.texcoord.y, 1e-6), 0, 0};
      const auto [texcoord, new_texcoord] = texcoords.emplace(uv, Id(texcoords.size()));
      if (new_texcoord) mesh.texcoords.push_back(glm::vec2(c.texcoord));
      triangle.vertex[k] = vertex->second;
      triangle.texcoord[k] = texcoord->second;
    }
    const auto& v = triangle.vertex;
    const Id p0 = mesh.vertices[v[0]].point, p1 = mesh.vertices[v[1]].point,
             p2 = mesh.vertices[v[2]].point;
    if (p0 != p1 && p1 != p2 && p2 != p0) mesh.triangles.push_back(triangle);
  }
  // Parts are modelled piece by piece, but files need the triangles of an object to be consecutive.
  std::stable_sort(mesh.triangles.begin(), mesh.triangles.end(),
                   [](const Triangle& a, const Triangle& b) {
                     return std::pair(a.object, a.material) < std::pair(b.object, b.material);
                   });
  mesh.points = Id(points.size());
  mesh.curved = !coarse_;
  return mesh;
}

}  // namespace cabin
