// Internal: the triangles around a vertex and their energy while it alone moves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/wide_vectors.h"
#include "libatlas/param/stiffness.h"

namespace atlas::param {

enum class VertexEnergy : std::uint8_t { untangling, symmetric_dirichlet, high_power };

// Four triangles at a time. Sums are over every fourth triangle first, whatever the processor has.
class VertexStar {
 public:
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  // A triangle that has the vertex at this corner of its element, the corners lying at `uvs`.
  void add(const Element& element, std::uint32_t corner, const std::array<glm::dvec2, 3>& uvs,
           double weight);
  // To be called when all have been added, before what follows.
  void finish();

  // What is asked for: `epsilon` is untangling's.
  struct Kind {
    VertexEnergy energy;
    double epsilon = 0;
  };
  // The weighted energy with the vertex moved by m; infinite if a triangle were not positive, but
  // for untangling.
  double energy(const Kind& kind, glm::dvec2 m) const;

  struct Derivatives {  // of the energy, where the vertex is
    glm::dvec2 gradient{0};
    double xx = 0, xy = 0, yy = 0;
  };
  Derivatives derivatives(const Kind& kind) const;

  // The share of the step, at most 1, that takes four fifths of the first triangle that it would
  // degenerate.
  double share_within(glm::dvec2 step) const;

 private:
  static constexpr std::size_t lanes = 4;
  struct Shapes {  // as added, a lane each
    double length[lanes], foot[lanes], altitude[lanes], weight[lanes];
    double x1[lanes], y1[lanes], x2[lanes], y2[lanes];  // corners 1 and 2 from corner 0
    double of_first[lanes], of_second[lanes];  // the corner's gradient by those of corners 1 and 2
  };
  // Quads lie at multiples of their size only where wide vectors are asked for when compiling.
  struct alignas(
      sizeof(Quad)) Terms {  // f = |J|² becomes f + 2 a.m + q m.m, d = det J becomes d + n.m
    Quad f, d, q, weight, ax, ay, nx, ny;
  };
  struct Kernels;

  std::vector<Shapes> shapes_;
  std::vector<Terms> terms_;
  std::size_t size_ = 0;
};

}  // namespace atlas::param
