#include <fstream>  // tiny_gltf.h does not include it if TINYGLTF_NO_FS is set
#define TINYGLTF_IMPLEMENTATION
#include "libatlas/scene/gltf/gltf_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <set>

#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/gltf/gltf_check.h"
#include "libatlas/scene/gltf/gltf_draco.h"
#include "libatlas/scene/gltf/gltf_lightmap.h"
#include "libatlas/scene/gltf/gltf_meshopt.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// What tinygltf passes to the file callbacks.
struct Folder {
  fs::path path;
  const GltfLoading& loading;
  const std::vector<double>& bytes;  // of each buffer in a file, in their order
  Status status;                     // error of the first one that could not be read
  std::size_t read = 0;
  bool refused = false;  // one may not be read
};

// Returns the folder under which tinygltf looks for buffers.
std::string base_of(const Folder& folder) {
  return folder.path.empty() ? "." : folder.path.string();
}

// Returns the file of a buffer. tinygltf puts the folder before all names, also absolute ones.
fs::path buffer_file(const Folder& folder, const std::string& name) {
  const std::string base = base_of(folder);
  const std::size_t begin = base.size() + !base.ends_with('/');
  if (!name.starts_with(base) || name.size() <= begin) return name;
  return base / fs::path(name.substr(begin));
}

// Keeps embedded images encoded. tinygltf has already decoded data URIs into `bytes`.
bool keep_image(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  return true;
}

bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string& name,
                 void* user) {
  auto& folder = *static_cast<Folder*>(user);
  const fs::path file = buffer_file(folder, name);
  folder.refused |= !folder.loading.may_read(file);
  if (folder.refused) return false;
  auto bytes = read_file_bytes(file);
  if (!bytes.ok()) {
    if (folder.status.ok()) folder.status = bytes.status();
    return false;
  }
  out->assign(bytes->begin(), bytes->end());
  // A file may be longer than its buffer, but tinygltf requires equal lengths.
  const std::size_t index = folder.read++;
  if (index < folder.bytes.size() && folder.bytes[index] < double(out->size())) {
    out->resize(static_cast<std::size_t>(folder.bytes[index]));
  }
  folder.loading.buffers.push_back(file);
  return true;
}

// Answers yes for the first candidate, which lies in the scene's folder, so that a missing buffer
// is reported by read_buffer with its name and never picked up from the working directory.
bool always_exists(const std::string&, void*) {
  return true;
}
std::string same_path(const std::string& name, void*) {
  return name;
}
bool never_write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

// Newer versions of tinygltf also ask for a file's size, to refuse large files. Here read_buffer
// decides.
[[maybe_unused]] bool any_size(std::size_t* size, std::string*, const std::string&, void*) {
  *size = 0;
  return true;
}

template <class Callbacks>
Callbacks file_access(Folder& folder) {
  Callbacks access{};
  access.FileExists = always_exists;
  access.ExpandFilePath = same_path;
  access.ReadWholeFile = read_buffer;
  access.WriteWholeFile = never_write;
  if constexpr (requires { access.GetFileSizeInBytes; }) access.GetFileSizeInBytes = any_size;
  access.user_data = &folder;
  return access;
}

// Returns the same file with its chunks padded as the format requires, and without an empty binary
// chunk.
std::string plain_glb(const GltfParts& parts) {
  const auto padded = [](std::string_view bytes, char with) {
    std::string result(bytes);
    result.resize((result.size() + 3) / 4 * 4, with);
    return result;
  };
  const auto chunk = [](const std::string& bytes, const char* kind) {
    const auto size = static_cast<std::uint32_t>(bytes.size());
    std::string result(reinterpret_cast<const char*>(&size), 4);
    return result.append(kind, 4) + bytes;
  };
  std::string result = chunk(padded(parts.json, ' '), "JSON");
  if (!parts.binary.empty()) result += chunk(padded(parts.binary, '\0'), "BIN");
  const std::uint32_t header[2] = {2, static_cast<std::uint32_t>(12 + result.size())};
  return "glTF" + std::string(reinterpret_cast<const char*>(header), 8) + result;
}

// Returns the first line, shortened, since it may quote megabytes of a data URI.
std::string short_line(const std::string& text) {
  constexpr std::size_t kLongest = 120;
  const std::string line = text.substr(0, text.find('\n'));
  return line.size() <= kLongest ? line : line.substr(0, kLongest) + "...";
}

