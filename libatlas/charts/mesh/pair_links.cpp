#include "libatlas/charts/mesh/pair_links.h"

#include <algorithm>

#include "libatlas/core/half_edge.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

// An edge at its lower vertex.
struct EdgeEnd {
  std::uint32_t upper, half_edge;
  bool operator==(const EdgeEnd&) const = default;
};

bool comes_before(const EdgeEnd& a, const EdgeEnd& b) {
  return a.upper != b.upper ? a.upper < b.upper : a.half_edge < b.half_edge;
}

void sort_ends(EdgeEnd* begin, EdgeEnd* end) {
  if (end - begin > 12) return sort_total(begin, end, comes_before);
  // Insertion sort: most vertices have three to six entries.
  for (EdgeEnd* i = begin; i < end; ++i) {
    const EdgeEnd moved = *i;
    EdgeEnd* j = i;
    for (; j > begin && comes_before(moved, j[-1]); --j) *j = j[-1];
    *j = moved;
  }
}

struct EdgesByVertex {
  std::vector<std::uint32_t> first;  // one per vertex, and the end
  std::vector<EdgeEnd> ends;         // those whose lower vertex it is
};

EdgesByVertex edges_by_vertex(std::span<const std::uint32_t> corners, std::size_t vertices) {
  EdgesByVertex edges;
  std::vector<std::uint32_t>& first = edges.first;
  first.assign(vertices + 2, 0);
  const auto each = [&](auto&& body) {
    for (std::uint32_t h = 0; h < corners.size(); ++h) {
      const std::uint32_t a = corners[h], b = corners[next_half_edge(h)];
      body(std::min(a, b), std::max(a, b), h);
    }
  };
  each([&](std::uint32_t low, std::uint32_t, std::uint32_t) { ++first[low + 2]; });
  for (std::size_t i = 2; i < first.size(); ++i) first[i] += first[i - 1];
  edges.ends.resize(corners.size());
  each([&](std::uint32_t low, std::uint32_t high, std::uint32_t h) {
    edges.ends[first[low + 1]++] = {high, h};
  });
  first.pop_back();
  return edges;
}

}  // namespace

std::vector<std::uint32_t> pair_links(std::span<const std::uint32_t> corners,
                                      std::size_t vertices) {
  EdgesByVertex edges = edges_by_vertex(corners, vertices);
  std::vector<std::uint32_t> opposite(corners.size(), kNoIndex);
  // Half-edges may lie anywhere in memory. They are prefetched this many ahead.
  constexpr std::size_t ahead = 64;
  std::size_t asked = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    for (; asked < std::min<std::size_t>(edges.ends.size(), edges.first[v + 1] + ahead); ++asked)
      __builtin_prefetch(opposite.data() + edges.ends[asked].half_edge, 1);
    EdgeEnd *const begin = edges.ends.data() + edges.first[v], *const end = edges.ends.data() +
                                                                            edges.first[v + 1];
    sort_ends(begin, end);
    for (EdgeEnd *i = begin, *j = begin; i < end; i = j) {
      while (j < end && j->upper == i->upper) ++j;
      if (j - i != 2 || i[0].half_edge / 3 == i[1].half_edge / 3) continue;
      opposite[i[0].half_edge] = i[1].half_edge;
      opposite[i[1].half_edge] = i[0].half_edge;
    }
  }
  return opposite;
}

}  // namespace atlas
