// Runs the player in its own folder, which holds a scene of two triangles.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace atlas::test {

namespace fs = std::filesystem;

struct RunResult {
  int exit_code = -1;
  std::string output, errors;
};

inline std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

class AtlasPlay : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::temp_directory_path() / fmt::format("atlas_play_{}_{}", info->name(), ::getpid());
    fs::create_directories(dir_);
    std::ofstream(dir_ / "roof.obj") << "v -1 1 -1\nv 1 1 -1\nv 0 1 1\nv -2 0 -2\nv 2 0 -2\n"
                                        "v 0 0 3\nf 3 2 1\nf 6 5 4\n";
    std::ofstream(dir_ / "points.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  }
  void TearDown() override { fs::remove_all(dir_); }

  // `environment` is as for env(1). Leak checks are disabled because graphics drivers leak. Without
  // XDG_RUNTIME_DIR, which desktops set, the Wayland library would print a line of its own.
  RunResult run(const std::string& arguments, const std::string& environment = "") const {
    const std::string command = fmt::format(
        "cd '{0}' && env {1} XDG_RUNTIME_DIR='{0}' LSAN_OPTIONS=detect_leaks=0 '{2}' {3} >out "
        "2>err",
        dir_.string(), environment, ATLAS_PLAY, arguments);
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, text_of(dir_ / "out"),
            text_of(dir_ / "err")};
  }

  // Expects the program's own error message as the only line on stderr.
  static void expect_one_line(const RunResult& r, const std::string& words) {
    EXPECT_EQ(r.exit_code, 1) << r.errors;
    EXPECT_EQ(r.errors.rfind("atlas-play: error: ", 0), 0u) << r.errors;
    EXPECT_EQ(std::count(r.errors.begin(), r.errors.end(), '\n'), 1) << r.errors;
    EXPECT_NE(r.errors.find(words), std::string::npos) << r.errors;
  }
  fs::path dir_;
};

}  // namespace atlas::test
