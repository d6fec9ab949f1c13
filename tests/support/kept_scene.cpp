#include "tests/support/kept_scene.h"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

namespace atlas::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + at, 4);
  return word;
}

struct GltfFile {
  json document;
  std::string buffer;

  explicit GltfFile(const fs::path& path) {
    document = json::parse(gltf_json(path));
    const std::string bytes = bytes_of_file(path);
    if (bytes.starts_with("glTF")) {
      buffer = bytes.substr(28 + word_at(bytes, 12));
    } else {
      buffer = bytes_of_file(path.parent_path() / document.at("buffers").at(0).at("uri"));
    }
  }

  // Returns the values of an accessor, with `width` values per element.
  template <class T>
  std::vector<T> values(std::size_t accessor, std::size_t width) const {
    const json& a = document.at("accessors").at(accessor);
    const json& view = document.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
    std::vector<T> result(a.at("count").get<std::size_t>() * width);
    const std::size_t length = result.size() * sizeof(T);
    if (view.at("byteLength") != length) throw std::runtime_error("accessor's length");
    const std::size_t offset = view.at("byteOffset");
    if (offset + length > buffer.size()) throw std::runtime_error("buffer's length");
    std::memcpy(result.data(), buffer.data() + offset, length);
    return result;
  }

  std::vector<std::uint32_t> indices(std::size_t accessor) const {
    if (document.at("accessors").at(accessor).at("componentType") == 5125)
      return values<std::uint32_t>(accessor, 1);
    const auto shorts = values<std::uint16_t>(accessor, 1);
    return {shorts.begin(), shorts.end()};
  }
};

std::string image_of(const json& document, const json& material) {
  const json& surface = material.at("pbrMetallicRoughness");
  if (!surface.contains("baseColorTexture")) return {};
  const json& texture =
      document.at("textures").at(surface["baseColorTexture"].at("index").get<std::size_t>());
  const json& image = document.at("images").at(texture.at("source").get<std::size_t>());
  return image.contains("uri") ? image["uri"].get<std::string>()
                               : std::to_string(image.at("bufferView").get<int>());
}

void add_primitive(const GltfFile& file, const json& primitive, const std::string& object,
                   std::vector<KeptTriangle>& to) {
  const json& attributes = primitive.at("attributes");
  const auto floats = [&](const char* name, std::size_t width) {
    return attributes.contains(name) ? file.values<float>(attributes[name], width)
                                     : std::vector<float>();
  };
  const auto positions = floats("POSITION", 3), normals = floats("NORMAL", 3);
  const auto texcoords = floats("TEXCOORD_0", 2), uvs = floats("TEXCOORD_1", 2);
  const json& material =
      file.document.at("materials").at(primitive.at("material").get<std::size_t>());
  const std::size_t page = primitive.value("extras", json::object()).value("lightmap", 0);
  const auto indices = file.indices(primitive.at("indices"));
  for (std::size_t k = 0; k + 2 < indices.size(); k += 3) {
    KeptTriangle triangle{object,
                          material.value("name", ""),
                          image_of(file.document, material),
                          {},
                          !normals.empty(),
                          attributes.at("TEXCOORD_0") != attributes.at("TEXCOORD_1"),
                          page};
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t v = indices[k + c];
      KeptCorner& corner = triangle.corners[c];
      corner.position = {positions.at(3 * v), positions.at(3 * v + 1), positions.at(3 * v + 2)};
      if (!normals.empty())
        corner.normal = {normals.at(3 * v), normals.at(3 * v + 1), normals.at(3 * v + 2)};
      corner.texcoord = {texcoords.at(2 * v), 1 - texcoords.at(2 * v + 1)};
      corner.uv = {uvs.at(2 * v), 1 - uvs.at(2 * v + 1)};
    }
    to.push_back(triangle);
  }
}

}  // namespace

std::string gltf_json(const fs::path& path) {
  const std::string bytes = bytes_of_file(path);
  return bytes.starts_with("glTF") ? bytes.substr(20, word_at(bytes, 12)) : bytes;
}

std::vector<KeptTriangle> read_kept_gltf(const fs::path& path) {
  const GltfFile file(path);
  std::vector<KeptTriangle> result;
  for (const json& node : file.document.at("nodes")) {
    if (!node.contains("mesh")) continue;
    const json& mesh = file.document.at("meshes").at(node["mesh"].get<std::size_t>());
    if (node.value("name", "") != mesh.value("name", "")) throw std::runtime_error("names differ");
    for (const json& primitive : mesh.at("primitives"))
      add_primitive(file, primitive, node.value("name", ""), result);
  }
  return result;
}

std::vector<KeptTriangle> read_kept_obj(const fs::path& path) {
  std::vector<Vec3f> positions, normals;
  std::vector<Vec2f> texcoords;
  std::vector<KeptTriangle> result;
  std::string line, object, material;
  std::istringstream text(bytes_of_file(path));
  while (std::getline(text, line)) {
    std::istringstream words(line);
    std::string key, word;
    words >> key;
    Vec3f v;
    if (key == "v" || key == "vn") {
      words >> v.x >> v.y >> v.z;
      (key == "v" ? positions : normals).push_back(v);
    } else if (key == "vt") {
      words >> v.x >> v.y;
      texcoords.push_back({v.x, v.y});
    } else if (key == "o" || key == "usemtl") {
      (key == "o" ? object : material) = line.substr(key.size() + 1);
    } else if (key == "f") {
      KeptTriangle triangle{object, material, {}, {}, true, true};
      for (KeptCorner& corner : triangle.corners) {
        words >> word;
        int at[3] = {0, 0, 0};
        std::istringstream parts(word);
        for (int i = 0; i < 3 && std::getline(parts, word, '/'); ++i)
          at[i] = word.empty() ? 0 : std::stoi(word);
        corner.position = positions.at(std::size_t(at[0] - 1));
        triangle.has_texcoords &= at[1] != 0;
        triangle.has_normals &= at[2] != 0;
        if (at[1] != 0) corner.texcoord = texcoords.at(std::size_t(at[1] - 1));
        if (at[2] != 0) corner.normal = normals.at(std::size_t(at[2] - 1));
      }
      if (words >> word) throw std::runtime_error(path.string() + ": a polygon");
      result.push_back(triangle);
    }
  }
  return result;
}

std::string bytes_of_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path.string() + ": cannot be opened");
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace atlas::test
