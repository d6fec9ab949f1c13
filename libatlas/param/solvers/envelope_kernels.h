// Internal: the inner loops of the envelope solver, with wider vectors where the processor has
// them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "libatlas/core/glm_bridge.h"

namespace atlas::param {

// A factor in blocks of 4 x 4, stored by columns. The blocks first[b] .. b of block row b start at
// block row[b].
struct EnvelopeBlocks {
  static constexpr std::size_t side = 4, size = side * side;
  const std::uint32_t* first;
  const std::size_t* row;
  double* entries;
  const double* inverse_pivot;  // one per row of the matrix

  double* at(std::size_t b, std::size_t c) const {
    return entries + size * (row[b] + c - first[b]);
  }
};

// Computes block row b of the factor, when all rows before are done, except for the last step of
// its diagonal block, whose entries are not yet eliminated from each other. The result is bitwise
// the same on every processor.
void eliminate_row(const EnvelopeBlocks& blocks, std::size_t b);

// The vectors in the plane that are passed below must be aligned to 16 bytes.

// Subtracts from `sum`, four vectors, the products of `count` columns of four entries with x, one
// vector each.
void subtract_columns(const double* columns, const glm::dvec2* x, std::size_t count,
                      glm::dvec2* sum);

// Subtracts from each of `count` vectors x the four known vectors times its column.
void subtract_rows(const double* columns, const glm::dvec2* known, std::size_t count,
                   glm::dvec2* x);

}  // namespace atlas::param
