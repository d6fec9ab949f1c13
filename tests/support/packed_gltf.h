// Makes glTF files whose buffer views meshoptimizer's own encoders have compressed.
#pragma once

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/gltf_maker.h"

namespace atlas::test {

inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kNewerMeshopt = "KHR_meshopt_compression";
using Bytes = std::vector<unsigned char>;

struct PackedRows {
  std::size_t count, stride;
  const char* mode;
  const char* filter = "NONE";
};

// Returns a number in the form of the exponential filter: 8 bits of an exponent above 24 bits of a
// signed mantissa, of which `bits` are used. The library's own function has other parameters in
// each version.
inline float exponential(float value, int bits) {
  int exponent = 0;
  const double part = std::frexp(double(value), &exponent);  // below 1
  const auto mantissa = static_cast<std::int32_t>(std::lround(std::ldexp(part, bits - 1)));
  const auto scale = static_cast<std::uint32_t>(exponent - (bits - 1));
  return std::bit_cast<float>(scale << 24 | (static_cast<std::uint32_t>(mantissa) & 0xffffff));
}

// A glTF file that holds its data only in compressed form, as gltfpack writes them.
struct PackedGltf : Gltf {
  const char* extension;
  explicit PackedGltf(const char* name = kMeshopt) : extension(name) {
    j["extensionsUsed"] = j["extensionsRequired"] = {name, "KHR_mesh_quantization"};
    j["buffers"] =
        json::array({{{"byteLength", 1 << 20}, {"extensions", {{name, {{"fallback", true}}}}}}});
  }
  int packed(const Bytes& compressed, const PackedRows& rows) {
    const int number = view(compressed);
    json& v = j["bufferViews"][std::size_t(number)];
    v["extensions"][extension] = {
        {"buffer", 0},          {"byteOffset", v["byteOffset"]}, {"byteLength", compressed.size()},
        {"count", rows.count},  {"byteStride", rows.stride},     {"mode", rows.mode},
        {"filter", rows.filter}};
    v["buffer"] = 1;
    v["byteOffset"] = 0;
    v["byteLength"] = rows.count * rows.stride;
    return number;
  }
  int packed_vertices(const void* data, const PackedRows& rows) {
    Bytes out(meshopt_encodeVertexBufferBound(rows.count, rows.stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), data, rows.count, rows.stride));
    return packed(out, rows);
  }
  // Adds vectors of three floats, filtered if `bits` is not 0.
  int packed_positions(const std::vector<float>& positions, int bits) {
    const std::size_t count = positions.size() / 3;
    std::vector<float> data = positions;
    for (float& value : data)
      if (bits > 0) value = exponential(value, bits);
    const int v =
        packed_vertices(data.data(), {count, 12, "ATTRIBUTES", bits > 0 ? "EXPONENTIAL" : "NONE"});
    return accessor(
        {{"bufferView", v}, {"componentType", 5126}, {"type", "VEC3"}, {"count", count}});
  }
  int packed_indices(const std::vector<std::uint32_t>& indices, bool as_triangles, int size) {
    const std::size_t count = indices.size();
    Bytes out(std::max(meshopt_encodeIndexBufferBound(count, count),
                       meshopt_encodeIndexSequenceBound(count, count)));
    out.resize(as_triangles
                   ? meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), count)
                   : meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), count));
    const int v = packed(out, {count, std::size_t(size), as_triangles ? "TRIANGLES" : "INDICES"});
    return accessor({{"bufferView", v},
                     {"componentType", size == 2 ? 5123 : 5125},
                     {"type", "SCALAR"},
                     {"count", count}});
  }
};

// A wavy grid of 31 x 31 vertices: more than one block of the codec.
struct Grid {
  static constexpr std::uint32_t side = 31;
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  Grid() {
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        const float fx = float(x), fy = float(y);
        positions.insert(positions.end(), {fx, fy, std::sin(0.7F * fx) * std::cos(0.4F * fy)});
        if (x + 1 == side || y + 1 == side) continue;
        const std::uint32_t a = y * side + x;
        indices.insert(indices.end(), {a, a + 1, a + side + 1, a, a + side + 1, a + side});
      }
    }
  }
};

inline PackedGltf packed_grid(bool as_triangles = true, int size = 2, int bits = 0,
                              const char* extension = kMeshopt) {
  const Grid grid;
  PackedGltf g(extension);
  const int positions = g.packed_positions(grid.positions, bits);
  const int indices = g.packed_indices(grid.indices, as_triangles, size);
  g.single({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return g;
}

}  // namespace atlas::test
