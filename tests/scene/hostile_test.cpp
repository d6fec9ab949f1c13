// Wrong files: each must give an error of one line that names the file and says what to do.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>

#include "libatlas/core/clock.h"
#include "libatlas/scene/reader.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

struct HostileCase {
  const char* file;
  std::string bytes;
  ErrorCode code;
  const char* says;
};

const std::string kPly = "ply\nformat ascii 1.0\n";
const std::string kXyz = "property float x\nproperty float y\nproperty float z\n";

const std::string kOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n";
const std::string kStl =
    "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    "endloop endfacet\n";

const HostileCase kCases[] = {
    {"empty.obj", "", ErrorCode::bad_input, "empty.obj: is empty"},
    {"no_faces.obj", "v 0 0 0\n", ErrorCode::bad_input, "holds no face"},
    {"all_bad.obj", "v 0 0 0\nf 1 2 3\n", ErrorCode::bad_input, "all 1 faces are unusable"},
    {"short_vertex.obj", "v 0 0 0\nv 1 2\n", ErrorCode::bad_input, "short_vertex.obj:2:"},
    {"five.obj", "v 0 0 0 1 2\n", ErrorCode::bad_input, "five.obj:1:"},
    {"word.obj", "\n\nv 0 zero 0\n", ErrorCode::bad_input, "word.obj:3: 'zero'"},
    {"comma.obj", "v 0,5 0 0\n", ErrorCode::bad_input, "comma.obj:1: '0,5'"},
    {"corner.obj", "v 0 0 0\nf 1/ /2 3\n", ErrorCode::bad_input, "corner.obj:2:"},
    {"slashes.obj", "v 0 0 0\nf 1/// 1 1\n", ErrorCode::bad_input, "slashes.obj:2:"},
    {"float_index.obj", "v 0 0 0\nf 1.5 1 1\n", ErrorCode::bad_input,
     "float_index.obj:2: '1.5' is"},
    {"cut.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2", ErrorCode::bad_input, "cut.obj:5:"},
    {"empty_vt.obj", "vt\n", ErrorCode::bad_input, "empty_vt.obj:1:"},
    {"binary.obj", std::string("\0\1\2\n\0\xff\n", 7), ErrorCode::bad_input, "no triangle"},
    {"continued.obj", "v 0 0 0 \\\n", ErrorCode::bad_input, "no triangle"},
    {"mtl.obj", "mtllib mtl.obj.mtl\nv 0 0 0\n", ErrorCode::bad_input, "mtl.obj.mtl:2:"},
    {"option.obj", "mtllib option.obj.mtl\n", ErrorCode::bad_input, "-o of map_Kd needs a number"},
    {"gain.obj", "mtllib gain.obj.mtl\n", ErrorCode::bad_input, "-mm of map_Kd needs two numbers"},
    {"nameless.obj", "mtllib nameless.obj.mtl\n", ErrorCode::bad_input, "map_Kd names no file"},
    {"infinite.obj", "mtllib infinite.obj.mtl\n", ErrorCode::bad_input,
     "infinite.obj.mtl:2: 'inf'"},
    {"early.obj", "mtllib early.obj.mtl\n", ErrorCode::bad_input,
     "early.obj.mtl:2: map_Kd before the first newmtl"},
    {"colour.obj", "mtllib colour.obj.mtl\n", ErrorCode::bad_input, "three numbers, or one"},
    {"empty.ply", "", ErrorCode::bad_input, "empty.ply: is empty"},
    {"not.ply", "plan\n", ErrorCode::bad_input, "not.ply:1:"},
    {"headless.ply", "ply\nelement vertex 3\nend_header\n", ErrorCode::bad_input, "no format"},
    {"open.ply", kPly + "element vertex 3\n", ErrorCode::bad_input, "ends inside the header"},
    {"format.ply", "ply\nformat middle 1.0\n", ErrorCode::bad_input, "format.ply:2:"},
    {"count.ply", kPly + "element vertex many\n", ErrorCode::bad_input, "count.ply:3:"},
    {"early_property.ply", kPly + "property float x\n", ErrorCode::bad_input,
     "early_property.ply:3:"},
    {"nameless_property.ply", kPly + "element vertex 1\nproperty float\n", ErrorCode::bad_input,
     "nameless_property.ply:4:"},
    {"fractional_list.ply", kPly + "element face 1\nproperty list float int vertex_indices\n",
     ErrorCode::bad_input, "fractional_list.ply:4:"},
    {"list_x.ply",
     kPly + "element vertex 1\nproperty list uchar float x\nproperty float y\nproperty float z\n"
            "end_header\n1 0 0 0\n",
     ErrorCode::bad_input, "no x, y and z"},
    {"short_elements.ply",
     kPly + "element vertex 1\n" + kXyz +
         "element face 3\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n0\n0\n0",
     ErrorCode::bad_input, "all 3 faces are unusable"},
    {"half_corner.ply",
     kPly + "element vertex 1\n" + kXyz +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n2.5 0 0 0\n",
     ErrorCode::bad_input, "length 2.5"},
    {"letters_in_face.ply",
     kPly + "element vertex 1\n" + kXyz +
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 0\n"
         "3 0 a 0\n3 0 0 0\n",
     ErrorCode::bad_input, "letters_in_face.ply:12: no number for 'vertex_indices' of face 1"},
    {"negative.ply", kPly + "element vertex -3\n", ErrorCode::bad_input, "negative.ply:3:"},
    {"type.ply", kPly + "element vertex 1\nproperty quad x\n", ErrorCode::bad_input, "type.ply:4:"},
    {"xy.ply", kPly + "element vertex 1\nproperty float x\nend_header\n0\n", ErrorCode::bad_input,
     "no x, y and z"},
    {"huge.ply", kPly + "element vertex 18446744073709551615\n" + kXyz + "end_header\n0 0 0\n",
     ErrorCode::bad_input, "announced"},
    {"huge_faces.ply",
     "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + kXyz +
         "element face 4000000000\nproperty list uchar int vertex_indices\nend_header\n" +
         std::string(12, '\0'),
     ErrorCode::bad_input, "announced"},
    {"huge_list.ply",
     "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + kXyz +
         "element face 1\nproperty list uint int vertex_indices\nend_header\n" +
         std::string(12, '\0') + "\xff\xff\xff\xff",
     ErrorCode::bad_input, "incomplete"},
    {"nothing.ply", kPly + "element hole 18446744073709551615\nend_header\n", ErrorCode::bad_input,
     "no triangle"},
    {"letters.ply", kPly + "element vertex 2\n" + kXyz + "end_header\n0 0 0\n0 a 0\n",
     ErrorCode::bad_input, "letters.ply:9:"},
    {"cut_line.ply",
     kPly + "element vertex 2\n" + kXyz +
         "element face 3\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n"
         "3 0 1 0\n3 0 1 \n \n",
     ErrorCode::bad_input, "cut_line.ply: face 2 of 3 is incomplete, but the file ends before"},
    {"short_line.ply",
     kPly + "element vertex 2\n" + kXyz +
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n"
         "3 0 1\n3 0 1 0\n",
     ErrorCode::bad_input, "short_line.ply:12: no number for 'vertex_indices'"},
    {"faceless.ply",
     kPly + "element vertex 1\n" + kXyz + "element face 1\nproperty int a\nend_header\n0 0 0\n1\n",
     ErrorCode::bad_input, "no list vertex_indices"},
    {"hollow.ply",
     kPly + "element face 0\nproperty int a\nelement vertex 0\n" + kXyz + "end_header\n",
     ErrorCode::bad_input, "holds no face"},
    {"early.ply",
     kPly + "element face 1\nproperty list uchar int vertex_indices\nelement vertex 1\n" + kXyz +
         "end_header\n3 0 0 0\n0 0\n",
     ErrorCode::bad_input, "early.ply: vertex 1 of 1 is incomplete"},
    {"two.ply",
     kPly + "element vertex 3\n" + kXyz + "element vertex 1\n" + kXyz +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "nan 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n",
     ErrorCode::bad_input, "a second element 'vertex', of 1"},
    {"list.ply",
     kPly + "element vertex 1\n" + kXyz +
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n-1 0 0\n",
     ErrorCode::bad_input, "length -1"},
    {"empty.off", "", ErrorCode::bad_input, "empty.off: is empty"},
    {"not.off", "# a comment\nplan 3\n", ErrorCode::bad_input, "not.off:2:"},
    {"only.off", "OFF\n# nothing\n", ErrorCode::bad_input, "a header is announced"},
    {"counts.off", "OFF\n3\n0 0 0\n", ErrorCode::bad_input, "counts.off:2:"},
    {"negative.off", "OFF\n3 -1 0\n0 0 0\n", ErrorCode::bad_input, "negative.off:2:"},
    {"four.off", "4OFF\n1 0 0\n0 0 0 1\n", ErrorCode::unsupported, "four.off:1:"},
    {"four_flat.off", "4nOFF 3\n1 0 0\n0 0 0\n", ErrorCode::unsupported, "four_flat.off:1:"},
    {"flat.off", "nOFF 2\n1 0 0\n0 0\n", ErrorCode::unsupported, "flat.off:1:"},
    {"faceless.off", "OFF\n1 0 0\n0 0 0\n", ErrorCode::bad_input, "holds no face"},
    {"huge.off", "OFF\n18446744073709551615 1 0\n0 0 0\n", ErrorCode::bad_input, "announced"},
    {"huge_faces.off", "OFF\n1 4000000000 0\n0 0 0\n", ErrorCode::bad_input, "announced"},
    {"huge_face.off", kOff + "4000000000 0 1 2\n", ErrorCode::bad_input, "face 1 of 1 has"},
    {"cut_face.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", ErrorCode::bad_input,
     "face 2 of 2"},
    {"cut_vertex.off", "OFF\n3 1 0\n0 0 0\n1 0 0                   \n", ErrorCode::bad_input,
     "vertex 3 of 3"},
    {"word.off", "OFF\n3 1 0\n0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", ErrorCode::bad_input,
     "word.off:4: 'zero'"},
    {"two.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", ErrorCode::bad_input, "two.off:4:"},
    {"grey.off", "COFF\n1 0 0\n0 0 0 255\n", ErrorCode::bad_input, "grey.off:3:"},
    {"float_index.off", kOff + "3 0 1.5 2\n", ErrorCode::bad_input, "float_index.off:6:"},
    {"five_colours.off", "COFF\n1 0 0\n0 0 0 1 2 3 4 5\n", ErrorCode::bad_input,
     "five_colours.off:3:"},
    {"short_elements.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n0", ErrorCode::bad_input,
     "all 1 faces are unusable"},
    {"short_face.off", kOff + "3 0 1\n3 0 1 2\n", ErrorCode::bad_input, "short_face.off:6:"},
    {"all_bad.off", kOff + "3 0 1 7\n", ErrorCode::bad_input, "all 1 faces are unusable"},
    {"binary.off", "OFF BINARY\n\1\2\3", ErrorCode::bad_input, "cut short"},
    {"huge_binary.off", "OFF BINARY\n" + std::string(40, '\xff'), ErrorCode::bad_input,
     "cut short"},
    {"empty.stl", "", ErrorCode::bad_input, "empty.stl: is empty"},
    {"not.stl", "OFF\n1 0 0\n", ErrorCode::bad_input, "is it an STL file"},
    {"no_facet.stl", "solid nothing\nendsolid\n", ErrorCode::bad_input, "holds no face"},
    {"no_triangle.stl", std::string(84, '\0'), ErrorCode::bad_input, "holds no face"},
    {"cut.stl", std::string(80, ' ') + std::string("\2\0\0\0", 4) + std::string(99, '\0'),
     ErrorCode::bad_input, "take 184 bytes, but the file has 183"},
    {"huge.stl", std::string(80, ' ') + std::string(100, '\xff'), ErrorCode::bad_input,
     "4294967295 triangles are announced"},
    {"solid.stl", "solid " + std::string(74, '\0') + std::string("\3\0\0\0", 4),
     ErrorCode::bad_input, "3 triangles are announced"},
    {"open.stl", kStl, ErrorCode::bad_input, "'facet' or 'endsolid' should follow"},
    {"word.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n", ErrorCode::bad_input,
     "word.stl:4: 'zero'"},
    {"keyword.stl", kStl + "edge\n", ErrorCode::bad_input, "keyword.stl:8: 'edge'"},
    {"loopless.stl", "solid\nfacet normal 0 0 1 0\nouter loop\n", ErrorCode::bad_input,
     "'outer loop' should follow"},
    {"empty.gltf", "", ErrorCode::bad_input, "empty.gltf: is empty"},
    {"empty.glb", "", ErrorCode::bad_input, "empty.glb: is empty"},
    {"broken.gltf", "{\n\"asset\": {\n", ErrorCode::bad_input, "broken.gltf:3:"},
    {"list.gltf", "[]", ErrorCode::bad_input, "not an object"},
    {"none.gltf", R"({"asset":{"version":"2.0"}})", ErrorCode::bad_input, "no triangle"},
    {"first.gltf", R"({"asset":{"version":"1.0"},"meshes":{"a":{}}})", ErrorCode::unsupported,
     "glTF version 1.0; only 2.0 is read"},
    {"one.gltf", R"({"asset":{"version":1}})", ErrorCode::unsupported, "glTF version 1;"},
    {"two.gltf", R"({"asset":{"version":"2"}})", ErrorCode::bad_input, "no triangle"},
    {"draft.gltf", R"({"meshes":{"a":{"primitives":[]}}})", ErrorCode::unsupported,
     "glTF version 1;"},
    {"first.glb", std::string("glTF\1\0\0\0\x18\0\0\0\4\0\0\0\0\0\0\0{}  ", 24),
     ErrorCode::unsupported, "glTF version 1;"},
    {"second_scene.gltf",
     R"({"asset":{"version":"2.0"},"scene":1,"scenes":[{"nodes":[0]},{}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{}}]}]})",
     ErrorCode::bad_input, "scene 1 shows none of its 1 meshes"},
    {"map.gltf", R"({"asset":{"version":"2.0"},"nodes":{"a":{}}})", ErrorCode::bad_input,
     "'nodes' is not a list"},
    {"number.gltf", R"({"asset":{"version":"2.0"},"accessors":[7]})", ErrorCode::bad_input,
     "element 0 of 'accessors'"},
    {"byteless.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":0}]})",
     ErrorCode::bad_input, "buffer 0 has no byteLength"},
    {"deep.gltf",
     R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[') +
         std::string(100000, ']') + "}",
     ErrorCode::bad_input, "nested too deeply"},
    {"overflow.gltf", R"({"asset":{"version":"2.0"},"extras":-4.2e515})", ErrorCode::bad_input,
     "a number beyond all bounds"},
    {"primitives.gltf", R"({"asset":{"version":"2.0"},"meshes":[{"primitives":{}}]})",
     ErrorCode::bad_input, "'primitives' of mesh 0"},
    {"empty_scene.gltf",
     R"({"asset":{"version":"2.0"},"scenes":[{}],"nodes":[{}],"meshes":[{"primitives":[{"attributes":{}}]}]})",
     ErrorCode::bad_input, "scene 0 shows none of its 1 meshes"},
    {"meshless.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{}]})",
     ErrorCode::bad_input, "no triangle to work on: it holds no mesh"},
    {"extension.gltf", R"({"asset":{"version":"2.0"},"extensionsRequired":["ACME_mesh"]})",
     ErrorCode::unsupported, "ACME_mesh"},
    {"unversioned.gltf", R"({"asset":{"version":""}})", ErrorCode::unsupported,
     "glTF version \"\"; only 2.0"},
    {"buffer.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"uri":"gone.bin","byteLength":4}]})",
     ErrorCode::not_found, "gone.bin"},
    {"cycle.gltf",
     R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]})",
     ErrorCode::bad_input, "no tree"},
    {"node.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[7]}]})", ErrorCode::bad_input,
     "node 7"},
    {"short.glb", "glTF\2\0\0\0", ErrorCode::bad_input, "too short"},
    {"cut.glb", std::string("glTF\2\0\0\0\xff\0\0\0\4\0\0\0JSON{}  ", 24), ErrorCode::bad_input,
     "cut short"},
    {"chunk.glb", std::string("glTF\2\0\0\0\x18\0\0\0\xff\xff\xff\xffJSON{}  ", 24),
     ErrorCode::bad_input, "JSON chunk"},
    {"empty.wrl", "", ErrorCode::bad_input, "empty.wrl: is empty"},
    {"empty.wrz", "", ErrorCode::bad_input, "empty.wrz: is empty"},
    {"proto.wrl", "#VRML V2.0 utf8\nPROTO A [ ] { Group { } }\n", ErrorCode::bad_input,
     "PROTO is not supported, and it declares A"},
    {"route.wrl", "#VRML V2.0 utf8\nROUTE a.b c.d\n", ErrorCode::bad_input, "'TO' expected"},
    {"lines.wrl", "#VRML V2.0 utf8\nGroup { \"two\nlines\" }\n", ErrorCode::bad_input,
     "'\"two' where a field should be"},
    {"scene.xyz", "1 2 3\n", ErrorCode::unsupported, "no reader"},
};

