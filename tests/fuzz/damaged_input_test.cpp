// Runs the fuzz targets on inputs that random changes have damaged.
#include <gtest/gtest.h>

#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/scene/reader.h"
#include "tests/fuzz/seeds.h"
#include "tests/fuzz/targets.h"
#include "tests/support/leaks.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

using Input = std::vector<std::uint8_t>;

// Returns the text after up to `most` changes, copies, removals or insertions of some bytes. What
// is inserted is often a number that readers may stumble over.
Input damaged(const std::string& text, std::size_t most, std::mt19937& random) {
  Input bytes(text.begin(), text.end());
  static const std::string hostile[] = {"-1", "4294967295", "1e39", "nan", "-",
                                        "\n", "\"",         "[",    "0"};
  for (auto hits = 1 + random() % most; hits > 0 && bytes.size() > 8; --hits) {
    const auto at = bytes.begin() + std::ptrdiff_t(random() % (bytes.size() - 8));
    switch (random() % 5) {
      case 0:
        *at = std::uint8_t(random());
        break;
      case 1:
        *at ^= std::uint8_t(1u << random() % 8);
        break;
      case 2:
        bytes.erase(at, at + std::ptrdiff_t(random() % 8));
        break;
      case 3: {
        const Input copy(at, at + 8);
        bytes.insert(bytes.begin() + std::ptrdiff_t(random() % bytes.size()), copy.begin(),
                     copy.end());
        break;
      }
      default: {
        const std::string& word = hostile[random() % std::size(hostile)];
        bytes.insert(at, word.begin(), word.end());
      }
    }
  }
  if (random() % 16 == 0) bytes.resize(random() % bytes.size());
  return bytes;
}

using test::Seed;

// How an input is damaged: so often, by that many changes at most, drawn from this seed.
struct Damage {
  int rounds;
  std::size_t most;
  unsigned seed;
};

// Runs a target on damaged inputs until one is at fault. Returns how many it accepted.
int accepted_of(const Seed& input, const Damage& damage, const auto& target) {
  std::mt19937 random(damage.seed);
  int accepted = 0;
  for (int round = 0; round < damage.rounds; ++round) {
    const test::FuzzResult result =
        target(damaged(input.bytes, damage.most, random), input.extension);
    EXPECT_EQ(result.fault, "") << "round " << round;
    if (!result.fault.empty()) break;
    accepted += result.accepted;
  }
  return accepted;
}

TEST(Seeds, AreSound) {
  for (const Seed& seed : test::scene_seeds()) {
    const test::FuzzResult result =
        test::fuzz_reader(Input(seed.bytes.begin(), seed.bytes.end()), seed.extension);
    EXPECT_EQ(result.fault, "") << seed.extension << " " << seed.name;
    EXPECT_TRUE(result.accepted) << seed.extension << " " << seed.name;
  }
}

class DamagedFiles : public ::testing::TestWithParam<Seed> {};

TEST_P(DamagedFiles, AreReadOrRefused) {
  EXPECT_GT(accepted_of(GetParam(), {1000, 4, 1}, test::fuzz_reader), 20);
}

TEST_P(DamagedFiles, AreShownByThePlayer) {
  EXPECT_GT(accepted_of(GetParam(), {100, 4, 4}, test::fuzz_view), 2);
}

TEST_P(DamagedFiles, AreRepackedOrRefused) {
  const int accepted = accepted_of(GetParam(), {100, 2, 5}, test::fuzz_repack);
  if (GetParam().extension == "stl") {
    EXPECT_EQ(accepted, 0) << "there are no uvs";
  } else {
    EXPECT_GT(accepted, 5);
  }
}

TEST_P(DamagedFiles, AreExportedAndReadAgain) {
  EXPECT_GT(accepted_of(GetParam(), {20, 1, 2}, test::fuzz_export), 2);
}

INSTANTIATE_TEST_SUITE_P(
    Formats, DamagedFiles,
    ::testing::Values(test::scene_seed("obj", "text"), test::scene_seed("ply", "text"),
                      test::scene_seed("off", "text"), test::scene_seed("stl", "text"),
                      test::scene_seed("wrl", "text"), test::scene_seed("glb", "skinned")),
    [](const auto& test) { return test.param.extension; });

