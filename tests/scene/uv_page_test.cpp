// What files say of the page that their uvs were made for.
#include "libatlas/scene/uv_page.h"

#include <gtest/gtest.h>

#include "libatlas/scene/reader.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using test::Gltf;
using test::kSquare;
using test::load_glb;
using test::TempFolder;

double uv_aspect_of(std::string_view line) {
  UvPages pages;
  pages.take(line);
  return pages.aspect_of("page0");
}

TEST(UvPage, TextsAreUnderstood) {
  EXPECT_EQ(uv_aspect_of(uv_page_text(2048, 512)), 4);
  EXPECT_EQ(uv_aspect_of("# " + uv_page_text(300, 1200)), 0.25);
  EXPECT_EQ(uv_aspect_of(uv_page_text(77, 77)), 1);
  for (const char* other :
       {"", "#", "# a scene", "uvs of 3 square pages, packed for 64 x 64 texels",
        "uvs of a page of ", "uvs of a page of 5", "uvs of a page of 5 x ", "uvs of a page of 5x5",
        "uvs of a page of 0 x 5 texels", "uvs of a page of 5 x -5 texels",
        "uvs of a page of 99999999999 x 5 texels", "uvs of a page of 2000000000 x 1 texels",
        "the uvs of a page of 5 x 5 texels", "uvs of page 0", "uvs of page -1: 8 x 2 texels",
        "uvs of page : 8 x 2 texels", "uvs of page 0: 8 x 0 texels", "uvs of page 1: 8 x 2 texels"})
    EXPECT_EQ(uv_aspect_of(other), 0) << other;
}

TEST(UvPage, TextsTellSizes) {
  UvPages one, square, several;
  one.take("# " + uv_page_text(2048, 512));
  EXPECT_EQ(one.page_of("any"), (UvPage{0, 2048, 512}));
  square.take(uv_page_text(1024, 1024));
  EXPECT_EQ(square.page_of("any"), (UvPage{0, 1024, 1024}));
  EXPECT_EQ(square.pages_of(), std::vector<UvPage>{square.page_of("any")});
  several.take(uv_page_text(3, 64, 32));
  several.take(uv_page_text(1, 32, 64));
  EXPECT_EQ(several.page_of("page3"), (UvPage{3, 64, 32}));
  EXPECT_EQ(several.pages_of(), (std::vector<UvPage>{{1, 32, 64}, {3, 64, 32}}));
  EXPECT_EQ(UvPages().page_of("page3"), UvPage{});
  EXPECT_TRUE(UvPages().pages_of().empty());
}

TEST(UvPage, SeveralPagesAreFoundByTheNamesOfMaterials) {
  UvPages pages;
  pages.take("# " + uv_page_text(0, 64, 32));
  pages.take("\"" + uv_page_text(1, 32, 64) + "\"");
  pages.take(uv_page_text(12, 64, 16));
  pages.take(uv_page_text(12, 64, 64));
  EXPECT_EQ(pages.aspect_of("page0"), 2);
  EXPECT_EQ(pages.aspect_of("page1_one_sided"), 0.5);
  EXPECT_EQ(pages.aspect_of("scene_12.png"), 4);
  for (const char* other : {"", "page", "page2", "page99999999999", "1page", "page1.001"})
    EXPECT_EQ(pages.aspect_of(other), 0) << other;
}

// Where lines name a set of uvs, each says the page of that set alone.
TEST(UvPage, MayBeOfOneSetOfUvs) {
  UvPages pages;
  pages.take(of_uv_set(1, uv_page_text(40, 10)));
  pages.take(of_uv_set(1, uv_page_text(10, 10)));
  pages.take(of_uv_set(3, uv_page_text(0, 64, 32)));
  EXPECT_EQ(pages.aspect_of("page0", 1), 4);
  EXPECT_EQ(pages.aspect_of("page0", 3), 2);
  EXPECT_EQ(pages.aspect_of("page0"), 0);
  EXPECT_EQ(pages.aspect_of("page0", 2), 0);
  pages.take(uv_page_text(10, 40));
  EXPECT_EQ(pages.aspect_of("page0"), 0.25);
  EXPECT_EQ(pages.aspect_of("page0", 1), 4);
  EXPECT_EQ(of_uv_set(2, of_uv_set(1, "line")), of_uv_set(1, "line"));
}

