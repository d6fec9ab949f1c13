#include "benchmarks/page/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace atlas::bench {
namespace {

// Sizes in the SVG's pixels. Of a panel, what its axes and title leave.
constexpr double kPanelWidth = 430, kWideWidth = 860, kPanelHeight = 330, kTallHeight = 480;
constexpr double kBesideAxes = 95, kAboveAxes = 85;
constexpr double kLetter = 5.4, kLine = 12, kPoint = 4;  // of labels

// Colours that stay apart on white, in print and for most colour-blind readers (after Wong 2011).
constexpr const char* kLineTypes =
    "set linetype 1 lc rgb '#0072b2' lw 1.5\nset linetype 2 lc rgb '#d55e00' lw 1.5\n"
    "set linetype 3 lc rgb '#009e73' lw 1.5\nset linetype 4 lc rgb '#cc79a7' lw 1.5\n"
    "set linetype 5 lc rgb '#7f7f7f' lw 1.5\nset linetype 6 lc rgb '#000000' lw 1.5\n"
    "set linetype 7 lc rgb '#e69f00' lw 1.5\nset linetype 8 lc rgb '#56b4e9' lw 1.5\n";

// Both quotes end a string.
std::string plain(std::string text) {
  for (char& c : text)
    if (c == '"' || c == '\'' || c == '\\') c = ' ';
  return text;
}

// The least of 1, 2 and 5 times a power of ten that is not below `step`.
double round_step(double step) {
  const double power = std::pow(10, std::floor(std::log10(step)));
  for (const double times : {1.0, 2.0, 5.0})
    if (times * power >= step) return times * power;
  return 10 * power;
}

// A coordinate's range, with room for labels, and its place in pixels.
class Axis {
 public:
  Axis(const Panel& panel, double PlotPoint::*coordinate, bool log, double pixels)
      : coordinate_(coordinate), log_(log), pixels_(pixels) {
    double low = 1e300, high = -1e300;
    for (const Series& s : panel.series)
      for (const PlotPoint& p : s.points) {
        low = std::min(low, value(p.*coordinate));
        high = std::max(high, value(p.*coordinate));
      }
    double room = 0.12 * (high - low);
    if (!(room > 0)) room = log ? 0.3 : std::max(0.5 * std::abs(high), 1e-12);  // a single value
    low_ = low - room;
    high_ = high + room;
    if (!log && low >= 0) low_ = std::max(low_, 0.0);
  }

  double pixel(const PlotPoint& p) const {
    return pixels_ * (value(p.*coordinate_) - low_) / (high_ - low_);
  }
  double length() const { return pixels_; }

  // Gnuplot's range, and ticks at 1, 2 and 5 where whole powers of ten would be too few.
  std::string commands(char name) const {
    if (!log_) {
      return fmt::format(
          "unset logscale {0}\nset {0}range [{1:.9g}:{2:.9g}]\nset {0}tics {3:.9g}\n", name, low_,
          high_, round_step((high_ - low_) / 5));
    }
    std::string text = fmt::format("set logscale {0}\nset {0}range [{1:.9g}:{2:.9g}]\n", name,
                                   std::pow(10, low_), std::pow(10, high_));
    if (high_ - low_ > 2.5) return text + fmt::format("set {}tics autofreq\n", name);
    std::string ticks;
    for (int power = int(std::floor(low_)); power <= int(std::ceil(high_)); ++power)
      for (const double step : {1.0, 2.0, 5.0}) {
        const double tick = step * std::pow(10, power);
        ticks += fmt::format("{}{:.3g}", ticks.empty() ? "" : ", ", tick);
      }
    return text + fmt::format("set {}tics ({})\n", name, ticks);
  }

 private:
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
};

// Places labels one by one, each in the first of eight places that is free, or the freest.
class Labels {
 public:
  Labels(const Panel& panel, const Axis& x, const Axis& y) : x_(x), y_(y) {
    for (const Series& s : panel.series)
      for (std::size_t i = 0; i < s.points.size(); ++i) {
        const double px = x.pixel(s.points[i]), py = y.pixel(s.points[i]);
        if (s.points_too || !s.lines) occupy(px, py, kPoint);
        if (!s.lines || i == 0) continue;
        const double dx = x.pixel(s.points[i - 1]) - px, dy = y.pixel(s.points[i - 1]) - py;
        const int steps = int(std::hypot(dx, dy) / 4);
        for (int k = 1; k < steps; ++k) occupy(px + dx * k / steps, py + dy * k / steps, 1);
      }
  }

