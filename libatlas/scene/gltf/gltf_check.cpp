#include "libatlas/scene/gltf/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "libatlas/scene/files/utf8.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

// Extensions that are read, or that do not change the shapes of a scene.
constexpr std::string_view kUnderstood[] = {"KHR_mesh_quantization",
                                            "KHR_texture_transform",
                                            "KHR_lights_punctual",
                                            "KHR_technique_webgl",
                                            "KHR_techniques_webgl",
                                            "EXT_mesh_gpu_instancing",
                                            "EXT_texture_webp",
                                            "EXT_meshopt_compression",
                                            "KHR_node_visibility",
                                            "KHR_meshopt_compression",
                                            "KHR_draco_mesh_compression",
                                            "KHR_animation_pointer",
                                            "KHR_xmp_json_ld",
                                            "KHR_node_selectability",
                                            "KHR_node_hoverability",
                                            "EXT_mesh_features",
                                            "EXT_instance_features",
                                            "EXT_structural_metadata",
                                            "EXT_lights_image_based",
                                            "EXT_lights_ies"};
// Extensions that only say in which format the images of textures are.
constexpr std::string_view kTextures[] = {"KHR_texture_basisu", "KHR_texture_ktx",
                                          "EXT_texture_avif", "MSFT_texture_dds"};
constexpr std::string_view kMaterials = "KHR_materials_";  // the diffuse part of these is read

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + at, 4);
  return word;
}

Status old_version(const fs::path& path, const std::string& version) {
  return {ErrorCode::unsupported,
          fmt::format("{}: glTF version {}; only 2.0 is read (convert it to glTF 2.0)",
                      path.string(), version)};
}

