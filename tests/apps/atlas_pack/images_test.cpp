// Tests atlas-pack images, which packs sprites.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/image/image_io.h"
#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

TEST_F(AtlasPack, ImagesListWhatTheyWereMadeFrom) {
  fs::create_directories(dir_ / "in/sub dir");
  const atlas::Image8 image(8, 8, 3, 77);
  for (const char* name : {"in/b.png", "in/a.png", "in/sub dir/c.png"})
    ASSERT_TRUE(atlas::write_png(dir_ / name, image, {}).ok());
  write("in/notes.txt", "no image");
  const std::string inputs =
      ": \\\n  in \\\n  in/sub\\ dir \\\n  in/a.png \\\n  in/b.png \\\n  in/sub\\ dir/c.png\n";
  for (const auto& [options, target] : {std::pair("-o sheet --crop", "sheet.json"),
                                        {"-o sheet.json --crop", "sheet.json"},
                                        {"-o sheet.png --crop", "sheet.png"},
                                        {"-o many.png --no-alias --page 8x8", "many-0.png"},
                                        {"-o many --no-alias --page 8x8", "many-0.json"}}) {
    const RunResult r = run(fmt::format("images in {} --depfile sheet.d", options));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    EXPECT_EQ(read("sheet.d"), target + inputs) << options;
    EXPECT_TRUE(fs::exists(dir_ / target)) << options;
  }
  for (const char* refused :
       {"-o new --depfile new.png", "-o new --depfile new.json", "-o new --depfile in/new.d",
        "-o new --depfile 'in/sub dir/new.d'", "-o new --preview new.svg --depfile new.svg",
        "-o 'a;b' --depfile new.d", "-o new --no-alias --page 8x8 --depfile new-1.png"}) {
    EXPECT_EQ(run(fmt::format("images in {}", refused)).exit_code, 2) << refused;
    EXPECT_TRUE(!fs::exists(dir_ / "new.d") && !fs::exists(dir_ / "new.png") &&
                !fs::exists(dir_ / "new-0.png"))
        << refused;
  }
}

TEST_F(AtlasPack, SpritesKeepTheirTexels) {
  fs::create_directories(dir_ / "in/sub");
  const auto sprite = [](int w, int h, int border, int tint) {
    atlas::Image8 image(w, h, 4);
    for (int y = border; y < h - border; ++y)
      for (int x = border; x < w - border; ++x) {
        std::uint8_t* t = image.at(x, y);
        t[0] = static_cast<std::uint8_t>(x * 7);
        t[1] = static_cast<std::uint8_t>(y * 5);
        t[2] = static_cast<std::uint8_t>(tint);
        t[3] = 255;
      }
    return image;
  };
  const atlas::Image8 a = sprite(20, 12, 3, 10), c = sprite(6, 30, 0, 90);
  ASSERT_TRUE(atlas::write_png(dir_ / "in/a.png", a, {}).ok());
  ASSERT_TRUE(atlas::write_png(dir_ / "in/b.png", a, {}).ok());
  ASSERT_TRUE(atlas::write_png(dir_ / "in/sub/c.png", c, {}).ok());
  const RunResult r = run("images in -o sheet --page 48x24 --rotate --extrude 1 --padding 1");
  ASSERT_EQ(r.exit_code, 0) << r.output;
  const auto page = atlas::read_image8(dir_ / "sheet.png");
  ASSERT_TRUE(page.ok());
  const auto frames = nlohmann::json::parse(read("sheet.json"))["frames"];
  EXPECT_EQ(frames["a.png"]["frame"], frames["b.png"]["frame"]);  // identical images share a place
  for (const auto& [name, image] : {std::pair("a.png", &a), {"sub/c.png", &c}}) {
    const auto& f = frames[name];
    const int w = f["frame"]["w"], h = f["frame"]["h"];
    const int ox = f["spriteSourceSize"]["x"], oy = f["spriteSourceSize"]["y"];
    EXPECT_EQ(f["sourceSize"]["w"], image->width);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        // Reads the sprite back as a game does: y points down, and rotated sprites are turned
        // clockwise.
        const bool turned = f["rotated"];
        const int px = int(f["frame"]["x"]) + (turned ? h - 1 - y : x);
        const int py = int(f["frame"]["y"]) + (turned ? x : y);
        const std::uint8_t* got = page->at(px, page->height - 1 - py);
        const std::uint8_t* expected = image->at(ox + x, image->height - 1 - (oy + y));
        ASSERT_TRUE(std::equal(got, got + 4, expected)) << name << " " << x << " " << y;
      }
  }
}

