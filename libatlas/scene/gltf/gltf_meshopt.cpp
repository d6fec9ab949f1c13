#include "libatlas/scene/gltf/gltf_meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "libatlas/scene/gltf/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// The codec for vertices spends at least two bits on sixteen bytes, and those for indices more. A
// view that promises more than this multiple of its compressed bytes is damaged, and no memory is
// allocated for it.
constexpr std::size_t kMostViewExpansion = 64;

// What the extension says about a view.
struct Packed {
  std::span<const unsigned char> bytes;
  std::size_t count = 0, stride = 0;
  std::string mode, filter;
};

// Returns a number that must be a whole one from 0 on, or `absent` without one; -1 if it is not.
double whole(const tinygltf::Value& object, const char* key, double absent) {
  if (!object.Has(key)) return absent;
  const tinygltf::Value& value = object.Get(key);
  const double number = value.IsNumber() ? value.GetNumberAsDouble() : -1;
  return number >= 0 && number < 0x1p53 && number == std::floor(number) ? number : -1;
}

std::string word(const tinygltf::Value& object, const char* key) {
  const bool given = object.Has(key) && object.Get(key).IsString();
  return given ? object.Get(key).Get<std::string>() : std::string();
}

// Returns what is wrong with a view's description, or nothing.
std::string read_description(const tinygltf::Model& model, const tinygltf::Value& extension,
                             Packed& packed) {
  const double buffer = whole(extension, "buffer", -1);
  const double offset = whole(extension, "byteOffset", 0);
  const double length = whole(extension, "byteLength", -1);
  const double count = whole(extension, "count", -1), stride = whole(extension, "byteStride", -1);
  if (!(buffer >= 0 && buffer < double(model.buffers.size())))
    return "names a buffer that does not exist";
  const auto& data = model.buffers[static_cast<std::size_t>(buffer)].data;
  if (!(offset >= 0 && length >= 1 && offset + length <= double(data.size())))
    return "leaves its buffer";
  if (!(count >= 1 && stride >= 1)) return "has no count or no byteStride";
  if (!(count * stride <= double(kMostViewExpansion) * length))
    return "is too short for what it should hold";
  packed.bytes =
      std::span(data).subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  packed.count = static_cast<std::size_t>(count);
  packed.stride = static_cast<std::size_t>(stride);
  packed.mode = word(extension, "mode");
  packed.filter = word(extension, "filter");
  return {};
}

// Colours of N bits, (1 << K) - 1 of which are 1: luma, two differences and an alpha of K - 1 bits,
// whose highest bit, the K-th, tells K. The transform is YCoCg without its lifting (appendix B of
// KHR_meshopt_compression).
template <class Signed, class Unsigned>
void unfilter_colors(std::size_t count, unsigned char* data) {
  for (std::size_t i = 0; i < count; ++i, data += 4 * sizeof(Unsigned)) {
    Signed in[4];
    Unsigned out[4];
    std::memcpy(in, data, sizeof in);
    const int y = static_cast<Unsigned>(in[0]), co = in[1], cg = in[2];
    const auto tagged = static_cast<Unsigned>(in[3]);
    const int one = (1 << std::bit_width(tagged)) - 1, alpha = tagged & (one >> 1);
    const int wanted[4] = {y + co - cg, y + cg, y - co - cg, alpha << 1 | (alpha & 1)};
    constexpr double kMost = std::numeric_limits<Unsigned>::max();
    for (int c = 0; c < 4; ++c)  // damaged data are beyond the range, and have no alpha
      out[c] = static_cast<Unsigned>(
          std::clamp(std::round(wanted[c] * kMost / std::max(one, 1)), 0.0, kMost));
    std::memcpy(data, out, sizeof out);
  }
}

// Undoes a filter of vertex data. Returns false if it is unknown, or does not fit the stride.
bool unfilter(const Packed& packed, unsigned char* data) {
  const std::size_t count = packed.count, stride = packed.stride;
  if (packed.filter.empty() || packed.filter == "NONE") return true;
  if (packed.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) {
    meshopt_decodeFilterOct(data, count, stride);
  } else if (packed.filter == "QUATERNION" && stride == 8) {
    meshopt_decodeFilterQuat(data, count, stride);
  } else if (packed.filter == "EXPONENTIAL" && stride % 4 == 0) {
    meshopt_decodeFilterExp(data, count, stride);
  } else if (packed.filter == "COLOR" && stride == 4) {
    unfilter_colors<std::int8_t, std::uint8_t>(count, data);
  } else if (packed.filter == "COLOR" && stride == 8) {
    unfilter_colors<std::int16_t, std::uint16_t>(count, data);
  } else {
    return false;
  }
  return true;
}

