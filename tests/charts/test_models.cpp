// The public models that the figures are about; skipped where they are not at hand.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "tests/charts/chart_checks.h"
#include "tests/support/shared_data.h"

namespace atlas::test {
namespace {

std::filesystem::path models() {
  const auto data = shared_data();
  return data ? *data / "models" : std::filesystem::path();
}

// Vertices and faces are all that is needed of these files.
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
  if (models().empty()) GTEST_SKIP() << "LIBATLAS_DATA is not set";
  for (const auto& entry : std::filesystem::directory_iterator(models())) {
    if (entry.path().extension() != ".obj") continue;
    const Mesh mesh = read(entry.path());
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok()) << entry.path() << set.status().message();
    const ChartFindings found = check_charts(mesh.view(), *set);
    EXPECT_EQ(found.fault, "") << entry.path();
    EXPECT_LE(found.stretch_999, 1.25 * (1 + 1e-6)) << entry.path();
    EXPECT_NEAR(found.seam, set->seam_length, 1e-4 * (1 + found.seam)) << entry.path();
  }
}

struct Wanted {
  const char* name;
  std::size_t charts;
  double stretch_l2, seam;
};

TEST(Models, NoWorseThanTheFiguresAskedFor) {
  if (models().empty()) GTEST_SKIP() << "LIBATLAS_DATA is not set";
  for (const Wanted& wanted :
       {Wanted{"spot", 22, 1.002, 13}, Wanted{"fandisk", 12, 1.001, 8.5},
        Wanted{"rocker-arm", 25, 1.002, 14}, Wanted{"stanford-bunny", 24, 1.003, 12.5},
        Wanted{"igl-armadillo", 60, 1.005, 20}}) {
    const Mesh mesh = read(models() / (std::string(wanted.name) + ".obj"));
    const Result<ChartSet> set = make_charts(mesh.view(), {}, {});
    ASSERT_TRUE(set.ok()) << wanted.name;
    EXPECT_LE(set->charts.size(), wanted.charts) << wanted.name;
    EXPECT_LE(set->distortion.stretch_l2, wanted.stretch_l2) << wanted.name;
    EXPECT_LE(set->seam_length / std::sqrt(set->surface_area), wanted.seam) << wanted.name;
  }
}

TEST(Models, ScanNoiseAddsHalfAsManyChartsAtMost) {
  if (models().empty()) GTEST_SKIP() << "LIBATLAS_DATA is not set";
  for (const char* name : {"rocker-arm", "igl-fertility"}) {
    const Mesh smooth = read(models() / (std::string(name) + ".obj"));
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