TEST_F(AtlasPack, WhatIsNoFileInAFolderOfImagesIsNamed) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(atlas::write_png(dir_ / "in/a.png", atlas::Image8(4, 4, 3, 9), {}).ok());
  fs::create_symlink("gone", dir_ / "in/b.png");
  fs::create_directory_symlink(".", dir_ / "in/c");
  const RunResult r = run("images in -o out");
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("in/b.png: left out, no file to read"), std::string::npos) << r.output;
  EXPECT_NE(r.output.find("in/c: left out, a link to a folder"), std::string::npos) << r.output;
}

TEST_F(AtlasPack, APageThatStaysMostlyEmptyIsNamedWithTheOptionThatCutsIt) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(atlas::write_png(dir_ / "in/a.png", atlas::Image8(8, 8, 3, 9), {}).ok());
  const std::string words = "2048 x 2048 texels are mostly empty (--crop";
  EXPECT_NE(run("images in -o out").output.find(words), std::string::npos);
  const RunResult cropped = run("images in -o out --crop");
  EXPECT_EQ(cropped.output.find("empty"), std::string::npos) << cropped.output;
  ASSERT_TRUE(atlas::write_png(dir_ / "in/b.png", atlas::Image8(64, 64, 3, 7), {}).ok());
  const RunResult several = run("images in -o out --page 64x64");
  EXPECT_NE(several.output.find("out-1.png: 64 x 64 texels are mostly empty (--crop"),
            std::string::npos)
      << several.output;
}

// Starting from any page, the names lead to all others, and to no page twice.
TEST_F(AtlasPack, EachPageNamesTheDataOfAllOthers) {
  fs::create_directories(dir_ / "out");
  fs::create_directories(dir_ / "in");
  for (int k = 0; k < 3; ++k) {
    const auto color = static_cast<std::uint8_t>(50 * k);
    ASSERT_TRUE(
        atlas::write_png(dir_ / fmt::format("in/{}.png", k), atlas::Image8(40, 40, 3, color), {})
            .ok());
  }
  for (const char* format : {"hash", "array"}) {
    const RunResult r = run(fmt::format("images in -o out/a.b --page 48x48 --data {}", format));
    ASSERT_EQ(r.exit_code, 0) << r.output;
    std::size_t frames = 0;
    for (int page = 0; page < 3; ++page) {
      const auto data = nlohmann::json::parse(read(fmt::format("out/a.b-{}.json", page)));
      EXPECT_EQ(data["meta"]["image"], fmt::format("a.b-{}.png", page));
      std::set<std::string> pages{fmt::format("a.b-{}.json", page)};
      ASSERT_EQ(data["meta"]["related_multi_packs"].size(), 2u);
      for (const std::string name : data["meta"]["related_multi_packs"]) {
        EXPECT_TRUE(fs::exists(dir_ / "out" / name)) << name;
        pages.insert(name);
      }
      EXPECT_EQ(pages.size(), 3u);
      frames += data["frames"].size();
    }
    EXPECT_EQ(frames, 3u);
  }
  ASSERT_EQ(run("images in -o one --page 128x128").exit_code, 0);
  EXPECT_FALSE(nlohmann::json::parse(read("one.json"))["meta"].contains("related_multi_packs"));
}

// Folders list their files in any order.
TEST_F(AtlasPack, SpritesAreInTheOrderOfTheirNames) {
  fs::create_directories(dir_ / "in/f");
  std::set<std::string> names;
  for (int i = 0; i < 24; ++i) {
    const std::string name = fmt::format("{}{:02}.png", i % 3 ? "" : "f/", 7 * i % 24);
    names.insert(name);
    const auto level = static_cast<std::uint8_t>(10 * (i % 4));
    ASSERT_TRUE(atlas::write_png(dir_ / "in" / name, atlas::Image8(4, 4, 3, level), {}).ok());
  }
  ASSERT_EQ(run("images in -o s --page 64 --data array").exit_code, 0);
  const auto data = nlohmann::json::parse(read("s.json"));
  std::vector<std::string> listed;
  for (const auto& frame : data["frames"]) listed.push_back(frame["filename"]);
  EXPECT_EQ(listed, std::vector<std::string>(names.begin(), names.end()));
}

// Writes an image of 4 x 4 texels of a colour that no other name has.
void write_frames(const fs::path& folder, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    fs::create_directories((folder / names[i]).parent_path());
    ASSERT_TRUE(
        atlas::write_png(folder / names[i], atlas::Image8(4, 4, 3, std::uint8_t(9 * i)), {}).ok());
  }
}

