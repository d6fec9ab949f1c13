// Internal: VertexUnifier, which turns several indices per corner into one, for formats that allow
// only one.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atlas {

// Each distinct tuple of indices is a vertex; vertices are numbered by first use.
template <std::size_t N>
struct UnifiedMesh {
  std::vector<std::array<std::uint32_t, N>> vertices;
  std::vector<std::uint32_t> indices;  // 1 per corner, into `vertices`
};

// Tuples are found in a hash table, not by searching the positions that have the same uv: in a mesh
// whose triangles take their colours from a few texels, a hundred thousand positions have one uv.
template <std::size_t N>
class VertexUnifier {
 public:
  using Key = std::array<std::uint32_t, N>;

  // `key_of(k)` returns the tuple of corner k, for k < corners.
  template <class KeyOf>
  UnifiedMesh<N> unify(std::size_t corners, const KeyOf& key_of) {
    UnifiedMesh<N> result;
    table_.assign(std::bit_ceil(2 * corners + 1), kNone);
    result.indices.reserve(corners);
    for (std::size_t k = 0; k < corners; ++k) {
      const Key key = key_of(k);
      std::uint32_t& vertex = find(key, result.vertices);
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(result.vertices.size());
        result.vertices.push_back(key);
      }
      result.indices.push_back(vertex);
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Returns the entry of the table where the tuple's vertex stands, or the free one where it
  // belongs.
  std::uint32_t& find(const Key& key, const std::vector<Key>& vertices) {
    std::uint64_t hash = 0;
    for (const std::uint32_t i : key) hash = (hash ^ i) * 0x9E3779B97F4A7C15u;
    const int shift = 64 - std::countr_zero(table_.size());
    // Fibonacci hashing. At least half of the table stays empty, so searches are short.
    std::size_t at = shift < 64 ? hash >> shift : 0;
    for (;; at = (at + 1) & (table_.size() - 1)) {
      const std::uint32_t v = table_[at];
      if (v == kNone || vertices[v] == key) return table_[at];
    }
  }

  std::vector<std::uint32_t> table_;
};

// Returns the values that index `which` of each vertex refers to.
template <class T, std::size_t N>
std::vector<T> gather(const std::vector<T>& values,
                      const std::vector<std::array<std::uint32_t, N>>& vertices,
                      std::size_t which) {
  std::vector<T> result;
  result.reserve(vertices.size());
  for (const auto& vertex : vertices) result.push_back(values[vertex[which]]);
  return result;
}

}  // namespace atlas