class Hostile : public ::testing::TestWithParam<HostileCase> {};

TEST_P(Hostile, EndsInOneClearLine) {
  const HostileCase& c = GetParam();
  const TempFolder folder;
  folder.write("mtl.obj.mtl", "newmtl a\nKd red\n");
  folder.write("option.obj.mtl", "newmtl a\nmap_Kd -o a.png\n");
  folder.write("gain.obj.mtl", "newmtl a\nmap_Kd -mm 1 a.png\n");
  folder.write("nameless.obj.mtl", "newmtl a\nmap_Kd -clamp on\n");
  folder.write("infinite.obj.mtl", "newmtl a\nKd inf 0 0\n");
  folder.write("early.obj.mtl", "# a\nmap_Kd a.png\nnewmtl a\n");
  folder.write("colour.obj.mtl", "newmtl a\nKd 1 0.5\n");
  const auto path = folder.write(c.file, c.bytes);
  const auto loaded = read_scene(path, {}, {});
  ASSERT_FALSE(loaded.ok());
  const std::string& message = loaded.status().message();
  EXPECT_EQ(loaded.status().code(), c.code) << message;
  EXPECT_NE(message.find(c.says), std::string::npos) << message;
  EXPECT_NE(message.find('('), std::string::npos) << "names no remedy: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(peak_memory(), std::int64_t{1} << 30) << "allocated what the header announced";
}