// Code that copies or takes apart JSON recurses once for each level, so a file of nothing but
// brackets would overflow the stack.
bool nested_too_deeply(std::string_view text) {
  constexpr int kMost = 1000;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c == '\\') ++i;
      if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '[' || c == '{') {
      if (++depth > kMost) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

// Finds the chunks of a GLB container and checks that all lie inside the file (tinygltf's own check
// of the binary chunk forgets the chunk's header). The JSON comes first. The binary chunk may be
// missing, be empty, lack its padding, or follow chunks of other kinds.
Result<GltfParts> glb_parts(const fs::path& path, std::string_view bytes) {
  constexpr std::uint32_t kBinary = 0x004e4942;
  if (bytes.size() < 20) return malformed_gltf(path, "too short for a GLB file");
  if (word_at(bytes, 4) != 2) return old_version(path, fmt::format("{}", word_at(bytes, 4)));
  const std::size_t length = word_at(bytes, 8), text = word_at(bytes, 12);
  if (length > bytes.size()) {
    return malformed_gltf(
        path, fmt::format("cut short: it announces {} bytes and has {}", length, bytes.size()));
  }
  if (20 + text > length) return malformed_gltf(path, "its JSON chunk is longer than the file");
  GltfParts parts;
  parts.container = true;
  parts.json = bytes.substr(20, text);
  const std::size_t first = 20 + text;
  for (std::size_t at = first; at + 8 <= length && parts.binary.empty();) {
    const std::size_t size = word_at(bytes, at);
    if (size > length - at - 8) {
      return malformed_gltf(path, "its binary chunk is longer than the file");
    }
    if (word_at(bytes, at + 4) == kBinary) parts.binary = bytes.substr(at + 8, size);
    at += 8 + (size + 3) / 4 * 4;
  }
  const bool follows =
      parts.binary.empty() ? first == length : parts.binary.data() == bytes.data() + first + 8;
  parts.plain = follows && text % 4 == 0 && parts.binary.size() % 4 == 0;
  return parts;
}

Status check_version(const fs::path& path, const json& file) {
  const auto asset = file.find("asset");
  const bool given = asset != file.end() && asset->is_object() && asset->contains("version");
  // Drafts of version 1 did not state it. They name their elements, whereas version 2 numbers them.
  if (!given) {
    const auto meshes = file.find("meshes");
    const bool named = meshes != file.end() && meshes->is_object();
    return named ? old_version(path, "1") : Status();
  }
  const json& version = (*asset)["version"];
  const std::string text =
      version.is_string() && version != "" ? version.get<std::string>() : version.dump();
  return text.starts_with("2") ? Status() : old_version(path, text.substr(0, 20));
}

// Replaces bytes that are not UTF-8. No parser takes them, and browsers replace them as well.
// Outside of strings a '?' is as wrong as they are.
void replace_bad_bytes(const fs::path& path, FileBytes& bytes, std::string_view text,
                       DefectReport& defects) {
  char* at = bytes.data.get() + (text.data() - bytes.begin());
  for (char* const end = at + text.size(); at != end;) {
    const std::size_t length = utf8_length(at, end);
    if (length == 0) {
      *at = '?';
      defects.add(DefectKind::text_not_utf8,
                  [&] { return fmt::format("{}: byte {}", path.string(), at - bytes.begin()); });
    }
    at += std::max<std::size_t>(length, 1);
  }
}

template <std::size_t count>
bool is_one_of(const std::string_view (&names)[count], std::string_view name) {
  return std::find(std::begin(names), std::end(names), name) != std::end(names);
}

Status check_extensions(const fs::path& path, const json& file, bool textures) {
  const auto required = file.find("extensionsRequired");
  if (required == file.end() || !required->is_array()) return {};
  for (const auto& name : *required) {
    const std::string extension = name.is_string() ? name.get<std::string>() : name.dump();
    const bool of_texture = is_one_of(kTextures, extension);
    if (extension.starts_with(kMaterials) || is_one_of(kUnderstood, extension) ||
        (of_texture && !textures)) {
      continue;
    }
    return {
        ErrorCode::unsupported,
        fmt::format("{}: needs the extension {}, which is not supported (export without it{})",
                    path.string(), extension, of_texture ? ", or read it without textures" : "")};
  }
  return {};
}

// tinygltf treats anything that is not a list as an empty list.
Status check_lists(const fs::path& path, const json& file) {
  for (const char* name : {"accessors", "buffers", "bufferViews", "images", "materials", "meshes",
                           "nodes", "scenes", "skins", "textures"}) {
    const auto list = file.find(name);
    if (list == file.end()) continue;
    if (!list->is_array()) return malformed_gltf(path, fmt::format("'{}' is not a list", name));
    for (std::size_t i = 0; i < list->size(); ++i) {
      if (!(*list)[i].is_object()) {
        return malformed_gltf(path, fmt::format("element {} of '{}' is not an object", i, name));
      }
    }
  }
  const auto buffers = file.find("buffers");
  for (std::size_t i = 0; buffers != file.end() && i < buffers->size(); ++i) {
    const auto length = (*buffers)[i].find("byteLength");
    if (length == (*buffers)[i].end() || !length->is_number() || length->get<double>() < 1) {
      return malformed_gltf(path, fmt::format("buffer {} has no byteLength", i));
    }
  }
  const auto meshes = file.find("meshes");
  for (std::size_t i = 0; meshes != file.end() && i < meshes->size(); ++i) {
    const auto primitives = (*meshes)[i].find("primitives");
    if (primitives != (*meshes)[i].end() && !primitives->is_array()) {
      return malformed_gltf(path, fmt::format("'primitives' of mesh {} is not a list", i));
    }
  }
  return {};
}

// tinygltf takes the address of an embedded image's first byte without checking the ranges.
bool image_views_fit(const json& file) {
  const auto element = [&](const char* array, std::int64_t i) -> const json* {
    const auto at = file.find(array);
    return at == file.end() || i < 0 || std::size_t(i) >= at->size() ? nullptr : &(*at)[i];
  };
  const auto images = file.find("images");
  if (images == file.end()) return true;
  for (const auto& image : *images) {
    if (!image.contains("bufferView")) continue;
    const json* view = element("bufferViews", integer_at(image, "bufferView", -1));
    const json* buffer = view ? element("buffers", integer_at(*view, "buffer", -1)) : nullptr;
    if (!buffer) return false;
    const std::int64_t offset = integer_at(*view, "byteOffset", 0);
    const std::int64_t length = integer_at(*view, "byteLength", -1);
    if (offset < 0 || length < 1 || length > integer_at(*buffer, "byteLength", -1) - offset)
      return false;
  }
  return true;
}

}  // namespace