std::size_t component_size(int type) {
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
  return size > 0 ? static_cast<std::size_t>(size) : 0;
}

template <class T>
T load(const std::uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

double component(const std::uint8_t* at, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized ? std::max(load<std::int8_t>(at) / 127.0, -1.0) : load<std::int8_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return normalized ? *at / 255.0 : *at;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? std::max(load<std::int16_t>(at) / 32767.0, -1.0) : load<std::int16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return normalized ? load<std::uint16_t>(at) / 65535.0 : load<std::uint16_t>(at);
    case TINYGLTF_COMPONENT_TYPE_INT:  // glTF has no such type, but tinygltf accepts it
      return load<std::int32_t>(at);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<std::uint32_t>(at);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(at);
    default:
      return load<double>(at);
  }
}

Status bad_accessor(int accessor, const std::string& what) {
  return {ErrorCode::bad_input, fmt::format("accessor {} {}", accessor, what)};
}

// Where the file says that an accessor's rows lie in a buffer view.
struct RowsAsked {
  int view = -1;
  std::size_t offset = 0, count = 0, row_bytes = 0;
};

// Rows that are `stride` apart and all inside their view.
struct Rows {
  const std::uint8_t* data = nullptr;
  std::size_t stride = 0;
};

Result<Rows> rows_of(const tinygltf::Model& model, const RowsAsked& asked) {
  const auto [view, offset, count, row_bytes] = asked;
  auto bytes = gltf_view(model, view);
  if (!bytes.ok()) return bytes.status();
  const std::size_t given = model.bufferViews[view].byteStride;
  const std::size_t stride = given == 0 ? row_bytes : given;
  // Compared by division: offset, stride and count come from the file and could overflow a product.
  const bool fits = count == 0 || (offset <= bytes->size() && row_bytes <= bytes->size() - offset &&
                                   count - 1 <= (bytes->size() - offset - row_bytes) / stride);
  if (!fits) return Status(ErrorCode::bad_input, fmt::format("leaves buffer view {}", view));
  return Rows{bytes->data() + offset, stride};
}

template <class Store>
Status read_dense(const tinygltf::Model& model, int index, int components, const Store& store) {
  const tinygltf::Accessor& a = model.accessors[index];
  const int own = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
  const std::size_t size = component_size(a.componentType);
  if (own < components || size == 0) {
    return bad_accessor(index, fmt::format("has {} components, not {}", own, components));
  }
  if (a.bufferView < 0) return {};
  auto rows = rows_of(model, {a.bufferView, a.byteOffset, a.count, size * own});
  if (!rows.ok()) return bad_accessor(index, rows.status().message());
  for (std::size_t i = 0; i < a.count; ++i) {
    const std::uint8_t* row = rows->data + i * rows->stride;
    for (int c = 0; c < components; ++c) {
      store(i, c, component(row + c * size, a.componentType, a.normalized));
    }
  }
  return {};
}

// Calls put(row of the accessor, bytes of its value) for each value of the accessor's sparse part,
// if it has one. A value is `row_bytes` long.
template <class Put>
Status for_sparse(const tinygltf::Model& model, int index, std::size_t row_bytes, const Put& put) {
  const tinygltf::Accessor& a = model.accessors[index];
  if (!a.sparse.isSparse) return {};
  const auto& where = a.sparse.indices;
  const auto& what = a.sparse.values;
  const std::size_t index_size = component_size(where.componentType);
  if (a.sparse.count < 0 || where.byteOffset < 0 || what.byteOffset < 0 || index_size == 0)
    return bad_accessor(index, "has a malformed sparse part");
  const auto count = static_cast<std::size_t>(a.sparse.count);
  auto indices =
      rows_of(model, {where.bufferView, std::size_t(where.byteOffset), count, index_size});
  if (!indices.ok()) return bad_accessor(index, indices.status().message());
  auto values = rows_of(model, {what.bufferView, std::size_t(what.byteOffset), count, row_bytes});
  if (!values.ok()) return bad_accessor(index, values.status().message());
  for (std::size_t k = 0; k < count; ++k) {
    const double at = component(indices->data + k * indices->stride, where.componentType, false);
    if (!(at >= 0 && at < double(a.count)))
      return bad_accessor(index, "has a sparse index out of range");
    put(static_cast<std::size_t>(at), values->data + k * values->stride);
  }
  return {};
}

