// Makes glTF files whose primitives Draco's own encoder has compressed.
#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/gltf_maker.h"

namespace atlas::test {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

// An attribute of each point: numbers of one type, `components` per point.
struct DracoValues {
  draco::GeometryAttribute::Type kind;
  int components;
  draco::DataType type;
  const void* data;
  bool normalized = false;
};

// A mesh to compress. Attributes get the ids 0, 1, ... in their order.
struct DracoSource {
  std::vector<std::uint32_t> indices;
  std::size_t points = 0;
  std::vector<DracoValues> attributes;
  bool sequential = true;  // keeps the order of points; the other method does not
  int bits = 0;            // of positions and uvs that are quantised; 0: they are not
  int speed = 5;           // of Draco, 0..10; below 4, quantised uvs are predicted from positions
  bool metadata = false;
};

inline std::vector<unsigned char> compress(const DracoSource& source) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(source.points));
  for (std::size_t t = 0; t + 2 < source.indices.size(); t += 3)
    mesh.AddFace({draco::PointIndex(source.indices[t]), draco::PointIndex(source.indices[t + 1]),
                  draco::PointIndex(source.indices[t + 2])});
  for (const DracoValues& values : source.attributes) {
    const auto row = static_cast<std::size_t>(draco::DataTypeLength(values.type)) *
                     static_cast<std::size_t>(values.components);
    draco::GeometryAttribute attribute;
    attribute.Init(values.kind, nullptr, static_cast<std::uint8_t>(values.components), values.type,
                   values.normalized, static_cast<std::int64_t>(row), 0);
    const int number =
        mesh.AddAttribute(attribute, true, static_cast<std::uint32_t>(source.points));
    for (std::uint32_t p = 0; p < source.points; ++p)
      mesh.attribute(number)->SetAttributeValue(draco::AttributeValueIndex(p),
                                                static_cast<const char*>(values.data) + p * row);
  }
  if (source.metadata) {
    auto metadata = std::make_unique<draco::GeometryMetadata>();
    metadata->AddEntryString("name", "a name");
    mesh.AddMetadata(std::move(metadata));
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(source.sequential ? draco::MESH_SEQUENTIAL_ENCODING
                                              : draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetSpeedOptions(source.speed, source.speed);
  if (source.bits > 0)
    for (const auto kind :
         {draco::GeometryAttribute::POSITION, draco::GeometryAttribute::TEX_COORD})
      encoder.SetAttributeQuantization(kind, source.bits);
  draco::EncoderBuffer out;
  if (!encoder.EncodeMeshToBuffer(mesh, &out).ok()) return {};
  return {out.data(), out.data() + out.size()};
}

// A glTF file that holds its data only in compressed form, as exporters write it.
struct DracoGltf : Gltf {
  DracoGltf() { j["extensionsUsed"] = j["extensionsRequired"] = {kDraco}; }

  // Adds an accessor that has no data of its own.
  int promised(std::size_t count, const char* type, int component_type = 5126) {
    return accessor({{"componentType", component_type}, {"type", type}, {"count", count}});
  }
  // Returns a primitive of promised accessors; attributes have the ids 0, 1, ... in their order.
  json primitive(const DracoSource& source,
                 const std::vector<std::pair<std::string, int>>& attributes) {
    json p = {{"indices", promised(source.indices.size(), "SCALAR", 5125)}};
    json& draco = p["extensions"][kDraco];
    draco["bufferView"] = view(compress(source));
    int id = 0;
    for (const auto& [name, number] : attributes) {
      p["attributes"][name] = number;
      draco["attributes"][name] = id++;
    }
    return p;
  }
};

}  // namespace atlas::test
