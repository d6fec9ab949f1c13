#include "benchmarks/page/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <set>

namespace atlas::bench {
namespace {

std::string kind_of(const Row& row) {
  return row.mesh.substr(0, row.mesh.find(':'));
}

// Gnuplot draws underscores as subscripts, and both quotes end a string.
std::string plain(std::string text) {
  for (char& c : text)
    if (c == '"' || c == '\'' || c == '\\') c = ' ';
  return text;
}

bool usable(const Row& row) {
  return row.failure.empty() && !row.values.empty() && row.cpu_seconds > 0 && row.threads == 0;
}

// Largest over smallest value of a coordinate.
double spread(const std::vector<Series>& all, double PlotPoint::*coordinate) {
  double low = 1e300, high = 0;
  for (const Series& s : all)
    for (const PlotPoint& p : s.points) {
      low = std::min(low, p.*coordinate);
      high = std::max(high, p.*coordinate);
    }
  return high / low;
}

// A coordinate as drawn, in shares of its axis.
class Axis {
 public:
  Axis(const std::vector<Series>& all, double PlotPoint::*coordinate, bool log)
      : coordinate_(coordinate), log_(log) {
    double low = 1e300, high = -1e300;
    for (const Series& s : all)
      for (const PlotPoint& p : s.points) {
        low = std::min(low, place(p));
        high = std::max(high, place(p));
      }
    length_ = high - low + 1e-300;
  }
  double distance(const PlotPoint& a, const PlotPoint& b) const {
    return std::abs(place(a) - place(b)) / length_;
  }

 private:
  double place(const PlotPoint& p) const {
    return log_ ? std::log(p.*coordinate_) : p.*coordinate_;
  }

