#include "benchmarks/page/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace atlas::bench {
namespace {

// Sizes in pixels of the SVG. The box of the axes is set explicitly and not by gnuplot, because the
// positions of labels are chosen here.
constexpr double kPanelWidth = 430, kWideWidth = 860, kPanelHeight = 300, kTallHeight = 450;
// Margins of a panel around its axes.
constexpr double kLeft = 104, kRight = 14, kAbove = 34, kBelow = 54;
constexpr double kTitle = 36, kKey = 56;
constexpr double kLetter = 5.4, kLine = 11, kPoint = 4;  // of labels

// Colours that are distinguishable on white, in print and for most colour-blind readers (after Wong
// 2011).
constexpr const char* kLineTypes =
    "set linetype 1 lc rgb '#0072b2' lw 1.5\nset linetype 2 lc rgb '#d55e00' lw 1.5\n"
    "set linetype 3 lc rgb '#009e73' lw 1.5\nset linetype 4 lc rgb '#cc79a7' lw 1.5\n"
    "set linetype 5 lc rgb '#7f7f7f' lw 1.5\nset linetype 6 lc rgb '#000000' lw 1.5\n"
    "set linetype 7 lc rgb '#e69f00' lw 1.5\nset linetype 8 lc rgb '#56b4e9' lw 1.5\n";

// Replaces both quotes, which would end a string, and backslashes.
std::string plain(std::string text) {
  for (char& c : text)
    if (c == '"' || c == '\'' || c == '\\') c = ' ';
  return text;
}

// Returns the least of 1, 2 and 5 times a power of ten that is not below `step`.
double round_step(double step) {
  const double power = std::pow(10, std::floor(std::log10(step)));
  for (const double times : {1.0, 2.0, 5.0})
    if (times * power >= step) return times * power;
  return 10 * power;
}

// The range of a coordinate with space for labels, and its mapping to pixels.
class Axis {
 public:
  // `after` is the space in pixels beyond the last point for its label.
  Axis(const Panel& panel, double PlotPoint::*coordinate, double pixels, double after)
      : coordinate_(coordinate),
        log_(coordinate == &PlotPoint::x ? panel.log_x : panel.log_y),
        pixels_(pixels) {
    double low = 1e300, high = -1e300;
    for (const Series& s : panel.series)
      for (const PlotPoint& p : s.points) {
        low = std::min(low, value(p.*coordinate));
        high = std::max(high, value(p.*coordinate));
      }
    constexpr double kRoom = 0.12;
    const double span = high - low;
    if (span > 0) {
      low_ = low - kRoom * span;
      high_ = high + span * std::max(kRoom, (1 + kRoom) * after / (pixels - after));
    } else {
      const double room = log_ ? 0.3 : std::max(0.5 * std::abs(high), 1e-12);
      low_ = low - room;
      high_ = high + room;
    }
    if (!log_ && low >= 0) low_ = std::max(low_, 0.0);
  }

  double pixel(const PlotPoint& p) const {
    return pixels_ * (value(p.*coordinate_) - low_) / (high_ - low_);
  }
  double length() const { return pixels_; }

  // Returns gnuplot's range and ticks. If `floor` is not 0, its tick says that smaller values are
  // drawn there, too.
  std::string commands(char name, double floor) const {
    if (!log_) {
      return fmt::format(
          "unset logscale {0}\nset {0}range [{1:.9g}:{2:.9g}]\nset {0}tics {3:.9g}\n", name, low_,
          high_, round_step((high_ - low_) / 5));
    }
    std::string ticks;
    for (int power = int(std::floor(low_)); power <= int(std::ceil(high_)); ++power)
      for (const double step : {1.0, 2.0, 5.0}) {
        if (step > 1 && high_ - low_ > kDecades) continue;
        const double tick = step * std::pow(10, power);
        if (tick < 0.99 * floor) continue;
        const bool lowest = floor > 0 && tick < 1.01 * floor;
        ticks += fmt::format("{}'{}{:.3g}' {:.3g}", ticks.empty() ? "" : ", ", lowest ? "≤ " : "",
                             tick, tick);
      }
    return fmt::format("set logscale {0}\nset {0}range [{1:.9g}:{2:.9g}]\nset {0}tics ({3})\n",
                       name, std::pow(10, low_), std::pow(10, high_), ticks);
  }

 private:
  static constexpr double kDecades = 2.5;  // fewer decades need ticks at 2 and 5, too

  double value(double v) const { return log_ ? std::log10(v) : v; }

