// Tests the images of a World::scene that was read from glTF: those in formats that glTF holds only
// by extensions keep their bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/scene/check_scene.h"
#include "tests/exporters/kept_gltf.h"

namespace atlas::test {
namespace {

using Lines = std::vector<std::string>;

// One texel in WebP's lossless form.
const std::string kWebp(
    "RIFF\x1a\0\0\0WEBPVP8L\x0d\0\0\0\x2f\0\0\0\x10\7\x10\x11\x11\x88\x88\xfe\7\0", 34);

struct Format {
  const char *extension, *ending, *mime_type;
  std::string bytes;  // of lengths that are no multiples of 4
};

const Format kFormats[] = {
    {"EXT_texture_webp", ".webp", "image/webp", kWebp},
    {"KHR_texture_basisu", ".ktx2", "image/ktx2", "\xabKTX 20\xbb\r\n\x1a\nxyz"},
    {"KHR_texture_ktx", ".ktx", "image/ktx", "\xabKTX 11\xbb\r\n\x1a\nx"},
    {"MSFT_texture_dds", ".dds", "image/vnd-ms.dds", "DDS |xyzabc"},
    {"EXT_texture_avif", ".avif", "image/avif", std::string("\0\0\0\x1c", 4) + "ftypavif-"},
    {"ACME_texture_jxr", ".jxr", "image/jxr", "II\xbc\x01yz"},
};

std::vector<char> chars(const std::string& bytes) {
  return {bytes.begin(), bytes.end()};
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63];
  }
  return text;
}

// Where a file has an image.
enum class Where { view, file, data };

// Adds an image, and returns its number.
std::size_t add_image(const TempFolder& folder, const Format& format, Where where, Gltf& gltf) {
  json image = {{"name", format.extension}, {"extras", {{"by", "hand"}}}};
  const std::string type = format.mime_type;
  if (where == Where::view) image["bufferView"] = gltf.view(chars(format.bytes));
  if (where == Where::view || type == "image/jxr") image["mimeType"] = type;
  if (where == Where::data) image["uri"] = "data:" + type + ";base64," + base64(format.bytes);
  if (where == Where::file) {
    std::filesystem::create_directories(folder / "in");
    std::filesystem::create_directories(folder / "wood ä");
    folder.write(std::string("wood ä/a b") + format.ending, format.bytes);
    image["uri"] = std::string("../wood%20%C3%A4/a%20b") + format.ending;
  }
  gltf.j["images"].push_back(std::move(image));
  return gltf.j["images"].size() - 1;
}

// A triangle whose base colour is a PNG file, and its emission an image of the format.
Gltf with_image(const TempFolder& folder, const Format& format, Where where) {
  Gltf gltf = textured(folder);
  const std::size_t image = add_image(folder, format, where, gltf);
  gltf.j["textures"].push_back({{"extensions", {{format.extension, {{"source", image}}}}}});
  gltf.j["materials"][0]["emissiveTexture"] = {{"index", 1}};
  gltf.j["extensionsUsed"] = gltf.j["extensionsRequired"] = {format.extension};
  if (format.mime_type == std::string("image/jxr")) gltf.j.erase("extensionsRequired");
  return gltf;
}

std::filesystem::path write_input(const TempFolder& folder, const Gltf& gltf) {
  std::filesystem::create_directories(folder / "in");
  return folder.write("in/s.glb", gltf.glb());
}

void expect_same_image(const GltfOracle& after, const Format& format, const json& before) {
  ASSERT_EQ(after.document["images"].size(), 2u);
  EXPECT_EQ(after.image(1), format.bytes) << format.extension;
  const json& image = after.document["images"][1];
  EXPECT_EQ(image["mimeType"], format.mime_type);
  EXPECT_EQ(image["name"], format.extension);
  EXPECT_EQ(image["extras"]["by"], "hand");
  EXPECT_EQ(after.document["textures"], before["textures"]);
  EXPECT_EQ(after.document["materials"], before["materials"]);
  EXPECT_EQ(after.document["extensionsUsed"], json{format.extension});
  EXPECT_EQ(after.document.value("extensionsRequired", json()),
            before.value("extensionsRequired", json()));
}

