// Internal: vertex-by-vertex descent that corrects flipped triangles without flipping others.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/mesh/percentile.h"
#include "libatlas/param/relaxing/vertex_star.h"
#include "libatlas/param/solvers/stiffness.h"

namespace atlas::param {

// The outcome for the stretch that exceeds a bound.
enum class Tail : std::uint8_t {
  lowered,  // it is within the bound now
  left,
  wide  // too many triangles to be lowered place by place
};

// Newton steps on one vertex at a time, over small neighbourhoods. There are three energies of each
// triangle's map J, with d = det J and f = |J|²:
// - untangling, (f + 1 + d²) / chi(d, e) with chi = (d + sqrt(d² + e²)) / 2, which is finite for
//   flipped triangles; e follows the worst d down (Garanzha, Kaporin, Kudryavtseva, Protais, Ray
//   and Sokolov 2021, "Foldover-free maps in 50 lines of code");
// - once all triangles are positive, the symmetric Dirichlet energy f (1 + 1 / d²), a barrier
//   against new flips, where each step is limited by the roots of the triangles' determinants
//   (Smith and Schaefer 2015, "Bijective parameterization with free boundaries");
// - a high power mean of the singular values and their inverses, which the worst triangles
//   dominate, with the same barrier.
class Relaxer {
 public:
  struct Outcome {
    std::uint32_t turned = 0;  // flipped triangles that were corrected
    std::uint32_t left = 0;    // triangles that are still not positive
  };

  struct Spring {
    std::uint32_t vertex;
    Vec2d target;
  };

  // Corrects flipped triangles by moving the vertices near them, and no others. Starts with one
  // ring around them, and doubles the rings as long as that is not enough; gives up earlier if the
  // mesh has holes.
  Outcome remove_flips(ElementView elements, const CornerLists& corners, bool holed,
                       std::span<Vec2d> uvs);

  struct Pull {
    std::span<const Spring> springs;
    int rings, sweeps;
    double least_gain = 0;  // ends after a sweep that gains less than this share of the best
  };

  // Pulls vertices towards targets while the neighbourhood, `rings` wide, follows by the symmetric
  // Dirichlet energy; nothing flips. All triangles must be positive.
  void pull(ElementView elements, const CornerLists& corners, const Pull& pull,
            std::span<Vec2d> uvs);

  struct Places {
    std::span<const std::uint32_t> triangles;
    bool border_moves;
  };

  // Lowers the symmetric Dirichlet energy in two rings around some triangles, by a few sweeps: each
  // widens a squeezed triangle by about a third. All triangles must be positive, and stay so.
  void smooth(ElementView elements, const CornerLists& corners, const Places& places,
              std::span<Vec2d> uvs);

  // Moves these vertices, and no others: turns flipped triangles, and then lowers the symmetric
  // Dirichlet energy of all triangles. Returns whether all triangles are positive.
  bool settle(ElementView elements, const CornerLists& corners,
              std::span<const std::uint32_t> vertices, std::span<Vec2d> uvs);

  // Lowers max(s1, 1/s2) of the uv-to-surface map's singular values, at the area-preserving scale,
  // where it exceeds `bound`, until 99.9 % of the area is within it; most of the other 0.1 % is
  // spared. Only vertices near those triangles move. All triangles must be positive, and stay so.
  // uvs become the best state found.
  Tail lower_tail(ElementView elements, const CornerLists& corners, double bound,
                  std::span<Vec2d> uvs);

 private:
  void begin(ElementView elements, const CornerLists& corners, std::span<Vec2d> uvs);
  void gather(std::span<const std::uint32_t> seeds, int rings);
  bool on_border(std::uint32_t v) const;
  void load_vertex(std::uint32_t v);
  double energy(glm::dvec2 m) const;
  glm::dvec2 newton_step() const;
  void wake_around(std::uint32_t v);
  double sweep();  // returns by how much it lowers the energy
  double least_determinant() const;
  Jacobian jacobian(std::uint32_t t) const;
  bool untangle(int sweeps);
  void measure_again(std::span<const std::uint32_t> triangles);
  double find_tail(double from, std::vector<std::uint32_t>& out);
  void spare_worst(double bound, std::vector<std::uint32_t> tail);

  ElementView elements_;
  const CornerLists* corners_ = nullptr;
  std::span<Vec2d> uvs_;
  // The neighbourhood: the vertices that move and the triangles that change.
  std::vector<std::uint32_t> vertices_, triangles_;
  std::vector<std::uint8_t> vertex_in_, triangle_in_;
  // One per vertex: whether a sweep has to visit it. Empty: it visits all.
  std::vector<std::uint8_t> awake_;
  // Triangles around the moving vertex; spared ones have an energy of their own.
  VertexStar star_, spared_star_;
  std::vector<std::uint32_t> spring_of_;  // one per vertex: 1 + its index in springs_, or 0
  std::span<const Spring> springs_;
  const Spring* spring_ = nullptr;  // of the moving vertex
  glm::dvec2 offset_{0};            // from the spring's target to that vertex
  double mean_area_ = 0;
  double epsilon_ = 0;  // of the untangling energy
  VertexEnergy energy_ = VertexEnergy::symmetric_dirichlet;
  struct Sizes {  // of a triangle's map, before any scale is applied
    double area, uv_area, large, inverse_small;
  };
  std::vector<Sizes> sizes_;     // one per triangle, for find_tail()
  std::vector<double> stretch_;  // likewise
  std::vector<WeightedValue> ranked_;
  std::vector<std::uint8_t> spared_;  // one per triangle, or empty
  std::vector<Vec2d> best_;
};

}  // namespace atlas::param
