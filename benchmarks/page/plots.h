// What the page draws: a stage's error against CPU time, cost against size.
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
  std::string name;  // in the key; empty: not there
  std::vector<PlotPoint> points;
  bool lines = false;  // joined in the order given
  bool points_too = true;
  int colour = 1;  // 1 and on
  int dash = 1;    // gnuplot's dash type; 1 is solid
};

// One pair of axes.
struct Panel {
  std::string title;
  std::vector<Series> series;
  bool log_x = true, log_y = true;
  double floor = 0;  // smaller values of y are drawn at it; 0: there are none
};

// Errors below `floor`, which a logarithmic axis has no place for, are moved there.
constexpr double kUnseen = 1e-6;
void draw_at_floor(Panel& panel, double floor);

struct Plot {
  std::string file;  // name without folder, .svg
  std::string title, x_axis, y_axis;
  std::vector<Panel> panels;  // side by side, three in a row at most
  bool key = false;           // names the series, below
};

// All plots that these results give: a stage's error against CPU time with a panel a mesh, the
// same of the rivals, time and memory against size, the light leak.
std::vector<Plot> make_plots(const Results& results);

}  // namespace atlas::bench
