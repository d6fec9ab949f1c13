#include "tests/exporters/gltf_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "tests/support/gltf_oracle.h"
#include "tests/support/kept_scene.h"

namespace atlas::test {
namespace {

using nlohmann::json;

constexpr int kVertexData = 0x8892, kIndexData = 0x8893;  // OpenGL's names of the buffers

std::size_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&word, bytes.data() + at, 4);
  return word;
}

void expect_chunks(const std::string& bytes, std::size_t binary) {
  EXPECT_EQ(word_at(bytes, 4), 2u);
  EXPECT_EQ(word_at(bytes, 8), bytes.size());
  const std::size_t text = word_at(bytes, 12);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(text % 4, 0u);
  const std::size_t end = bytes.find_last_of('}', 20 + text - 1) + 1;
  EXPECT_EQ(bytes.substr(end, 20 + text - end), std::string(20 + text - end, ' '));
  const std::size_t length = word_at(bytes, 20 + text);
  EXPECT_EQ(bytes.substr(24 + text, 4), std::string("BIN\0", 4));
  EXPECT_EQ(length % 4, 0u);
  EXPECT_EQ(28 + text + length, bytes.size());
  EXPECT_TRUE(length >= binary && length < binary + 4);
  EXPECT_EQ(bytes.substr(28 + text + binary), std::string(length - binary, '\0'));
}

void expect_bounds(const GltfOracle& file, const json& number) {
  const json& accessor = file.document["accessors"].at(number.get<std::size_t>());
  const std::vector<double> values = file.values(number);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = INFINITY, high = -INFINITY;
    for (std::size_t i = axis; i < values.size(); i += 3) {
      low = std::min(low, values[i]);
      high = std::max(high, values[i]);
    }
    EXPECT_EQ(accessor.at("min").at(axis).get<double>(), low) << axis;
    EXPECT_EQ(accessor.at("max").at(axis).get<double>(), high) << axis;
  }
}

// Expects indices of 16 bits where that is enough.
void expect_indices(const GltfOracle& file, const json& number) {
  const json& accessor = file.document["accessors"].at(number.get<std::size_t>());
  const json& view = file.document["bufferViews"].at(accessor.at("bufferView").get<std::size_t>());
  EXPECT_EQ(view.at("target"), kIndexData);
  EXPECT_FALSE(view.contains("byteStride"));
  EXPECT_FALSE(accessor.contains("byteOffset"));
  const std::vector<double> values = file.values(number);
  const bool is_short = *std::max_element(values.begin(), values.end()) < 65535;
  EXPECT_EQ(accessor.at("componentType"), is_short ? 5123 : 5125);
  EXPECT_EQ(view.at("byteLength"), values.size() * (is_short ? 2 : 4));
}

// Expects a view of a vertex's data, whose rows begin at multiples of four.
void expect_view(const GltfOracle& file, const json& number) {
  const json& accessor = file.document["accessors"].at(number.get<std::size_t>());
  const json& view = file.document["bufferViews"].at(accessor.at("bufferView").get<std::size_t>());
  EXPECT_EQ(view.at("target"), kVertexData);
  const std::size_t count = accessor.at("count"), length = view.at("byteLength");
  ASSERT_GT(count, 0u);
  EXPECT_EQ(length % count, 0u);
  EXPECT_EQ(length / count % 4, 0u) << accessor;
  EXPECT_EQ(view.value("byteStride", length / count), length / count);
  EXPECT_EQ(file.values(number).size() % count, 0u);
  EXPECT_EQ(accessor.value("byteOffset", 0u), 0u);
}

bool encoded(const std::string& uri) {
  return std::all_of(uri.begin(), uri.end(), [](char c) { return c > ' ' && c <= '~'; });
}

}  // namespace

void expect_gltf_layout(const std::filesystem::path& path) {
  const std::string bytes = bytes_of_file(path);
  const json document = json::parse(gltf_json(path));
  const json& buffer = document.at("buffers").at(0);
  const bool binary = bytes.starts_with("glTF");
  EXPECT_EQ(buffer.contains("uri"), !binary);
  EXPECT_TRUE(encoded(buffer.value("uri", "")));
  for (const json& image : document.value("images", json::array()))
    EXPECT_TRUE(encoded(image.value("uri", ""))) << image;
  const std::size_t size = buffer.at("byteLength");
  if (binary) expect_chunks(bytes, size);
  for (const json& view : document.at("bufferViews")) {
    const std::size_t begin = view.at("byteOffset"), length = view.at("byteLength");
    EXPECT_EQ(begin % 4, 0u);
    EXPECT_LE(begin + length, size);
  }
  if (!binary && buffer.at("uri").get<std::string>().find('%') != std::string::npos) return;
  const GltfOracle file(path);
  for (const json& mesh : document.at("meshes")) {
    for (const json& primitive : mesh.at("primitives")) {
      if (primitive.value("mode", 4) != 4) continue;
      for (const auto& [name, number] : primitive.at("attributes").items())
        expect_view(file, number);
      expect_indices(file, primitive.at("indices"));
      expect_bounds(file, primitive["attributes"]["POSITION"]);
    }
  }
}

}  // namespace atlas::test
