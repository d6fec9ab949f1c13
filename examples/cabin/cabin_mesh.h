// The cabin's geometry while it is built and while it is refined.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "libatlas/core/image.h"

namespace cabin {

using Id = std::uint32_t;

struct SurfaceMaterial {
  std::string name;
  glm::vec3 diffuse{1};      // Kd, linear
  std::string texture_file;  // empty if it has none
  atlas::Image8 texture;     // sRGB-encoded
  glm::vec3 reflectance{1};  // diffuse times the texture's mean, linear; set by finish_materials
  glm::vec3 emission{0};     // exitance, lux; such a surface shows it instead of what it receives
};

// A point of a surface as light sees it. Faces that meet at a crease have separate vertices there,
// because they receive different light. Vertices at the same position share `point`.
struct Vertex {
  glm::vec3 position;   // on the smooth surface
  glm::vec3 ray_start;  // on the coarse mesh that rays are traced against
  glm::vec3 normal;     // unit, smooth
  Id point;
};

struct Triangle {
  std::array<Id, 3> vertex;
  std::array<Id, 3> texcoord;
  std::uint16_t object, material;
};

struct Mesh {
  std::vector<Vertex> vertices;
  std::vector<glm::vec2> texcoords;
  std::vector<Triangle> triangles;
  std::vector<std::string> objects;
  std::vector<SurfaceMaterial> materials;
  bool curved = true;               // normals are accurate enough to refine along
  Id points = 0;                    // number of distinct Vertex::point
  std::vector<glm::vec3> direct;    // one per vertex, lux
  std::vector<glm::vec3> indirect;  // one per vertex, lux
};

// The mesh that rays are traced against.
struct Shell {
  std::vector<glm::vec3> positions;
  std::vector<std::array<Id, 3>> triangles;
};
Shell shell_of(const Mesh& mesh);

// A corner as the modelling functions make it, before welding.
struct Corner {
  glm::dvec3 position;
  glm::dvec3 normal;
  glm::dvec2 texcoord;
};

// Collects triangles as loose corners; finish() welds them.
class Builder {
 public:
  Builder(double edge_length, bool coarse) : edge_length_(edge_length), coarse_(coarse) {}

  // The largest edge that the caller wants; parts choose their numbers of segments by it.
  double edge_length() const { return edge_length_; }
  // Whether there are so few triangles that small parts must use as few as possible.
  bool coarse() const { return coarse_; }
  // Returns the number of segments for a length, at least `least`.
  int segments(double length, int least = 1) const;

  // Sets the object and material of the triangles that follow.
  void begin(const std::string& object, const std::string& material);
  // Adds a triangle, oriented so that it faces along the normals of its corners. Triangles without
  // area (at poles) are left out.
  void triangle(const Corner& a, const Corner& b, const Corner& c);
  void quad(const Corner& a, const Corner& b, const Corner& c, const Corner& d);

  std::size_t triangle_count() const { return corners_.size() / 3; }
  // Corners at the same position become one point. Those that also share normal and object become
  // one vertex.
  Mesh finish(std::vector<SurfaceMaterial> materials) const;

 private:
  double edge_length_;
  bool coarse_;
  std::vector<Corner> corners_;
  std::vector<std::uint16_t> object_, material_;  // one per triangle
  std::vector<std::string> object_names_, material_names_;
  std::uint16_t current_object_ = 0, current_material_ = 0;
};

}  // namespace cabin
