// Internal: as-rigid-as-possible descent (Liu et al. 2008, "A local/global approach to mesh
// parameterization") for a few fans of a coarse mesh that are joined along arcs. The fans' centres
// are eliminated beforehand, since each is joined only to its own rim; those of wide fans are not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/fans.h"

namespace atlas {

// Joined fans with their own vertex numbers. The cells' centres come first, in order; then come the
// classes of joined slots, in an order that keeps the numbers within each fan close together.
struct JoinedFans {
  static constexpr std::size_t kBeyond = Fans::kBeyond;
  struct Triangle {
    std::uint32_t slot, centre, a, b;  // b: the vertex of the next slot
  };
  std::span<const std::uint32_t> cells;
  std::span<const std::uint32_t> first;  // where each cell's triangles begin, and the end
  // The triangles of each cell are in the order of its slots; kBeyond more may be read.
  std::span<const Triangle> triangles;
};

class FanSolver {
 public:
  explicit FanSolver(const Fans& fans) : fans_(fans) {}

  // Factorizes the stiffness of these fans, whose data must outlive the following steps.
  void factorize(const JoinedFans& joined, std::size_t vertex_count);
  // Makes a local and a global step from `uvs` (one per vertex, in a std::vector), in place. The
  // step is `relaxation` times as long as that to the minimum for the current rotations. Below 2
  // the energy falls (see ArapSolver::iterate).
  void step(double relaxation, std::span<Vec2d> uvs);
  // Number of values that the factor stores.
  std::size_t entries() const { return factor_.size(); }

 private:
  struct Factor;
  struct Fan;
  struct Kernels;

  void find_envelope();
  void fill(std::size_t place);
  Factor factor();
  Fan scratch_fan();
  // Where a row's entries begin, and the place in any row of a column.
  double* row_values(std::uint32_t row) {
    return factor_.data() + row_[row / 2] - 2 * std::size_t{first_[row / 2]} + row % 2 * 2;
  }
  static std::uint32_t column_of(std::uint32_t row) { return row / 2 * 4 + row % 2; }
  std::uint32_t row_of(std::uint32_t vertex) const {
    return vertex - static_cast<std::uint32_t>(joined_.cells.size());
  }

  const Fans& fans_;
  JoinedFans joined_;
  // The factor's rows are stored in pairs. Both rows of a pair run from the same even column to the
  // diagonal, two columns at a time: first the upper row's entries, then the lower row's.
  std::vector<std::uint32_t> first_;  // one per pair: its first column
  std::vector<std::size_t> row_;      // where each pair begins
  std::vector<double> factor_, inverse_pivot_;
  // Number of rows without padding: those of vertices, then those of centres that are not
  // eliminated.
  std::uint32_t count_ = 0, vertex_rows_ = 0;
  std::vector<std::uint32_t> centre_row_;  // one per cell; kNoIndex: eliminated
  std::vector<Vec2d> load_;      // one per cell, then one per row; the latter become the solution
  std::vector<double> scratch_;  // for the current fan, see Fan
  std::size_t longest_ = 0;      // triangles in the largest fan, rounded up to a multiple of four
  std::vector<std::uint32_t> columns_;
  std::vector<double*> rows_;
};

}  // namespace atlas