  double PlotPoint::*coordinate_;
  bool log_;
  double length_;
};

// Points so close together on the plot that their labels would overlap share one, at the first.
void join_labels(Plot& plot) {
  constexpr double kLabelWidth = 0.15, kLabelHeight = 0.05;  // of the plot
  const Axis across(plot.series, &PlotPoint::x, plot.log_x),
      up(plot.series, &PlotPoint::y, plot.log_y);
  std::vector<PlotPoint*> labelled;
  for (Series& s : plot.series)
    for (PlotPoint& p : s.points) {
      if (p.label.empty()) continue;
      const auto near = std::find_if(labelled.begin(), labelled.end(), [&](const PlotPoint* q) {
        return across.distance(p, *q) < kLabelWidth && up.distance(p, *q) < kLabelHeight;
      });
      if (near == labelled.end()) {
        labelled.push_back(&p);
        continue;
      }
      if (("; " + (*near)->label + "; ").find("; " + p.label + "; ") == std::string::npos)
        (*near)->label += "; " + p.label;
      p.label.clear();
    }
}

// One plot a stage that was run with several settings.
void error_plots(const Results& results, std::vector<Plot>& plots) {
  std::map<std::string, std::map<std::string, std::vector<const Row*>>> stages;
  for (const Row& row : results.rows)
    if (usable(row) && row.stage != "light_leak" && row.stage != "baseline")
      stages[row.stage][row.mesh].push_back(&row);
  for (const auto& [stage, meshes] : stages) {
    Plot plot;
    plot.file = "error_" + stage + ".svg";
    std::replace(plot.file.begin(), plot.file.end(), '/', '_');
    plot.title = stage + ": error against time";
    plot.x_axis = "CPU seconds";
    for (const auto& [mesh, rows] : meshes) {
      if (rows.size() < 3 && stage != "unwrap") continue;
      plot.y_axis = rows.front()->values.front().first;
      Series series{mesh, {}, false};
      for (const Row* row : rows)
        series.points.push_back({row->cpu_seconds, std::max(row->values.front().second, 1e-6),
                                 row->preset ? row->setting : ""});
      plot.series.push_back(series);
      if (stage != "unwrap") plot.series.push_back({"", pareto_front(series.points), true});
    }
    for (Series& s : plot.series)
      if (s.lines)
        for (PlotPoint& p : s.points) p.label.clear();
    plot.log_x = spread(plot.series, &PlotPoint::x) > 8;  // less, and a log axis has no labels
    plot.log_y = spread(plot.series, &PlotPoint::y) > 8;
    join_labels(plot);
    if (!plot.series.empty()) plots.push_back(plot);
  }
}

// The file with most sizes of one kind of work: rows of others were measured with other budgets.
std::string file_of_sizes(const Results& results) {
  std::map<std::string, std::set<std::uint64_t>> sizes;
  for (const Row& row : results.rows)
    if (row.stage == "charts" && row.threads == 0 && row.instructions == 0 &&
        row.mesh.rfind("file:", 0) != 0)
      sizes[row.source.substr(0, row.source.find(':'))].insert(row.triangles);
  std::string file;
  std::size_t most = 0;
  for (const auto& [name, triangles] : sizes)
    if (triangles.size() > most) {
      most = triangles.size();
      file = name;
    }
  return file;
}

void size_plot(const Results& results, bool time, std::vector<Plot>& plots) {
  std::map<std::string, std::vector<PlotPoint>> series;
  const std::string file = file_of_sizes(results);
  for (const Row& row : results.rows) {
    if (row.source.substr(0, row.source.find(':')) != file || row.mesh.rfind("file:", 0) == 0)
      continue;
    if (!row.failure.empty() || row.threads > 0) continue;
    if (row.setting != "standard" && row.stage != "baseline") continue;
    if (row.mesh.find(':') == std::string::npos || row.cpu_seconds <= 0) continue;
    if (row.stage.find('/') != std::string::npos) continue;
    series[row.stage + ", " + kind_of(row)].push_back(
        {double(row.triangles), time ? row.cpu_seconds : row.memory_mib, ""});
  }
  Plot plot;
  plot.file = time ? "time_against_size.svg" : "memory_against_size.svg";
  plot.title = time ? "CPU time against size" : "Memory against size";
  plot.x_axis = "triangles";
  plot.y_axis = time ? "CPU seconds" : "MiB";
  std::map<std::string, int> colours;  // one a stage; kinds of work are told apart by dashes
  std::map<std::string, int> dashes;
  for (auto& [name, points] : series) {
    if (points.size() < 2) continue;
    std::sort(points.begin(), points.end(),
              [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    const auto comma = name.find(", ");
    const auto colour = colours.try_emplace(name.substr(0, comma), int(colours.size()) + 1).first;
    const auto dash = dashes.try_emplace(name.substr(comma), int(dashes.size()) + 1).first;
    plot.series.push_back({name, points, true, colour->second, dash->second});
  }
  if (!plot.series.empty()) plots.push_back(plot);
}

void leak_plot(const Results& results, std::vector<Plot>& plots) {
  std::map<std::string, Series> series;
  for (const Row& row : results.rows) {
    if (row.stage != "light_leak" || !row.failure.empty()) continue;
    const std::pair<const char*, const char*> figures[] = {
        {"p95", "within 2 texels of the edge, 95 %"},
        {"fixed_p95", "within 10 mm of the edge, 95 %"},
        {"fixed_rms", "within 10 mm of the edge, rms"}};
    for (const auto& [value, text] : figures) {
      Series& s = series[row.mesh + ": " + text];
      s.points.push_back({row.value("texel_mm"), row.value(value), ""});
      s.lines = true;
    }
  }
  Plot plot{"light_leak.svg",
            "Light leak along a shadow on the door",
            "texel on the surface, mm",
            "error, display values",
            true,
            false,
            {}};
  for (auto& [name, s] : series) {
    s.name = name;
    plot.series.push_back(s);
  }
  if (!plot.series.empty()) plots.push_back(plot);
}

}  // namespace

std::vector<PlotPoint> pareto_front(std::vector<PlotPoint> points) {
  std::sort(points.begin(), points.end(), [](const PlotPoint& a, const PlotPoint& b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  });
  std::vector<PlotPoint> front;
  double best = std::numeric_limits<double>::infinity();
  for (const PlotPoint& p : points) {
    if (p.y >= best) continue;
    best = p.y;
    front.push_back(p);
  }
  return front;
}

std::vector<Plot> make_plots(const Results& results) {
  std::vector<Plot> plots;
  error_plots(results, plots);
  size_plot(results, true, plots);
  size_plot(results, false, plots);
  leak_plot(results, plots);
  return plots;
}

// Colours that stay apart on white, in print and for most colour-blind readers (after Wong 2011).
constexpr const char* kLineTypes =
    "set linetype 1 lc rgb '#0072b2' lw 1.5\nset linetype 2 lc rgb '#d55e00' lw 1.5\n"
    "set linetype 3 lc rgb '#009e73' lw 1.5\nset linetype 4 lc rgb '#cc79a7' lw 1.5\n"
    "set linetype 5 lc rgb '#7f7f7f' lw 1.5\nset linetype 6 lc rgb '#000000' lw 1.5\n"
    "set linetype 7 lc rgb '#e69f00' lw 1.5\nset linetype 8 lc rgb '#56b4e9' lw 1.5\n";

std::string gnuplot_script(const Plot& plot, const std::filesystem::path& target) {
  std::string text = fmt::format(
      "set terminal svg size 860,560 noenhanced font 'sans,13' background rgb 'white'\n"
      "set output '{}'\nset title '{}'\nset xlabel '{}'\nset ylabel '{}'\n"
      "set key below left\nset grid\nset format '%g'\nset autoscale noextend\n"
      "set offsets graph 0.04, graph 0.12, graph 0.06, graph 0.06\n"
      "{}",
      target.string(), plain(plot.title), plain(plot.x_axis), plain(plot.y_axis), kLineTypes);
  if (plot.log_x) text += "set logscale x\n";
  if (plot.log_y) text += "set logscale y\n";
  std::string commands, data;
  int colour = 0;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const Series& s = plot.series[i];
    if (!s.name.empty()) colour = s.colour ? s.colour : colour + 1;  // nameless: as the one before
    data += fmt::format("$s{} << EOD\n", i);
    bool labels = false;
    for (const PlotPoint& p : s.points) {
      data += fmt::format("{:.9g} {:.9g} \"{}\"\n", p.x, p.y, plain(p.label));
      labels |= !p.label.empty();
    }
    data += "EOD\n";
    const std::string title = s.name.empty() ? "notitle" : "title '" + plain(s.name) + "'";
    const char* style = !s.lines         ? "points pt 7 ps 0.7"
                        : s.name.empty() ? "lines"
                                         : "linespoints pt 7 ps 0.5";
    commands += fmt::format("{}$s{} using 1:2 with {} lt {} dt {} {}",
                            commands.empty() ? "plot " : ", ", i, style, colour, s.dash, title);
    if (labels)
      commands +=
          fmt::format(", $s{} using 1:2:3 with labels left offset 0.6,0.3 font ',9' notitle", i);
  }
  return data + text + commands + "\n";
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
