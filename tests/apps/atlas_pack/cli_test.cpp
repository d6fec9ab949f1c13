// Tests what all commands of atlas-pack have in common.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "apps/atlas-pack/command_line.h"
#include "tests/apps/atlas_pack/run_pack.h"

namespace atlas::test {
namespace {

// With an effort, no time limit applies, so that results can be repeated.
TEST(PackCommandLine, AnEffortIsTheOnlyLimitUnlessABudgetIsGivenToo) {
  const auto budget = [](std::vector<const char*> words) {
    words.insert(words.begin(),
                 {"atlas-pack", "rects", "a.csv", "-o", "b.csv", "--preset", "best"});
    app::PackCommand command;
    EXPECT_EQ(app::parse_command_line(int(words.size()), const_cast<char**>(words.data()), command),
              -1);
    return command.options.time_budget;
  };
  EXPECT_EQ(budget({}), 1);
  EXPECT_EQ(budget({"--budget", "3s"}), 3);
  EXPECT_EQ(budget({"--effort", "500", "--budget", "3s"}), 3);
  EXPECT_TRUE(std::isinf(budget({"--effort", "500"})));
}

// Expects one line that contains the words, and no output file.
TEST_F(AtlasPack, WhatCannotBeDoneLeavesNothing) {
  fs::create_directories(dir_ / "folder");
  write("ok.csv", "a,4,5\nb,6,7\n");
  write("empty.csv", "");
  write("twice.csv", "a,4,5\na,6,7\n");
  write("header.csv", "name,width,height\n");
  write("short.csv", "a,4\nb,6,7\n");  // its first line is no header, because it contains a number
  write("huge.csv", "a,99999999999,5\n");
  write("cut.json", "[[4,5],[6");
  write("uv.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::pair<const char*, const char*> cases[] = {
      {"rects folder -o q.csv", "is a directory"},
      {"rects empty.csv -o q.csv", "no rectangle"},
      {"rects ok.csv/in.csv -o q.csv", "cannot be read: Not a directory"},
      {"rects twice.csv -o q.json", "two items are called 'a'"},
      {"rects header.csv -o q.csv", "no rectangle"},
      {"rects short.csv -o q.csv", "short.csv:1"},
      {"rects huge.csv -o q.csv", "huge.csv:1"},
      {"rects cut.json -o q.csv", "cut.json"},
      {"rects ok.csv -o ./ok.csv", "would overwrite"},
      {"rects ok.csv -o q.txt", ".csv or .json"},
      {"rects ok.csv -o no/q.csv", "no does not exist (create it first)"},
      {"rects ok.csv -o ok.csv/q.csv", "ok.csv is not a directory (name a folder)"},
      {"rects ok.csv -o q.csv --preview p.gif", ".svg or .png"},
      {"rects ok.csv -o q.csv --preview no/p.svg", "no does not exist (create it first)"},
      {"rects ok.csv -o q.csv --page 99999999999", "--page"},
      {"rects ok.csv -o q.csv --page 0x512", "--page"},  // hexadecimal numbers are not accepted
      {"rects ok.csv -o q.csv --page 1e2", "--page"},
      {"rects ok.csv -o q.csv --threads -1", "--threads"},
      {"rects ok.csv -o q.csv --effort -1", "--effort"},
      {"rects ok.csv -o q.csv --padding -1", "--padding"},
      {"rects ok.csv -o q.csv --align 0", "--align"},
      {"rects ok.csv -o q.csv --preset good", "one of best, default, fast"},
      {"images folder -o q", "no image"},
      {"images ok.csv -o q", "no folder"},
      {"images folder -o folder/q", "in the folder that is read"},
      {"mesh uv.obj -o uv.obj", "would overwrite"},
      {"mesh uv.obj -o q.stl", "must end in .obj"},
      {"mesh uv.obj -o q.obj --rotations 3", "--rotations"},
      {"mesh plain.obj -o q.obj", "plain.obj: has no uvs"},
      {"mesh folder -o q.obj", "is a directory"},
      {"", "a command is needed"},
  };
  const auto files = [&] {
    return std::distance(fs::directory_iterator(dir_), fs::directory_iterator());
  };
  const auto before = files();
  for (const auto& [arguments, words] : cases) {
    const RunResult r = run(arguments);
    EXPECT_TRUE(r.exit_code == 1 || r.exit_code == 2) << arguments << "\n" << r.output;
    EXPECT_EQ(std::count(r.output.begin(), r.output.end(), '\n'), 1) << r.output;
    EXPECT_EQ(r.output.rfind("atlas-pack: error: ", 0), 0u) << r.output;
    EXPECT_NE(r.output.find(words), std::string::npos) << arguments << "\n" << r.output;
    EXPECT_EQ(files(), before) << arguments;
  }
  EXPECT_EQ(read("ok.csv"), "a,4,5\nb,6,7\n");
}

TEST_F(AtlasPack, InterruptLeavesNothing) {
  std::string obj, sizes;
  for (int i = 0; i < 12; ++i) {
    const double w = 1 + 0.37 * (i % 5), h = 2 - 0.11 * i;
    obj += fmt::format("v {0} 0 0\nv {1} 0 0\nv {0} {2} 0\nvt {0} 0\nvt {1} 0\nvt {0} {2}\n", 5 * i,
                       5 * i + w, h);
    obj += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    sizes += fmt::format("{},{}\n", 13 + 7 * i, 90 - 5 * i);
  }
  write("m.obj", obj);
  write("r.csv", sizes);
  // Background jobs of a shell ignore ctrl-C, so this is what kill(1) sends. Installing the handler
  // may take long on a busy machine.
  const std::string interrupt =
      "& for i in $(seq 200); do grep -q 'SigCgt:.*[4567cdef]...$' /proc/$!/status && break;"
      " sleep 0.1; done; sleep 0.3; kill -TERM $!; wait $!";
  for (const char* what : {"mesh m.obj -o out.obj", "rects r.csv --page 128x0 -o out.csv"}) {
    const RunResult r = run(fmt::format("{} --preset best --budget 60s {}", what, interrupt));
    EXPECT_EQ(r.exit_code, 130) << what << ": " << r.output;
    for (const auto& entry : fs::directory_iterator(dir_))
      EXPECT_TRUE(entry.path().filename() == "m.obj" || entry.path().filename() == "r.csv")
          << entry.path();
  }
}

}  // namespace
}  // namespace atlas::test
