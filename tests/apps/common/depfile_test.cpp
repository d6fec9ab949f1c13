// Tests the dependency files by what GNU make and ninja read from them.
#include "apps/common/depfile.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/temp_folder.h"

namespace atlas::app {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

std::string shell(const std::string& command) {
  std::string output;
  FILE* pipe = ::popen(command.c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) output.append(buffer, n);
  ::pclose(pipe);
  return output;
}

bool has(const char* program) {
  return !shell(fmt::format("command -v {}", program)).empty();
}

const std::vector<fs::path> kInputs{"my scene.obj", "a#b.mtl", "c$d.png", "../e/f\\g[1].png",
                                    "c:d.bin"};

// Creates the folder in which the inputs can be read by their names. Returns it.
fs::path folder_of_inputs(const TempFolder& folder) {
  for (const char* sub : {"work", "e"}) fs::create_directory(folder / sub);
  for (const fs::path& input : kInputs) folder.write("work" / input, "1");
  return folder / "work";
}

std::string rule_of(const fs::path& target, const std::vector<fs::path>& inputs) {
  const Result<std::string> rule = dependency_rule(target, inputs);
  EXPECT_TRUE(rule.ok()) << rule.status().message();
  return rule.ok() ? *rule : "";
}

TEST(Depfile, NamesEachFileOnce) {
  EXPECT_EQ(rule_of("w.wrl", {"s.obj", "", "./s.obj", "a b.mtl", "s.obj"}),
            "w.wrl: \\\n  s.obj \\\n  a\\ b.mtl\n");
}

TEST(Depfile, RefusesNamesThatCannotBeWritten) {
  for (const char* name : {"a\nb", "a\tb", "a*b", "a;b", "a|b", "a\\ b", "a\\#b", "a\\", "a:"}) {
    EXPECT_EQ(dependency_rule("w.wrl", std::vector<fs::path>{name}).status().code(),
              ErrorCode::bad_option)
        << name;
    EXPECT_EQ(dependency_rule(name, {}).status().code(), ErrorCode::bad_option) << name;
  }
}

TEST(Depfile, MakeReadsAllNames) {
  if (!has("make")) GTEST_SKIP() << "there is no make";
  const TempFolder folder;
  const fs::path work = folder_of_inputs(folder);
  folder.write("work/my world.d", rule_of("my world.wrl", kInputs));
  folder.write("work/Makefile", "my\\ world.wrl: ; @touch '$@'; echo made\ninclude my\\ world.d\n");
  const std::string make = fmt::format("cd '{}' && make --no-print-directory 2>&1", work.string());
  EXPECT_EQ(shell(make), "made\n");
  EXPECT_NE(shell(make).find("up to date"), std::string::npos);
  const auto aged = [&](const fs::path& file, int hours) {
    fs::last_write_time(work / file, fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  for (const fs::path& input : kInputs) aged(input, 3);
  for (const fs::path& input : kInputs) {
    aged("my world.wrl", 2);
    aged(input, 1);
    EXPECT_EQ(shell(make), "made\n") << input;
    aged(input, 3);
  }
}

TEST(Depfile, NinjaReadsAllNames) {
  if (!has("ninja")) GTEST_SKIP() << "there is no ninja";
  const TempFolder folder;
  const fs::path work = folder_of_inputs(folder);
  folder.write("work/rule", rule_of("my world.wrl", kInputs));
  folder.write("work/build.ninja",
               "rule export\n  command = touch $out && cp rule w.d\n  depfile = w.d\n"
               "  deps = gcc\nbuild my$ world.wrl: export\n");
  const std::string deps =
      shell(fmt::format("cd '{}' && ninja >log 2>&1 && ninja -t deps", work.string()));
  EXPECT_NE(deps.find(fmt::format("#deps {}, ", kInputs.size())), std::string::npos) << deps;
  EXPECT_NE(deps.find("(VALID)"), std::string::npos) << deps;
  for (const fs::path& input : kInputs)
    EXPECT_NE(deps.find(fmt::format("    {}\n", input.string())), std::string::npos)
        << input << "\n"
        << deps;
}

}  // namespace
}  // namespace atlas::app