template <class Store>
Status read_sparse(const tinygltf::Model& model, int index, int components, const Store& store) {
  const tinygltf::Accessor& a = model.accessors[index];
  const std::size_t size = component_size(a.componentType);
  const auto row = size * tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
  return for_sparse(model, index, row, [&](std::size_t at, const std::uint8_t* value) {
    for (int c = 0; c < components; ++c)
      store(at, c, component(value + c * size, a.componentType, a.normalized));
  });
}

template <class T>
Result<std::vector<T>> read_accessor(const tinygltf::Model& model, int index, int components) {
  if (index < 0 || std::size_t(index) >= model.accessors.size()) {
    return bad_accessor(index, "does not exist");
  }
  std::vector<T> values;
  const tinygltf::Accessor& a = model.accessors[index];
  const auto store = [&](std::size_t i, int c, double value) {
    values[i * components + c] = static_cast<T>(value);
  };
  // The count must be backed by data before anything is allocated for it.
  if (a.bufferView >= 0) {
    auto bytes = gltf_view(model, a.bufferView);
    if (!bytes.ok()) return bad_accessor(index, bytes.status().message());
    if (a.count > bytes->size()) return bad_accessor(index, "is longer than its buffer view");
  } else if (a.count > kMostGltfZeros) {
    return bad_accessor(index, "has no data for its count");
  }
  values.assign(a.count * components, T{});
  if (Status s = read_dense(model, index, components, store); !s.ok()) return s;
  if (Status s = read_sparse(model, index, components, store); !s.ok()) return s;
  return values;
}

// Each column of a matrix begins at a multiple of 4 bytes.
std::size_t row_bytes_of(const tinygltf::Accessor& a) {
  const std::size_t size = component_size(a.componentType);
  const std::size_t columns = a.type == TINYGLTF_TYPE_MAT2   ? 2
                              : a.type == TINYGLTF_TYPE_MAT3 ? 3
                                                             : 1;
  const int components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(a.type));
  if (components <= 0) return 0;
  const std::size_t column = size * static_cast<std::size_t>(components) / columns;
  return columns == 1 ? column : columns * ((column + 3) / 4 * 4);
}

}  // namespace

Result<tinygltf::Model> load_gltf(const fs::path& path, const GltfLoading& loading) {
  auto bytes = read_file_bytes(path);
  if (!bytes.ok()) return bytes.status();
  if (bytes->size > 0xffffffffu) {
    return Status(ErrorCode::unsupported, path.string() + ": larger than 4 GiB (split the scene)");
  }
  auto parts = check_gltf(path, *bytes, loading.textures, loading.defects);
  if (!parts.ok()) return parts.status();
  nlohmann::json parsed = std::move(parts->document);
  const std::set<int> fallbacks = fill_fallback_buffers(parsed, parts->container);
  std::vector<GltfDracoPart> draco;
  if (Status s = describe_draco(path, parsed, draco); !s.ok()) return s;
  const bool marked = loading.lightmap && mark_lightmap_values(parsed);
  const bool retyped = retype_data_images(parsed);
  const bool changed = !fallbacks.empty() || !draco.empty() || marked || retyped;
  const std::string text = changed ? parsed.dump() : std::string();
  if (changed) {
    parts->json = text;
    parts->plain = false;
  }
  if (loading.document != nullptr) *loading.document = std::move(parsed);
  parsed = nullptr;  // frees an unwanted JSON to make room for the second parser
  const std::string rebuilt = parts->container && !parts->plain ? plain_glb(*parts) : std::string();
  std::string_view data = bytes->text();
  if (!parts->plain) data = parts->container ? std::string_view(rebuilt) : parts->json;

  tinygltf::TinyGLTF loader;
  Folder folder{path.parent_path(), loading, parts->external_bytes, {}};
  loader.SetImageLoader(keep_image, nullptr);
  loader.SetFsCallbacks(file_access<tinygltf::FsCallbacks>(folder));
  tinygltf::Model model;
  std::string error, warning;
  const auto size = static_cast<unsigned>(data.size());
  const std::string base = base_of(folder);
  const auto* raw = reinterpret_cast<const unsigned char*>(data.data());
  bool loaded = false;
  try {
    loaded = parts->container
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning, raw, size, base)
                 : loader.LoadASCIIFromString(&model, &error, &warning, data.data(), size, base);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& exception) {  // tinygltf does not check some indices
    error = fmt::format("its parser gave up: {}", exception.what());
  }
  if (!folder.status.ok()) return folder.status;
  if (!loaded) return malformed_gltf(path, error.empty() ? "not a glTF file" : short_line(error));
  if (Status s = decode_meshopt_views(path, fallbacks, model); !s.ok()) return s;
  if (Status s = decode_draco_parts(path, draco, loading, model); !s.ok()) return s;
  return model;
}

