// Reads glTF files as plain numbers. The code is independent, because a test of an exporter must
// not use the library's own readers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace atlas::test {

// A triangle of a primitive, as an instance of one node.
struct OracleTriangle {
  std::string node;            // the node's name
  int material = -1;           // -1 if it has none
  std::vector<double> matrix;  // from the node to the world, 16 numbers in column-major order
  // For each attribute the values of the three corners, one after the other, as they are stored.
  // Attributes of morph targets are named like "0/POSITION".
  std::map<std::string, std::vector<double>> attributes;
};

// A .glb, or a .gltf with one buffer file beside it. All functions throw std::exception if the file
// violates the format.
class GltfOracle {
 public:
  explicit GltfOracle(const std::filesystem::path& path);

  nlohmann::json document;

  // Returns all values of an accessor as they are stored. Sparse accessors are refused.
  std::vector<double> values(const nlohmann::json& accessor) const;
  // Returns the bytes of an image, which is embedded or beside the file.
  std::string image(std::size_t index) const;
  // Returns the triangles of the default scene, node by node, children after their parents.
  std::vector<OracleTriangle> triangles() const;

 private:
  void add_node(const nlohmann::json& index, const std::vector<double>& above,
                std::vector<OracleTriangle>& to) const;
  void add_primitive(const nlohmann::json& primitive, const OracleTriangle& place,
                     std::vector<OracleTriangle>& to) const;

  std::filesystem::path folder_;
  std::string buffer_;
};

}  // namespace atlas::test
