// The command line of atlas-pack: every option fills in what it is named after.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "apps/atlas-pack/command_line.h"

namespace atlas::test {
namespace {

using app::PackCommand;

// Returns the exit code, -1 to go on.
int parsed(std::vector<const char*> words, PackCommand& command) {
  words.insert(words.begin(), "atlas-pack");
  return app::parse_command_line(int(words.size()), const_cast<char**>(words.data()), command);
}

PackCommand good(const std::vector<const char*>& words) {
  PackCommand command;
  EXPECT_EQ(parsed(words, command), -1) << words.back();
  return command;
}

TEST(PackOptions, OfPages) {
  const PackCommand c =
      good({"rects", "a.csv", "-o", "b.csv", "--padding", "3", "--border", "5", "--align", "8",
            "--pot", "--crop", "--max-pages", "7", "--page", "300x200"});
  EXPECT_EQ(c.kind, PackCommand::Kind::rects);
  EXPECT_EQ(c.input, "a.csv");
  EXPECT_EQ(c.output, "b.csv");
  EXPECT_EQ(c.options.padding, 3);
  EXPECT_EQ(c.options.border, 5);
  EXPECT_EQ(c.options.alignment, 8);
  EXPECT_TRUE(c.options.power_of_two);
  EXPECT_FALSE(c.options.square);
  EXPECT_TRUE(c.options.crop);
  EXPECT_FALSE(c.options.allow_rotation);
  EXPECT_EQ(c.options.max_pages, 7u);
  EXPECT_EQ(c.options.page, (Extent{300, 200}));
  EXPECT_TRUE(c.page_given);
  const PackCommand other = good({"rects", "a.csv", "-o", "b.csv", "--square", "--rotate"});
  EXPECT_TRUE(other.options.square);
  EXPECT_TRUE(other.options.allow_rotation);
  EXPECT_FALSE(other.options.power_of_two || other.options.crop || other.page_given);
  EXPECT_EQ(other.options.page, (Extent{2048, 2048}));
}

TEST(PackOptions, SidesMayBeGivenOneByOne) {
  const PackCommand wide = good({"rects", "a.csv", "-o", "b.csv", "--max-width", "99"});
  EXPECT_EQ(wide.options.page, (Extent{99, 2048}));
  EXPECT_TRUE(wide.page_given);
  const PackCommand strip = good({"rects", "a.csv", "-o", "b.csv", "--max-height", "0"});
  EXPECT_EQ(strip.options.page, (Extent{2048, 0}));
  EXPECT_TRUE(strip.page_given);
  EXPECT_EQ(good({"rects", "a", "-o", "b.csv", "--page", "64"}).options.page, (Extent{64, 64}));
  EXPECT_EQ(good({"rects", "a", "-o", "b.csv", "--page", "64x0"}).options.page, (Extent{64, 0}));
  for (const char* page : {"0", "0x64", "64x", "x64", "64x64x64", "-1", "64 x 64"}) {
    PackCommand command;
    EXPECT_EQ(parsed({"rects", "a", "-o", "b.csv", "--page", page}, command), 2) << page;
  }
}

TEST(PackOptions, OfEffortAndRunning) {
  const auto budget = [](const char* time) {
    return good({"rects", "a", "-o", "b.csv", "--preset", "best", "--budget", time})
        .options.time_budget;
  };
  EXPECT_DOUBLE_EQ(budget("1.5"), 1.5);
  EXPECT_DOUBLE_EQ(budget("1.5s"), 1.5);
  EXPECT_DOUBLE_EQ(budget("500ms"), 0.5);
  EXPECT_DOUBLE_EQ(budget("2m"), 120);
  EXPECT_DOUBLE_EQ(budget("2min"), 120);
  const PackCommand c =
      good({"rects", "a", "-o", "b.csv", "--preset", "best", "--effort", "90", "--seed", "12",
            "--threads", "3", "--preview", "p.svg", "--json", "-q", "--data", "array"});
  EXPECT_EQ(c.options.preset, PackPreset::best);
  EXPECT_EQ(c.options.effort, 90u);
  EXPECT_EQ(c.options.seed, 12u);
  EXPECT_EQ(c.threads, 3);
  EXPECT_EQ(c.preview, "p.svg");
  EXPECT_TRUE(c.json && c.quiet);
  EXPECT_EQ(c.format, app::DataFormat::array);
  EXPECT_EQ(good({"rects", "a", "-o", "b.csv", "--preset", "FAST"}).options.preset,
            PackPreset::fast);
}

TEST(PackOptions, OfImages) {
  const PackCommand c =
      good({"images", "in", "-o", "out", "--extrude", "2", "--trim-threshold", "9", "--no-alias"});
  EXPECT_EQ(c.kind, PackCommand::Kind::images);
  EXPECT_EQ(c.extrude, 2);
  EXPECT_EQ(c.trim_threshold, 9);
  EXPECT_TRUE(c.trim);
  EXPECT_FALSE(c.alias);
  const PackCommand whole = good({"images", "in", "-o", "out", "--no-trim"});
  EXPECT_FALSE(whole.trim);
  EXPECT_TRUE(whole.alias);
  EXPECT_EQ(whole.extrude, 0);
}

TEST(PackOptions, OfMeshes) {
  const PackCommand c =
      good({"mesh", "a.obj", "-o", "b.obj", "--page", "512", "--pages", "3", "--rotations", "64"});
  EXPECT_EQ(c.kind, PackCommand::Kind::mesh);
  EXPECT_EQ(c.page_side, 512);
  EXPECT_EQ(c.pages, 3u);
  EXPECT_EQ(c.rotations, 64u);
  for (const char* number : {"1", "2", "4", "8", "12"})
    EXPECT_EQ(good({"mesh", "a", "-o", "b", "--rotations", number}).rotations, std::stoul(number));
  for (const char* number : {"0", "3", "6", "68", "-4", "many"}) {
    PackCommand command;
    EXPECT_EQ(parsed({"mesh", "a", "-o", "b", "--rotations", number}, command), 2) << number;
  }
}

}  // namespace
}  // namespace atlas::test