  std::string place(const PlotPoint& p) {
    const double px = x_.pixel(p), py = y_.pixel(p), width = kLetter * double(p.label.size());
    std::optional<Box> best;
    double least = 1e300;
    bool best_left = false;
    for (const double up : {0.0, 0.9, -0.9, 1.7, -1.7})
      for (const bool left : {false, true}) {
        const double x0 = left ? px - 2 * kPoint - width : px + 2 * kPoint;
        const double middle = py + up * kLine;
        const Box box{x0, middle - kLine / 2, x0 + width, middle + kLine / 2};
        const double cost = cover(box) + 2 * std::abs(up);
        if (cost < least) {
          least = cost;
          best = box;
          best_left = left;
        }
      }
    taken_.push_back(*best);
    return fmt::format("set label '{}' at graph {:.4f},{:.4f} {} font ',9' front\n", plain(p.label),
                       (best_left ? best->x1 : best->x0) / x_.length(),
                       (best->y0 + best->y1) / 2 / y_.length(), best_left ? "right" : "left");
  }

 private:
  void occupy(double x, double y, double radius) {
    taken_.push_back({x - radius, y - radius, x + radius, y + radius});
  }

  // Square pixels of other labels and points, and of what is outside.
  double cover(const Box& box) const {
    double sum = 0;
    for (const Box& other : taken_) sum += box.shared(other);
    const Box inside{0, 0, x_.length(), y_.length()};
    return sum + 4 * ((box.x1 - box.x0) * (box.y1 - box.y0) - box.shared(inside));
  }

  const Axis &x_, &y_;
  std::vector<Box> taken_;
};

std::string style_of(const Series& s, bool important) {
  if (s.lines && !s.points_too) return "lines";
  return fmt::format("{} pt {} ps {}", s.lines ? "linespoints" : "points", important ? 7 : 6,
                     important ? 0.7 : 0.6);
}

struct Size {
  double width, height;
};

std::string panel_script(const Panel& panel, int index, const Size& size) {
  const Axis x(panel, &PlotPoint::x, panel.log_x, size.width - kBesideAxes);
  const Axis y(panel, &PlotPoint::y, panel.log_y, size.height - kAboveAxes);
  std::string data, commands,
      text = fmt::format("set title '{}'\nunset label\n", plain(panel.title));
  text += x.commands('x') + y.commands('y');
  Labels labels(panel, x, y);
  for (const bool important : {true, false})
    for (const Series& s : panel.series)
      for (const PlotPoint& p : s.points)
        if (!p.label.empty() && p.important == important) text += labels.place(p);
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

}  // namespace

std::string gnuplot_script(const Plot& plot, const std::filesystem::path& target) {
  const auto panels = int(plot.panels.size());
  const int columns = std::min(panels, panels == 4 ? 2 : 3);
  const int rows = (panels + columns - 1) / std::max(columns, 1);
  const Size size = panels == 1 ? Size{kWideWidth, kTallHeight} : Size{kPanelWidth, kPanelHeight};
  const double title = 30;
  std::string text = fmt::format(
      "set terminal svg size {},{} noenhanced font 'sans,12' background rgb 'white'\n"
      "set output '{}'\nset grid\nset format '%g'\n{}"
      "set xlabel '{}'\nset ylabel '{}'\n{}\n"
      "set multiplot layout {},{} title '{}'\n",
      columns * size.width, rows * size.height + title, target.string(), kLineTypes,
      plain(plot.x_axis), plain(plot.y_axis),
      plot.key ? "set key below center spacing 1.2" : "unset key", rows, columns,
      plain(plot.title));
  for (int i = 0; i < panels; ++i) text += panel_script(plot.panels[std::size_t(i)], i, size);
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
