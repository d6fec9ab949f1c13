#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "libatlas/core/no_index.h"
#include "libatlas/param/solvers/envelope_kernels.h"
#include "libatlas/param/solvers/linear_solver.h"

namespace atlas::param {
namespace {

constexpr std::size_t block_side = EnvelopeBlocks::side, block_size = EnvelopeBlocks::size;

}  // namespace

// Returns where entry (i, j) of the reordered matrix is stored, j <= i.
inline std::size_t EnvelopeSolver::place(std::size_t i, std::size_t j) const {
  return block_size * (row_[i / block_side] + (j / block_side - first_[i / block_side])) +
         block_side * (j % block_side) + i % block_side;
}

// Builds the graph of the elements' vertices. Neighbours are in the order in which elements list
// them.
EnvelopeSolver::Graph EnvelopeSolver::connect(const Elements& elements, std::size_t vertices) {
  graph_first_.assign(vertices + 1, 0);
  graph_column_.resize(6 * elements.size());
  elements.visit([&](const auto& each) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      for (const std::uint32_t v : e.v) graph_first_[v] += 2;
    }
    std::uint32_t end = 0;
    for (std::uint32_t& first : graph_first_) first = std::exchange(end, end + first);
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& next = graph_first_[e.v[k]];
        graph_column_[next++] = e.v[(k + 1) % 3];
        graph_column_[next++] = e.v[(k + 2) % 3];
      }
    }
  });
  for (std::size_t v = vertices; v > 0; --v) graph_first_[v] = graph_first_[v - 1];
  graph_first_[0] = 0;
  return {graph_first_, graph_column_};
}

// Fills queue_ breadth-first from `start`, over vertices whose position_ is kNoIndex. Returns the
// last one.
std::uint32_t EnvelopeSolver::sweep(const Graph& graph, std::uint32_t start) {
  queue_.assign(1, start);
  position_[start] = 0;
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const std::uint32_t v = queue_[i];
    for (std::uint32_t k = graph.first[v]; k < graph.first[v + 1]; ++k) {
      const std::uint32_t w = graph.column[k];
      if (position_[w] != kNoIndex) continue;
      position_[w] = static_cast<std::uint32_t>(queue_.size());
      queue_.push_back(w);
    }
  }
  return queue_.back();
}

void EnvelopeSolver::order(const Graph& graph) {
  const std::uint32_t n = static_cast<std::uint32_t>(graph.rows());
  order_.clear();
  position_.assign(n, kNoIndex);
  held_.assign(n, 0);
  for (std::uint32_t v = 0; v < n; ++v) {
    if (position_[v] != kNoIndex) continue;
    const std::uint32_t start = sweep(graph, v);  // the farthest vertex is a good end
    for (const std::uint32_t w : queue_) position_[w] = kNoIndex;
    sweep(graph, start);
    // The last vertex of its piece to be eliminated: its pivot is mere rounding.
    held_[start] = 1;
    order_.insert(order_.end(), queue_.begin(), queue_.end());
  }
  std::reverse(order_.begin(), order_.end());
  for (std::uint32_t i = 0; i < n; ++i) position_[order_[i]] = i;
}

void EnvelopeSolver::find_envelope(const Graph& graph) {
  const std::size_t n = graph.rows(), blocks = (n + block_side - 1) / block_side;
  first_.resize(blocks);
  row_.resize(blocks + 1);
  row_[0] = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    std::uint32_t first = static_cast<std::uint32_t>(block_side * b);
    for (std::size_t i = block_side * b; i < std::min(block_side * (b + 1), n); ++i) {
      const std::uint32_t v = order_[i];
      for (std::uint32_t k = graph.first[v]; k < graph.first[v + 1]; ++k) {
        first = std::min(first, position_[graph.column[k]]);
      }
    }
    first_[b] = first / block_side;
    row_[b + 1] = row_[b] + (b - first_[b] + 1);
  }
}

void EnvelopeSolver::find_places(const Elements& elements) {
  places_.resize(elements.size());
  elements.visit([&](const auto& each) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      const std::uint32_t p[3] = {position_[e.v[0]], position_[e.v[1]], position_[e.v[2]]};
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = p[(k + 1) % 3], b = p[(k + 2) % 3];
        places_[t][k] = place(std::max(a, b), std::min(a, b));
      }
    }
  });
}

// Copies the matrix into the envelope. Rows beyond the last one are 0.
void EnvelopeSolver::fill(const SymmetricMatrix& matrix) {
  factor_.assign(block_size * row_.back(), 0);
  for (std::uint32_t i = 0; i < matrix.rows(); ++i) {
    const std::uint32_t v = order_[i];
    factor_[place(i, i)] = matrix.diagonal[v];
    for (std::uint32_t k = matrix.first[v]; k < matrix.first[v + 1]; ++k) {
      const std::uint32_t j = position_[matrix.column[k]];
      if (j < i) factor_[place(i, j)] += matrix.value[k];
    }
  }
}

