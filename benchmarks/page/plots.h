// The plots of the page: a stage's error against CPU time, cost against size.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

struct PlotPoint {
  double x = 0, y = 0;
  std::string label;       // drawn beside the point if not empty
  bool important = false;  // filled, and labelled before others
};

struct Series {
  std::string name;  // name in the key; empty: not in it
  std::vector<PlotPoint> points;
  bool lines = false;  // joined in the given order
  bool points_too = true;
  int colour = 1;  // from 1
  int dash = 1;    // gnuplot's dash type; 1 is solid
};

// One pair of axes.
struct Panel {
  std::string title;
  std::vector<Series> series;
  bool log_x = true, log_y = true;
  double floor = 0;  // smaller values of y are drawn at it; 0: there are none
};

// Moves errors below `floor` to it, because a logarithmic axis cannot show them.
constexpr double kUnseen = 1e-6;
void draw_at_floor(Panel& panel, double floor);

struct Plot {
  std::string file;  // name without folder, .svg
  std::string title, x_axis, y_axis;
  std::vector<Panel> panels;  // side by side, at most three in a row
  bool key = false;           // whether a key below names the series
};

// Returns all plots that these results allow: a stage's error against CPU time with a panel per
// mesh, the same for the rivals, time and memory against size, and the light leak.
std::vector<Plot> make_plots(const Results& results);

}  // namespace atlas::bench