  double PlotPoint::*coordinate_;
  bool log_;
  double pixels_, low_, high_;
};

struct Box {
  double x0, y0, x1, y1;
  double shared(const Box& o) const {
    return std::max(0.0, std::min(x1, o.x1) - std::max(x0, o.x0)) *
           std::max(0.0, std::min(y1, o.y1) - std::max(y0, o.y0));
  }
  double distance(double x, double y) const {
    return std::hypot(std::max({x0 - x, x - x1, 0.0}), std::max({y0 - y, y - y1, 0.0}));
  }
};

// Places labels one by one. Each gets the free position beside its point that is nearest to it, or
// else the best of those that are not free.
class Labels {
 public:
  Labels(const Panel& panel, const Axis& x, const Axis& y) : x_(x), y_(y) {
    for (const Series& s : panel.series)
      for (std::size_t i = 0; i < s.points.size(); ++i) {
        const Spot at = spot(s.points[i]);
        if (s.points_too || !s.lines) {
          occupy(at, kPoint);
          points_.push_back(at);
        }
        if (!s.lines || i == 0) continue;
        const Spot last = spot(s.points[i - 1]);
        const int steps = int(std::hypot(last.x - at.x, last.y - at.y) / 4);
        for (int k = 1; k < steps; ++k)
          occupy({at.x + (last.x - at.x) * k / steps, at.y + (last.y - at.y) * k / steps}, 1);
      }
  }

  // Places the labels of important points, or those of the others.
  std::string place_all(const Panel& panel, bool important) {
    std::vector<std::pair<Spot, std::string>> labels;
    for (const Series& s : panel.series)
      for (const PlotPoint& p : s.points)
        if (!p.label.empty() && p.important == important) add(spot(p), p.label, labels);
    std::string text;
    for (const auto& [at, label] : labels) text += place(at, label);
    return text;
  }

 private:
  struct Spot {
    double x, y;
    double distance(const Spot& o) const { return std::hypot(x - o.x, y - o.y); }
  };
  static constexpr double kAstray = 60;  // penalty in square pixels for a label that may be misread

  // Close points with the same label share it; different labels at one point are joined.
  static void add(Spot at, const std::string& label,
                  std::vector<std::pair<Spot, std::string>>& labels) {
    for (auto& [other, text] : labels) {
      if (text == label && other.distance(at) < kLine) return;
      if (other.distance(at) >= kPoint) continue;
      const std::size_t word = label.rfind(' ') + 1;  // the setting's name, as in "slip 0.1, 0.5"
      text += ", " + (text.starts_with(label.substr(0, word)) ? label.substr(word) : label);
      return;
    }
    labels.emplace_back(at, label);
  }

  std::string place(Spot at, const std::string& label) {
    struct Side {
      double start, anchor;  // shares of the label's width
      const char* justify;
      double gap;
    };
    constexpr Side kSides[] = {
        {0, 0, "left", 2 * kPoint}, {-1, 1, "right", -2 * kPoint}, {-0.5, 0.5, "center", 0}};
    const double width = kLetter * double(label.size());
    std::string best;
    Box best_box{};
    double least = 1e300;
    for (const double up : {0.0, 0.4, -0.4, 1.0, -1.0, 1.8, -1.8})
      for (const Side& side : kSides) {
        const double x0 = at.x + side.gap + side.start * width, y = at.y + up * kLine;
        const Box box{x0, y - kLine / 2, x0 + width, y + kLine / 2};
        const double cost = cover(box) + kAstray * nearer_to_others(box, at) + 2 * std::abs(up);
        if (cost >= least) continue;
        least = cost;
        best_box = box;
        best =
            fmt::format("set label '{}' at graph {:.4f},{:.4f} {} font ',9' front\n", plain(label),
                        (x0 + side.anchor * width) / x_.length(), y / y_.length(), side.justify);
      }
    taken_.push_back(best_box);
    return best;
  }

  Spot spot(const PlotPoint& p) const { return {x_.pixel(p), y_.pixel(p)}; }

  void occupy(Spot at, double radius) {
    taken_.push_back({at.x - radius, at.y - radius, at.x + radius, at.y + radius});
  }

  // Returns the covered square pixels of other labels and points, and of the area outside.
  double cover(const Box& box) const {
    double sum = 0;
    for (const Box& other : taken_) sum += box.shared(other);
    const Box inside{0, 0, x_.length(), y_.length()};
    return sum + 4 * ((box.x1 - box.x0) * (box.y1 - box.y0) - box.shared(inside));
  }

  // Returns the number of points to which the label is nearer than to its own, so that it could be
  // misread.
  double nearer_to_others(const Box& box, Spot own) const {
    const double distance = box.distance(own.x, own.y);
    return double(std::count_if(points_.begin(), points_.end(), [&](const Spot& p) {
      return p.distance(own) >= kPoint && box.distance(p.x, p.y) <= distance;
    }));
  }

