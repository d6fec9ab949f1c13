// The same files with the line ends of three systems, and with the byte order mark that editors
// write.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "libatlas/scene/files/file_bytes.h"
#include "libatlas/scene/reader.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::TempFolder;

std::string with_ends(const std::string& text, const std::string& end) {
  std::string result;
  for (const char c : text) c == '\n' ? result += end : result += c;
  return result;
}

struct TextFile {
  const char* name;
  std::string text;
};

const TextFile kFiles[] = {
    {"a.obj",
     "# by a test\nmtllib a.mtl\nv 0 0 0 1 2 3\nv 1 0 0 1 2 3\nv 0 1 \\\n0 1 2 3\n# end\n"
     "usemtl m\nf 1// 2/ 3\n"},
    {"a.off", "OFF\n# by a test\n3 1 0\n0 0 0 # first\n1 0 0\n0 1 0\n3 0 1 2\n"},
    {"a.stl",
     "solid by a test\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
     "endloop\nendfacet\nendsolid by a test\n"},
    {"a.ply",
     "ply\nformat ascii 1.0\ncomment by a test\nCreated by an old Blender\nelement vertex 3\n"
     "property float x\nproperty float y\nproperty float z\nelement face 1\n"
     "property list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
    {"a.wrl",
     "#VRML V2.0 utf8\n# by a test\nShape { geometry IndexedFaceSet {\ncoord Coordinate { point [ "
     "0 "
     "0 0 1 0 0 0 1 0 ] } # three\ncoordIndex [ 0 1 2 -1 ] } }\n"},
};

TEST(LineEnds, OfAnyKindAndMixed) {
  const TempFolder folder;
  for (const TextFile& file : kFiles) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
      for (const bool marked : {false, true}) {
        for (const bool cut : {false, true}) {  // the last line may lack its line end
          std::string bytes = (marked ? "\xef\xbb\xbf" : "") + with_ends(file.text, end);
          if (cut) bytes.resize(bytes.size() - end.size());
          folder.write("a.mtl", with_ends("# by a test\nnewmtl m\nKd 0 1 0\n", end));
          const auto loaded = read_scene(folder.write(file.name, bytes), {}, {});
          const std::string what = fmt::format("{} {} {}", file.name, end.size(), end == "\r");
          ASSERT_TRUE(loaded.ok()) << what << ": " << loaded.status().message();
          EXPECT_EQ(loaded->scene.indices, (std::vector<std::uint32_t>{0, 1, 2})) << what;
          EXPECT_EQ(loaded->scene.positions[2], (Vec3f{0, 1, 0})) << what;
          EXPECT_TRUE(loaded->defects.empty()) << what << ": " << loaded->defects.lines()[0];
        }
      }
    }
    // Another program has added a line.
    const auto loaded =
        read_scene(folder.write(file.name, with_ends(file.text, "\r") + "\n"), {}, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.triangle_count(), 1u);
  }
}

TEST(LineEnds, OfMaterialsAndIllumination) {
  const TempFolder folder;
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    folder.write("a.mtl", with_ends("# green\nnewmtl m # a\nKd 0 1 0\nnewmtl n\n", end));
    ReadOptions options;
    options.illumination_file =
        folder.write("light.txt", with_ends("# lux\n1 2 3\n4\n5 6 7 # last", end));
    const auto path = folder.write("a.obj", kFiles[0].text);
    const auto loaded = read_scene(path, options, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->scene.materials[0].diffuse, (Vec3f{0, 1, 0}));
    EXPECT_EQ(loaded->scene.illumination[1], (Vec3f{4, 4, 4}));
  }
}

// What follows the line end of the header's last line belongs to the data, even if it is a
// newline's byte.
TEST(LineEnds, OfBinaryPly) {
  const TempFolder folder;
  for (const std::string end : {"\n", "\r\n", "\r\r\n", "\r"}) {
    for (const std::uint32_t first : {0x0a0a0a0au, 0x0d0d0d0du, 0x0a0d0a0du, 0x0d0a0d0au, 0u}) {
      std::string bytes = with_ends(
          "ply\nformat binary_little_endian 1.0\ncomment File exported by a test\n"
          "element vertex 3\nproperty int x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n",
          end);
      const float yz[3][2] = {{0, 0}, {1, 0}, {0, 1}};
      for (const auto& row : yz) {
        bytes.append(reinterpret_cast<const char*>(&first), 4);
        bytes.append(reinterpret_cast<const char*>(row), 8);
      }
      const std::int32_t corners[3] = {0, 1, 2};
      bytes += '\3';
      bytes.append(reinterpret_cast<const char*>(corners), 12);
      const auto loaded = read_scene(folder.write("a.ply", bytes), {}, {});
      ASSERT_TRUE(loaded.ok()) << loaded.status().message();
      const Scene& s = loaded->scene;
      EXPECT_EQ(s.origin.x + double(s.positions[0].x), double(first)) << first << " " << end.size();
      EXPECT_EQ(s.origin.z + double(s.positions[2].z), 1) << first << " " << end.size();
    }
  }
}

TEST(TextFiles, LineEndsInGzipFiles) {
  const TempFolder folder;
  const std::filesystem::path path = folder / "s.wrz";
  const gzFile file = gzopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  EXPECT_GT(gzputs(file, "\xef\xbb\xbf#a\rb\r\nc\n\rd"), 0);
  gzclose(file);
  EXPECT_EQ(*read_text_or_gzip(path), "#a\nb\r\nc\n\nd\n");
}

// A file that is intact, but holds more than can be read, is not called damaged.
TEST(TextFiles, TooMuchTextInAGzipFileIsToldApartFromDamage) {
  const TempFolder folder;
  const std::filesystem::path path = folder / "s.wrz";
  const gzFile file = gzopen(path.c_str(), "wb");
  ASSERT_NE(file, nullptr);
  const std::string text(5 << 20, 'a');
  EXPECT_GT(gzwrite(file, text.data(), unsigned(text.size())), 0);
  gzclose(file);
  EXPECT_EQ(read_text_or_gzip(path)->size(), text.size() + 1);
  const auto much = read_text_or_gzip(path, std::size_t{3} << 20);
  EXPECT_EQ(much.status().code(), ErrorCode::unsupported);
  EXPECT_NE(much.status().message().find("holds 3 MiB of text or more"), std::string::npos)
      << much.status().message();
  const std::string bytes = TempFolder::read(path);
  const auto cut = read_text_or_gzip(folder.write("cut.wrz", bytes.substr(0, bytes.size() / 2)));
  EXPECT_EQ(cut.status().code(), ErrorCode::bad_input);
}

}  // namespace
}  // namespace atlas
