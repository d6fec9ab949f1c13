#include "libatlas/param/solvers/envelope_kernels.h"

#include <algorithm>

#include "libatlas/core/wide_vectors.h"

namespace atlas::param {
namespace {

constexpr std::size_t side = EnvelopeBlocks::side;

// Computes a block of the factor from the entries that were filled in. `a` and `b` are the first
// blocks in the columns that its row and its column's row share.
template <class Vector>
ATLAS_INLINE void eliminate_block(double* own, const double* a, const double* b,
                                  const double* inverse_pivot) {
  constexpr std::size_t parts = side * sizeof(double) / sizeof(Vector);
  Vector sum[side * parts];
  Vector* const out = reinterpret_cast<Vector*>(own);
  for (std::size_t i = 0; i < side * parts; ++i) sum[i] = out[i];
  for (; a != own; a += EnvelopeBlocks::size, b += EnvelopeBlocks::size) {
#pragma GCC unroll 1  // otherwise the sum does not stay in registers
    for (std::size_t k = 0; k < side; ++k) {
      const Vector* const column = reinterpret_cast<const Vector*>(a + side * k);
      for (std::size_t j = 0; j < side; ++j) {
        const double factor = b[side * k + j];
        for (std::size_t p = 0; p < parts; ++p) sum[parts * j + p] -= column[p] * factor;
      }
    }
  }
  if (inverse_pivot) {
    for (std::size_t j = 0; j < side; ++j) {
      for (std::size_t p = 0; p < parts; ++p) sum[parts * j + p] *= inverse_pivot[j];
      for (std::size_t k = j + 1; k < side; ++k) {
        const double factor = b[side * j + k];
        for (std::size_t p = 0; p < parts; ++p) sum[parts * k + p] -= sum[parts * j + p] * factor;
      }
    }
  }
  for (std::size_t i = 0; i < side * parts; ++i) out[i] = sum[i];
}

template <class Vector>
ATLAS_INLINE void eliminate_row_by(const EnvelopeBlocks& blocks, std::size_t b) {
  for (std::size_t c = blocks.first[b]; c <= b; ++c) {
    const std::size_t begin = std::max(blocks.first[b], blocks.first[c]);
    eliminate_block<Vector>(blocks.at(b, c), blocks.at(b, begin), blocks.at(c, begin),
                            b == c ? nullptr : blocks.inverse_pivot + side * c);
  }
}

void eliminate_row_narrow(const EnvelopeBlocks& blocks, std::size_t b) {
  eliminate_row_by<Pair>(blocks, b);
}

ATLAS_INLINE const Pair& pair(const glm::dvec2& v) {
  return reinterpret_cast<const Pair&>(v);
}
ATLAS_INLINE Pair& pair(glm::dvec2& v) {
  return reinterpret_cast<Pair&>(v);
}

void subtract_columns_narrow(const double* columns, const glm::dvec2* x, std::size_t count,
                             glm::dvec2* sum) {
  Pair own[side];
  for (std::size_t r = 0; r < side; ++r) own[r] = pair(sum[r]);
  for (std::size_t i = 0; i < count; ++i, columns += side) {
    for (std::size_t r = 0; r < side; ++r) own[r] -= columns[r] * pair(x[i]);
  }
  for (std::size_t r = 0; r < side; ++r) pair(sum[r]) = own[r];
}

void subtract_rows_narrow(const double* columns, const glm::dvec2* known, std::size_t count,
                          glm::dvec2* x) {
  const Pair a = pair(known[0]), b = pair(known[1]), c = pair(known[2]), d = pair(known[3]);
  for (std::size_t i = 0; i < count; ++i, columns += side) {
    pair(x[i]) -= (columns[0] * a + columns[2] * c) + (columns[1] * b + columns[3] * d);
  }
}

ATLAS_WIDE void eliminate_row_wide(const EnvelopeBlocks& blocks, std::size_t b) {
  eliminate_row_by<QuadInPlace>(blocks, b);
}

ATLAS_WIDE void subtract_columns_wide(const double* columns, const glm::dvec2* x, std::size_t count,
                                      glm::dvec2* sum) {
  QuadInPlace* const out = reinterpret_cast<QuadInPlace*>(sum);
  Quad low = out[0], high = out[1];
  for (std::size_t i = 0; i < count; ++i) {
    const Quad c = reinterpret_cast<const QuadInPlace*>(columns)[i];
    const Quad both{x[i].x, x[i].y, x[i].x, x[i].y};
    low -= __builtin_shufflevector(c, c, 0, 0, 1, 1) * both;
    high -= __builtin_shufflevector(c, c, 2, 2, 3, 3) * both;
  }
  out[0] = low;
  out[1] = high;
}

ATLAS_WIDE void subtract_rows_wide(const double* columns, const glm::dvec2* known,
                                   std::size_t count, glm::dvec2* x) {
  const Quad low = reinterpret_cast<const QuadInPlace*>(known)[0];
  const Quad high = reinterpret_cast<const QuadInPlace*>(known)[1];
  for (std::size_t i = 0; i < count; ++i) {
    const Quad c = reinterpret_cast<const QuadInPlace*>(columns)[i];
    const Quad sum = __builtin_shufflevector(c, c, 0, 0, 1, 1) * low +
                     __builtin_shufflevector(c, c, 2, 2, 3, 3) * high;
    pair(x[i]) -= __builtin_shufflevector(sum, sum, 0, 1) + __builtin_shufflevector(sum, sum, 2, 3);
  }
}

}  // namespace

void eliminate_row(const EnvelopeBlocks& blocks, std::size_t b) {
  has_wide_vectors ? eliminate_row_wide(blocks, b) : eliminate_row_narrow(blocks, b);
}

void subtract_columns(const double* columns, const glm::dvec2* x, std::size_t count,
                      glm::dvec2* sum) {
  has_wide_vectors ? subtract_columns_wide(columns, x, count, sum)
                   : subtract_columns_narrow(columns, x, count, sum);
}

void subtract_rows(const double* columns, const glm::dvec2* known, std::size_t count,
                   glm::dvec2* x) {
  has_wide_vectors ? subtract_rows_wide(columns, known, count, x)
                   : subtract_rows_narrow(columns, known, count, x);
}

}  // namespace atlas::param