// Returns whether the bytes say that they are vertices of a codec newer than the first, which old
// versions of the library do not know.
bool newer_codec(const Packed& packed) {
  constexpr unsigned char kVertices = 0xa0;
  return packed.mode == "ATTRIBUTES" && packed.bytes[0] > kVertices &&
         packed.bytes[0] < kVertices + 16;
}

// Returns what is wrong, or nothing.
std::string decode(const Packed& packed, std::vector<unsigned char>& out) {
  const auto& [bytes, count, stride, mode, filter] = packed;
  const bool vertices = mode == "ATTRIBUTES", triangles = mode == "TRIANGLES";
  if (!vertices && !triangles && mode != "INDICES") return "is of an unknown mode";
  const bool fits = vertices ? stride % 4 == 0 && stride <= 256 : stride == 2 || stride == 4;
  if (!fits || (triangles && count % 3 != 0))
    return fmt::format("has a count or byteStride that {} cannot have", mode);
  out.resize(count * stride);
  using Decoder = int(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
  Decoder* run = meshopt_decodeIndexSequence;
  if (triangles) run = meshopt_decodeIndexBuffer;
  if (vertices) run = meshopt_decodeVertexBuffer;
  if (run(out.data(), count, stride, bytes.data(), bytes.size()) != 0)
    return "cannot be decompressed";
  if (vertices ? !unfilter(packed, out.data()) : !(filter.empty() || filter == "NONE"))
    return fmt::format("has a filter, {}, that it cannot have", filter);
  return {};
}

// Decodes if no more than `left` bytes come of it, which are taken from these. Views that name the
// same bytes again and again would fill any memory without a limit of the sum.
std::string decode_within(std::size_t& left, const Packed& packed,
                          std::vector<unsigned char>& out) {
  const std::size_t wanted = packed.count * packed.stride;
  if (wanted > left)
    return "decodes to more than a file of this size can hold (name the same data less often)";
  left -= wanted;
  return decode(packed, out);
}

// Returns whether a buffer or a view in the JSON has one of the extensions.
bool has_extension(const json& element) {
  return std::any_of(std::begin(kGltfMeshopt), std::end(kGltfMeshopt), [&](const char* name) {
    const json* extension = extension_at(element, name);
    return extension && extension->is_object();
  });
}

// Returns the numbers of the buffers that compressed views name.
std::set<std::int64_t> buffers_of_packed_views(const json& document) {
  std::set<std::int64_t> buffers;
  const auto views = document.find("bufferViews");
  if (views == document.end()) return buffers;
  for (const json& view : *views)
    if (has_extension(view)) buffers.insert(integer_at(view, "buffer", -1));
  return buffers;
}

Status too_new(const fs::path& path, std::size_t view, const char* name) {
  return {
      ErrorCode::unsupported,
      fmt::format("{}: buffer view {} ({}) is of a codec that this build's meshoptimizer cannot "
                  "decode (compress the file by EXT_meshopt_compression, or not at all)",
                  path.string(), view, name)};
}

}  // namespace

std::set<int> fill_fallback_buffers(json& document, bool container) {
  std::set<int> fallbacks;
  const std::set<std::int64_t> packed = buffers_of_packed_views(document);
  const auto buffers = document.find("buffers");
  for (std::size_t i = 0; buffers != document.end() && i < buffers->size(); ++i) {
    json& buffer = (*buffers)[i];
    const bool in_container = container && i == 0 && !has_extension(buffer);
    if (buffer.contains("uri") || in_container || !packed.contains(std::int64_t(i))) continue;
    buffer["byteLength"] = 1;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    fallbacks.insert(static_cast<int>(i));
  }
  return fallbacks;
}

Status decode_meshopt_views(const fs::path& path, const std::set<int>& fallbacks,
                            tinygltf::Model& model) {
  std::vector<tinygltf::Buffer> decoded;
  const std::size_t first = model.buffers.size();
  std::size_t left = kMostViewExpansion * gltf_buffer_bytes(model);
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = model.bufferViews[i];
    if (!fallbacks.contains(view.buffer)) continue;
    for (const char* name : kGltfMeshopt) {
      const auto extension = view.extensions.find(name);
      if (extension == view.extensions.end()) continue;
      Packed packed;
      tinygltf::Buffer buffer;
      std::string wrong = read_description(model, extension->second, packed);
      const bool described = wrong.empty();
      if (described) wrong = decode_within(left, packed, buffer.data);
      if (!wrong.empty() && described && newer_codec(packed)) return too_new(path, i, name);
      if (!wrong.empty())
        return malformed_gltf(path, fmt::format("buffer view {} ({}) {}", i, name, wrong));
      view.buffer = static_cast<int>(first + decoded.size());
      view.byteOffset = 0;
      view.byteLength = buffer.data.size();
      decoded.push_back(std::move(buffer));
      break;
    }
  }
  for (tinygltf::Buffer& buffer : decoded) model.buffers.push_back(std::move(buffer));
  return {};
}

}  // namespace atlas
