// Plots by gnuplot, as SVG.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;  // drawn beside the point if not empty
};

struct Series {
  std::string name;
  std::vector<PlotPoint> points;
  bool lines = false;  // joined in the order given
  int colour = 0;      // 1 and on, 0: the next one that is free
  int dash = 1;        // gnuplot's dash type; 1 is solid
};

struct Plot {
  std::string file;  // name without folder, .svg
  std::string title, x_axis, y_axis;
  bool log_x = true, log_y = true;
  std::vector<Series> series;
};

// Points that no other beats in both coordinates, by ascending x.
std::vector<PlotPoint> pareto_front(std::vector<PlotPoint> points);

// All plots that these results give: a stage's error against CPU time, time and memory against
// size, the light leak, the rivals.
std::vector<Plot> make_plots(const Results& results);

// The gnuplot script of one plot, which writes `target`.
std::string gnuplot_script(const Plot& plot, const std::filesystem::path& target);

// Errors: io when gnuplot is missing or fails.
Status draw(const Plot& plot, const std::filesystem::path& folder);

}  // namespace atlas::bench