TEST(KeptImages, KeepTheirBytesAndTheirExtension) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "out");
  for (const Format& format : kFormats) {
    for (const Where where : {Where::view, Where::file, Where::data}) {
      const Gltf gltf = with_image(folder, format, where);
      const auto input = write_input(folder, gltf);
      for (const std::string name : {"w.glb", "w.gltf"}) {
        const auto output = folder / ("out/" + name), again = folder / ("out/again_" + name);
        EXPECT_EQ(keep(input, output).not_kept, Lines{});
        const GltfOracle after(folder / ("out/" + name));
        expect_same_image(after, format, gltf.j);
        EXPECT_EQ(keep(output, again).not_kept, Lines{});
        expect_same_image(GltfOracle(again), format, gltf.j);
        if (name == "w.glb") continue;
        const std::string file = after.document["images"][1]["uri"];
        const bool named = format.mime_type != std::string("image/jxr") || where == Where::file;
        EXPECT_EQ(file, std::string("w_texture1") + (named ? format.ending : ".bin"));
      }
    }
  }
}

// In a .glb, what follows an image begins at a multiple of 4 bytes.
TEST(KeptImages, LeaveDataAligned) {
  const TempFolder folder;
  for (const Format& format : kFormats) {
    const auto input = write_input(folder, with_image(folder, format, Where::view));
    keep(input, folder / "w.glb");
    const json document = GltfOracle(folder / "w.glb").document;
    EXPECT_GT(document["bufferViews"].size(), 1u);
    for (const json& view : document["bufferViews"])
      EXPECT_EQ(view["byteOffset"].get<int>() % 4, 0);
  }
}

// Reading one does not need what it cannot decode, and says nothing of what is kept.
TEST(KeptImages, MayBeBaseColours) {
  const TempFolder folder;
  for (const Format& format : kFormats) {
    Gltf gltf = with_image(folder, format, Where::file);
    const auto emissive = read_scene(write_input(folder, gltf), kGltfRest, {});
    ASSERT_TRUE(emissive.ok()) << emissive.status().message();
    EXPECT_EQ(emissive->scene.textures.size(), 1u);  // no other one is decoded
    gltf.j["materials"][0].erase("emissiveTexture");
    gltf.j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
    const auto loaded = read_scene(write_input(folder, gltf), kGltfRest, {});
    ASSERT_TRUE(loaded.ok()) << loaded.status().message();
    EXPECT_EQ(loaded->defects.lines(), Lines{});
    EXPECT_EQ(check_scene(loaded->scene).message(), "");
    const bool webp = format.bytes == kWebp;
    EXPECT_EQ(loaded->scene.materials[0].texture, webp ? 1 : -1);
    EXPECT_EQ(loaded->scene.textures.size(), webp ? 2u : 1u);
    EXPECT_EQ(std::count(loaded->files.begin(), loaded->files.end(),
                         folder / (std::string("in/../wood ä/a b") + format.ending)),
              1);
    ASSERT_TRUE(write_kept(world_of(loaded->scene), folder / "w.glb").ok());
    expect_same_image(GltfOracle(folder / "w.glb"), format, gltf.j);
  }
}