TEST(DamagedDialects, AreReadOrRefused) {
  for (const auto& [extension, name] : {std::pair("wrz", "text"),
                                        {"ply", "binary"},
                                        {"glb", "draco_edgebreaker"},
                                        {"glb", "meshopt_filtered"},
                                        {"glb", "texture"},
                                        {"gltf", "buffer"}})
    EXPECT_GT(accepted_of(test::scene_seed(extension, name), {200, 2, 12}, test::fuzz_reader), 0)
        << extension << " " << name;
}

TEST(DamagedLightmaps, AreReadOrLeftOut) {
  for (const auto& [extension, seed] : {std::pair("glb", 8u), {"obj", 10u}}) {
    const Seed lightmap = test::scene_seed(extension, "lightmap");
    EXPECT_GT(accepted_of(lightmap, {500, 4, seed}, test::fuzz_reader), 20);
    EXPECT_GT(accepted_of(lightmap, {200, 4, seed + 1}, test::fuzz_view), 2);
  }
}

constexpr Damage kOfLists{250, 3, 6};

TEST(DamagedLists, ArePackedOrRefused) {
  for (const Seed& seed : test::list_seeds()) {
    if (seed.name != "rects") continue;
    EXPECT_GT(accepted_of(seed, kOfLists, test::fuzz_rects), 3) << seed.extension;
  }
}

TEST(DamagedLists, OfIlluminationAreReadOrRefused) {
  for (const Seed& seed : test::list_seeds()) {
    if (seed.name != "light") continue;
    EXPECT_GT(accepted_of(seed, kOfLists, test::fuzz_illumination), 10);
  }
  EXPECT_GT(accepted_of(test::scene_seed("ply", "text"), kOfLists, test::fuzz_illumination), 10);
}

// What fuzzers found in atlas-pack's lists: a number that no double holds.
TEST(DamagedLists, NumbersBeyondAllBoundsAreRefusedClearly) {
  const std::string text = "[[3, 2], [2147483648, 41e400]]";
  const test::FuzzResult result = test::fuzz_rects(Input(text.begin(), text.end()), "json");
  EXPECT_EQ(result.fault, "");
  EXPECT_FALSE(result.accepted);
}

// Checksums of PNG files tell of nearly all damage.
int least_of(const Seed& seed) {
  return seed.extension == "png" ? 0 : 5;
}

TEST(DamagedImages, AreReadOrRefused) {
  const test::IgnoreLeaks readers;  // OpenImageIO never frees the texts of its errors
  for (const Seed& seed : test::image_seeds()) {
    const test::FuzzResult whole =
        test::fuzz_image(Input(seed.bytes.begin(), seed.bytes.end()), seed.extension);
    EXPECT_EQ(whole.fault, "") << seed.extension;
    EXPECT_TRUE(whole.accepted) << seed.extension;
    EXPECT_GT(accepted_of(seed, {200, 3, 6}, test::fuzz_image), least_of(seed)) << seed.extension;
  }
}

TEST(DamagedImages, ArePackedOrRefused) {
  const test::IgnoreLeaks readers;  // OpenImageIO never frees the texts of its errors
  for (const Seed& seed : test::image_seeds()) {
    if (seed.extension == "exr" || seed.extension == "hdr") continue;
    EXPECT_GT(accepted_of(seed, {100, 3, 6}, test::fuzz_sprites), least_of(seed)) << seed.extension;
  }
}

TEST(MadeUpMeshes, AreUnwrapped) {
  std::mt19937 random(3);
  int accepted = 0;
  for (int round = 0; round < 100; ++round) {
    Input bytes(20 + random() % 500);
    for (std::uint8_t& b : bytes) b = std::uint8_t(random());
    const test::FuzzResult result = test::fuzz_unwrap(bytes);
    ASSERT_EQ(result.fault, "") << "round " << round;
    accepted += result.accepted;
  }
  EXPECT_GT(accepted, 50);
}

}  // namespace
}  // namespace atlas