INSTANTIATE_TEST_SUITE_P(Files, Hostile, ::testing::ValuesIn(kCases), [](const auto& test) {
  std::string name = test.param.file;
  for (char& ch : name) {
    if (ch == '.') ch = '_';
  }
  return name;
});

TEST(Reader, MissingFilesFoldersAndOptions) {
  const TempFolder folder;
  for (const char* extension : {".obj", ".ply", ".off", ".stl", ".gltf", ".glb"}) {
    const auto missing = read_scene(folder / (std::string("gone") + extension), {}, {});
    EXPECT_EQ(missing.status().code(), ErrorCode::not_found);
    const auto directory = folder / (std::string("folder") + extension);
    std::filesystem::create_directory(directory);
    const auto result = read_scene(directory, {}, {});
    EXPECT_EQ(result.status().code(), ErrorCode::io);
    EXPECT_NE(result.status().message().find("directory"), std::string::npos);
  }
  ReadOptions options;
  for (const double metres : {0.0, -1.0, HUGE_VAL, double(NAN)}) {
    options.metres_per_unit = metres;
    EXPECT_EQ(read_scene(folder / "any.obj", options, {}).status().code(), ErrorCode::bad_option)
        << metres;
  }
  EXPECT_NE(
      read_scene(folder / "plain", {}, {}).status().message().find("a name without an ending"),
      std::string::npos);
}

// Nobody writes to the pipe, so opening it would wait without end.
TEST(Reader, ReadsNoPipes) {
  const TempFolder folder;
  const auto pipe = folder / "pipe.obj";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Status status = read_scene(pipe, {}, {}).status();
  EXPECT_EQ(status.code(), ErrorCode::io);
  EXPECT_NE(status.message().find("pipe.obj: cannot be read: not a regular file"),
            std::string::npos)
      << status.message();
}

TEST(Reader, CancelEndsIt) {
  const TempFolder folder;
  const auto path = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::atomic<bool> raised{true};
  Context context;
  context.cancel = &raised;
  EXPECT_EQ(read_scene(path, {}, context).status().code(), ErrorCode::cancelled);
}

}  // namespace
}  // namespace atlas