void EnvelopeSolver::fill(const Elements& elements) {
  factor_.assign(block_size * row_.back(), 0);
  diagonal_.assign(order_.size(), 0);
  elements.visit([&](const auto& each) {
    for (std::size_t t = 0; t < elements.size(); ++t) {
      const Element& e = each[t];
      const ElementStiffness s = e.stiffness();
      for (std::size_t k = 0; k < 3; ++k) {
        diagonal_[e.v[k]] += s.own[k];
        factor_[places_[t][k]] += s.across[k];
      }
    }
  });
  for (std::size_t i = 0; i < order_.size(); ++i) factor_[place(i, i)] = diagonal_[order_[i]];
}

void EnvelopeSolver::factorize(const SymmetricMatrix& matrix) {
  const Graph graph{matrix.first, matrix.column};
  order(graph);
  find_envelope(graph);
  fill(matrix);
  eliminate(matrix.diagonal);
}

double EnvelopeSolver::analyze(const Elements& elements, std::size_t vertices) {
  const Graph graph = connect(elements, vertices);
  order(graph);
  find_envelope(graph);
  find_places(elements);
  double work = 0;
  for (std::size_t b = 0; b < first_.size(); ++b) {
    const double width = double(row_[b + 1] - row_[b]);
    work += width * width;
  }
  return work;
}

void EnvelopeSolver::factorize(const Elements& elements) {
  fill(elements);
  eliminate(diagonal_);
}

// Factorizes the filled matrix, whose diagonal is given, one per vertex.
void EnvelopeSolver::eliminate(std::span<const double> diagonal) {
  const std::size_t blocks = first_.size();
  inverse_pivot_.assign(block_side * blocks, 0);
  const EnvelopeBlocks factor{first_.data(), row_.data(), factor_.data(), inverse_pivot_.data()};
  for (std::size_t b = 0; b < blocks; ++b) {
    eliminate_row(factor, b);
    double* own = factor.at(b, b);
    for (std::size_t j = 0; j < std::min(block_side, order_.size() - block_side * b); ++j) {
      const std::uint32_t v = order_[block_side * b + j];
      const double pivot = own[block_side * j + j];
      if (held_[v] == 0 && pivot > 1e-15 * diagonal[v]) {
        inverse_pivot_[block_side * b + j] = 1 / std::sqrt(pivot);
      }
      for (std::size_t r = j + 1; r < block_side; ++r)
        own[block_side * j + r] *= inverse_pivot_[block_side * b + j];
      for (std::size_t k = j + 1; k < block_side; ++k) {
        for (std::size_t r = k; r < block_side; ++r) {
          own[block_side * k + r] -= own[block_side * j + r] * own[block_side * j + k];
        }
      }
    }
  }
}

void EnvelopeSolver::solve(std::span<const glm::dvec2> load, std::span<glm::dvec2> x) {
  const std::size_t n = order_.size(), blocks = first_.size();
  work_.assign(block_side * blocks, glm::dvec2(0));
  glm::dvec2* work = work_.data();
  const EnvelopeBlocks factor{first_.data(), row_.data(), factor_.data(), inverse_pivot_.data()};
  for (std::size_t i = 0; i < n; ++i) work[i] = load[order_[i]];
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::size_t begin = block_side * first_[b];
    alignas(16) std::array<glm::dvec2, block_side> sum;
    for (std::size_t r = 0; r < block_side; ++r) sum[r] = work[block_side * b + r];
    subtract_columns(factor.at(b, first_[b]), work + begin, block_side * b - begin, sum.data());
    const double* column = factor.at(b, b);
    for (std::size_t j = 0; j < block_side; ++j, column += block_side) {
      sum[j] *= inverse_pivot_[block_side * b + j];
      for (std::size_t r = j + 1; r < block_side; ++r) sum[r] -= column[r] * sum[j];
      work[block_side * b + j] = sum[j];
    }
  }
  for (std::size_t b = blocks; b-- > 0;) {
    const std::size_t begin = block_side * first_[b];
    alignas(16) std::array<glm::dvec2, block_side> known;
    const double* own = factor.at(b, b);
    for (std::size_t j = block_side; j-- > 0;) {
      known[j] = work[block_side * b + j];
      for (std::size_t r = j + 1; r < block_side; ++r)
        known[j] -= own[block_side * j + r] * known[r];
      work[block_side * b + j] = known[j] *= inverse_pivot_[block_side * b + j];
    }
    subtract_rows(factor.at(b, first_[b]), known.data(), block_side * b - begin, work + begin);
  }
  for (std::size_t i = 0; i < n; ++i) x[order_[i]] = work[i];
}

}  // namespace atlas::param
