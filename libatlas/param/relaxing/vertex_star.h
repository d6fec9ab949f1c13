// Internal: VertexStar, the triangles around a vertex, with their energy while only that vertex
// moves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/wide_vectors.h"
#include "libatlas/param/solvers/stiffness.h"

namespace atlas::param {

enum class VertexEnergy : std::uint8_t { untangling, symmetric_dirichlet, high_power };

// Four triangles are processed at a time. Sums are taken over every fourth triangle first, on every
// processor.
class VertexStar {
 public:
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  // Adds a triangle whose element has the vertex at this corner. `uvs` are the places of the
  // corners.
  void add(const Element& element, std::uint32_t corner, const std::array<glm::dvec2, 3>& uvs,
           double weight);
  // To be called after all triangles are added, before the functions below.
  void finish();

  // The energy to compute. `epsilon` is used by the untangling energy only.
  struct Kind {
    VertexEnergy energy;
    double epsilon = 0;
  };
  // Returns the weighted energy if the vertex moves by m; infinite if a triangle would not be
  // positive, except for untangling.
  double energy(const Kind& kind, glm::dvec2 m) const;

  struct Derivatives {  // of the energy, at the vertex's present place
    glm::dvec2 gradient{0};
    double xx = 0, xy = 0, yy = 0;
  };
  Derivatives derivatives(const Kind& kind) const;

  // Returns the share of the step, at most 1, that goes four fifths of the way to the first
  // degenerate triangle.
  double share_within(glm::dvec2 step) const;

 private:
  static constexpr std::size_t lanes = 4;
  struct Shapes {  // as added, one lane each
    double length[lanes], foot[lanes], altitude[lanes], weight[lanes];
    double x1[lanes], y1[lanes], x2[lanes], y2[lanes];  // corners 1 and 2 relative to corner 0
    // The gradient of the corner as a combination of those of corners 1 and 2.
    double of_first[lanes], of_second[lanes];
  };
  // f = |J|² becomes f + 2 a.m + q m.m, and d = det J becomes d + n.m. Quads are aligned to their
  // size only where wide vectors are enabled when compiling.
  struct alignas(sizeof(Quad)) Terms {
    Quad f, d, q, weight, ax, ay, nx, ny;
  };
  struct Kernels;

  std::vector<Shapes> shapes_;
  std::vector<Terms> terms_;
  std::size_t size_ = 0;
};

}  // namespace atlas::param
