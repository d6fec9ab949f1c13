#include "tests/fuzz/seeds.h"

#include <zlib.h>

#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "libatlas/image/image_io.h"
#include "tests/support/draco_gltf.h"
#include "tests/support/file_bytes.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/packed_gltf.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

void must(const Status& status) {
  if (!status.ok()) throw std::runtime_error(status.message());
}

const std::string kObj = R"(mtllib second.mtl
o a
v 0 0 0 1 0.5 .25
v 1 0 0 2 0 0
v 1 1 .5 3 0 0
v 0 1 0 4 0 0
vt 0 0
vt 1 0
vt 1 1 0
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/3/1
g b c
usemtl blue
f -1//-1 -2//-1 1//1 2//1
f 1/1 2/2 \
 3/3
l 1 2
%%
newmtl red
Kd 1 .5 0.25
Ke 0 1 0
d .5
map_Kd -s 1 2 1 -o 0 0 0 -clamp on -mm 0 1 a.png
newmtl blue
Kd 0.2
Tr 0.3
)";

const std::string kPly = R"(ply
format ascii 1.0
comment TextureFile a.png
element vertex 4
property float x
property float y
property double z
property uchar red
property uchar green
property uchar blue
property float nx
property float ny
property float nz
element face 2
property list uchar int vertex_indices
property list uchar float texcoord
property int texnumber
end_header
0 0 0 255 3 4 0 0 1
1 0 0 255 3 4 0 0 1
1 1 .5 0 3 4 0 0 1
0 1 0 255 3 4 0 0 1
3 0 1 2 6 0 0 1 0 1 1 0
4 0 1 2 3 8 0 0 1 0 1 1 0 1 -1
)";

const std::string kOff = R"(STCNOFF
4 2 0
0 0 0 0 0 1 255 51 0 255 .25 .5
1 0 0 0 0 1 0 0 0 255 1 0
0 1 0 0 0 1 0 102 0 255 -2 3
1 1 0 0 0 1 1 2 3 255 0 0
3 2 1 0
4 0 1 3 2 255 0 0
)";

const std::string kStl = R"(solid x
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 1 0
endloop
endfacet
endsolid x
)";

const std::string kWrl = R"(#VRML V2.0 utf8
WorldInfo { title "x" info [ "a" ] }
DEF a Transform { translation 1 2 3 rotation 0 0 1 .5 scale 2 2 2 children [
  Shape {
    appearance Appearance {
      material Material { diffuseColor 1 1 1 }
      texture ImageTexture { url [ "a.png" ] repeatS FALSE }
    }
    geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] }
      texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] }
      coordIndex [ 0 1 2 -1 0 2 3 -1 ]
      texCoordIndex [ 0 1 2 -1 0 2 3 -1 ]
    }
  }
] }
)";

// Two meshes under three nodes, with a skin, a morph target, instances and an animation.
std::string glb() {
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int light = g.floats({1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 1, 1}, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int weights = g.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  const int joints = g.accessor({{"bufferView", g.view(std::vector<std::uint8_t>(16))},
                                 {"componentType", 5121},
                                 {"type", "VEC4"},
                                 {"count", 4}});
  const int places = g.floats({0, 0, 0, 5, 0, 0}, "VEC3", 3);
  const int times = g.floats({0, 1}, "SCALAR", 1);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes",
             {{"POSITION", positions},
              {"_ILLUMINANCE", light},
              {"TEXCOORD_0", uvs},
              {"JOINTS_0", joints},
              {"WEIGHTS_0", weights}}},
            {"indices", indices},
            {"material", 0}},
           {{"skin", 0}, {"children", {1}}});
  g.j["meshes"].push_back(
      {{"weights", {0.5}},
       {"primitives", json::array({{{"attributes", {{"POSITION", positions}}},
                                    {"targets", json::array({{{"POSITION", light}}})},
                                    {"mode", 5}}})}});
  g.j["nodes"].push_back({{"name", "joint"}, {"translation", {1, 2, 3}}});
  g.j["nodes"].push_back(
      {{"mesh", 1},
       {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", places}}}}}}}});
  g.j["scenes"][0]["nodes"] = {0, 2};
  g.j["skins"] = json::array({{{"joints", {1}}}});
  g.j["materials"] =
      json::array({{{"name", "a"},
                    {"alphaMode", "MASK"},
                    {"pbrMetallicRoughness", {{"baseColorFactor", {1, .5, .2, 1}}}}}});
  g.j["animations"] = json::array(
      {{{"channels",
         json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})},
        {"samplers", json::array({{{"input", times}, {"output", places}}})}}});
  return g.glb();
}

