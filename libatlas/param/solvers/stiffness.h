// Internal: the linear system of the isometric solvers, that is, triangles as finite elements,
// their cotangent stiffness in compressed rows, the local step and the right-hand side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/isometric.h"
#include "libatlas/param/mesh/rest_shape.h"

namespace atlas::param {

// Frees the vector's memory, which assigning {} would keep.
template <class T>
void give_back(std::vector<T>& v) {
  std::vector<T>().swap(v);
}

// Weight times area times the products of the gradients of an element's hat functions: `own` of
// each corner's with itself, `across` of the other two corners'.
struct ElementStiffness {
  std::array<double, 3> own, across;
};

// A rest shape with a positive altitude. Quantities that take a few cycles to compute are not
// stored.
struct Element {
  std::array<std::uint32_t, 3> v;
  float weight = 1;  // factor of the energy
  double length, foot, altitude;

  double area() const { return 0.5 * length * altitude; }
  Jacobian jacobian(glm::dvec2 u0, glm::dvec2 u1, glm::dvec2 u2) const {
    const glm::dvec2 x = (u1 - u0) / length;
    return {x, (u2 - u0 - x * foot) / altitude};
  }
  // Area times the gradients of the corners' hat functions. There is no division, so any sliver is
  // safe.
  std::array<glm::dvec2, 3> area_gradients() const {
    const glm::dvec2 g1(0.5 * altitude, -0.5 * foot), g2(0, 0.5 * length);
    return {-(g1 + g2), g1, g2};
  }
  ElementStiffness stiffness() const {
    const double scale = 0.5 * weight / (length * altitude), rest = length - foot;
    const double squared = altitude * altitude;
    return {
        {(squared + rest * rest) * scale, (squared + foot * foot) * scale, length * length * scale},
        {-foot * length * scale, -rest * length * scale, (foot * rest - squared) * scale}};
  }
};

// The elements of a mesh. In large charts they would take more memory than anything else, so each
// element is assembled on access, from its shape and its triangle's corners. This saves 15 bytes
// per triangle, but would take longer for small charts, which fit the processor's caches.
class Elements {
 public:
  // Altitudes are raised to at least min_altitude and 1e-9 of the base. A triangle without any
  // length becomes a right-angled triangle of that size. Every element's stiffness is then finite
  // and positive semi-definite, whatever its angles, and the system of a connected mesh is definite
  // once one vertex is held. The mesh's triangles must outlive the elements.
  void build(const LocalMesh& mesh, double min_altitude);
  void give_back();

  std::size_t size() const { return triangles_.size(); }
  Element operator[](std::size_t t) const { return whole_.empty() ? assembled(t) : whole_[t]; }
  // The same without a copy where elements are stored; otherwise the element is assembled in
  // `room`.
  const Element& at(std::size_t t, Element& room) const {
    return whole_.empty() ? room = assembled(t) : whole_[t];
  }
  // Calls body with an object whose operator[] returns the element of a triangle. A loop inside
  // body then checks only once how elements are stored.
  template <class Body>
  auto visit(const Body& body) const {
    return whole_.empty() ? body(Assembler{*this}) : body(std::span<const Element>(whole_));
  }
  void set_weight(std::size_t t, float weight);
  void reset_weights();  // sets all weights to 1

 private:
  static constexpr std::size_t large = 100000;
  struct Shape {
    double length, foot, altitude;
  };

  struct Assembler {
    const Elements& elements;
    Element operator[](std::size_t t) const { return elements.assembled(t); }
  };

  Element assembled(std::size_t t) const {
    const auto& v = triangles_[t];
    const std::uint32_t k = base_[t], k1 = k == 2 ? 0 : k + 1, k2 = k == 0 ? 2 : k - 1;
    const Shape& s = shapes_[t];
    return {{v[k], v[k1], v[k2]}, weights_.empty() ? 1 : weights_[t], s.length, s.foot, s.altitude};
  }

  std::span<const std::array<std::uint32_t, 3>> triangles_;
  std::vector<Element> whole_;  // of a small mesh
  // Of a large mesh; base_ is the corner where Element::v begins.
  std::vector<Shape> shapes_;
  std::vector<std::uint8_t> base_;
  std::vector<float> weights_;  // may be empty
};

// Refers to the elements of a mesh, or to none.
class ElementView {
 public:
  ElementView() = default;
  ElementView(const Elements& elements) : elements_(&elements) {}
  std::size_t size() const { return elements_->size(); }
  Element operator[](std::size_t t) const { return (*elements_)[t]; }
  const Element& at(std::size_t t, Element& room) const { return elements_->at(t, room); }

 private:
  const Elements* elements_ = nullptr;
};

// The triangle corners around each vertex: entries 3 t + corner, in order of t.
struct CornerLists {
  std::vector<std::uint32_t> first, corner;
  void build(const Elements& elements, std::size_t vertices);
};

// A symmetric matrix. The diagonal is stored separately, the other entries by rows, in both halves.
// Their order within a row is reproducible but not sorted.
struct SymmetricMatrix {
  std::vector<double> diagonal, value;
  std::vector<std::uint32_t> first, column;
  std::vector<std::uint32_t> scratch;
  std::size_t rows() const { return diagonal.size(); }
};

// Computes the sum over elements of weight * area * grad(i) . grad(j).
void build_stiffness(const Elements& elements, const CornerLists& corners, SymmetricMatrix& out);

// (cosine, sine) per triangle. Computations with them are in double.
using Rotations = std::vector<glm::vec2>;

// Computes the global step's right-hand side: uvs that minimize the sum of weight * area * |J - R|²
// solve K u = out.
void rotation_load(const Elements& elements, const Rotations& rotations, std::span<glm::dvec2> out);

struct LocalStep {
  std::span<const Vec2d> uvs;
  // IsometricOptions::shear_weight. The rest, 1 - shear_weight, of a triangle's shear stays in the
  // target of its map, in addition to the rotation. The energy of that target has the gradient of
  // the desired energy and, but for a constant, is an upper bound of it, so each step descends.
  // Only small shear is kept: large shear is removed as if its weight were 1, and flipped triangles
  // are turned back.
  double shear_weight = 1;
};

// Makes a local step from the given rotations, and computes the right-hand side of the next global
// step. Returns by how much the new rotations lower the sum of weight * area * |J - R|².
double update_rotations(const Elements& elements, const LocalStep& step, Rotations& rotations,
                        std::span<glm::dvec2> load);

// IsometricResult without its uvs.
struct MapEnergy {
  double energy = 0;
  std::uint64_t flips = 0;
};

// Returns the energy of uvs with each triangle's nearest rotation (without weights), and the number
// of non-positive triangles.
MapEnergy measure_energy(const Elements& elements, std::span<const Vec2d> uvs);

// Whether that energy exceeds the limit. Visits no more triangles than needed.
bool energy_exceeds(double limit, const Elements& elements, std::span<const Vec2d> uvs);

}  // namespace atlas::param