TEST_F(AtlasPack, FramesComeInNaturalOrderAndAreAnimations) {
  const std::vector<std::string> names{
      "fall.png",   "run/1.png",    "run/2.png",   "run/12.png",  "walk_1.png",
      "walk_2.png", "walk_010.png", "walk_10.png", "walk_11.png", "walk_123456789012345678901.png",
      "wave 7.png"};
  write_frames(dir_ / "in", {names.rbegin(), names.rend()});
  for (const char* format : {"hash", "array"}) {
    ASSERT_EQ(run(fmt::format("images in -o s --page 64 --data {}", format)).exit_code, 0);
    const auto data = nlohmann::ordered_json::parse(read("s.json"));
    std::vector<std::string> listed;
    for (const auto& [key, frame] : data["frames"].items())
      listed.push_back(frame.contains("filename") ? std::string(frame["filename"]) : key);
    EXPECT_EQ(listed, names) << format;
    const auto& animations = data["animations"];
    EXPECT_EQ(animations.size(), 2u) << animations;
    EXPECT_EQ(animations["run"], nlohmann::json({"run/1.png", "run/2.png", "run/12.png"}));
    EXPECT_EQ(animations["walk"],
              nlohmann::json(std::vector<std::string>(names.begin() + 4, names.begin() + 10)));
  }
}

// The frames of an animation may lie on several pages; a loader finds them by their names.
TEST_F(AtlasPack, EachPageListsAllAnimations) {
  write_frames(dir_ / "in", {"a1.png", "a2.png", "a3.png", "b.png"});
  ASSERT_EQ(run("images in -o s --page 4x4").exit_code, 0);
  for (int page = 0; page < 4; ++page) {
    const auto data = nlohmann::json::parse(read(fmt::format("s-{}.json", page)));
    EXPECT_EQ(data["animations"], nlohmann::json({{"a", {"a1.png", "a2.png", "a3.png"}}}));
  }
  fs::remove(dir_ / "in/a2.png");
  fs::remove(dir_ / "in/a3.png");
  ASSERT_EQ(run("images in -o s --page 64").exit_code, 0);
  EXPECT_FALSE(nlohmann::json::parse(read("s.json")).contains("animations"));
}

// The data of each page tell the size of its own image.
TEST_F(AtlasPack, EachPageTellsItsOwnSize) {
  fs::create_directories(dir_ / "in");
  int level = 0;
  for (const auto& [width, height] : {std::pair(40, 40), {30, 35}, {25, 22}})
    ASSERT_TRUE(atlas::write_png(dir_ / fmt::format("in/{}.png", width),
                                 atlas::Image8(width, height, 3, std::uint8_t(++level)), {})
                    .ok());
  ASSERT_EQ(run("images in -o s --page 40x40 --crop").exit_code, 0);
  std::set<int> widths;
  for (int page = 0; page < 3; ++page) {
    const auto size = nlohmann::json::parse(read(fmt::format("s-{}.json", page)))["meta"]["size"];
    const auto image = atlas::read_image8(dir_ / fmt::format("s-{}.png", page));
    ASSERT_TRUE(image.ok());
    EXPECT_EQ(size["w"], image->width);
    EXPECT_EQ(size["h"], image->height);
    widths.insert(image->width);
  }
  EXPECT_EQ(widths, (std::set<int>{25, 30, 40}));
}

TEST_F(AtlasPack, PagesOfAnEarlierRunAreNamed) {
  fs::create_directories(dir_ / "in");
  for (int i = 0; i < 3; ++i) {
    const auto level = static_cast<std::uint8_t>(50 * i);
    const fs::path image = dir_ / fmt::format("in/{}.png", i);
    ASSERT_TRUE(atlas::write_png(image, atlas::Image8(40, 40, 3, level), {}).ok());
  }
  const std::string three = "images in -o out --page 40x40",
                    one = "images in -o out --page 128x128";
  EXPECT_EQ(run(three).output.find("earlier"), std::string::npos);
  EXPECT_TRUE(fs::exists(dir_ / "out-2.png"));
  const RunResult fewer = run(one);
  EXPECT_NE(fewer.output.find("out-0.png to out-2.png: of an earlier run"), std::string::npos)
      << fewer.output;
  const RunResult more = run(three);
  EXPECT_NE(more.output.find("out.png: of an earlier run"), std::string::npos) << more.output;
}