// Two squares with materials, on two pages of a lightmap that are one image.
std::string lightmapped_glb() {
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  const auto square = [&](int page) {
    return json{{"attributes", {{"POSITION", positions}, {"TEXCOORD_1", uvs}}},
                {"indices", indices},
                {"material", page},
                {"extras", {{"lightmap", page}}}};
  };
  g.single(square(0));
  g.j["meshes"][0]["primitives"].push_back(square(1));
  g.j["materials"] = {{{"name", "a"}}, {{"name", "b"}, {"doubleSided", true}}};
  g.j["asset"]["extras"]["lightmap"] = {{"images", {"page.hdr", "page.hdr"}},
                                        {"linear", {"page.hdr", "page.hdr"}},
                                        {"texCoord", 1},
                                        {"white", 2.5}};
  return g.glb();
}

// A triangle in the formats of which the text is one dialect.
const std::vector<float> kTriangle{0, 0, 0, 1, 0, 0, 0, 1, 0};

std::string floats_of(const std::vector<float>& values) {
  std::string bytes;
  for (const float v : values) bytes += little(std::bit_cast<std::uint32_t>(v), 4);
  return bytes;
}

std::string binary_ply() {
  return "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
         "property float y\nproperty float z\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n" +
         floats_of(kTriangle) + '\3' + little(0, 4) + little(1, 4) + little(2, 4);
}

std::string binary_stl() {
  return std::string(80, ' ') + little(1, 4) + floats_of({0, 0, 1}) + floats_of(kTriangle) +
         little(0, 2);
}

std::string gzipped(const std::string& text) {
  z_stream stream{};
  std::string bytes(text.size() + 64, '\0');
  constexpr int kGzip = 16 + MAX_WBITS;
  if (deflateInit2(&stream, 9, Z_DEFLATED, kGzip, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::runtime_error("zlib");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = uInt(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = uInt(bytes.size());
  deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  deflateEnd(&stream);
  return bytes;
}

// The square as Draco compresses it, in the order of its points or not.
std::string draco_glb(bool sequential) {
  DracoSource source;
  source.indices = {0, 1, 2, 0, 2, 3};
  source.points = 4;
  source.attributes = {{draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, kSquare.data()}};
  source.sequential = sequential;
  source.bits = sequential ? 0 : 10;
  DracoGltf g;
  g.single(g.primitive(source, {{"POSITION", g.promised(source.points, "VEC3")}}));
  return g.glb();
}

std::string meshopt_glb(bool as_triangles, int bits, const char* extension) {
  PackedGltf g(extension);
  const int positions = g.packed_positions(kSquare, bits);
  const int indices = g.packed_indices({0, 1, 2, 0, 2, 3}, as_triangles, 2);
  g.single({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return g.glb();
}

// A square whose base colour is an image within the file.
std::string textured_glb(const std::string& png) {
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
            {"indices", indices},
            {"material", 0}});
  g.j["images"] = json::array({{{"bufferView", g.view(std::vector<char>(png.begin(), png.end()))},
                                {"mimeType", "image/png"}}});
  g.j["textures"] = json::array({{{"source", 0}}});
  g.j["materials"] =
      json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
  return g.glb();
}

// The same data in two files: `%%` begins the second.
std::string gltf_with_a_buffer() {
  Gltf g;
  g.single({{"attributes", {{"POSITION", g.floats(kSquare, "VEC3", 3)}}},
            {"indices", g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3})}});
  g.j["buffers"] = json::array({{{"byteLength", g.bytes.size()}, {"uri", "second.bin"}}});
  return g.j.dump() + "\n%%\n" + g.bytes;
}

std::string tiff() {
  std::string entries;
  const auto entry = [&](std::size_t tag, std::size_t value) {
    entries += little(tag, 2) + little(3, 2) + little(1, 4) + little(value, 4);
  };
  constexpr std::size_t kCount = 9, kTexels = 8 + 2 + 12 * kCount + 4;
  for (const auto& [tag, value] : {std::pair<std::size_t, std::size_t>{256, 3},
                                   {257, 2},
                                   {258, 8},
                                   {259, 1},
                                   {262, 1},
                                   {273, kTexels},
                                   {277, 1},
                                   {278, 2},
                                   {279, 6}})
    entry(tag, value);
  return "II*" + std::string(1, '\0') + little(8, 4) + little(kCount, 2) + entries + little(0, 4) +
         std::string(6, '\x55');
}

const std::string kCsv = R"(name,width,height
# sizes
a,3,4
"b ""x""",10,2 # the second
c #2,0,5
d,2147483647,1
)";

