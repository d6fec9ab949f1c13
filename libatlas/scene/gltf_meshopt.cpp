#include "libatlas/scene/gltf_meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <cmath>
#include <string>
#include <utility>

#include "libatlas/scene/gltf_check.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// The codec for vertices spends at least two bits on sixteen bytes, and those for indices more. A
// view that promises more than this multiple of its compressed bytes is damaged, and no memory is
// allocated for it.
constexpr std::size_t kMostExpansion = 64;

// What the extension says about a view.
struct Packed {
  std::span<const unsigned char> bytes;
  std::size_t count = 0, stride = 0;
  std::string mode, filter;
};

bool is_fallback(const tinygltf::Buffer& buffer) {
  const auto extension = buffer.extensions.find(kGltfMeshopt);
  if (extension == buffer.extensions.end() || !extension->second.Has("fallback")) return false;
  const tinygltf::Value& fallback = extension->second.Get("fallback");
  return fallback.IsBool() && fallback.Get<bool>();
}

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
  if (!(count * stride <= double(kMostExpansion) * length))
    return "is too short for what it should hold";
  packed.bytes =
      std::span(data).subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
  packed.count = static_cast<std::size_t>(count);
  packed.stride = static_cast<std::size_t>(stride);
  packed.mode = word(extension, "mode");
  packed.filter = word(extension, "filter");
  return {};
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
  } else {
    return false;
  }
  return true;
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

}  // namespace

bool fill_fallback_buffers(json& document) {
  bool any = false;
  const auto buffers = document.find("buffers");
  if (buffers == document.end()) return false;
  for (json& buffer : *buffers) {
    const auto extensions = buffer.find("extensions");
    if (buffer.contains("uri") || extensions == buffer.end() || !extensions->is_object()) continue;
    const auto meshopt = extensions->find(kGltfMeshopt);
    if (meshopt == extensions->end() || !meshopt->is_object()) continue;
    if (meshopt->value("fallback", json()) != true) continue;
    buffer["byteLength"] = 1;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    any = true;
  }
  return any;
}

Status decode_meshopt_views(const fs::path& path, tinygltf::Model& model) {
  std::vector<tinygltf::Buffer> decoded;
  const std::size_t first = model.buffers.size();
  for (std::size_t i = 0; i < model.bufferViews.size(); ++i) {
    tinygltf::BufferView& view = model.bufferViews[i];
    const auto extension = view.extensions.find(kGltfMeshopt);
    if (extension == view.extensions.end() || view.buffer < 0 ||
        std::size_t(view.buffer) >= first || !is_fallback(model.buffers[view.buffer])) {
      continue;
    }
    Packed packed;
    tinygltf::Buffer buffer;
    std::string wrong = read_description(model, extension->second, packed);
    if (wrong.empty()) wrong = decode(packed, buffer.data);
    if (!wrong.empty())
      return malformed_gltf(path, fmt::format("buffer view {} ({}) {}", i, kGltfMeshopt, wrong));
    view.buffer = static_cast<int>(first + decoded.size());
    view.byteOffset = 0;
    view.byteLength = buffer.data.size();
    decoded.push_back(std::move(buffer));
  }
  for (tinygltf::Buffer& buffer : decoded) model.buffers.push_back(std::move(buffer));
  return {};
}

}  // namespace atlas
