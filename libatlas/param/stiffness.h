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

// A rest shape with a positive altitude. Large charts hold more memory in these than in anything
// else, so what can be had from the rest in a few cycles is not kept.
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
};

// Altitudes are raised to at least min_altitude and 1e-9 of the base; a triangle without any length
// becomes a right-angled speck of that size. Every element's stiffness is then finite and positive
// semi-definite, whatever its angles, and the system of a connected mesh is definite once one
// vertex is held.
void build_elements(const LocalMesh& mesh, double min_altitude, std::vector<Element>& out);

// Triangle corners around each vertex: entries 3 t + corner in order of t.
struct CornerLists {
  std::vector<std::uint32_t> first, corner;
  void build(std::span<const Element> elements, std::size_t vertices);
};

// A symmetric matrix: its diagonal apart, the rest by rows, both halves stored. The columns of row
// i below i stand first, from first[i] to middle[i]; otherwise their order is reproducible, no
// more.
struct SymmetricMatrix {
  std::vector<double> diagonal, value;
  std::vector<std::uint32_t> first, middle, column;
  std::vector<std::uint32_t> scratch;
  std::size_t rows() const { return diagonal.size(); }
};

// Brings the rows into that order.
void partition_rows(SymmetricMatrix& matrix);

// Sum over elements of weight * area * grad(i) . grad(j).
void build_stiffness(std::span<const Element> elements, const CornerLists& corners,
                     SymmetricMatrix& out);

// (cosine, sine), 1 a triangle; what the steps compute from each other is in double.
using Rotations = std::vector<glm::vec2>;

// The local step: the rotation nearest to each triangle's map.
void local_rotations(std::span<const Element> elements, std::span<const Vec2d> uvs, Rotations& out);

// The global step's right-hand side: uvs that minimise sum weight * area * |J - R|² solve K u =
// this.
void rotation_load(std::span<const Element> elements, const Rotations& rotations,
                   std::span<glm::dvec2> out);

// Local step from given rotations, with the right-hand side of the next global step; returns by how
// much it lowers sum weight * area * |J - R|².
double update_rotations(std::span<const Element> elements, std::span<const Vec2d> uvs,
                        Rotations& rotations, std::span<glm::dvec2> load);

// Energy and non-positive triangles of uvs, with each triangle's nearest rotation (weights left
// out).
IsometricResult measure_energy(std::span<const Element> elements, std::span<const Vec2d> uvs);

// Whether that energy is beyond the limit; no more triangles are looked at than it takes.
bool energy_exceeds(double limit, std::span<const Element> elements, std::span<const Vec2d> uvs);

}  // namespace atlas::param