const std::string kJson = R"({"rects": [[1, 2], {"name": "a\u00e4", "w": 3, "h": 4},
{"width": 50, "height": 60}, [2147483647, 0]]})";

const std::string kLight = R"(1 2 3
# grey
.5

1e3 0 0
2
)";

}  // namespace

std::vector<Seed> scene_seeds() {
  const std::string named =
      "# lightmap: page.hdr (sRGB-encoded, white is 2.5 of it), page.hdr (linear)\n";
  std::string png;
  for (const Seed& image : image_seeds())
    if (image.extension == "png") png = image.bytes;
  return {{"obj", "text", kObj},
          {"ply", "text", kPly},
          {"off", "text", kOff},
          {"stl", "text", kStl},
          {"wrl", "text", kWrl},
          {"glb", "skinned", glb()},
          {"obj", "lightmap", named + kObj},
          {"ply", "binary", binary_ply()},
          {"stl", "binary", binary_stl()},
          {"wrz", "text", gzipped(kWrl)},
          {"glb", "lightmap", lightmapped_glb()},
          {"glb", "draco_sequential", draco_glb(true)},
          {"glb", "draco_edgebreaker", draco_glb(false)},
          {"glb", "meshopt", meshopt_glb(true, 0, kMeshopt)},
          {"glb", "meshopt_filtered", meshopt_glb(false, 12, kMeshopt)},
          {"glb", "meshopt_newer", meshopt_glb(true, 0, kNewerMeshopt)},
          {"glb", "texture", textured_glb(png)},
          {"gltf", "buffer", gltf_with_a_buffer()}};
}

Seed scene_seed(const std::string& extension, const std::string& name) {
  for (const Seed& seed : scene_seeds())
    if (seed.extension == extension && seed.name == name) return seed;
  throw std::runtime_error("no seed " + extension + " " + name);
}

std::vector<Seed> image_seeds() {
  const TempFolder folder;
  Image8 bytes(3, 2, 4);
  std::iota(bytes.texels.begin(), bytes.texels.end(), std::uint8_t{70});
  ImageF floats(3, 2, 3);
  std::iota(floats.texels.begin(), floats.texels.end(), 0.5f);
  must(write_png(folder.path() / "a.png", bytes, {}));
  must(write_exr(folder.path() / "a.exr", floats));
  const std::string texels(3 * 2 * 3, '\x55'), row(3 * 3, '\x55'), none(4, '\0');
  const std::string bmp = "BM" + little(78, 4) + none + little(54, 4) + little(40, 4) +
                          little(3, 4) + little(2, 4) + little(1, 2) + little(24, 2) + none +
                          little(24, 4) + std::string(16, '\0') + row + std::string(3, '\0') + row +
                          std::string(3, '\0');
  const std::string tga = std::string("\0\0\2\0\0\0\0\0\0\0\0\0", 12) + little(3, 2) +
                          little(2, 2) + std::string("\x18\0", 2) + texels;
  const std::string gif = "GIF89a" + little(1, 2) + little(1, 2) +
                          std::string("\x80\0\0\1\2\3\4\5\6,\0\0\0\0\1\0\1\0\0\2\2\x44\1\0;", 25);
  return {{"png", "rgba", TempFolder::read(folder.path() / "a.png")},
          {"exr", "half", TempFolder::read(folder.path() / "a.exr")},
          {"hdr", "rgbe",
           "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n" + std::string(24, '\x80')},
          {"bmp", "rgb", bmp},
          {"tga", "rgb", tga},
          {"gif", "grey", gif},
          {"tif", "grey", tiff()}};
}

std::vector<Seed> list_seeds() {
  return {{"csv", "rects", kCsv}, {"json", "rects", kJson}, {"txt", "light", kLight}};
}

}  // namespace atlas::test
