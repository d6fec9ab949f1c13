// Makes small glTF files value by value.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {

using nlohmann::json;

// Builds a glTF file: binary data, with a view and an accessor for each array.
struct Gltf {
  json j = {{"asset", {{"version", "2.0"}}}};
  std::string bytes;

  template <class T>
  int view(const std::vector<T>& values, int stride = 0) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    json v = {
        {"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
    if (stride != 0) v["byteStride"] = stride;
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    j["bufferViews"].push_back(v);
    return int(j["bufferViews"].size()) - 1;
  }
  int accessor(json a) {
    j["accessors"].push_back(std::move(a));
    return int(j["accessors"].size()) - 1;
  }
  int floats(const std::vector<float>& values, const char* type, int components) {
    return accessor({{"bufferView", view(values)},
                     {"componentType", 5126},
                     {"type", type},
                     {"count", values.size() / components}});
  }
  template <class T>
  int indices(const std::vector<T>& values) {
    const int type = sizeof(T) == 1 ? 5121 : sizeof(T) == 2 ? 5123 : 5125;
    return accessor({{"bufferView", view(values)},
                     {"componentType", type},
                     {"type", "SCALAR"},
                     {"count", values.size()}});
  }
  // Adds one mesh with one primitive, under one node.
  void single(json primitive, json node = json::object()) {
    j["meshes"] = json::array({{{"primitives", json::array({std::move(primitive)})}}});
    node["mesh"] = 0;
    j["nodes"] = json::array({std::move(node)});
    j["scenes"] = json::array({{{"nodes", {0}}}});
    j["scene"] = 0;
  }
  // Buffers that the JSON has already come after that of the bytes.
  std::string glb() const {
    json with_buffer = j;
    std::string binary = bytes;
    binary.resize((binary.size() + 3) / 4 * 4);
    if (!bytes.empty()) {
      with_buffer["buffers"] = json::array({{{"byteLength", bytes.size()}}});
      for (const json& more : j.value("buffers", json::array()))
        with_buffer["buffers"].push_back(more);
    }
    std::string text = with_buffer.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t v) {
      std::string s(4, '\0');
      const auto bits = std::uint32_t(v);
      std::memcpy(s.data(), &bits, 4);
      return s;
    };
    return "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) + "JSON" +
           text + word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

inline Result<LoadedScene> load_glb(const TempFolder& folder, const Gltf& gltf) {
  return read_scene(folder.write("scene.glb", gltf.glb()), {}, {});
}

inline const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

}  // namespace atlas::test
