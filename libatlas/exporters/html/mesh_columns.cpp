#include "libatlas/exporters/html/mesh_columns.h"

#include <zlib.h>

#include <algorithm>
#include <vector>

namespace atlas {
namespace {

void append_planes(std::span<const std::uint32_t> values, std::string& out) {
  std::uint32_t any = 0;
  for (const std::uint32_t v : values) any |= v;
  int planes = 0;
  while (planes < 4 && (any >> (8 * planes)) != 0) ++planes;
  out += static_cast<char>(planes);
  for (int p = 0; p < planes; ++p)
    for (const std::uint32_t v : values) out += static_cast<char>(v >> (8 * p));
}

}  // namespace

void append_differences(std::span<const std::uint32_t> values, std::string& out) {
  std::vector<std::uint32_t> folded(values.size());
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t d = values[i] - last;
    last = values[i];
    folded[i] = (d << 1) ^ (d >> 31 ? ~0u : 0u);
  }
  append_planes(folded, out);
}

void append_indices(std::span<const std::uint32_t> indices, std::string& out) {
  std::vector<std::uint32_t> distances(indices.size());
  std::uint32_t next = 0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    distances[k] = next - indices[k];
    next = std::max(next, indices[k] + 1);
  }
  append_planes(distances, out);
}

Result<std::string> deflated(std::string_view bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string result(size, '\0');
  constexpr int kLevel = 6;
  if (compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uLong>(bytes.size()),
                kLevel) != Z_OK)
    return Status(ErrorCode::unsupported,
                  "there is no memory to compress the data (export fewer triangles or pages)");
  result.resize(size);
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string result;
  result.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      result += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return result;
}

}  // namespace atlas
