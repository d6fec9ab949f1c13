// LoadedScene::unread_files, which programs must not write over.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/scene/load_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

TEST(UnreadFiles, AreThoseThatTheSceneNames) {
  const TempFolder folder;
  for (const char* name : {"a.png", "b.png", "c d.png", "e.png"}) folder.write(name, "image");
  const auto unread = [&](const std::string& name, const std::string& text, bool textures = false) {
    ReadOptions options;
    options.load_textures = textures;
    std::string names;
    for (const fs::path& path : load(folder.write(name, text), options).unread_files)
      names += path.filename().string() + ";";
    return names;
  };
  const std::string obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
  folder.write("m.mtl",
               "newmtl m\nmap_Kd a.png\nmap_Ks -s 2 2 -clamp on c d.png\n"
               "newmtl n\nmap_Kd -o 1 1 b.png\nnorm a.png\nbump none.png\nrefl -type sphere .\n");
  EXPECT_EQ(unread("s.obj", obj), "c d.png;a.png;b.png;");
  EXPECT_EQ(unread("s.obj", obj, true), "c d.png;b.png;");
  EXPECT_EQ(unread("s.ply",
                   "ply\nformat ascii 1.0\ncomment TextureFile e.png\nelement vertex 3\n"
                   "property float x\nproperty float y\nproperty float z\nelement face 1\n"
                   "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
                   "3 0 1 2\n"),
            "e.png;");
  EXPECT_EQ(unread("s.wrl",
                   "#VRML V2.0 utf8\nInline { url \"e.png\" }\nShape { appearance Appearance { "
                   "texture ImageTexture { url [\"none.png\" \"a.png\" \"c%20d.png\"] } }\n"
                   "geometry IndexedFaceSet { coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } "
                   "coordIndex [0 1 2 -1] } }\n"
                   "Shape { appearance Appearance { texture MovieTexture { loop TRUE url \"b.png\" "
                   "} } }\n"),
            "e.png;a.png;c d.png;b.png;");
  EXPECT_EQ(unread("s.gltf",
                   R"({"asset":{"version":"2.0"},"images":[{"uri":"a.png"},{"uri":"c%20d.png"},
                 {"uri":"data:image/png;base64,AAAA"}],"buffers":[{"byteLength":36,"uri":
                 "data:application/octet-stream;base64,)"
                   "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}],"
                   R"("bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,
                 "componentType":5126,"count":3,"type":"VEC3"}],
                 "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})"),
            "a.png;c d.png;");
}

}  // namespace
}  // namespace atlas::test