// A scene without its source has the same textures as ever.
TEST(KeptImages, BecomePlainOnesWithoutTheirFile) {
  const TempFolder folder;
  Gltf gltf = with_image(folder, kFormats[0], Where::view);
  gltf.j["materials"][0].erase("emissiveTexture");
  gltf.j["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
  auto loaded = read_scene(write_input(folder, gltf), kGltfRest, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  loaded->scene.source = nullptr;
  ASSERT_TRUE(write_kept(world_of(loaded->scene), folder / "w.glb").ok());
  const GltfOracle after(folder / "w.glb");
  EXPECT_EQ(after.document["images"][0]["mimeType"], "image/png");
  EXPECT_EQ(after.image(0).substr(1, 3), "PNG");
  EXPECT_FALSE(after.document.contains("extensionsUsed"));
}

// An image in two formats keeps both, or the one that is there.
TEST(KeptImages, KeepBothForms) {
  const TempFolder folder;
  for (const std::string gone : {"", "png", "webp", "both"}) {
    Gltf gltf = with_image(folder, kFormats[0], Where::view);
    const json absent = {{"uri", "gone.png"}};
    if (gone == "png" || gone == "both") gltf.j["images"][0] = absent;
    if (gone == "webp" || gone == "both") gltf.j["images"][1] = absent;
    gltf.j["textures"][1]["source"] = 0;
    gltf.j.erase("extensionsRequired");
    gltf.j["materials"][0].erase("pbrMetallicRoughness");
    const WorldFile written = keep(write_input(folder, gltf), folder / "w.glb");
    EXPECT_EQ(written.not_kept, gone == "both" ? Lines{kNoImage} : Lines{});
    const json after = GltfOracle(folder / "w.glb").document;
    EXPECT_EQ(after.value("images", json::array()).size(), gone == "both" ? 0u
                                                           : gone.empty() ? 2u
                                                                          : 1u);
    const json of_webp = {{"EXT_texture_webp", {{"source", gone == "png" ? 0 : 1}}}};
    json expected = json::object();
    if (gone.empty() || gone == "webp") expected["source"] = 0;
    if (gone.empty() || gone == "png") expected["extensions"] = of_webp;
    EXPECT_EQ(after["textures"][1], expected) << gone;
    EXPECT_EQ(after["materials"][0].contains("emissiveTexture"), gone != "both");
  }
}

TEST(KeptImages, ThatAreEmptyAreCounted) {
  const TempFolder folder;
  for (const Format& format : kFormats) {
    Gltf gltf = with_image(folder, format, Where::file);
    folder.write(std::string("wood ä/a b") + format.ending, "");
    const WorldFile written = keep(write_input(folder, gltf), folder / "w.glb");
    EXPECT_EQ(written.not_kept, Lines{kNoImage});
    const json after = GltfOracle(folder / "w.glb").document;
    EXPECT_EQ(after["images"].size(), 1u);
    EXPECT_FALSE(after.contains("extensionsRequired"));
    EXPECT_FALSE(after["materials"][0].contains("emissiveTexture"));
  }
}

// Where glTF has no extension for a format, PNG holds the image. What cannot be decoded stays, if
// it is an image at all.
TEST(KeptImages, WithoutAnExtensionBecomePngIfTheyCan) {
  const TempFolder folder;
  for (const Format& format : kFormats) {
    for (const Where where : {Where::view, Where::file}) {
      Gltf gltf = with_image(folder, format, where);
      gltf.j["textures"][1] = {{"source", 1}};
      gltf.j.erase("extensionsUsed");
      gltf.j.erase("extensionsRequired");
      const bool known = format.mime_type != std::string("image/jxr");
      const auto input = write_input(folder, gltf);
      const WorldFile written = keep(input, folder / "w.gltf");
      EXPECT_EQ(written.not_kept, known ? Lines{} : Lines{kNoImage});
      const auto loaded = read_scene(input, kGltfRest, {});
      ASSERT_TRUE(loaded.ok()) << loaded.status().message();
      EXPECT_EQ(loaded->defects.count(DefectKind::texture_unreadable), known ? 0u : 1u);
      if (!known) continue;
      const GltfOracle after(folder / "w.gltf");
      EXPECT_EQ(after.document["textures"][1], (json{{"source", 1}}));
      if (format.bytes == kWebp)
        EXPECT_EQ(after.image(1).substr(1, 3), "PNG");
      else
        EXPECT_EQ(after.image(1), format.bytes);
    }
  }
}

// Images of one name lie in different folders, and one may be called as another one becomes. Their
// numbers are those of the file that was read, of which one is absent.
TEST(KeptImages, BesideAFileHaveNamesOfTheirOwn) {
  const TempFolder folder;
  Gltf gltf = textured(folder);
  gltf.j["images"] = {{{"uri", "gone.png"}}};
  gltf.j["textures"].clear();
  std::vector<std::string> bytes;
  for (const std::string name : {"in/a.webp", "a.webp", "in/b.png", "in/w_texture1.webp"}) {
    std::filesystem::create_directories(folder / "in");
    bytes.push_back(name.ends_with("png") ? png_bytes(folder, 5) : kWebp + name);
    folder.write(name, bytes.back());
    gltf.j["images"].push_back({{"uri", "../" + name}});
    const std::size_t i = bytes.size();
    gltf.j["textures"].push_back({{"extensions", {{"EXT_texture_webp", {{"source", i}}}}}});
  }
  const auto input = write_input(folder, gltf);
  keep(input, folder / "w.gltf");
  const GltfOracle after(folder / "w.gltf");
  ASSERT_EQ(after.document["images"].size(), 4u);
  const auto loaded = read_scene(input, kGltfRest, {});
  ASSERT_TRUE(loaded.ok()) << loaded.status().message();
  const auto paths = scene_texture_paths(loaded->scene, folder / "w.gltf");
  ASSERT_EQ(paths.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(after.image(i), bytes[i]) << i;
    EXPECT_EQ(after.document["images"][i]["uri"], paths[i].filename().string());
  }
  for (const std::size_t i : {0, 1, 3}) EXPECT_EQ(paths[i].extension(), ".webp");
}

// A file of a format that is not known keeps the ending of its name if that is a plain one, and is
// called neither PNG nor JPEG.
TEST(KeptImages, OfUnknownFormatsKeepTheEndingOfTheirName) {
  const std::pair<const char*, const char*> cases[] = {
      {"a.jxr", ".jxr"},    {"a.JXR", ".jxr"},     {"a.%6Axr", ".jxr"}, {"a.png", ".bin"},
      {"a.jpg", ".bin"},    {"a", ".bin"},         {"a.", ".bin"},      {"a.j-r", ".bin"},
      {"a.sixsix", ".bin"}, {"a.fives", ".fives"}, {"a.gltf", ".bin"}};
  const Format& jxr = kFormats[5];
  for (const auto& [uri, ending] : cases) {
    const TempFolder folder;
    Gltf gltf = with_image(folder, jxr, Where::view);
    gltf.j["images"][1] = {{"uri", uri}, {"mimeType", jxr.mime_type}};
    const auto input = write_input(folder, gltf);
    folder.write(std::string("in/") + (uri == cases[2].first ? "a.jxr" : uri), jxr.bytes);
    EXPECT_EQ(keep(input, folder / "w.gltf").not_kept, Lines{});
    const GltfOracle after(folder / "w.gltf");
    EXPECT_EQ(after.document["images"][1]["uri"], std::string("w_texture1") + ending) << uri;
    EXPECT_EQ(after.image(1), jxr.bytes) << uri;
  }
}

// Lights refer to images as textures do.
TEST(KeptImages, OfLightsGetTheirNumbers) {
  const TempFolder folder;
  Gltf gltf = with_image(folder, kFormats[0], Where::view);
  json& images = gltf.j["images"];
  images.push_back(images[0]);
  images[2]["name"] = "light";
  images[0] = {{"uri", "gone.png"}};
  gltf.j["extensions"]["EXT_lights_image_based"]["lights"] = {{{"specularImages", {{2, 2}}}}};
  keep(write_input(folder, gltf), folder / "w.glb");
  const json after = GltfOracle(folder / "w.glb").document;
  ASSERT_EQ(after["images"].size(), 2u);
  EXPECT_EQ(after["images"][1]["name"], "light");
  EXPECT_EQ(after["extensions"]["EXT_lights_image_based"]["lights"][0]["specularImages"],
            (json{{1, 1}}));
  EXPECT_EQ(after["textures"][1]["extensions"]["EXT_texture_webp"]["source"], 0);
}

}  // namespace
}  // namespace atlas::test
