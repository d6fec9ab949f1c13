// Internal: as-rigid-as-possible descent (Liu et al. 2008, "A local/global approach to mesh
// parameterization") for a few fans of a coarse mesh joined along arcs. Their centres are
// eliminated beforehand: each is joined to its own rim only.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/fans.h"

namespace atlas {

// Fans with their local vertices: the cells' centres in order, then the classes of joined slots, in
// an order that keeps the numbers within each fan close together.
struct JoinedFans {
  static constexpr std::size_t kBeyond = Fans::kBeyond;
  struct Triangle {
    std::uint32_t slot, centre, a, b;  // b: the vertex of the next slot
  };
  std::span<const std::uint32_t> cells;
  std::span<const std::uint32_t> first;  // where a cell's triangles begin, and one more
  // A cell's in the order of its slots; kBeyond more may be read.
  std::span<const Triangle> triangles;
};

class FanSolver {
 public:
  explicit FanSolver(const Fans& fans) : fans_(fans) {}

  // Factorises the stiffness of these fans, which must stay for the steps to come.
  void factorize(const JoinedFans& joined, std::size_t vertex_count) {
    factorize(joined, vertex_count, {});
  }
  // The same where vertices from `first_held` on stay as `uvs` (1 a vertex) has them; free ones are
  // joined to some of these, if there are any.
  void factorize(const JoinedFans& joined, std::size_t first_held, std::span<const Vec2d> uvs);
  // A local and a global step from uvs (1 a vertex, of a std::vector), in place, `relaxation` times
  // as long as to the minimum for given rotations: below 2 the energy falls (see
  // ArapSolver::iterate).
  void step(double relaxation, std::span<Vec2d> uvs);

 private:
  struct Factor;
  struct Fan;
  struct Kernels;

  void find_envelope();
  void fill(std::size_t place, std::span<const Vec2d> uvs);
  Factor factor();
  Fan scratch_fan();
  std::uint32_t row_of(std::uint32_t vertex) const {
    return vertex - static_cast<std::uint32_t>(joined_.cells.size());
  }

  const Fans& fans_;
  JoinedFans joined_;
  // The factor's rows in pairs, each from the same even column to the diagonal, two columns of both
  // at a time: the upper row's, then the lower one's.
  std::vector<std::uint32_t> first_;  // that column, 1 a pair
  std::vector<std::size_t> row_;      // where the pair begins
  std::vector<double> factor_, inverse_pivot_;
  std::uint32_t count_ = 0;       // of rows that are not mere padding
  std::size_t held_ = 0;          // vertices
  std::vector<Vec2d> held_load_;  // 1 a row: what these ask of it
  std::vector<Vec2d> load_;       // 1 a cell, 1 a row; then the rows' solution
  std::vector<double> scratch_;   // for the fan at hand, see Fan
  std::size_t longest_ = 0;       // of the fans, and some beyond
  std::vector<std::uint32_t> columns_;
  std::vector<double*> rows_;
};

}  // namespace atlas