std::int64_t integer_at(const json& object, const char* key, std::int64_t absent) {
  const auto at = object.find(key);
  return at != object.end() && at->is_number_integer() ? at->get<std::int64_t>() : absent;
}

std::size_t length_at(const json& object, const char* key) {
  const auto at = object.find(key);
  return at == object.end() ? 0 : at->size();
}

const json* extension_at(const json& element, const char* name) {
  return member_at(member_at(&element, "extensions"), name);
}

bool retype_data_images(json& document) {
  constexpr std::string_view kData = "data:", kEnd = ";base64,",
                             kDecoded[] = {"image/png", "image/jpeg"};
  const auto images = document.find("images");
  bool any = false;
  for (std::size_t i = 0; images != document.end() && i < images->size(); ++i) {
    json& image = (*images)[i];
    const auto found = image.find("uri");
    if (found == image.end() || !found->is_string()) continue;
    std::string& uri = found->get_ref<std::string&>();
    const std::size_t comma = uri.starts_with(kData) ? uri.find(',') : std::string::npos;
    if (comma == std::string::npos) continue;
    const std::string_view head = std::string_view(uri).substr(0, comma + 1);
    if (!head.ends_with(kEnd)) continue;
    const std::string type(head.substr(kData.size(), head.find(';') - kData.size()));
    if (is_one_of(kDecoded, type) && head.size() == kData.size() + type.size() + kEnd.size())
      continue;
    uri.replace(0, head.size(), "data:application/octet-stream;base64,");
    if (!type.empty() && !image.contains("mimeType")) image["mimeType"] = type;
    any = true;
  }
  return any;
}

Status malformed_gltf(const fs::path& path, const std::string& what) {
  return {ErrorCode::bad_input,
          fmt::format("{}: {} (check it with a glTF validator)", path.string(), what)};
}

Result<GltfParts> check_gltf(const fs::path& path, FileBytes& bytes, bool textures,
                             DefectReport& defects) {
  Result<GltfParts> parts = GltfParts{bytes.text(), {}, {}, {}, false, true};
  if (bytes.text().starts_with("glTF")) parts = glb_parts(path, bytes.text());
  if (!parts.ok()) return parts;
  replace_bad_bytes(path, bytes, parts->json, defects);
  const std::string_view text = parts->json;
  if (nested_too_deeply(text)) return malformed_gltf(path, "its JSON is nested too deeply");
  json file;
  try {
    file = json::parse(text);
  } catch (const json::parse_error& error) {
    const auto line =
        1 + std::count(text.begin(), text.begin() + std::min(error.byte, text.size()), '\n');
    return Status(ErrorCode::bad_input, fmt::format("{}:{}: not valid JSON (export the file again)",
                                                    path.string(), line));
  } catch (const json::out_of_range&) {
    return malformed_gltf(path, "its JSON holds a number beyond all bounds");
  }
  if (!file.is_object()) return malformed_gltf(path, "its JSON is not an object");
  if (Status s = check_version(path, file); !s.ok()) return s;
  if (Status s = check_extensions(path, file, textures); !s.ok()) return s;
  if (Status s = check_lists(path, file); !s.ok()) return s;
  if (!image_views_fit(file)) return malformed_gltf(path, "an embedded image leaves its buffer");
  for (const auto& buffer : file.value("buffers", json::array())) {
    const auto uri = buffer.find("uri");
    if (uri == buffer.end() || !uri->is_string()) continue;
    if (uri->get_ref<const std::string&>().starts_with("data:")) continue;
    parts->external_bytes.push_back(buffer["byteLength"].get<double>());
  }
  parts->document = std::move(file);
  return parts;
}

}  // namespace atlas
