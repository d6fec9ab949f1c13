// Tests what all formats of worlds have in common.
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <string>

#include "tests/exporters/kept_gltf.h"
#include "tests/exporters/worlds.h"
#include "tests/support/full_disk.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

const char* const kNames[] = {"w.wrl", "w.wrz", "w.obj", "w.gltf", "w.glb"};

// Two triangles with a common edge, on one page each.
World two_pages() {
  World world;
  world.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  world.uvs = {{0, 0}, {1, 0}, {0, 1}};
  world.pages.resize(2);
  world.pages[0].indices = {0, 1, 2};
  world.pages[1].indices = {2, 1, 3};
  for (Page& page : world.pages) page.uv_indices = {0, 1, 2};
  return world;
}

void expect_size(const WorldFile& written, const TempFolder& folder) {
  std::uintmax_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    bytes += entry.file_size();
  EXPECT_EQ(std::uintmax_t(written.bytes), bytes);
}

// Only OBJ shares positions and uvs among pages.
TEST(Worlds, WhatIsWrittenIsCounted) {
  for (const std::string name : kNames) {
    const TempFolder folder;
    const auto written = write_kept(two_pages(), folder / name);
    ASSERT_TRUE(written.ok()) << written.status().message();
    EXPECT_EQ(written->triangles, 2u) << name;
    EXPECT_EQ(written->vertices, name == "w.obj" ? 4u : 6u) << name;
    EXPECT_EQ(written->uvs, name == "w.obj" ? 3u : 6u) << name;
    expect_size(*written, folder);
  }
}

// A uv of tile n lies n mod 10 to the right and n / 10 above, with as many digits as in the first.
TEST(Worlds, OnlyObjHasUdimTiles) {
  World world = two_pages();
  world.uvs = {{0.25f, 0.125f}, {1, 0}, {0.1f, 0x1p-20f}, {0, 1}};
  world.uv_tiles = {0, 9, 10, 8998};
  world.pages[1].uv_indices = {2, 1, 3};
  const TempFolder folder;
  ASSERT_TRUE(write_kept(world, folder / "w.obj").ok());
  const std::string obj = TempFolder::read(folder / "w.obj");
  EXPECT_NE(obj.find("vt 0.25 0.125\nvt 10 0\nvt 0.1000000015 1.0000009537\nvt 8 900\n"),
            std::string::npos)
      << obj;
  for (const char* name : {"w.wrl", "w.wrz", "w.gltf", "w.glb"})
    EXPECT_EQ(write_kept(world, folder / name).status().code(), ErrorCode::bad_input) << name;
  world.uv_tiles.pop_back();
  EXPECT_EQ(write_kept(world, folder / "w.obj").status().code(), ErrorCode::bad_input);
}

// Each corner has a uv of its own here.
TEST(Worlds, WhatIsWrittenOfScenesIsCounted) {
  for (const std::string name : {"w.obj", "w.gltf", "w.glb"}) {
    const TempFolder folder;
    const Scene scene = small_scene();
    const auto written = write_kept(world_of(scene), folder / name);
    ASSERT_TRUE(written.ok()) << written.status().message();
    EXPECT_EQ(written->triangles, 4u) << name;
    EXPECT_EQ(written->vertices, name == "w.obj" ? 4u : 12u) << name;
    EXPECT_EQ(written->uvs, 12u) << name;
    expect_size(*written, folder);
  }
  const TempFolder folder;
  const WorldFile written = keep(folder.write("s.glb", textured(folder).glb()), folder / "w.glb");
  EXPECT_EQ(written.triangles, 1u);
  EXPECT_EQ(written.vertices, 3u);
  EXPECT_EQ(written.uvs, 3u);
}

// The material of a primitive says whether its triangles are seen from behind.
TEST(Worlds, OneSidedTrianglesAreAPrimitiveOfGltf) {
  for (const std::string name : {"w.gltf", "w.glb"}) {
    const TempFolder folder;
    World world = two_pages();
    ASSERT_TRUE(write_kept(world, folder / name).ok());
    const std::string plain = TempFolder::read(folder / name);
    Page& page = world.pages[0];
    page.indices.insert(page.indices.end(), {3, 1, 2});
    page.uv_indices.insert(page.uv_indices.end(), {2, 1, 0});
    page.one_sided = {true, false};
    const auto written = write_kept(world, folder / name);
    ASSERT_TRUE(written.ok()) << written.status().message();
    EXPECT_EQ(written->triangles, 3u);
    const GltfOracle file(folder / name);
    ASSERT_EQ(file.document["meshes"].size(), 2u);
    const auto triangles = file.triangles();
    ASSERT_EQ(triangles.size(), 3u);
    std::vector<bool> double_sided;
    for (const OracleTriangle& t : triangles)
      double_sided.push_back(
          file.document["materials"][std::size_t(t.material)].value("doubleSided", false));
    EXPECT_EQ(double_sided, (std::vector<bool>{true, false, true}));
    EXPECT_EQ(triangles[0].attributes.at("POSITION"),
              (std::vector<double>{1, 1, 0, 1, 0, 0, 0, 1, 0}));
    EXPECT_EQ(triangles[1].attributes.at("POSITION"),
              (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}));

    World same = two_pages();
    for (Page& p : same.pages) p.one_sided = {false};
    ASSERT_TRUE(write_kept(same, folder / name).ok());
    EXPECT_EQ(TempFolder::read(folder / name), plain);
  }
}

