#include "libatlas/exporters/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/viewing/camera.h"
#include "libatlas/exporters/writing/text_output.h"
#include "libatlas/scene/uv_page.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

constexpr int kFloat = 5126, kUint = 5125, kUshort = 5123, kArrayBuffer = 34962,
              kElementBuffer = 34963;

constexpr const char *kMeshopt = "EXT_meshopt_compression",
                     *kQuantization = "KHR_mesh_quantization";

std::string word(std::size_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &bits, 4);
  return bytes;
}

// Writes a GLB file: a header and one or two chunks, each padded to 4 bytes.
void write_glb(TextFile& file, std::string text, const std::string& binary) {
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t padded = (binary.size() + 3) / 4 * 4;
  const bool has_binary = !binary.empty();
  const std::size_t total = 12 + 8 + text.size() + (has_binary ? 8 + padded : 0);
  file.write("glTF" + word(2) + word(total) + word(text.size()) + "JSON" + text);
  if (!has_binary) return;
  file.write(word(padded) + std::string("BIN\0", 4));
  file.write(binary);
  file.write(std::string(padded - binary.size(), '\0'));
}

}  // namespace

GltfDocument::GltfDocument(const World& world, bool binary)
    : binary_(binary), compress_(world.compress_slip.has_value()) {
  json["asset"] = {{"version", "2.0"}, {"generator", "libatlas"}};
  if (!world.title.empty()) json["asset"]["extras"]["title"] = world.title;
  if (!world.info.empty()) json["asset"]["extras"]["info"] = world.info;
}

void GltfDocument::add_info(const std::string& line) {
  json["asset"]["extras"]["info"].push_back(line);
}

void GltfDocument::name_uv_sets(const std::set<std::int64_t>& sets) {
  if (!json["asset"].contains("extras")) return;
  nlohmann::json& info = json["asset"]["extras"]["info"];
  nlohmann::json named = nlohmann::json::array();
  for (const nlohmann::json& line : info) {
    if (!uv_set_of_page(line.get<std::string>()))
      named.push_back(line);
    else
      for (const std::int64_t set : sets) named.push_back(of_uv_set(set, line));
  }
  info = std::move(named);
}

void GltfDocument::name_lightmap(const World& world, std::int64_t uv_set) {
  if (!world.lightmap) return;
  nlohmann::json map = {{"images", world.lightmap->images}, {"texCoord", uv_set}};
  if (!world.lightmap->linear.empty()) map["linear"] = world.lightmap->linear;
  if (world.lightmap->white > 0) map["white"] = world.lightmap->white;
  json["asset"]["extras"]["lightmap"] = std::move(map);
}

void name_lightmap_page(const World& world, std::uint32_t page, nlohmann::json& primitive) {
  if (world.lightmap && !world.lightmap->triangle_page.empty()) set_lightmap_page(page, primitive);
}

void set_lightmap_page(std::int64_t page, nlohmann::json& primitive) {
  nlohmann::json& extras = primitive["extras"];
  if (!extras.is_null() && !extras.is_object()) extras = {{"source", std::move(extras)}};
  extras["lightmap"] = page;
}

std::size_t GltfDocument::add_view(const void* data, std::size_t size, nlohmann::json view) {
  while (bytes_.size() % 4 != 0) bytes_.push_back('\0');
  view["buffer"] = 0;
  view["byteOffset"] = bytes_.size();
  view["byteLength"] = size;
  bytes_.append(static_cast<const char*>(data), size);
  json["bufferViews"].push_back(std::move(view));
  return json["bufferViews"].size() - 1;
}

void GltfDocument::use(const char* extension, bool required) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!required && std::strcmp(list, "extensionsRequired") == 0) continue;
    nlohmann::json& names = json[list];
    if (std::find(names.begin(), names.end(), extension) == names.end()) names.push_back(extension);
  }
}

// The second buffer has no bytes: it is as large as what the packed views become, one after the
// other.
std::size_t GltfDocument::add_packed(const std::string& bytes, nlohmann::json view,
                                     nlohmann::json packing) {
  use(kMeshopt, true);
  while (bytes_.size() % 4 != 0) bytes_.push_back('\0');
  while (unpacked_bytes_ % 4 != 0) ++unpacked_bytes_;
  packing.update({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}});
  view.update({{"buffer", 1}, {"byteOffset", unpacked_bytes_}});
  unpacked_bytes_ += view["byteLength"].get<std::size_t>();
  view["extensions"][kMeshopt] = std::move(packing);
  bytes_.append(bytes);
  json["bufferViews"].push_back(std::move(view));
  return json["bufferViews"].size() - 1;
}

