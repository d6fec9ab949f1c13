// glTF files as plain numbers, read by code of our own: what judges an export must not share its
// readers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace atlas::test {

// A triangle of a primitive where a node shows it.
struct OracleTriangle {
  std::string node;            // its name
  int material = -1;           // -1: none
  std::vector<double> matrix;  // of the node into the world, 16 numbers, column by column
  // By attribute the values of the three corners, one after the other, as they are stored; those of
  // morph targets as "0/POSITION".
  std::map<std::string, std::vector<double>> attributes;
};

// A .glb, or a .gltf with one buffer beside it. All functions throw std::exception where the file
// breaks the format.
class GltfOracle {
 public:
  explicit GltfOracle(const std::filesystem::path& path);

  nlohmann::json document;

  // All values of an accessor as they are stored; sparse ones are refused.
  std::vector<double> values(const nlohmann::json& accessor) const;
  // The bytes of an image, embedded or beside the file.
  std::string image(std::size_t index) const;
  // The triangles of the default scene, node by node, children after their parents.
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
