// Runs the program in its own folder, and makes a lit scene for it.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace atlas::test {

namespace fs = std::filesystem;

struct RunResult {
  int exit_code = -1;
  std::string output;  // stdout and stderr together
};

class AtlasExport : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::temp_directory_path() / fmt::format("atlas_export_{}_{}", info->name(), ::getpid());
    fs::create_directories(dir_);
  }
  void TearDown() override { fs::remove_all(dir_); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name, std::ios::binary) << text;
    return dir_ / name;
  }

  static RunResult run(const std::string& arguments) {
    RunResult result;
    FILE* pipe = ::popen(fmt::format("{} {} 2>&1", ATLAS_EXPORT, arguments).c_str(), "r");
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) {
      result.output.append(buffer, n);
    }
    const int status = ::pclose(pipe);
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
  }

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(dir_)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

  // Runs on a scene that cannot be exported. Expects one line that contains `expected`, exit code 1
  // or 2, and no new file.
  void expect_refusal(const fs::path& scene, const std::string& expected,
                      const std::string& more = "") {
    const auto before = files();
    const RunResult r =
        run(fmt::format("{} -o {} {}", scene.string(), (dir_ / "world.wrl").string(), more));
    EXPECT_TRUE(r.exit_code == 1 || r.exit_code == 2) << r.exit_code << "\n" << r.output;
    EXPECT_EQ(std::count(r.output.begin(), r.output.end(), '\n'), 1) << r.output;
    EXPECT_NE(r.output.find(expected), std::string::npos) << r.output;
    // Messages name the flag instead.
    EXPECT_EQ(r.output.find("Options::"), std::string::npos) << r.output;
    EXPECT_EQ(files(), before);
  }

  fs::path dir_;
};

// Returns a room with n x n quads per side, seen from inside and lit by a smooth function of the
// position.
inline std::string lit_box(int n) {
  std::ostringstream obj;
  int first = 1;
  for (int side = 0; side < 6; ++side) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        double p[3];
        p[side / 2] = side % 2;
        p[(side / 2 + 1) % 3] = double(i) / n;
        p[(side / 2 + 2) % 3] = double(j) / n;
        const double light = 1 + 0.5 * std::sin(3 * p[0] + 2 * p[1]) * std::cos(2 * p[2]);
        obj << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << ' ' << light << ' ' << light * 0.9
            << ' ' << light * 0.7 << '\n';
      }
    }
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const int a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
        if (side % 2) {
          obj << "f " << a << ' ' << c << ' ' << d << ' ' << b << '\n';
        } else {
          obj << "f " << a << ' ' << b << ' ' << d << ' ' << c << '\n';
        }
      }
    }
    first += (n + 1) * (n + 1);
  }
  return obj.str();
}

inline std::string slurp(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace atlas::test
