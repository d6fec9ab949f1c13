// Internal: the inner loops of the envelope solver, with wider vectors where the processor has
// them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "libatlas/core/glm_bridge.h"

namespace atlas::param {

// A factor in blocks of 4 x 4, column after column: row b's blocks first[b] .. b start at block
// row[b].
struct EnvelopeBlocks {
  static constexpr std::size_t side = 4, size = side * side;
  const std::uint32_t* first;
  const std::size_t* row;
  double* entries;
  const double* inverse_pivot;  // 1 a row of the matrix

  double* at(std::size_t b, std::size_t c) const {
    return entries + size * (row[b] + c - first[b]);
  }
};

// Row b of the factor but for the last step of its diagonal block, whose own entries are not
// eliminated from each other yet; all rows before are done. What comes out is the same to the bit
// on every processor.
void eliminate_row(const EnvelopeBlocks& blocks, std::size_t b);

// Vectors of the plane that are given below lie at multiples of 16 bytes.

// `sum`, four vectors, less so many columns of four entries times x, a vector each.
void subtract_columns(const double* columns, const glm::dvec2* x, std::size_t count,
                      glm::dvec2* sum);

// Each of so many vectors x less the four known ones times its column.
void subtract_rows(const double* columns, const glm::dvec2* known, std::size_t count,
                   glm::dvec2* x);

}  // namespace atlas::param
