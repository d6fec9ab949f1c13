#include "tests/support/gltf_oracle.h"

#include <cstring>
#include <stdexcept>

#include "tests/support/kept_scene.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

template <class T>
double load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return double(value);
}

std::size_t size_of(int type) {
  return type <= 5121 ? 1 : type <= 5123 ? 2 : 4;
}

double number_at(const char* at, int type) {
  switch (type) {
    case 5120:
      return load<std::int8_t>(at);
    case 5121:
      return load<std::uint8_t>(at);
    case 5122:
      return load<std::int16_t>(at);
    case 5123:
      return load<std::uint16_t>(at);
    case 5125:
      return load<std::uint32_t>(at);
    case 5126:
      return load<float>(at);
    default:
      throw std::runtime_error("componentType");
  }
}

std::size_t width_of(const json& accessor) {
  const std::map<std::string, std::size_t> widths{
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  return widths.at(accessor.at("type").get<std::string>());
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(16);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      for (int k = 0; k < 4; ++k)
        c[std::size_t(4 * column + row)] +=
            a[std::size_t(4 * k + row)] * b[std::size_t(4 * column + k)];
  return c;
}

std::vector<double> identity() {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

std::vector<double> local(const json& node) {
  if (node.contains("matrix")) return node["matrix"].get<std::vector<double>>();
  std::vector<double> move = identity(), turn = identity(), scale = identity();
  if (node.contains("translation"))
    for (std::size_t i = 0; i < 3; ++i) move[12 + i] = node["translation"][i];
  if (node.contains("scale"))
    for (std::size_t i = 0; i < 3; ++i) scale[5 * i] = node["scale"][i];
  if (node.contains("rotation")) {
    const double x = node["rotation"][0], y = node["rotation"][1], z = node["rotation"][2],
                 w = node["rotation"][3];
    turn = {1 - 2 * (y * y + z * z),
            2 * (x * y + w * z),
            2 * (x * z - w * y),
            0,
            2 * (x * y - w * z),
            1 - 2 * (x * x + z * z),
            2 * (y * z + w * x),
            0,
            2 * (x * z + w * y),
            2 * (y * z - w * x),
            1 - 2 * (x * x + y * y),
            0,
            0,
            0,
            0,
            1};
  }
  return product(move, product(turn, scale));
}

}  // namespace

GltfOracle::GltfOracle(const fs::path& path) : folder_(path.parent_path()) {
  document = json::parse(gltf_json(path));
  const std::string bytes = bytes_of_file(path);
  if (!document.contains("buffers")) return;
  if (document["buffers"].size() != 1) throw std::runtime_error("buffers");
  if (bytes.starts_with("glTF"))
    buffer_ = bytes.substr(28 + std::size_t(load<std::uint32_t>(bytes.data() + 12)));
  else
    buffer_ = bytes_of_file(folder_ / document["buffers"][0].at("uri"));
  if (buffer_.size() < document["buffers"][0].at("byteLength")) throw std::runtime_error("buffer");
}

std::vector<double> GltfOracle::values(const json& number) const {
  const json& accessor = document.at("accessors").at(number.get<std::size_t>());
  if (accessor.contains("sparse")) throw std::runtime_error("sparse");
  const json& view = document.at("bufferViews").at(accessor.at("bufferView").get<std::size_t>());
  const int type = accessor.at("componentType");
  const std::size_t width = width_of(accessor), row = width * size_of(type);
  const std::size_t stride = view.value("byteStride", row), begin = view.value("byteOffset", 0u),
                    offset = accessor.value("byteOffset", 0u);
  std::vector<double> result;
  const std::size_t count = accessor.at("count");
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = offset + i * stride;
    if (at + row > view.at("byteLength").get<std::size_t>() || begin + at + row > buffer_.size())
      throw std::runtime_error("an accessor leaves its view");
    for (std::size_t c = 0; c < width; ++c)
      result.push_back(number_at(buffer_.data() + begin + at + c * size_of(type), type));
  }
  return result;
}

std::string GltfOracle::image(std::size_t index) const {
  const json& image = document.at("images").at(index);
  if (image.contains("uri")) return bytes_of_file(folder_ / image["uri"].get<std::string>());
  const json& view = document.at("bufferViews").at(image.at("bufferView").get<std::size_t>());
  return buffer_.substr(view.at("byteOffset"), view.at("byteLength"));
}

std::vector<OracleTriangle> GltfOracle::triangles() const {
  std::vector<OracleTriangle> result;
  const json& scene = document.at("scenes").at(document.value("scene", 0u));
  for (const json& node : scene.at("nodes")) add_node(node, identity(), result);
  return result;
}

void GltfOracle::add_node(const json& index, const std::vector<double>& above,
                          std::vector<OracleTriangle>& to) const {
  const json& node = document.at("nodes").at(index.get<std::size_t>());
  OracleTriangle place;
  place.node = node.value("name", "");
  place.matrix = product(above, local(node));
  if (node.contains("mesh")) {
    const json& mesh = document.at("meshes").at(node["mesh"].get<std::size_t>());
    for (const json& primitive : mesh.at("primitives"))
      if (primitive.value("mode", 4) == 4) add_primitive(primitive, place, to);
  }
  if (node.contains("children"))
    for (const json& child : node["children"]) add_node(child, place.matrix, to);
}

void GltfOracle::add_primitive(const json& primitive, const OracleTriangle& place,
                               std::vector<OracleTriangle>& to) const {
  std::map<std::string, std::pair<std::size_t, std::vector<double>>> all;  // width, values
  const auto add_all = [&](const json& attributes, const std::string& prefix) {
    for (const auto& [name, number] : attributes.items())
      all[prefix + name] = {width_of(document.at("accessors").at(number.get<std::size_t>())),
                            values(number)};
  };
  add_all(primitive.at("attributes"), "");
  if (primitive.contains("targets"))
    for (std::size_t t = 0; t < primitive["targets"].size(); ++t)
      add_all(primitive["targets"][t], std::to_string(t) + "/");
  std::vector<double> indices;
  if (primitive.contains("indices")) {
    indices = values(primitive["indices"]);
  } else {
    const std::size_t count = all.at("POSITION").second.size() / 3;
    for (std::size_t i = 0; i < count; ++i) indices.push_back(double(i));
  }
  if (indices.size() % 3 != 0) throw std::runtime_error("no whole triangles");
  for (std::size_t k = 0; k < indices.size(); k += 3) {
    OracleTriangle triangle = place;
    triangle.material = primitive.value("material", -1);
    for (const auto& [name, attribute] : all) {
      const auto& [width, numbers] = attribute;
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < width; ++i)
          triangle.attributes[name].push_back(numbers.at(std::size_t(indices[k + c]) * width + i));
    }
    to.push_back(std::move(triangle));
  }
}

}  // namespace atlas::test