TEST(UvPage, TellsWhichSetALineIsAbout) {
  EXPECT_EQ(uv_set_of_page(uv_page_text(40, 10)), 0);
  EXPECT_EQ(uv_set_of_page(uv_page_text(7, 40, 10)), 0);
  EXPECT_EQ(uv_set_of_page(of_uv_set(12, uv_page_text(10, 10))), 12);
  for (const char* other : {"", "TEXCOORD_1", "TEXCOORD_1: ", "TEXCOORD_: uvs of a square page",
                            "TEXCOORD_-1: uvs of a square page", "TEXCOORD_1: a square page",
                            "TEXCOORD_1 uvs of a square page", "the new uvs: TEXCOORD_1"})
    EXPECT_FALSE(uv_set_of_page(other)) << other;
}

TEST(UvPage, IsReadFromTheHeadOfAnObj) {
  const TempFolder folder;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                    line = "# " + uv_page_text(40, 10);
  const auto aspect = [&](const std::string& text) {
    const auto loaded = read_scene(folder.write("scene.obj", text), {}, {});
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return loaded->uv_aspect;
  };
  EXPECT_EQ(aspect(line + "\n" + triangle), 4);
  EXPECT_EQ(aspect("# name\r\n" + line + "\r\n" + triangle), 4);
  EXPECT_EQ(aspect(triangle), 0);
  EXPECT_EQ(aspect("# name\n" + triangle + line), 0) << "not at the head";
}

TEST(UvPage, DiffersBetweenMaterials) {
  const TempFolder folder;
  const auto read = [&](const std::string& head) {
    auto loaded = read_scene(
        folder.write("scene.obj", head + "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl page1\nf 1 2 3\n"
                                         "usemtl page0\nf 3 2 1\nusemtl wood\nf 2 3 1\n"),
        {}, {});
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return std::move(*loaded);
  };
  const std::string first = "# " + uv_page_text(0, 64, 32) + "\n";
  const LoadedScene unlike = read(first + "# " + uv_page_text(1, 32, 64) + "\n");
  EXPECT_EQ(unlike.uv_aspect, 0);
  EXPECT_EQ(unlike.material_uv_aspects, (std::vector<double>{0.5, 2, 1}));
  const LoadedScene alike = read("# " + uv_page_text(40, 10) + "\n");
  EXPECT_EQ(alike.uv_aspect, 4);
  EXPECT_TRUE(alike.material_uv_aspects.empty());
}

TEST(UvPage, IsReadFromTheExtrasOfAGltf) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.single({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  const auto aspect = [&](const test::json& extras) {
    g.j["asset"]["extras"] = extras;
    const auto loaded = load_glb(folder, g);
    EXPECT_TRUE(loaded.ok()) << loaded.status().message();
    return loaded->uv_aspect;
  };
  EXPECT_EQ(aspect({{"info", {"other", uv_page_text(40, 10)}}}), 4);
  EXPECT_EQ(aspect({{"info", {1, test::json::object(), nullptr}}}), 0);
  EXPECT_EQ(aspect({{"info", uv_page_text(40, 10)}}), 0);
  EXPECT_EQ(aspect("text"), 0);
}

// The shape of one set's page is not that of the set that a material uses, unless both refer to the
// same data.
TEST(UvPage, OfAGltfIsThatOfTheSetThatIsRead) {
  const TempFolder folder;
  Gltf g;
  const int positions = g.floats(kSquare, "VEC3", 3),
            uvs = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2),
            others = g.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2", 2);
  const int indices = g.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  g.j["images"] = {{{"uri", "none.png"}}};
  g.j["textures"] = {{{"source", 0}}};
  g.single({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", others}, {"TEXCOORD_1", uvs}}},
            {"indices", indices},
            {"material", 0}});
  g.j["asset"]["extras"] = {{"info", {of_uv_set(1, uv_page_text(40, 10))}}};
  for (const int set : {0, 1}) {
    g.j["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", set}}}}}}};
    const auto loaded = load_glb(folder, g);
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->uv_aspect, set == 1 ? 4 : 0);
    Gltf shared = g;
    shared.j["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs;
    EXPECT_EQ(load_glb(folder, shared)->uv_aspect, 4);
  }
}

}  // namespace
}  // namespace atlas
