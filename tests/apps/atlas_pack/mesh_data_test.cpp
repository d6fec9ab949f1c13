// What atlas-pack mesh writes of odd meshes, and where charts lie on pages and in previews.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/core/vec.h"
#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

constexpr const char* kTriangle =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

TEST_F(AtlasPack, MaterialFilesHaveSafeNames) {
  write("m.obj", kTriangle);
  const RunResult r = run("mesh m.obj -o 'a #1.obj' --page 64");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const std::string obj = read("a #1.obj");
  const std::size_t at = obj.find("mtllib a__1-");
  ASSERT_NE(at, std::string::npos) << obj;
  const std::string name = obj.substr(at + 7, obj.find('\n', at) - at - 7);
  EXPECT_EQ(read(name), "newmtl page_0\nKd 1 1 1\n");
  EXPECT_TRUE(holds(r.output, name)) << r.output;
  // Nothing that is read is written over.
  write(name, "newmtl red\n");
  write("n.obj", "mtllib " + name + "\n" + kTriangle);
  EXPECT_EQ(run("mesh n.obj -o 'a #1.obj' --page 64").exit_code, 2);
  EXPECT_EQ(read(name), "newmtl red\n");
}

TEST_F(AtlasPack, MeshListsWhatItWasMadeFrom) {
  write("a.mtl", "newmtl red\n");
  write("m n.obj", std::string("mtllib a.mtl none.mtl\n") + kTriangle);
  const RunResult r = run("mesh 'm n.obj' -o out.obj --page 64 --depfile out.d");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_EQ(read("out.d"), "out.obj: \\\n  m\\ n.obj \\\n  a.mtl\n");
  for (const char* same : {"'m n.obj'", "a.mtl", "out.obj", "out.mtl"})
    EXPECT_EQ(run(fmt::format("mesh 'm n.obj' -o out.obj --page 64 --depfile {}", same)).exit_code,
              2)
        << same;
  // Before anything else is said of the mesh, such as that it has no uvs.
  write("no;uvs.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(run("mesh 'no;uvs.obj' -o new.obj --depfile new.d").exit_code, 2);
  write("none.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(run("mesh none.obj -o new.obj --depfile new.d").exit_code, 1);
  EXPECT_EQ(run("mesh 'm n.obj' -o 'a;b.obj' --page 64 --depfile new.d").exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(dir_ / "new.d") ||
               std::filesystem::exists(dir_ / "a;b.obj"));
}

TEST_F(AtlasPack, MeshOverwritesNoTextureThatItNeedNotRead) {
  write("a.mtl", "newmtl red\nmap_Kd wood.png\nmap_Ks shine.png\n");
  write("m.obj", std::string("mtllib a.mtl\nusemtl red\n") + kTriangle);
  for (const char* image : {"wood.png", "shine.png"}) {
    write(image, "an image");
    for (const char* option : {"--preview", "--depfile"}) {
      const RunResult r = run(fmt::format("mesh m.obj -o out.obj --page 64 {} {}", option, image));
      EXPECT_EQ(r.exit_code, 2) << r.output;
      EXPECT_TRUE(holds(r.output, "would overwrite")) << r.output;
      EXPECT_EQ(read(image), "an image") << option;
    }
  }
  EXPECT_EQ(run("mesh m.obj -o out.obj --page 64 --preview out.png").exit_code, 0);
}

// Returns the uvs of an OBJ in its order.
std::vector<Vec2d> uvs_of(const std::string& obj) {
  std::vector<Vec2d> uvs;
  std::istringstream lines(obj);
  Vec2d uv;
  for (std::string line; std::getline(lines, line);)
    if (std::sscanf(line.c_str(), "vt %lf %lf", &uv.x, &uv.y) == 2) uvs.push_back(uv);
  return uvs;
}

TEST_F(AtlasPack, TrianglesWithoutUvsStayAndAreCounted) {
  write("m.obj", std::string(kTriangle) + "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 4 5 6\nf 1 2 99\n");
  const RunResult r = run("mesh m.obj -o out.obj --page 64");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(holds(r.output, "atlas-pack: triangles without uvs, which get none: 1\n"));
  EXPECT_TRUE(holds(r.output, "atlas-pack: defect: 1 x ")) << r.output;
  EXPECT_TRUE(holds(read("out.obj"), "usemtl page_0\nf 1/1 2/2 3/3\nusemtl no_uv\nf 4 5 6\n"));
  EXPECT_EQ(read("out.mtl"), "newmtl page_0\nKd 1 1 1\nnewmtl no_uv\nKd 1 1 1\n");
  write("m.obj", kTriangle);
  const RunResult whole = run("mesh m.obj -o out.obj --page 64");
  EXPECT_FALSE(holds(whole.output, "without")) << whole.output;
  EXPECT_FALSE(holds(read("out.obj") + read("out.mtl"), "no_uv"));
}

TEST_F(AtlasPack, ChartsWithoutAnAreaAreCounted) {
  write("m.obj", std::string(kTriangle) +
                     "v 0 0 1\nv 1 0 1\nv 0 1 1\nvt 5 5\nvt 6 6\nvt 7 7\nf 4/4 5/5 6/6\n");
  const RunResult r = run("mesh m.obj -o out.obj --page 64 --preview p.png");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(
      holds(r.output, "charts without an area in uv or in space, which shrink to a point: 1"))
      << r.output;
  for (const Vec2d uv : uvs_of(read("out.obj")))
    EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
}

TEST_F(AtlasPack, BordersAreRoundedUpToCells) {
  write("m.obj", kTriangle);
  struct Case {
    const char* options;
    double border;
  };
  for (const Case& c : {Case{"", 0}, Case{"--border 5", 5}, Case{"--border 5 --align 8", 8},
                        Case{"--border 8 --align 8", 8}}) {
    const RunResult r =
        run(fmt::format("mesh m.obj -o out.obj --page 64 --padding 0 {}", c.options));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    double least = 64;
    for (const Vec2d uv : uvs_of(read("out.obj")))
      least = std::min({least, 64 * uv.x, 64 * uv.y, 64 - 64 * uv.x, 64 - 64 * uv.y});
    EXPECT_NEAR(least, c.border, 1) << c.options;
    EXPECT_GE(least, c.border - 1e-4) << c.options;
  }
  // Half of an odd padding is rounded up.
  ASSERT_EQ(run("mesh m.obj -o out.obj --page 64 --padding 5").exit_code, 0);
  for (const Vec2d uv : uvs_of(read("out.obj"))) EXPECT_GE(64 * std::min(uv.x, uv.y), 3 - 1e-4);
}

TEST_F(AtlasPack, SidesOfPagesArePowersOfTwoOrEqualWhereAsked) {
  // A strip ten times as long as wide.
  write("m.obj",
        "v 0 0 0\nv 10 0 0\nv 10 1 0\nv 0 1 0\nvt 0 0\nvt 10 0\nvt 10 1\nvt 0 1\n"
        "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  const auto page = [&](const std::string& options) {
    const RunResult r = run("mesh m.obj -o out.obj --json " + options);
    EXPECT_EQ(r.exit_code, 0) << r.output;
    const auto json = nlohmann::json::parse(r.output);
    EXPECT_EQ(json["files"].size(), 2u);
    double area = 0;  // of the strip, by its uvs
    const std::vector<Vec2d> uvs = uvs_of(read("out.obj"));
    for (const auto& [a, b] : {std::pair(1, 2), {2, 3}})
      area +=
          std::abs((uvs.at(std::size_t(a)).x - uvs[0].x) * (uvs.at(std::size_t(b)).y - uvs[0].y) -
                   (uvs.at(std::size_t(a)).y - uvs[0].y) * (uvs.at(std::size_t(b)).x - uvs[0].x)) /
          2;
    EXPECT_NEAR(double(json["utilization"]), area, 0.02) << options;
    return std::pair(int(json["pages"][0]["width"]), int(json["pages"][0]["height"]));
  };
  EXPECT_EQ(page("--page 200"), std::pair(200, 200));
  EXPECT_EQ(page("--page 200 --border 9"), std::pair(200, 200));
  // Along the diagonal, the strip would be longer, and the page all but empty.
  EXPECT_EQ(page("--page 200 --crop --padding 0"), std::pair(200, 20));
  for (const char* border : {"", " --border 9"}) {
    const auto [w, h] = page(std::string("--page 256 --crop --pot") + border);
    EXPECT_TRUE(std::has_single_bit(unsigned(w)) && std::has_single_bit(unsigned(h)))
        << w << " x " << h << border;
    EXPECT_LE(std::max(w, h), 256);
    const auto [a, b] = page(std::string("--page 200 --crop --square") + border);
    EXPECT_EQ(a, b);
    const RunResult r = run(std::string("mesh m.obj -o no.obj --page 200 --crop --pot") + border);
    EXPECT_EQ(r.exit_code, 2);
    EXPECT_TRUE(holds(r.output, "--page 200: with --pot it must be a power of two (give 128)"))
        << r.output;
  }
}

// The picture shows a chart's triangle, but not the other half of its box.
TEST_F(AtlasPack, PreviewsOfMeshesShowTriangles) {
  write("m.obj", kTriangle);
  ASSERT_EQ(run("mesh m.obj -o out.obj --page 64 --rotations 1 --preview p.png").exit_code, 0);
  const std::vector<Vec2d> uvs = uvs_of(read("out.obj"));
  ASSERT_EQ(uvs.size(), 3u);
  const Result<Image8> picture = read_image8(dir_ / "p.png");
  ASSERT_TRUE(picture.ok());
  const auto free = [&](Vec2d uv) {
    const std::uint8_t* texel = picture->at(int(64 * uv.x), int(64 * uv.y));
    return texel[0] == 51 && texel[1] == 51 && texel[2] == 51;
  };
  const Vec2d a = uvs[0], b = uvs[1], c = uvs[2];
  EXPECT_FALSE(free({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}));
  EXPECT_FALSE(free({0.8 * a.x + 0.1 * (b.x + c.x), 0.8 * a.y + 0.1 * (b.y + c.y)}));
  EXPECT_TRUE(free({0.6 * (b.x + c.x) - 0.2 * a.x, 0.6 * (b.y + c.y) - 0.2 * a.y}));
  ASSERT_EQ(run("mesh m.obj -o out.obj --page 64 --rotations 1 --preview p.svg").exit_code, 0);
  EXPECT_TRUE(holds(read("p.svg"),
                    fmt::format("d=\"M{:.2f} {:.2f}L{:.2f} {:.2f}L{:.2f} {:.2f}Z\"", 64 * a.x,
                                64 - 64 * a.y, 64 * b.x, 64 - 64 * b.y, 64 * c.x, 64 - 64 * c.y)))
      << read("p.svg");
  EXPECT_EQ(run("mesh m.obj -o out.obj --preview out.mtl").exit_code, 2);
  EXPECT_EQ(run("mesh m.obj -o out.obj --preview m.obj").exit_code, 2);
}

TEST_F(AtlasPack, VeryManyPagesOfAMeshAreNamedWithItsOwnOptions) {
  std::string text;
  for (int i = 0; i < 80; ++i) {
    text += fmt::format("v {0} 0 0\nv {1} 0 0\nv {1} 1 0\nv {0} 1 0\n", 2 * i, 2 * i + 1);
    text += fmt::format("vt {0} 0\nvt {1} 0\nvt {1} 1\nvt {0} 1\n", 2 * i, 2 * i + 1);
    text += "f -4/-4 -3/-3 -2/-2 -1/-1\n";
  }
  write("m.obj", text);
  const RunResult r = run("mesh m.obj -o out.obj --page 16 --pages 80 --padding 0");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  EXPECT_TRUE(holds(r.output,
                    "80 pages, each a texture of its own, are slow to load and to draw "
                    "(--page 32 --pages 20 takes about 20)"))
      << r.output;
}

}  // namespace
}  // namespace atlas::test
