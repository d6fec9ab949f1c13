#include "benchmarks/page/plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "benchmarks/support/pareto.h"

namespace atlas::bench {
namespace {

constexpr int kFrontColour = 5, kSingleColour = 6;  // grey, black

std::string kind_of(const Row& row) {
  return row.mesh.substr(0, row.mesh.find(':'));
}

bool usable(const Row& row) {
  constexpr double kClock = 1e-5;  // CPU seconds; less than a few ticks of the clock is unreliable
  return row.failure.empty() && !row.values.empty() && std::isfinite(row.values.front().second) &&
         row.cpu_seconds >= kClock && row.threads == 0;
}

constexpr double kUnseenOfPrograms = 1e-5;

// Returns the addition to a caption if values lie below the floor.
std::string unseen(const Plot& plot) {
  double floor = 0;
  for (const Panel& panel : plot.panels) floor = std::max(floor, panel.floor);
  return floor > 0 ? fmt::format("; errors below {} are drawn at it", floor) : "";
}

// Shortens "scan:100000" to "scan 100 k".
std::string short_name(const std::string& mesh) {
  const auto colon = mesh.find(':');
  std::uint64_t size = 0;
  const char* end = mesh.data() + mesh.size();
  if (colon == std::string::npos || std::from_chars(&mesh[colon + 1], end, size).ptr != end)
    return mesh;
  const double unit = size >= 1000000 ? 1e6 : size >= 1000 ? 1e3 : 1;
  return fmt::format("{} {:.3g}{}", mesh.substr(0, colon), double(size) / unit,
                     unit > 1e3 ? " M"
                     : unit > 1 ? " k"
                                : "");
}

// Returns the ratio of the largest to the smallest value of a coordinate.
double spread(const std::vector<Series>& all, double PlotPoint::*coordinate) {
  double low = 1e300, high = 0;
  for (const Series& s : all)
    for (const PlotPoint& p : s.points) {
      low = std::min(low, p.*coordinate);
      high = std::max(high, p.*coordinate);
    }
  return high / low;
}

// Returns the name on an axis for a row's first value.
std::string axis_name(const std::string& value) {
  static const std::map<std::string, std::string> names = {
      {"empty", "empty share of the pages"},
      {"l2_minus_1", "L2 stretch less 1"},
      {"mean", "mean error of the visibility"},
      {"rms", "rms error, display values"},
      {"seam", "seams / square root of the area"}};
  const auto name = names.find(value);
  return name == names.end() ? value : name->second;
}

// Returns the group of a setting: that of "linear, k = 4" is "linear".
std::string group_of(const std::string& setting) {
  const auto comma = setting.rfind(", ");
  return comma == std::string::npos ? "" : setting.substr(0, comma);
}

PlotPoint point_of(const Row& row) {
  return {row.cpu_seconds, row.values.front().second, row.setting, row.preset};
}

// Joins the settings of one group in their order. The key shows their common name.
std::vector<Series> grouped(const std::vector<const Row*>& rows) {
  std::map<std::string, int> sizes, colours;
  for (const Row* row : rows) ++sizes[group_of(row->setting)];
  std::vector<Series> series;
  Series single;
  single.colour = kSingleColour;
  std::map<std::string, std::size_t> at;
  for (const Row* row : rows) {
    const std::string group = group_of(row->setting);
    PlotPoint point = point_of(*row);
    if (group.empty() || sizes[group] < 2) {
      single.points.push_back(point);
      continue;
    }
    const auto [place, fresh] = at.try_emplace(group, series.size());
    if (fresh) {
      series.emplace_back();
      series.back().name = group;
      series.back().lines = true;
      const int colour = int(at.size());
      series.back().colour = colour < kFrontColour ? colour : colour + 2;
    }
    point.label = row->setting.substr(group.size() + 2);
    point.important = true;
    series[place->second].points.push_back(point);
  }
  if (!single.points.empty()) series.push_back(single);
  return series;
}

Panel settings_panel(const std::string& mesh, const std::vector<const Row*>& rows) {
  Panel panel;
  panel.title = mesh;
  std::vector<PlotPoint> all;
  for (const Row* row : rows) all.push_back(point_of(*row));
  Series front;
  front.points = pareto_front(
      all, [](const PlotPoint& p) { return p.x; }, [](const PlotPoint& p) { return p.y; });
  for (PlotPoint& p : front.points) p.label.clear();
  front.name = "Pareto front";
  front.lines = true;
  front.points_too = false;
  front.colour = kFrontColour;
  front.dash = 2;
  panel.series = grouped(rows);
  panel.series.insert(panel.series.begin(), front);
  return panel;
}

// In the order of the rows.
using Meshes = std::vector<std::pair<std::string, std::vector<const Row*>>>;

// Draws all meshes in one panel with a colour per program. The title counts missing results.
Plot programs_plot(const Meshes& meshes) {
  Plot plot;
  plot.title = "Programs: error against time";
  plot.key = true;
  Panel panel;
  std::map<std::string, std::size_t> at;
  std::vector<std::pair<std::string, int>> without;  // how often a program gave no result
  for (const auto& [mesh, rows] : meshes)
    for (const Row* row : rows) {
      if (!usable(*row)) {
        const auto same = std::find_if(without.begin(), without.end(), [&](const auto& program) {
          return program.first == row->setting;
        });
        if (same == without.end()) {
          without.emplace_back(row->setting, 1);
        } else {
          ++same->second;
        }
        continue;
      }
      const auto [place, fresh] = at.try_emplace(row->setting, panel.series.size());
      if (fresh) panel.series.push_back({row->setting, {}, false, true, int(at.size())});
      PlotPoint point = point_of(*row);
      point.label = short_name(mesh);
      point.important = true;
      panel.series[place->second].points.push_back(point);
      plot.y_axis = axis_name(row->values.front().first);
    }
  for (const auto& [program, count] : without)
    panel.title += fmt::format("{}{} on {}", panel.title.empty() ? "no result: " : ", ", program,
                               count == 1 ? "one mesh" : fmt::format("{} meshes", count));
  draw_at_floor(panel, kUnseenOfPrograms);
  if (!panel.series.empty()) plot.panels.push_back(std::move(panel));
  plot.title += unseen(plot);
  return plot;
}

Plot settings_plot(const std::string& stage, const Meshes& meshes) {
  Plot plot;
  plot.key = true;
  for (const auto& [mesh, rows] : meshes) {
    if (rows.size() < 3) continue;
    Panel panel = settings_panel(mesh, rows);
    draw_at_floor(panel, kUnseen);
    panel.log_x = spread(panel.series, &PlotPoint::x) > 3;
    panel.log_y = spread(panel.series, &PlotPoint::y) > 3;
    plot.y_axis = axis_name(rows.back()->values.front().first);
    plot.panels.push_back(std::move(panel));
  }
  plot.title =
      stage + ": error against time (filled: presets or joined settings" + unseen(plot) + ")";
  return plot;
}

// Whether the settings of a stage can be compared by its error. Those of the simplifier set the
// error itself, those of grouping are different problems or give the same groups.
bool trades_error_for_time(const std::string& stage) {
  for (const char* other : {"light_leak", "baseline", "simplify", "grouping"})
    if (stage == other) return false;
  return true;
}

// Makes one plot for every stage that was run with several settings, with a panel per mesh, and one
// plot of the programs.
void error_plots(const Results& results, std::vector<Plot>& plots) {
  std::map<std::string, Meshes> stages;
  for (const Row& row : results.rows) {
    if (!trades_error_for_time(row.stage)) continue;
    if (row.stage != "unwrap" && !usable(row)) continue;
    Meshes& meshes = stages[row.stage];
    const auto same = std::find_if(meshes.begin(), meshes.end(),
                                   [&](const auto& mesh) { return mesh.first == row.mesh; });
    if (same == meshes.end())
      meshes.push_back({row.mesh, {&row}});
    else
      same->second.push_back(&row);
  }
  for (const auto& [stage, meshes] : stages) {
    Plot plot = stage == "unwrap" ? programs_plot(meshes) : settings_plot(stage, meshes);
    plot.file = "error_" + stage + ".svg";
    std::replace(plot.file.begin(), plot.file.end(), '/', '_');
    plot.x_axis = "CPU seconds";
    if (!plot.panels.empty()) plots.push_back(std::move(plot));
  }
}

// Returns the file with the most sizes of one kind of work. Rows of other files were measured with
// other budgets.
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
    if (row.mesh.find(':') == std::string::npos) continue;
    if (row.cpu_seconds <= 0 || row.memory_mib <= 0) continue;
    if (row.stage.find('/') != std::string::npos) continue;
    series[row.stage + ", " + kind_of(row)].push_back(
        {double(row.triangles), time ? row.cpu_seconds : row.memory_mib, ""});
  }
  Plot plot;
  plot.file = time ? "time_against_size.svg" : "memory_against_size.svg";
  plot.title = time ? "CPU time against size" : "Memory against size";
  plot.x_axis = "triangles";
  plot.y_axis = time ? "CPU seconds" : "MiB";
  plot.key = true;
  Panel panel;
  std::map<std::string, int> colours;  // one per stage; dashes distinguish kinds of work
  std::map<std::string, int> dashes;
  for (auto& [name, points] : series) {
    if (points.size() < 2) continue;
    std::sort(points.begin(), points.end(),
              [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
    const auto comma = name.find(", ");
    const auto colour = colours.try_emplace(name.substr(0, comma), int(colours.size()) + 1).first;
    const auto dash = dashes.try_emplace(name.substr(comma), int(dashes.size()) + 1).first;
    panel.series.push_back({name, points, true, true, colour->second, dash->second});
  }
  if (panel.series.empty()) return;
  plot.panels.push_back(std::move(panel));
  plots.push_back(std::move(plot));
}

// Distances are measured from the shadow edge.
void leak_plot(const Results& results, std::vector<Plot>& plots) {
  const std::pair<const char*, const char*> figures[] = {{"p95", "within 2 texels, 95 %"},
                                                         {"fixed_p95", "within 10 mm, 95 %"},
                                                         {"fixed_rms", "within 10 mm, rms"}};
  std::map<std::string, Panel> meshes;
  for (const Row& row : results.rows) {
    if (row.stage != "light_leak" || !row.failure.empty()) continue;
    Panel& panel = meshes[row.mesh];
    panel.title = row.mesh;
    panel.log_y = false;
    panel.series.resize(std::size(figures));
    for (std::size_t i = 0; i < panel.series.size(); ++i) {
      const auto& [value, text] = figures[i];
      Series& s = panel.series[i];
      s.name = text;
      s.lines = true;
      s.colour = int(i) + 1;
      const PlotPoint point{row.value("texel_mm", NAN), row.value(value, NAN), ""};
      if (std::isfinite(point.x + point.y)) s.points.push_back(point);
    }
  }
  if (meshes.empty()) return;
  Plot plot{"light_leak.svg",
            "Light leak along the edge of a shadow on the door",
            "texel on the surface, mm",
            "error, display values",
            {},
            true};
  for (auto& [mesh, panel] : meshes) plot.panels.push_back(std::move(panel));
  plots.push_back(std::move(plot));
}

}  // namespace

void draw_at_floor(Panel& panel, double floor) {
  for (Series& s : panel.series)
    for (PlotPoint& p : s.points) {
      if (p.y >= floor) continue;
      p.y = floor;
      panel.floor = floor;
    }
}

std::vector<Plot> make_plots(const Results& results) {
  std::vector<Plot> plots;
  error_plots(results, plots);
  size_plot(results, true, plots);
  size_plot(results, false, plots);
  leak_plot(results, plots);
  return plots;
}

}  // namespace atlas::bench
