// Every kind of generated mesh is complete after export, as measured from the written OBJ.
#include <gtest/gtest.h>

#include "benchmarks/charts/charts_bench.h"

namespace atlas::bench {
namespace {

TEST(ChartsBench, EveryFigureComesOutWhole) {
  // bust:30000 has a cell that loses all its triangles to its neighbours.
  for (const std::string name :
       {"figure:4000", "hound:4000", "bust:30000", "figure-scan:4000", "terraces:4000",
        "shaft:5000", "bracket:3000", "fasteners:3000", "assembly:2000", "genus:3000",
        "terrain:4000", "needles:500", "soup:300"}) {
    const Result<LoadedScene> loaded = charts_work(name, {});
    ASSERT_TRUE(loaded.ok()) << name << ": " << loaded.status().message();
    const Result<std::string> row = charts_table_row(name, *loaded, {});
    ASSERT_TRUE(row.ok()) << name << ": " << row.status().message();
    EXPECT_NE(row->find("| none |"), std::string::npos) << *row;
  }
}

TEST(ChartsBench, AnUnknownFigureIsNamed) {
  const Result<LoadedScene> loaded = charts_work("statue:1000", {});
  ASSERT_FALSE(loaded.ok());
  EXPECT_NE(loaded.status().message().find("statue"), std::string::npos);
}

}  // namespace
}  // namespace atlas::bench