  const Axis &x_, &y_;
  std::vector<Box> taken_;
  std::vector<Spot> points_;
};

// A line through a single point is not drawn. If no panel has a longer line, its name in the key
// would have no meaning. The key is that of the first panel, which therefore keeps what another
// panel draws.
bool drawn_somewhere(const Plot& plot, const std::string& name) {
  return std::any_of(plot.panels.begin(), plot.panels.end(), [&](const Panel& panel) {
    return std::any_of(panel.series.begin(), panel.series.end(), [&](const Series& s) {
      return s.name == name && s.points.size() >= (s.lines && !s.points_too ? 2u : 1u);
    });
  });
}

std::string style_of(const Series& s, bool important) {
  if (s.lines && !s.points_too) return "lines";
  return fmt::format("{} pt {} ps {}", s.lines ? "linespoints" : "points", important ? 7 : 6,
                     important ? 0.7 : 0.6);
}

// Sets the box of the axes, in pixels from the lower left corner of the picture.
std::string margins(const Box& axes, double width, double height) {
  return fmt::format(
      "set lmargin at screen {:.6f}\nset rmargin at screen {:.6f}\n"
      "set bmargin at screen {:.6f}\nset tmargin at screen {:.6f}\n",
      axes.x0 / width, axes.x1 / width, axes.y0 / height, axes.y1 / height);
}

// Returns the length of the longest label and its distance from the point, in pixels.
double longest_label(const Panel& panel) {
  std::size_t letters = 0;
  for (const Series& s : panel.series)
    for (const PlotPoint& p : s.points) letters = std::max(letters, p.label.size());
  return letters > 0 ? 3 * kPoint + kLetter * double(letters) : 0;
}

std::string panel_script(const Plot& plot, int index, const Box& axes) {
  const Panel& panel = plot.panels[std::size_t(index)];
  const Axis x(panel, &PlotPoint::x, axes.x1 - axes.x0, longest_label(panel));
  const Axis y(panel, &PlotPoint::y, axes.y1 - axes.y0, 0);
  std::string data, commands,
      text = fmt::format("set title '{}'\nunset label\n", plain(panel.title));
  text += x.commands('x', 0) + y.commands('y', panel.floor);
  Labels labels(panel, x, y);
  for (const bool important : {true, false}) text += labels.place_all(panel, important);
  int block = 0;
  const auto add = [&](const Series& s, const std::vector<PlotPoint>& points, bool important,
                       bool named) {
    if (points.empty()) return;
    data += fmt::format("$p{}_{} << EOD\n", index, block);
    for (const PlotPoint& p : points) data += fmt::format("{:.9g} {:.9g}\n", p.x, p.y);
    data += "EOD\n";
    commands +=
        fmt::format("{}$p{}_{} using 1:2 with {} lt {} dt {} {}", commands.empty() ? "plot " : ", ",
                    index, block++, style_of(s, important), s.colour, s.dash,
                    named ? "title '" + plain(s.name) + "'" : "notitle");
  };
  for (const Series& s : panel.series) {
    if (!drawn_somewhere(plot, s.name)) continue;
    if (s.lines) {
      add(s, s.points, true, !s.name.empty());
      continue;
    }
    bool named = !s.name.empty();
    for (const bool important : {true, false}) {
      std::vector<PlotPoint> points;
      for (const PlotPoint& p : s.points)
        if (p.important == important) points.push_back(p);
      add(s, points, important, named);
      named = named && points.empty();
    }
  }
  return data + text + commands + "\n";
}

// Returns the key for all panels, whose series have the same names.
std::string key_command(const Plot& plot, double height) {
  if (!plot.key) return "unset key\n";
  return fmt::format("set key at screen 0.5,{:.6f} center center vertical maxrows 2\n",
                     kKey / 2 / height);
}

}  // namespace

std::string gnuplot_script(const Plot& plot, const std::filesystem::path& target) {
  const auto panels = int(plot.panels.size());
  const int columns = std::min(panels, panels == 4 ? 2 : 3);
  const int rows = (panels + columns - 1) / std::max(columns, 1);
  const double across = panels == 1 ? kWideWidth : kPanelWidth;
  const double down = panels == 1 ? kTallHeight : kPanelHeight;
  const double key = plot.key ? kKey : 0;
  const double width = columns * across, height = rows * down + kTitle + key;
  std::string text = fmt::format(
      "set terminal svg size {},{} noenhanced font 'sans,12' background rgb 'white'\n"
      "set encoding utf8\nset output '{}'\nset grid\nset tics nomirror\nset format '%g'\n{}"
      "set xlabel '{}'\nset ylabel '{}'\n{}set multiplot title '{}'\n",
      width, height, target.string(), kLineTypes, plain(plot.x_axis), plain(plot.y_axis),
      key_command(plot, height), plain(plot.title));
  for (int i = 0; i < panels; ++i) {
    const double left = (i % columns) * across, top = height - kTitle - (i / columns) * down;
    const Box axes{left + kLeft, top - down + kBelow, left + across - kRight, top - kAbove};
    text += margins(axes, width, height) + panel_script(plot, i, axes);
    text += "unset key\n";
  }
  return text + "unset multiplot\n";
}

Status draw(const Plot& plot, const std::filesystem::path& folder) {
  FILE* pipe = popen("gnuplot", "w");
  if (!pipe) return {ErrorCode::io, "gnuplot cannot be started (package gnuplot-nox)"};
  const std::string script = gnuplot_script(plot, folder / plot.file);
  std::fwrite(script.data(), 1, script.size(), pipe);
  if (pclose(pipe) == 0) return {};
  return {ErrorCode::io, plot.file + ": gnuplot failed (is the package gnuplot-nox installed?)"};
}

}  // namespace atlas::bench
