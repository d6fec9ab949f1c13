// The published instance sets, if LIBATLAS_DATA points at them. The totals must not get worse.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "libatlas/pack/pack.h"
#include "tests/support/layout_checks.h"
#include "tests/support/shared_data.h"

namespace atlas {
namespace {

struct Instance {
  Extent page;
  std::vector<Extent> items;
};

std::vector<Instance> read_set(const std::string& name) {
  std::vector<Instance> set;
  const auto data = test::shared_data("packing/" + name);
  if (!data) return set;
  std::vector<std::filesystem::path> files;
  for (const auto& e : std::filesystem::directory_iterator(*data)) files.push_back(e.path());
  std::sort(files.begin(), files.end());
  for (const auto& path : files) {
    std::ifstream file(path);
    Instance in;
    std::size_t n = 0;
    file >> in.page.width >> in.page.height >> n;
    in.items.resize(n);
    for (Extent& e : in.items) file >> e.width >> e.height;
    EXPECT_TRUE(file) << path;
    set.push_back(std::move(in));
  }
  return set;
}

TEST(PackSets, Class) {
  const auto set = read_set("CLASS");
  if (set.empty()) GTEST_SKIP() << test::lacks("packing");
  for (bool rotate : {false, true}) {
    std::size_t bins = 0;
    for (const Instance& in : set) {
      PackOptions o;
      o.page = in.page;
      o.allow_rotation = rotate;
      const Result<PackResult> r = pack_rects(in.items, o, {});
      ASSERT_TRUE(r.ok());
      ASSERT_EQ(test::check_layout(in.items, r->placements, r->pages, o), "");
      bins += r->pages.size();
    }
    EXPECT_LE(bins, rotate ? 7100u : 7360u);
  }
}

TEST(PackSets, Strips) {
  if (read_set("C_HT2001").empty()) GTEST_SKIP() << test::lacks("packing");
  const std::pair<const char*, std::pair<double, double>> sets[] = {{"C_HT2001", {4.5, 3.1}},
                                                                    {"NT_HOPPER", {6.8, 4.0}}};
  for (const auto& [name, limits] : sets)
    for (bool rotate : {false, true}) {
      const auto set = read_set(name);
      double gap = 0;
      for (const Instance& in : set) {
        PackOptions o;
        o.page = {in.page.width, 0};
        o.allow_rotation = rotate;
        const Result<PackResult> r = pack_rects(in.items, o, {});
        ASSERT_TRUE(r.ok());
        ASSERT_EQ(test::check_layout(in.items, r->placements, r->pages, o), "");
        gap += 100.0 * (r->pages[0].height - in.page.height) / in.page.height;
      }
      EXPECT_LE(gap / double(set.size()), rotate ? limits.second : limits.first) << name;
    }
}

}  // namespace
}  // namespace atlas