std::size_t GltfDocument::add_vertices(const void* data, std::size_t count, std::size_t stride) {
  nlohmann::json view = {{"target", kArrayBuffer}, {"byteStride", stride}};
  if (!compress_) return add_view(data, count * stride, std::move(view));
  view["byteLength"] = count * stride;
  return add_packed(pack_vertices(data, count, stride), std::move(view),
                    {{"mode", "ATTRIBUTES"}, {"count", count}, {"byteStride", stride}});
}

std::size_t GltfDocument::add_accessor(nlohmann::json accessor) {
  json["accessors"].push_back(std::move(accessor));
  return json["accessors"].size() - 1;
}

std::size_t GltfDocument::add_bounded(std::span<const Vec3f> values, const nlohmann::json& bounds) {
  const std::size_t view = add_vertices(values.data(), values.size(), sizeof(Vec3f));
  nlohmann::json accessor = {
      {"bufferView", view}, {"componentType", kFloat}, {"type", "VEC3"}, {"count", values.size()}};
  accessor.update(bounds);
  return add_accessor(std::move(accessor));
}

std::size_t GltfDocument::add_positions(std::span<const Vec3f> values) {
  float low[3], high[3];
  std::fill(low, low + 3, std::numeric_limits<float>::max());
  std::fill(high, high + 3, std::numeric_limits<float>::lowest());
  for (const Vec3f& p : values) {
    const float c[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], c[i]);
      high[i] = std::max(high[i], c[i]);
    }
  }
  return add_bounded(values,
                     {{"min", {low[0], low[1], low[2]}}, {"max", {high[0], high[1], high[2]}}});
}

std::size_t GltfDocument::add_vectors(std::span<const Vec3f> values) {
  return add_bounded(values, nlohmann::json::object());
}

std::size_t GltfDocument::add_zeros(std::size_t count) {
  const auto zero = nlohmann::json::array({0, 0, 0});
  return add_accessor({{"componentType", kFloat},
                       {"type", "VEC3"},
                       {"count", count},
                       {"min", zero},
                       {"max", zero}});
}

std::size_t GltfDocument::add_colours(std::span<const Vec3f> colours,
                                      std::span<const float> alphas) {
  std::vector<float> rgba;
  rgba.reserve(4 * colours.size());
  for (std::size_t i = 0; i < colours.size(); ++i)
    rgba.insert(rgba.end(), {colours[i].x, colours[i].y, colours[i].z, alphas[i]});
  const std::size_t view = add_vertices(rgba.data(), colours.size(), 4 * sizeof(float));
  return add_accessor({{"bufferView", view},
                       {"componentType", kFloat},
                       {"type", "VEC4"},
                       {"count", colours.size()}});
}

std::size_t GltfDocument::add_uvs(std::vector<Vec2f> values) {
  for (Vec2f& uv : values) uv.y = 1 - uv.y;
  const std::size_t view = add_vertices(values.data(), values.size(), sizeof(Vec2f));
  return add_accessor({{"bufferView", view},
                       {"componentType", kFloat},
                       {"type", "VEC2"},
                       {"count", values.size()}});
}

std::size_t GltfDocument::add_positions(std::span<const Vec3f> values, const PositionGrid& grid) {
  use(kQuantization, true);
  std::vector<std::array<std::uint16_t, 4>> rows;
  std::array<std::uint16_t, 3> low{65535, 65535, 65535}, high{};
  for (const Vec3f& p : values) {
    rows.push_back(grid.at(p));
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], rows.back()[k]);
      high[k] = std::max(high[k], rows.back()[k]);
    }
  }
  const std::size_t view = add_vertices(rows.data(), rows.size(), sizeof rows[0]);
  return add_accessor({{"bufferView", view},
                       {"componentType", kUshort},
                       {"type", "VEC3"},
                       {"count", rows.size()},
                       {"min", low},
                       {"max", high}});
}

std::size_t GltfDocument::add_short_uvs(std::span<const Vec2f> values) {
  use(kQuantization, true);
  std::vector<std::array<std::uint16_t, 2>> rows;
  for (const Vec2f& uv : values)
    rows.push_back({static_cast<std::uint16_t>(std::lround(65535.0 * double(uv.x))),
                    static_cast<std::uint16_t>(std::lround(65535.0 * (1 - double(uv.y))))});
  const std::size_t view = add_vertices(rows.data(), rows.size(), sizeof rows[0]);
  return add_accessor({{"bufferView", view},
                       {"componentType", kUshort},
                       {"normalized", true},
                       {"type", "VEC2"},
                       {"count", rows.size()}});
}