std::size_t gltf_buffer_bytes(const tinygltf::Model& model) {
  std::size_t bytes = 0;
  for (const tinygltf::Buffer& buffer : model.buffers) bytes += buffer.data.size();
  return bytes;
}

Result<std::span<const std::uint8_t>> gltf_view(const tinygltf::Model& model, int view) {
  if (view < 0 || std::size_t(view) >= model.bufferViews.size()) {
    return Status(ErrorCode::bad_input,
                  fmt::format("names buffer view {}, which does not exist", view));
  }
  const tinygltf::BufferView& v = model.bufferViews[view];
  if (v.buffer < 0 || std::size_t(v.buffer) >= model.buffers.size()) {
    return Status(ErrorCode::bad_input,
                  fmt::format("names buffer {}, which does not exist", v.buffer));
  }
  const auto& data = model.buffers[v.buffer].data;
  if (v.byteOffset > data.size() || v.byteLength > data.size() - v.byteOffset) {
    return Status(ErrorCode::bad_input,
                  fmt::format("uses buffer view {}, which leaves its buffer", view));
  }
  return std::span<const std::uint8_t>(data.data() + v.byteOffset, v.byteLength);
}

Result<std::vector<float>> gltf_floats(const tinygltf::Model& model, int accessor, int components) {
  return read_accessor<float>(model, accessor, components);
}

Result<std::vector<std::uint32_t>> gltf_integers(const tinygltf::Model& model, int accessor) {
  if (accessor >= 0 && std::size_t(accessor) < model.accessors.size()) {
    const int type = model.accessors[accessor].componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
      return bad_accessor(accessor, "holds indices that are not unsigned integers");
    }
  }
  return read_accessor<std::uint32_t>(model, accessor, 1);
}

Result<GltfRows> gltf_rows(const tinygltf::Model& model, int accessor) {
  if (accessor < 0 || std::size_t(accessor) >= model.accessors.size())
    return bad_accessor(accessor, "does not exist");
  const tinygltf::Accessor& a = model.accessors[accessor];
  GltfRows rows;
  rows.row_bytes = rows.stride = row_bytes_of(a);
  rows.count = a.count;
  if (rows.row_bytes == 0) return bad_accessor(accessor, "has values of no known kind");
  if (a.bufferView >= 0) {
    auto dense = rows_of(model, {a.bufferView, a.byteOffset, a.count, rows.row_bytes});
    if (!dense.ok()) return bad_accessor(accessor, dense.status().message());
    rows.data = dense->data;
    rows.stride = dense->stride;
    if (!a.sparse.isSparse) return rows;
  } else if (a.count > kMostGltfZeros) {
    return bad_accessor(accessor, "has no data for its count");
  }
  rows.filled.resize(a.count * rows.row_bytes);
  for (std::size_t i = 0; a.bufferView >= 0 && i < a.count; ++i)
    std::memcpy(&rows.filled[i * rows.row_bytes], rows.data + i * rows.stride, rows.row_bytes);
  rows.data = rows.filled.data();
  rows.stride = rows.row_bytes;
  const auto fill = [&](std::size_t at, const std::uint8_t* value) {
    std::memcpy(&rows.filled[at * rows.row_bytes], value, rows.row_bytes);
  };
  if (Status s = for_sparse(model, accessor, rows.row_bytes, fill); !s.ok()) return s;
  return rows;
}

double gltf_component(const std::uint8_t* at, int type) {
  return component(at, type, false);
}

}  // namespace atlas
