// Tests plots and their scripts with invented numbers.
#include "benchmarks/page/plots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "benchmarks/page/gnuplot.h"
#include "libatlas/core/vec.h"
#include "tests/benchmarks/rows.h"

namespace atlas::bench {
namespace {

// Returns the position of a label in the script, as shares of the panel.
Vec2d label_place(const std::string& script, const std::string& label) {
  const std::size_t at = script.find("set label '" + label + "' at graph ");
  Vec2d place{-1, -1};
  if (at != std::string::npos)
    std::sscanf(script.c_str() + script.find("graph ", at), "graph %lf,%lf", &place.x, &place.y);
  return place;
}

TEST(Plots, LabelsOfOnePlaceLieApartAndInside) {
  Plot plot{"x.svg", "title", "x", "y", {Panel{}, Panel{}}};
  plot.panels[0].series.push_back({"", {{1, 5, "first", true}, {1, 5, "second"}, {9, 7, "third"}}});
  plot.panels[1].series.push_back({"", {{0.25, 4, "it's"}}});  // its range has no length
  const std::string script = gnuplot_script(plot, "x.svg");
  const Vec2d first = label_place(script, "first"), second = label_place(script, "second");
  EXPECT_GE(std::hypot(first.x - second.x, first.y - second.y), 0.02);
  for (const char* name : {"first", "second", "third", "it s"}) {
    const Vec2d place = label_place(script, name);
    EXPECT_GT(std::min(place.x, place.y), 0) << name;
    EXPECT_LT(std::max(place.x, place.y), 1) << name;
  }
  EXPECT_EQ(script.find("nan"), std::string::npos);
  EXPECT_EQ(script.find("inf"), std::string::npos);
}

TEST(Plots, AProgramHasItsColourAndThoseThatFailAreCounted) {
  Results results;
  for (const char* mesh : {"sphere:10", "torus:10"})
    for (const char* program : {"ours", "theirs", "third"}) {
      Row made = row(10, 1, 0.5);
      made.stage = "unwrap";
      made.mesh = mesh;
      made.setting = program;
      if (mesh[0] == 's' && program[0] == 't') made.failure = "timed out";
      results.rows.push_back(made);
    }
  const std::vector<Plot> plots = make_plots(results);
  ASSERT_EQ(plots.size(), 1u);
  ASSERT_EQ(plots[0].panels.size(), 1u);
  const Panel& panel = plots[0].panels[0];
  EXPECT_EQ(panel.title, "no result: theirs on one mesh, third on one mesh");
  ASSERT_EQ(panel.series.size(), 3u);
  EXPECT_EQ(panel.series[0].name, "ours");
  EXPECT_EQ(panel.series[0].points.size(), 2u);
  EXPECT_EQ(panel.series[0].points[1].label, "torus 10");
  EXPECT_EQ(panel.series[1].points.size(), 1u);
  EXPECT_NE(panel.series[0].colour, panel.series[1].colour);
  EXPECT_NE(panel.series[1].colour, panel.series[2].colour);
}

TEST(Plots, SmallerErrorsAreDrawnAtTheLowestTickWhichSaysSo) {
  Results results;
  for (const double error : {0.0, 1e-4, 1e-2}) {
    Row made = row(1000, 1 + error, error);
    made.setting = "setting " + std::to_string(error);
    results.rows.push_back(made);
  }
  std::vector<Plot> plots = make_plots(results);
  ASSERT_EQ(plots.size(), 1u);
  EXPECT_EQ(plots[0].panels.at(0).floor, kUnseen);
  EXPECT_NE(plots[0].title.find("errors below 1e-06 are drawn at it"), std::string::npos);
  EXPECT_NE(gnuplot_script(plots[0], "x.svg").find("'≤ 1e-06'"), std::string::npos);
  results.rows[0].values[0].second = 1e-5;
  plots = make_plots(results);
  EXPECT_EQ(plots.at(0).panels.at(0).floor, 0);
  EXPECT_EQ(gnuplot_script(plots[0], "x.svg").find("≤"), std::string::npos);
}

// On a logarithmic axis it would be drawn at the floor, as if it was perfect.
TEST(Plots, ErrorsThatAreNoNumbersAreNotDrawn) {
  Results results;
  for (const double error : {std::nan(""), 1e-3, 1e-2, 1e-1}) {
    Row made = row(1000, 1 + (error > 0 ? error : 0), error);
    made.setting = "setting " + std::to_string(error);
    results.rows.push_back(made);
  }
  std::vector<Plot> plots = make_plots(results);
  ASSERT_EQ(plots.size(), 1u);
  EXPECT_EQ(plots[0].panels.at(0).floor, 0);
  EXPECT_EQ(plots[0].panels[0].series.back().points.size(), 3u);
  for (Row& made : results.rows) made.stage = "unwrap";
  plots = make_plots(results);
  ASSERT_EQ(plots.size(), 1u);
  EXPECT_EQ(plots[0].panels.at(0).title, "no result: setting nan on one mesh");
}

TEST(Plots, AFrontOfOneSettingIsNotInTheKey) {
  Results results;
  for (const double error : {0.3, 0.2, 0.1}) {
    Row made = row(1000, 1 + error, error);  // the fastest one is also the best
    made.setting = "setting " + std::to_string(error);
    results.rows.push_back(made);
  }
  const auto names_the_front = [&] {
    const std::vector<Plot> plots = make_plots(results);
    return !plots.empty() &&
           gnuplot_script(plots[0], "x.svg").find("Pareto front") != std::string::npos;
  };
  EXPECT_FALSE(names_the_front());
  for (const double error : {0.3, 0.2, 0.1}) {
    Row other = row(5000, 1 - error, error);
    other.setting = "setting " + std::to_string(error);
    results.rows.push_back(other);
  }
  EXPECT_TRUE(names_the_front()) << "one for all panels";
  results.rows.resize(3);
  results.rows[0].values[0].second = 0.05;
  EXPECT_TRUE(names_the_front());
}

TEST(Plots, PointsOfOnePlaceShareALabel) {
  Plot plot{"x.svg", "title", "x", "y", {Panel{}}};
  plot.panels[0].series.push_back({"", {{1, 5, "slip 1"}, {1, 5, "slip 2"}, {9, 7, "slip 3"}}});
  const std::string script = gnuplot_script(plot, "x.svg");
  EXPECT_NE(script.find("set label 'slip 1, 2' at"), std::string::npos);
  EXPECT_NE(script.find("set label 'slip 3' at"), std::string::npos);
}

}  // namespace
}  // namespace atlas::bench
