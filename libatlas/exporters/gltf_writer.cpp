// glTF 2.0 and GLB with unlit materials (KHR_materials_unlit).
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "libatlas/core/file_extension.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/exporters/camera.h"
#include "libatlas/exporters/text_output.h"
#include "libatlas/exporters/world.h"

namespace atlas {
namespace fs = std::filesystem;
using nlohmann::json;
namespace {

constexpr int kFloat = 5126, kUint = 5125, kArrayBuffer = 34962, kElementBuffer = 34963;
constexpr int kLinear = 9729, kLinearMipmapLinear = 9987, kClampToEdge = 33071;

// glTF knows one index a corner: every pair of position and uv that occurs becomes a vertex.
struct UnifiedPage {
  std::vector<std::uint32_t> positions, uvs;  // 1 a vertex
  std::vector<std::uint32_t> indices;
};

// Pairs are found in a hash table and not along the positions of a uv: a mesh whose triangles take
// their colours from a few texels has a hundred thousand positions at one uv.
class Unifier {
 public:
  UnifiedPage unify(const Page& page) {
    UnifiedPage result;
    table_.assign(std::bit_ceil(2 * page.indices.size() + 1), kNone);
    result.indices.reserve(page.indices.size());
    for (std::size_t k = 0; k < page.indices.size(); ++k) {
      std::uint32_t& vertex = find(page.indices[k], page.uv_indices[k], result);
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(result.positions.size());
        result.positions.push_back(page.indices[k]);
        result.uvs.push_back(page.uv_indices[k]);
      }
      result.indices.push_back(vertex);
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Where the pair's vertex stands, or is to stand.
  std::uint32_t& find(std::uint32_t position, std::uint32_t uv, const UnifiedPage& page) {
    const std::uint64_t pair = (std::uint64_t{uv} << 32) | position;
    const int shift = 64 - std::countr_zero(table_.size());
    // Fibonacci hashing; half of the table stays empty, so walks are short.
    std::size_t at = shift < 64 ? (pair * 0x9E3779B97F4A7C15u) >> shift : 0;
    for (;; at = (at + 1) & (table_.size() - 1)) {
      const std::uint32_t v = table_[at];
      if (v == kNone || (page.positions[v] == position && page.uvs[v] == uv)) return table_[at];
    }
  }

  std::vector<std::uint32_t> table_;
};

json array(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

class GltfBuilder {
 public:
  GltfBuilder(const World& world, bool binary) : world_(world), binary_(binary) {
    document_["asset"] = {{"version", "2.0"}, {"generator", "libatlas"}};
    if (!world.title.empty()) document_["asset"]["extras"]["title"] = world.title;
    if (!world.info.empty()) document_["asset"]["extras"]["info"] = world.info;
  }

  Status add_page(std::size_t number, Unifier& unifier, WorldFile& result) {
    const Page& page = world_.pages[number];
    const UnifiedPage unified = unifier.unify(page);
    json primitive;
    primitive["attributes"]["POSITION"] = add_positions(unified);
    primitive["attributes"]["TEXCOORD_0"] = add_uvs(unified);
    primitive["indices"] = add_indices(unified);
    primitive["material"] = document_["materials"].size();
    document_["meshes"].push_back(
        {{"name", fmt::format("page{}", number)}, {"primitives", json::array({primitive})}});
    result.triangles += unified.indices.size() / 3;
    result.vertices += unified.positions.size();
    result.uvs += unified.positions.size();
    return add_material(page, fmt::format("page{}", number));
  }

  // The nodes, once the meshes are known. glTF is y-up and in metres.
  void add_scene() {
    const auto turn = [&](const glm::dvec3& v) { return world_.up == Up::z ? z_up_to_y_up(v) : v; };
    const double scale = world_.metres_per_unit;
    json root = {{"name", "world"}, {"children", json::array()}};
    root["translation"] = array(turn(to_glm(world_.origin)) * scale);
    if (world_.up == Up::z) root["rotation"] = {-std::sqrt(0.5), 0, 0, std::sqrt(0.5)};
    root["scale"] = {scale, scale, scale};
    const Viewpoint& view = world_.viewpoint;
    const glm::dvec3 eye = turn(to_glm(world_.origin) + to_glm(view.position)) * scale;
    json camera = {{"name", "start"}, {"camera", 0}, {"translation", array(eye)}};
    camera["rotation"] = camera_rotation(turn(to_glm(view.direction)));
    // zfar is optional by the standard, but Castle Game Engine insists on it.
    const double far = 4 * farthest() * scale;
    const json lens = {{"yfov", view.fov}, {"znear", std::min(0.02, far * 1e-4)}, {"zfar", far}};
    document_["cameras"] = json::array({{{"type", "perspective"}, {"perspective", lens}}});
    document_["nodes"] = json::array({root, camera});
    for (std::size_t i = 0; i < document_["meshes"].size(); ++i) {
      document_["nodes"][0]["children"].push_back(i + 2);
      document_["nodes"].push_back({{"name", document_["meshes"][i]["name"]}, {"mesh", i}});
    }
    document_["scenes"] = json::array({{{"nodes", {0, 1}}}});
    document_["scene"] = 0;
  }

  // The finished document; `buffer_uri` is empty for GLB.
  std::string text(const std::string& buffer_uri) {
    json buffer = {{"byteLength", bytes_.size()}};
    if (!buffer_uri.empty()) buffer["uri"] = buffer_uri;
    document_["buffers"] = json::array({buffer});
    return document_.dump(binary_ ? -1 : 1, ' ', false, json::error_handler_t::replace);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::size_t add_view(const void* data, std::size_t size, int target) {
    while (bytes_.size() % 4 != 0) bytes_.push_back('\0');
    json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target != 0) view["target"] = target;
    bytes_.append(static_cast<const char*>(data), size);
    document_["bufferViews"].push_back(std::move(view));
    return document_["bufferViews"].size() - 1;
  }

  // From the first viewpoint to a position, in scene units.
  double farthest() const {
    const glm::dvec3 eye = to_glm(world_.viewpoint.position);
    double farthest = 1e-6;
    for (const Vec3f& p : world_.positions) {
      farthest = std::max(farthest, glm::distance(eye, to_dvec(p)));
    }
    return farthest;
  }

  std::size_t add_accessor(json accessor) {
    document_["accessors"].push_back(std::move(accessor));
    return document_["accessors"].size() - 1;
  }

  std::size_t add_positions(const UnifiedPage& page) {
    std::vector<Vec3f> values;
    float low[3], high[3];
    std::fill(low, low + 3, std::numeric_limits<float>::max());
    std::fill(high, high + 3, std::numeric_limits<float>::lowest());
    for (const std::uint32_t p : page.positions) {
      values.push_back(world_.positions[p]);
      const float c[3] = {values.back().x, values.back().y, values.back().z};
      for (int i = 0; i < 3; ++i) {
        low[i] = std::min(low[i], c[i]);
        high[i] = std::max(high[i], c[i]);
      }
    }
    const std::size_t view = add_view(values.data(), values.size() * sizeof(Vec3f), kArrayBuffer);
    return add_accessor({{"bufferView", view},
                         {"componentType", kFloat},
                         {"type", "VEC3"},
                         {"count", values.size()},
                         {"min", {low[0], low[1], low[2]}},
                         {"max", {high[0], high[1], high[2]}}});
  }

  std::size_t add_uvs(const UnifiedPage& page) {
    std::vector<Vec2f> values;
    for (const std::uint32_t t : page.uvs) {
      values.push_back({world_.uvs[t].x, 1 - world_.uvs[t].y});  // glTF's v points down
    }
    const std::size_t view = add_view(values.data(), values.size() * sizeof(Vec2f), kArrayBuffer);
    return add_accessor({{"bufferView", view},
                         {"componentType", kFloat},
                         {"type", "VEC2"},
                         {"count", values.size()}});
  }

  std::size_t add_indices(const UnifiedPage& page) {
    const std::size_t view =
        add_view(page.indices.data(), page.indices.size() * sizeof(std::uint32_t), kElementBuffer);
    return add_accessor({{"bufferView", view},
                         {"componentType", kUint},
                         {"type", "SCALAR"},
                         {"count", page.indices.size()}});
  }

  Status add_material(const Page& page, const std::string& name) {
    json material = {{"name", name}, {"doubleSided", true}};
    material["pbrMetallicRoughness"] = {{"metallicFactor", 0}, {"roughnessFactor", 1}};
    if (!page.image.empty()) {  // else viewers light it: unlit it would be a silhouette
      material["extensions"]["KHR_materials_unlit"] = json::object();
      document_["extensionsUsed"] = {"KHR_materials_unlit"};
      document_["samplers"] = json::array({{{"magFilter", kLinear},
                                            {"minFilter", kLinearMipmapLinear},
                                            {"wrapS", kClampToEdge},
                                            {"wrapT", kClampToEdge}}});
      json image = {{"name", name}};
      if (binary_) {
        auto bytes = read_image_bytes(page);
        if (!bytes.ok()) return bytes.status();
        image["mimeType"] = "image/png";
        image["bufferView"] = add_view(bytes->data(), bytes->size(), 0);
      } else {
        image["uri"] = encode_uri(page.image);
      }
      document_["images"].push_back(std::move(image));
      const std::size_t index = document_["images"].size() - 1;
      document_["textures"].push_back({{"sampler", 0}, {"source", index}});
      material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", index}};
    }
    document_["materials"].push_back(std::move(material));
    return {};
  }

  static Result<std::string> read_image_bytes(const Page& page) {
    std::ifstream stream(page.image_source, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
    if (stream.bad() || bytes.empty()) {
      return Status(ErrorCode::io,
                    fmt::format("the page's image {} cannot be read from '{}' to embed it "
                                "(Page::image_source names where it lies)",
                                page.image, page.image_source.string()));
    }
    return bytes;
  }

  const World& world_;
  bool binary_;
  json document_;
  std::string bytes_;
};

std::string word(std::size_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &bits, 4);
  return bytes;
}

// GLB: a header and two chunks, each padded to 4 bytes.
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

Result<WorldFile> write_gltf(const World& world, const fs::path& path, AtomicFiles& files,
                             const Context& context) {
  if (Status s = check_world(world); !s.ok()) return s;
  const bool binary = lower_extension(path) == ".glb";
  WorldFile result;
  GltfBuilder builder(world, binary);
  Unifier unifier;
  for (std::size_t i = 0; i < world.pages.size(); ++i) {
    if (context.cancelled()) return Status::cancelled();
    if (world.pages[i].indices.empty()) continue;  // glTF forbids empty meshes
    if (Status s = builder.add_page(i, unifier, result); !s.ok()) return s;
    context.report("writing the world", double(i + 1) / double(world.pages.size()));
  }
  if (result.triangles == 0) {
    return Status(ErrorCode::bad_input,
                  path.string() + ": a glTF world needs at least one triangle");
  }
  builder.add_scene();
  if (builder.bytes().size() > 0xf0000000u) {
    return Status(ErrorCode::unsupported,
                  path.string() + ": more than 4 GB of data (use fewer or smaller pages, or .wrl)");
  }
  fs::path buffer_path = path;
  buffer_path.replace_extension(".bin");
  if (!binary) {
    TextFile buffer(files.path_for(buffer_path), buffer_path, false);
    buffer.write(builder.bytes());
    if (Status s = buffer.finish(); !s.ok()) return s;
    result.bytes += buffer.bytes();
  }
  TextFile file(files.path_for(path), path, false);
  if (binary) {
    write_glb(file, builder.text(""), builder.bytes());
  } else {
    file.write(builder.text(encode_uri(buffer_path.filename().string())));
  }
  if (Status s = file.finish(); !s.ok()) return s;
  result.bytes += file.bytes();
  return result;
}

}  // namespace atlas