std::size_t GltfDocument::add_indices(std::span<const std::uint32_t> values) {
  // 65535 is no vertex: in 16 bits it divides strips (primitive restart).
  constexpr std::uint32_t kLeastLong = 65535;
  const bool is_short = std::all_of(values.begin(), values.end(),
                                    [](std::uint32_t value) { return value < kLeastLong; });
  const std::vector<std::uint16_t> shorts =
      is_short ? std::vector<std::uint16_t>(values.begin(), values.end())
               : std::vector<std::uint16_t>();
  const std::size_t size = is_short ? sizeof(std::uint16_t) : sizeof(std::uint32_t);
  nlohmann::json target = {{"target", kElementBuffer}};
  if (compress_) target["byteLength"] = values.size() * size;
  const std::size_t view =
      compress_
          ? add_packed(pack_triangles(values), target,
                       {{"mode", "TRIANGLES"}, {"count", values.size()}, {"byteStride", size}})
      : is_short ? add_view(shorts.data(), shorts.size() * sizeof(std::uint16_t), target)
                 : add_view(values.data(), values.size_bytes(), target);
  return add_accessor({{"bufferView", view},
                       {"componentType", is_short ? kUshort : kUint},
                       {"type", "SCALAR"},
                       {"count", values.size()}});
}

nlohmann::json GltfDocument::embedded_image(std::span<const char> bytes, const char* mime_type) {
  return {{"mimeType", mime_type},
          {"bufferView", add_view(bytes.data(), bytes.size(), nlohmann::json::object())}};
}

nlohmann::json GltfDocument::image_beside(const std::string& file_name) {
  return {{"uri", encode_uri(file_name)}};
}

// Returns the document as text. `buffer_uri` is empty for GLB.
std::string GltfDocument::text(const std::string& buffer_uri) {
  nlohmann::json buffer = {{"byteLength", bytes_.size()}};
  if (!buffer_uri.empty()) buffer["uri"] = buffer_uri;
  json["buffers"] = nlohmann::json::array({buffer});
  if (unpacked_bytes_ > 0) {
    nlohmann::json unpacked = {{"byteLength", unpacked_bytes_}};
    unpacked["extensions"][kMeshopt]["fallback"] = true;
    json["buffers"].push_back(std::move(unpacked));
  }
  return json.dump(binary_ ? -1 : 1, ' ', false, nlohmann::json::error_handler_t::replace);
}

Status GltfDocument::write(const fs::path& path, AtomicFiles& files, WorldFile& result) {
  fs::path buffer_path = path;
  buffer_path.replace_extension(".bin");
  std::string document = text(binary_ ? "" : encode_uri(buffer_path.filename().string()));
  if (bytes_.size() + document.size() > 0xf0000000u) {  // a .glb counts its bytes in 32 bits
    return {
        ErrorCode::unsupported,
        path.string() + ": more than 4 GB of data (use fewer or smaller pages, or another format)"};
  }
  if (!binary_) {
    TextFile buffer(files.path_for(buffer_path), buffer_path, false);
    buffer.write(bytes_);
    if (Status s = buffer.finish(); !s.ok()) return s;
    result.bytes += buffer.bytes();
  }
  TextFile file(files.path_for(path), path, false);
  if (binary_) {
    write_glb(file, std::move(document), bytes_);
  } else {
    file.write(document);
  }
  if (Status s = file.finish(); !s.ok()) return s;
  result.bytes += file.bytes();
  return {};
}

// glTF is y-up and in metres.
nlohmann::json gltf_position(const World& world, const Vec3d& position) {
  const glm::dvec3 p = to_glm(position);
  const glm::dvec3 moved = (world.up == Up::z ? z_up_to_y_up(p) : p) * world.metres_per_unit;
  return {moved.x, moved.y, moved.z};
}

nlohmann::json gltf_root(const World& world, const Vec3d& origin) {
  const double scale = world.metres_per_unit;
  nlohmann::json root = {{"name", "world"}, {"children", nlohmann::json::array()}};
  root["translation"] = gltf_position(world, origin);
  if (world.up == Up::z) root["rotation"] = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
  root["scale"] = {scale, scale, scale};
  return root;
}

nlohmann::json gltf_far_origin(const World& world, nlohmann::json children) {
  return {{"name", kFarOriginNode},
          {"translation", gltf_position(world, world.origin)},
          {"children", std::move(children)}};
}

}  // namespace atlas