// OBJ has no word for it, and the order of its faces stays.
TEST(Worlds, OneSidedTrianglesAreNotToldInObj) {
  const TempFolder folder;
  World world = two_pages();
  ASSERT_TRUE(write_kept(world, folder / "w.obj").ok());
  const std::string plain = TempFolder::read(folder / "w.obj");
  for (Page& page : world.pages) page.one_sided = {true};
  ASSERT_TRUE(write_kept(world, folder / "w.obj").ok());
  EXPECT_EQ(TempFolder::read(folder / "w.obj"), plain);
  world.pages[1].one_sided = {true, false};
  const auto refused = write_kept(world, folder / "w.obj");
  EXPECT_EQ(refused.status().code(), ErrorCode::bad_input);
  EXPECT_NE(refused.status().message().find("2 values one_sided for 1 triangles"),
            std::string::npos);
}

TEST(Worlds, CancellingLeavesNothingBehind) {
  const std::atomic<bool> raised{true};
  Context context;
  context.cancel = &raised;
  const TempFolder folder;
  const Scene scene = small_scene();
  const auto loaded = read_scene(folder.write("s.glb", textured(folder).glb()), kGltfRest, {});
  ASSERT_TRUE(loaded.ok());
  for (const World& world : {two_pages(), world_of(scene), world_of(loaded->scene)}) {
    for (const char* name : kNames) {
      if (world.scene && !holds_scene(name)) continue;
      AtomicFiles files;
      EXPECT_EQ(write_world(world, folder / name, files, context).status().code(),
                ErrorCode::cancelled)
          << name;
    }
    EXPECT_EQ(folder.count(), 1u);  // what was read
  }
}

// Writing small worlds fails when the file is closed, writing large ones before that.
TEST(Worlds, AFullDiskIsNoticed) {
  const TempFolder folder;
  for (const int side : {5, 200}) {
    World world = wavy_world(side, 1);
    world.pages[0].image.clear();
    for (const char* name : kNames) {
      Status status;
      {
        AtomicFiles files;
        const FullDisk full(100);
        status = write_world(world, folder / name, files, {}).status();
      }
      EXPECT_EQ(status.code(), ErrorCode::io) << name << ' ' << side;
      EXPECT_EQ(folder.count(), 0u) << name;
    }
  }
}

// The file beside the world may be the larger one, and the only one that fails.
TEST(Worlds, AFullDiskIsNoticedInEveryFile) {
  World named = two_pages(), large = wavy_world(40, 1);
  named.pages[0].image = std::string(400, 'x') + ".png";
  large.pages[0].image.clear();
  Scene scene = small_scene();
  scene.materials[0].mtl_lines = {"Ns 1 #" + std::string(2000, 'x')};
  const struct {
    World world;
    const char *name, *named;
    rlim_t space;
  } cases[] = {{named, "w.obj", "w.mtl", 300},
               {world_of(scene), "w.obj", "w.mtl", 1500},
               {large, "w.gltf", "w.bin", 8192}};
  for (const auto& c : cases) {
    const TempFolder folder;
    Status status;
    {
      AtomicFiles files;
      const FullDisk full(c.space);
      status = write_world(c.world, folder / c.name, files, {}).status();
    }
    EXPECT_EQ(status.code(), ErrorCode::io) << c.named;
    EXPECT_NE(status.message().find(c.named), std::string::npos) << status.message();
    EXPECT_EQ(folder.count(), 0u) << c.named;
  }
}

TEST(Worlds, OriginsAreAddedToObj) {
  const TempFolder folder;
  World world = two_pages();
  world.origin = {4468000.25, -7, 0};
  ASSERT_TRUE(write_kept(world, folder / "w.obj").ok());
  const std::string obj = TempFolder::read(folder / "w.obj");
  EXPECT_NE(obj.find("\nv 4468000.25 -7 0\nv 4468001.25 -7 0\nv 4468000.25 -6 0\n"),
            std::string::npos)
      << obj;
  EXPECT_NE(obj.find("mtllib w.mtl\n"), std::string::npos) << "found in any folder";
}

