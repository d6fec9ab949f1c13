#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "examples/cabin/cabin_mesh.h"
#include "libatlas/core/status.h"

namespace cabin {
namespace {

using nlohmann::json;

constexpr int kFloat = 5126, kUnsigned = 5125;  // glTF component types

// The JSON description and the binary chunk, which grow together.
struct Glb {
  json root;
  std::vector<char> binary;

  // Adds a buffer view with one accessor over it and returns the index of the accessor.
  template <class T>
  std::size_t add(const std::vector<T>& data, int component, const char* type, std::size_t count) {
    const std::size_t offset = binary.size(), size = data.size() * sizeof(T);
    binary.resize(offset + size);
    std::memcpy(binary.data() + offset, data.data(), size);
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
    root["accessors"].push_back({{"bufferView", root["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return root["accessors"].size() - 1;
  }
};

// The triangles of one object and material, with their own vertices, because glTF has a single
// index for position and texture coordinate.
struct Part {
  bool y_up;
  std::vector<glm::vec3> positions = {}, light = {};
  std::vector<glm::vec2> texcoords = {};
  std::vector<Id> indices = {};
  std::unordered_map<std::uint64_t, Id> index_of = {};
};

void add_corner(Part& part, const Mesh& mesh, Id vertex, Id texcoord) {
  const auto [it, fresh] =
      part.index_of.emplace(std::uint64_t(vertex) << 32 | texcoord, Id(part.positions.size()));
  if (fresh) {
    const glm::vec3 p = mesh.vertices[vertex].position;
    part.positions.push_back(part.y_up ? glm::vec3(p.x, p.z, -p.y) : p);
    part.light.push_back(mesh.direct[vertex] + mesh.indirect[vertex]);
    // Textures in glTF start at the top.
    part.texcoords.push_back({mesh.texcoords[texcoord].x, 1 - mesh.texcoords[texcoord].y});
  }
  part.indices.push_back(it->second);
}

json primitive_of(Glb& glb, const Part& part, std::size_t material) {
  const std::size_t n = part.positions.size();
  glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
  for (const glm::vec3& p : part.positions)
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  json attributes;
  const std::size_t position = glb.add(part.positions, kFloat, "VEC3", n);
  glb.root["accessors"][position]["min"] = {low.x, low.y, low.z};
  glb.root["accessors"][position]["max"] = {high.x, high.y, high.z};
  attributes["POSITION"] = position;
  attributes["TEXCOORD_0"] = glb.add(part.texcoords, kFloat, "VEC2", n);
  attributes["_ILLUMINANCE"] = glb.add(part.light, kFloat, "VEC3", n);
  return {{"attributes", attributes},
          {"indices", glb.add(part.indices, kUnsigned, "SCALAR", part.indices.size())},
          {"material", material}};
}

void add_materials(Glb& glb, const Mesh& mesh) {
  std::unordered_map<std::string, std::size_t> image_of;
  for (const SurfaceMaterial& m : mesh.materials) {
    json pbr = {{"baseColorFactor", {m.diffuse.x, m.diffuse.y, m.diffuse.z, 1}},
                {"metallicFactor", 0}};
    if (!m.texture_file.empty()) {
      const auto [it, fresh] = image_of.emplace(m.texture_file, image_of.size());
      if (fresh) {
        glb.root["images"].push_back({{"uri", m.texture_file}});
        glb.root["textures"].push_back({{"source", it->second}});
      }
      pbr["baseColorTexture"] = {{"index", it->second}};
    }
    glb.root["materials"].push_back({{"name", m.name}, {"pbrMetallicRoughness", pbr}});
  }
}

void append_u32(std::string& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(char(value >> shift & 0xff));
}

}  // namespace

atlas::Status write_glb(const std::filesystem::path& path, const std::filesystem::path& target,
                        const Mesh& mesh, bool y_up) {
  Glb glb;
  glb.root["asset"] = {{"version", "2.0"}, {"generator", "atlas-make-cabin"}};
  add_materials(glb, mesh);
  // The triangles of an object are consecutive, so a change of object ends a node.
  json nodes = json::array(), roots = json::array();
  for (std::size_t t = 0; t < mesh.triangles.size();) {
    const std::uint16_t object = mesh.triangles[t].object;
    json primitives = json::array();
    while (t < mesh.triangles.size() && mesh.triangles[t].object == object) {
      const std::uint16_t material = mesh.triangles[t].material;
      Part part{y_up};
      for (; t < mesh.triangles.size() && mesh.triangles[t].object == object &&
             mesh.triangles[t].material == material;
           ++t)
        for (int k = 0; k < 3; ++k)
          add_corner(part, mesh, mesh.triangles[t].vertex[k], mesh.triangles[t].texcoord[k]);
      primitives.push_back(primitive_of(glb, part, material));
    }
    glb.root["meshes"].push_back({{"name", mesh.objects[object]}, {"primitives", primitives}});
    roots.push_back(nodes.size());
    nodes.push_back({{"name", mesh.objects[object]}, {"mesh", glb.root["meshes"].size() - 1}});
  }
  glb.root["nodes"] = nodes;
  glb.root["scenes"] = {{{"nodes", roots}}};
  glb.root["scene"] = 0;
  glb.root["buffers"] = {{{"byteLength", glb.binary.size()}}};
  std::string text = glb.root.dump();
  text.append((4 - text.size() % 4) % 4, ' ');
  if (glb.binary.size() + text.size() + 28 > 0xffffffffu)
    return {atlas::ErrorCode::unsupported, path.string() + ": GLB files end at 4 GiB (write .obj)"};
  std::string header;
  append_u32(header, 0x46546C67);
  append_u32(header, 2);
  append_u32(header, std::uint32_t(28 + text.size() + glb.binary.size()));
  append_u32(header, std::uint32_t(text.size()));
  append_u32(header, 0x4E4F534A);
  std::string second;
  append_u32(second, std::uint32_t(glb.binary.size()));
  append_u32(second, 0x004E4942);
  std::ofstream file(target, std::ios::binary);
  file << header << text << second;
  file.write(glb.binary.data(), std::streamsize(glb.binary.size()));
  file.flush();
  if (file) return {};
  return {atlas::ErrorCode::io, path.string() + ": could not be written (is the disk full?)"};
}

}  // namespace cabin
