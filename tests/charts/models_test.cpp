// Public models with known figures. The tests are skipped if the models are not available.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/charts/chart_checks.h"
#include "tests/support/shared_data.h"

namespace atlas::test {
namespace {

// Only vertices and faces are needed from these files.
Mesh read(const std::filesystem::path& path) {
  Mesh mesh;
  std::ifstream in(path);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3f p;
      words >> p.x >> p.y >> p.z;
      mesh.positions.push_back(p);
    } else if (word == "f") {
      std::vector<std::uint32_t> corners;
      while (words >> word) corners.push_back(std::uint32_t(std::stoul(word) - 1));
      for (std::size_t k = 2; k < corners.size(); ++k) {
        for (const std::size_t i : {std::size_t{0}, k - 1, k}) mesh.indices.push_back(corners[i]);
      }
    }
  }
  return mesh;
}

TEST(Models, AllComeOutWhole) {
  if (shared_models().empty()) GTEST_SKIP() << lacks("models");
  for (const std::filesystem::path& path : shared_models()) {
    const Mesh mesh = read(path);
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok()) << path << set.status().message();
    const ChartFindings found = check_charts(mesh.view(), *set);
    EXPECT_EQ(found.fault, "") << path;
    EXPECT_LE(found.stretch_999, 1.25 * (1 + 1e-6)) << path;
    EXPECT_NEAR(found.seam, set->seam_length, 1e-4 * (1 + found.seam)) << path;
  }
}

struct Wanted {
  const char* name;
  std::size_t charts;
  double stretch_l2, seam;
};

TEST(Models, NoWorseThanTheFiguresAskedFor) {
  if (shared_models().empty()) GTEST_SKIP() << lacks("models");
  for (const Wanted& wanted :
       {Wanted{"spot", 22, 1.003, 13}, Wanted{"fandisk", 12, 1.001, 8.5},
        Wanted{"rocker-arm", 25, 1.002, 14}, Wanted{"stanford-bunny", 24, 1.003, 12.5},
        Wanted{"igl-armadillo", 60, 1.005, 20}}) {
    const Mesh mesh = read(*shared_data("models") / (std::string(wanted.name) + ".obj"));
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok()) << wanted.name;
    EXPECT_LE(set->charts.size(), wanted.charts) << wanted.name;
    EXPECT_LE(set->distortion.stretch_l2, wanted.stretch_l2) << wanted.name;
    EXPECT_LE(set->seam_length / std::sqrt(set->surface_area), wanted.seam) << wanted.name;
  }
}

TEST(Models, ScanNoiseAddsHalfAsManyChartsAtMost) {
  if (shared_models().empty()) GTEST_SKIP() << lacks("models");
  for (const char* name : {"rocker-arm", "igl-fertility"}) {
    const Mesh smooth = read(*shared_data("models") / (std::string(name) + ".obj"));
    const Result<ChartSet> calm = make_charts(smooth.view(), {}, {});
    ASSERT_TRUE(calm.ok()) << name;
    const Mesh mesh(noisy_along_normals({name, smooth.positions, smooth.indices}, 0.15));
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok()) << name;
    const ChartFindings found = check_charts(mesh.view(), *set);
    EXPECT_EQ(found.fault, "") << name;
    EXPECT_LE(found.stretch_999, 1.25 * (1 + 1e-6)) << name;
    EXPECT_LE(double(set->charts.size()), 1.5 * double(calm->charts.size())) << name;
  }
}

}  // namespace
}  // namespace atlas::test