// Viewers take names for URLs, which a '#' cuts off.
TEST(Worlds, MaterialFilesOfObjHaveSafeNames) {
  const TempFolder folder;
  const Scene scene = small_scene();
  for (const std::string stem : {"plain-2_b.v3", "caf\xc3\xa9 #%&'1", "two\nlines"}) {
    const std::string safe = safe_file_name(stem) + ".mtl";
    EXPECT_EQ(
        safe.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_."),
        std::string::npos)
        << safe;
    EXPECT_EQ(safe == stem + ".mtl", stem == "plain-2_b.v3");
    for (const World& world : {two_pages(), world_of(scene)}) {
      ASSERT_TRUE(write_kept(world, folder / (stem + ".obj")).ok());
      EXPECT_TRUE(std::filesystem::exists(folder / safe)) << safe;
      const std::string obj = TempFolder::read(folder / (stem + ".obj"));
      EXPECT_NE(("\n" + obj).find("\nmtllib " + safe + "\n"), std::string::npos) << obj;
      const auto back = read_scene(folder / (stem + ".obj"), {}, {});
      ASSERT_TRUE(back.ok()) << back.status().message();
      EXPECT_EQ(back->defects.count(DefectKind::material_file_missing), 0u) << safe;
    }
  }
  EXPECT_EQ(folder.count(), 6u) << "beside the .obj, under no other name";
}

// Pages hold light, so nothing may shine on them, and readers must see that they are unlit.
TEST(Worlds, PagesOfObjSayThatNothingLightsThem) {
  const TempFolder folder;
  World world = two_pages();
  world.pages[1].image = "w_1.png";
  ASSERT_TRUE(write_kept(world, folder / "w.obj").ok());
  EXPECT_EQ(TempFolder::read(folder / "w.mtl"),
            "newmtl page0\nKd 1 1 1\n"
            "newmtl page1\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nillum 0\nmap_Kd w_1.png\n");
  ASSERT_TRUE(write_png(folder / "w_1.png", Image8(2, 2, 3, 77), {}).ok());
  const auto back = read_scene(folder / "w.obj", {}, {});
  ASSERT_TRUE(back.ok()) << back.status().message();
  ASSERT_EQ(back->scene.materials.size(), 2u);
  for (const Material& material : back->scene.materials)
    EXPECT_EQ(material.unlit, material.name == "page1") << material.name;
}

// More lines than are formatted at once.
TEST(Worlds, LongListsAreWrittenInOrder) {
  const TempFolder folder;
  World world = two_pages();
  constexpr std::size_t kCount = 300000;
  world.positions.resize(kCount);
  for (std::size_t i = 0; i < kCount; ++i) world.positions[i] = {float(i), 0, 0};
  world.pages.resize(1);
  world.pages[0].indices.clear();
  for (std::uint32_t i = 0; i < kCount; ++i) world.pages[0].indices.push_back(i);
  world.pages[0].uv_indices.assign(kCount, 0);
  ASSERT_TRUE(write_kept(world, folder / "w.obj").ok());
  const std::string obj = TempFolder::read(folder / "w.obj");
  std::size_t expected = 0;
  for (std::size_t at = 0; (at = obj.find("\nv ", at)) != std::string::npos; ++at, ++expected)
    ASSERT_EQ(std::strtod(obj.c_str() + at + 3, nullptr), double(expected));
  EXPECT_EQ(expected, kCount);
}

TEST(Worlds, EachAxisAndListIsChecked) {
  const auto refused = [](auto spoil) {
    World world = two_pages();
    spoil(world);
    return check_world(world).code() == ErrorCode::bad_input;
  };
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(refused([](World&) {}));
  EXPECT_TRUE(refused([](World& w) { w.positions[1].x = kNan; }));
  EXPECT_TRUE(refused([](World& w) { w.positions[1].y = kNan; }));
  EXPECT_TRUE(refused([](World& w) { w.positions[1].z = kNan; }));
  EXPECT_TRUE(refused([](World& w) { w.origin.z = 1e39; }));
  EXPECT_TRUE(refused([](World& w) { w.pages[1].indices[0] = 4; }));
  EXPECT_TRUE(refused([](World& w) { w.pages[1].uv_indices[2] = 3; }));
  EXPECT_TRUE(refused([](World& w) { w.pages[0].indices = w.pages[0].uv_indices = {0, 1}; }));
  EXPECT_TRUE(refused([](World& w) { w.metres_per_unit = INFINITY; }));
  EXPECT_TRUE(refused([](World& w) { w.viewpoint.fov = 3.1416; }));
}

TEST(Worlds, NamesOfFilesAndFormats) {
  EXPECT_EQ(safe_file_name(""), "world");
  EXPECT_TRUE(check_world_extension("a.WRZ").ok());
  EXPECT_EQ(check_world_extension("a.stl").message(),
            "a.stl: the target must end in .wrl, .wrz, .obj, .gltf, .glb or .html");
  EXPECT_TRUE(check_world_extension({}).message().starts_with("no name given: the target must"));
}

}  // namespace
}  // namespace atlas::test