TEST_F(AtlasPack, TheNameOfAPageMayBeGivenWholeAndTheFilesAreNamed) {
  fs::create_directories(dir_ / "in");
  for (int i = 0; i < 3; ++i) {
    const auto level = static_cast<std::uint8_t>(50 * i);
    const fs::path image = dir_ / fmt::format("in/{}.png", i);
    ASSERT_TRUE(atlas::write_png(image, atlas::Image8(40, 40, 3, level), {}).ok());
  }
  for (const char* name : {"sheet", "sheet.png", "sheet.PNG", "sheet.json"}) {
    const RunResult r = run(fmt::format("images in -o {} --crop", name));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    EXPECT_EQ(r.output.find("sheet.png, sheet.json: 3 items on 1 page, "), 0u) << r.output;
    EXPECT_TRUE(fs::remove(dir_ / "sheet.png"));
    EXPECT_TRUE(fs::remove(dir_ / "sheet.json"));
  }
  const RunResult dotted = run("images in -o v1.2 --crop --preview p.svg");
  EXPECT_EQ(dotted.output.find("v1.2.png, v1.2.json, p.svg: 3 items"), 0u) << dotted.output;
  const RunResult several = run("images in -o out.png --page 40x40");
  EXPECT_EQ(several.output.find("out-0.png, out-0.json, out-1.png, ... out-2.json: 3 items"), 0u)
      << several.output;
  const auto summary = nlohmann::json::parse(run("images in -o out --page 40x40 --json").output);
  EXPECT_EQ(summary["files"].size(), 6u);
  for (const char* name : {"sheet.jpg", "sheet.ktx2", "sheet.KTX2", "sheet.avif", "sheet.plist"}) {
    const RunResult refused = run(fmt::format("images in -o {}", name));
    EXPECT_EQ(refused.exit_code, 2) << name;
    EXPECT_NE(refused.output.find(fmt::format("{}: pages are PNG images, and their data are JSON "
                                              "(name them NAME, NAME.png or NAME.json)",
                                              name)),
              std::string::npos)
        << refused.output;
    EXPECT_FALSE(fs::exists(dir_ / fmt::format("{}.png", name)));
  }
}

TEST_F(AtlasPack, NoSpriteIsWrittenOverThroughALink) {
  fs::create_directories(dir_ / "in");
  fs::create_directories(dir_ / "out");
  const fs::path sprite = dir_ / "in/a.png";
  ASSERT_TRUE(atlas::write_png(sprite, atlas::Image8(40, 40, 3, 9), {}).ok());
  for (const char* name : {"x.png", "x.json"}) {
    fs::create_symlink("../in/a.png", dir_ / "out" / name);
    const RunResult r = run("images in -o out/x --crop");
    EXPECT_EQ(r.exit_code, 2) << r.output;
    EXPECT_NE(r.output.find(fmt::format("out/{}: leads into the folder that is read", name)),
              std::string::npos)
        << r.output;
    const auto image = atlas::read_image8(sprite);
    ASSERT_TRUE(image.ok()) << "still the sprite";
    EXPECT_EQ(image->width, 40);
    fs::remove(dir_ / "out" / name);
  }
  EXPECT_EQ(run("images in -o out/x --crop").exit_code, 0);
}

// Such a page once took 14 GB before anything was drawn.
// A flat image of a few kilobytes is as large as its sides say, once it is decoded.
TEST_F(AtlasPack, ImagesLargerThanThePageAreRefusedBeforeTheyAreDecoded) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(atlas::write_png(dir_ / "in/flat.png", atlas::Image8(6000, 5000, 1), {9}).ok());
  EXPECT_LT(fs::file_size(dir_ / "in/flat.png"), 100'000u);
  const RunResult r = run("images in -o sheet --page 256x256");
  EXPECT_EQ(r.exit_code, 1) << r.output;
  EXPECT_NE(r.output.find("in/flat.png: 6000 x 5000 texels are more than the page of 256 x 256"),
            std::string::npos)
      << r.output;
  // What is trimmed may fit.
  atlas::Image8 small(600, 500, 4);
  small.at(300, 200)[3] = 255;
  fs::remove(dir_ / "in/flat.png");
  ASSERT_TRUE(atlas::write_png(dir_ / "in/small.png", small, {}).ok());
  EXPECT_EQ(run("images in -o sheet --page 256x256").exit_code, 0);
  EXPECT_NE(run("images in -o other --page 256x256 --no-trim").exit_code, 0);
}

TEST_F(AtlasPack, PagesThatNoMemoryHoldsAreRefused) {
  fs::create_directories(dir_ / "in");
  ASSERT_TRUE(atlas::write_png(dir_ / "in/a.png", atlas::Image8(8, 8, 3, 9), {}).ok());
  const RunResult r = run("images in -o out --page 60000x60000");
  EXPECT_EQ(r.exit_code, 2) << r.output;
  EXPECT_NE(r.output.find("60000 x 60000 texels takes 13 GiB (give a smaller --page, or --crop)"),
            std::string::npos)
      << r.output;
  EXPECT_EQ(run("images in -o out --page 60000x60000 --crop").exit_code, 0);
}

}  // namespace
}  // namespace atlas::test
