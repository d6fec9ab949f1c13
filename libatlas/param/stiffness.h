// Internal: the linear system of the isometric solvers: triangles as finite elements, their
// cotangent stiffness in compressed rows, the local step and the right-hand side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/isometric.h"
#include "libatlas/param/rest_shape.h"

namespace atlas::param {

// Assigning {} would keep the memory.
template <class T>
void give_back(std::vector<T>& v) {
  std::vector<T>().swap(v);
}

// Weight times area times the products of the gradients of an element's hat functions: of each
// corner's with itself, and of the two others'.
struct ElementStiffness {
  std::array<double, 3> own, across;
};

// A rest shape with a positive altitude. What can be had from the rest in a few cycles is not kept.
struct Element {
  std::array<std::uint32_t, 3> v;
  float weight = 1;  // factor of the energy
  double length, foot, altitude;

  double area() const { return 0.5 * length * altitude; }
  Jacobian jacobian(glm::dvec2 u0, glm::dvec2 u1, glm::dvec2 u2) const {
    const glm::dvec2 x = (u1 - u0) / length;
    return {x, (u2 - u0 - x * foot) / altitude};
  }
  // Area times the gradient of the corner's hat function. No division: safe for any sliver.
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

// Those of a mesh. Large charts hold more memory in them than in anything else: there each is put
// together when it is asked for, of its shape and its triangle's corners. That is 15 bytes a
// triangle less, but small charts, which fit the processor's caches, would take longer.
class Elements {
 public:
  // Altitudes are raised to at least min_altitude and 1e-9 of the base; a triangle without any
  // length becomes a right-angled speck of that size. Every element's stiffness is then finite and
  // positive semi-definite, whatever its angles, and the system of a connected mesh is definite
  // once one vertex is held. The mesh's triangles must outlive the elements.
  void build(const LocalMesh& mesh, double min_altitude);
  void give_back();

  std::size_t size() const { return triangles_.size(); }
  Element operator[](std::size_t t) const { return whole_.empty() ? assembled(t) : whole_[t]; }
  // The same without a copy where it is kept; else `room` takes it.
  const Element& at(std::size_t t, Element& room) const {
    return whole_.empty() ? room = assembled(t) : whole_[t];
  }
  // Calls body with what gives the element of a triangle by []. A loop inside asks only once how
  // they are kept.
  template <class Body>
  auto visit(const Body& body) const {
    return whole_.empty() ? body(Assembler{*this}) : body(std::span<const Element>(whole_));
  }
  void set_weight(std::size_t t, float weight);
  void reset_weights();  // to 1

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
  std::vector<Shape> shapes_;   // of a large one, with the corner where Element::v begins
  std::vector<std::uint8_t> base_;
  std::vector<float> weights_;  // or empty
};

// Points at the elements of a mesh, or at none.
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

// Triangle corners around each vertex: entries 3 t + corner in order of t.
struct CornerLists {
  std::vector<std::uint32_t> first, corner;
  void build(const Elements& elements, std::size_t vertices);
};

// A symmetric matrix: its diagonal apart, the rest by rows, both halves stored, in an order that is
// reproducible, no more.
struct SymmetricMatrix {
  std::vector<double> diagonal, value;
  std::vector<std::uint32_t> first, column;
  std::vector<std::uint32_t> scratch;
  std::size_t rows() const { return diagonal.size(); }
};

// Sum over elements of weight * area * grad(i) . grad(j).
void build_stiffness(const Elements& elements, const CornerLists& corners, SymmetricMatrix& out);

// (cosine, sine), 1 a triangle; what the steps compute from each other is in double.
using Rotations = std::vector<glm::vec2>;

// The global step's right-hand side: uvs that minimise sum weight * area * |J - R|² solve K u =
// this.
void rotation_load(const Elements& elements, const Rotations& rotations, std::span<glm::dvec2> out);

struct LocalStep {
  std::span<const Vec2d> uvs;
  // IsometricOptions::shear_weight. What is left to 1 stays in the target of each triangle's map
  // beside the rotation, whose energy then has the gradient of the one asked for, and is nowhere
  // below it but for a constant: each step descends. Only of little shear: much of it is removed as
  // if its weight were 1, and triangles that are turned over are turned back.
  double shear_weight = 1;
};

// Local step from given rotations, with the right-hand side of the next global step; returns by how
// much the new rotations lower sum weight * area * |J - R|².
double update_rotations(const Elements& elements, const LocalStep& step, Rotations& rotations,
                        std::span<glm::dvec2> load);

// Energy and non-positive triangles of uvs, with each triangle's nearest rotation (weights left
// out).
IsometricResult measure_energy(const Elements& elements, std::span<const Vec2d> uvs);

// Whether that energy is beyond the limit; no more triangles are looked at than it takes.
bool energy_exceeds(double limit, const Elements& elements, std::span<const Vec2d> uvs);

}  // namespace atlas::param
