// Internal: turns several indices per corner into one, for formats that allow only one.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/core/first_index.h"

namespace atlas {

// Each distinct tuple of indices is a vertex; vertices are numbered by first use.
template <std::size_t N>
struct UnifiedMesh {
  std::vector<std::array<std::uint32_t, N>> vertices;
  std::vector<std::uint32_t> indices;  // 1 per corner, into `vertices`
};

// Tuples are found in a hash table, not by searching the positions that have the same uv: in a mesh
// whose triangles take their colours from a few texels, a hundred thousand positions have one uv.
// `key_of(k)` returns the tuple of corner k, for k < corners.
template <std::size_t N, class KeyOf>
UnifiedMesh<N> unify_vertices(std::size_t corners, const KeyOf& key_of) {
  UnifiedMesh<N> result;
  FirstIndex first(corners);
  result.indices.reserve(corners);
  for (std::size_t k = 0; k < corners; ++k) {
    const std::array<std::uint32_t, N> key = key_of(k);
    std::uint32_t& vertex =
        first.find(hash_words(key), [&](std::uint32_t v) { return result.vertices[v] == key; });
    if (vertex == kNoIndex) {
      vertex = static_cast<std::uint32_t>(result.vertices.size());
      result.vertices.push_back(key);
    }
    result.indices.push_back(vertex);
  }
  return result;
}

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
