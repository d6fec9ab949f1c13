// Internal: vertex-by-vertex descent that turns flipped triangles right and keeps the others so.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/param/percentile.h"
#include "libatlas/param/stiffness.h"
#include "libatlas/param/vertex_star.h"

namespace atlas::param {

// Of what a bound on the stretch exceeds.
enum class Tail : std::uint8_t {
  lowered,  // it is within now
  left,
  wide  // too many triangles to be lowered one place after the other
};

// Newton steps on one vertex at a time over small neighbourhoods, three energies of each triangle's
// map J with d = det J and f = |J|²:
// - untangling, (f + 1 + d²) / chi(d, e) with chi = (d + sqrt(d² + e²)) / 2, finite for flipped
//   triangles; e follows the worst d down (Garanzha, Kaporin, Kudryavtseva, Protais, Ray and
//   Sokolov 2021, "Foldover-free maps in 50 lines of code");
// - once all are positive, the symmetric Dirichlet energy f (1 + 1 / d²), a barrier against new
//   flips, each step limited by the roots of the triangles' determinants (Smith and Schaefer 2015,
//   "Bijective parameterization with free boundaries");
// - a high power mean of the singular values and their inverses, which the worst triangles rule;
//   the same barrier.
class Relaxer {
 public:
  struct Outcome {
    std::uint32_t turned = 0;  // triangles turned right
    std::uint32_t left = 0;    // still not positive
  };

  struct Spring {
    std::uint32_t vertex;
    Vec2d target;
  };

  // Moves the vertices near non-positive triangles and no others. Starts with a ring about them,
  // and doubles the rings while that is not enough, less patiently where the mesh has holes.
  Outcome remove_flips(ElementView elements, const CornerLists& corners, bool holed,
                       std::span<Vec2d> uvs);

  struct Pull {
    std::span<const Spring> springs;
    int rings, sweeps;
    double least_gain = 0;  // ends with a sweep that gains less than this share of the best one's
  };

  // Draws vertices towards targets while the neighbourhood, so many rings wide, follows by the
  // symmetric Dirichlet energy; nothing flips. All triangles must be positive.
  void pull(ElementView elements, const CornerLists& corners, const Pull& pull,
            std::span<Vec2d> uvs);

  // Lowers max(s1, 1/s2) of the uv-to-surface map's singular values, at the area-preserving scale,
  // where it exceeds `bound`, until 99.9 % of the area stays within it; of the rest, most of 0.1 %
  // is spared. Only what lies near those triangles moves. All triangles must be positive and stay
  // so. uvs become the best state seen.
  Tail lower_tail(ElementView elements, const CornerLists& corners, double bound,
                  std::span<Vec2d> uvs);

 private:
  void begin(ElementView elements, const CornerLists& corners, std::span<Vec2d> uvs);
  void gather(std::span<const std::uint32_t> seeds, int rings);
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
  std::vector<std::uint32_t> vertices_,
      triangles_;  // the neighbourhood: what moves, what is touched
  std::vector<std::uint8_t> vertex_in_, triangle_in_;
  std::vector<std::uint8_t> awake_;  // 1 a vertex: a sweep is to look at it; empty: at all
  VertexStar star_,
      spared_star_;  // of the vertex that is moving; triangles with an energy of their own
  std::vector<std::uint32_t> spring_of_;  // 1 a vertex: 1 + its place in springs_, or 0
  std::span<const Spring> springs_;
  const Spring* spring_ = nullptr;  // of the vertex that is moving
  glm::dvec2 offset_{0};            // from the spring's target to where that vertex is
  double mean_area_ = 0;
  double epsilon_ = 0;  // of untangling
  VertexEnergy energy_ = VertexEnergy::symmetric_dirichlet;
  struct Sizes {  // of a triangle's map, before any scale is taken out
    double area, uv_area, large, inverse_small;
  };
  std::vector<Sizes> sizes_;     // 1 a triangle, of find_tail()
  std::vector<double> stretch_;  // likewise
  std::vector<WeightedValue> ranked_;
  std::vector<std::uint8_t> spared_;  // 1 a triangle, or empty
  std::vector<Vec2d> best_;
};

}  // namespace atlas::param
