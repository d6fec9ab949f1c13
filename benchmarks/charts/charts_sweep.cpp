#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmarks/charts/charts_bench.h"
#include "benchmarks/page/gnuplot.h"
#include "benchmarks/support/chart_setting.h"
#include "benchmarks/support/pareto.h"
#include "libatlas/charts/charts.h"

namespace atlas::bench {
namespace {

std::vector<ChartSetting> settings() {
  std::vector<ChartSetting> list = chart_presets();
  list[1].name = "default";  // the name on the command line
  for (const double stretch : {1.05, 1.1, 1.15, 1.5, 2.0}) list.push_back(with_stretch(stretch));
  return list;
}

using Value = double (*)(const ChartsPoint&);
double loss(const ChartsPoint& p) {
  return p.stretch_l2 - 1;
}
double seams(const ChartsPoint& p) {
  return p.seam;
}

double time(const ChartsPoint* p) {
  return p->cpu_seconds;
}

// Bounds with nearly equal results share a point and its label.
std::vector<ChartsPoint> joined(const std::vector<const ChartsPoint*>& points, Value value) {
  constexpr double kNearTime = 0.05, kNearValue = 0.02;
  std::vector<ChartsPoint> kept;
  for (const ChartsPoint* p : points) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const ChartsPoint& q) {
      return std::abs(p->cpu_seconds - q.cpu_seconds) < kNearTime * q.cpu_seconds &&
             std::abs(value(*p) - value(q)) < kNearValue * value(q);
    });
    if (same == kept.end()) {
      kept.push_back(*p);
    } else {
      same->setting += ", " + p->setting;
    }
  }
  return kept;
}

std::vector<PlotPoint> plotted(const std::vector<ChartsPoint>& points, Value value) {
  std::vector<PlotPoint> plotted;
  for (const ChartsPoint& p : points)
    plotted.push_back({1000 * p.cpu_seconds, value(p), p.setting, p.preset});
  return plotted;
}

// Returns the panel with the points of one mesh.
Panel panel_of(const std::vector<const ChartsPoint*>& points, Value value) {
  std::vector<ChartsPoint> presets, front;
  std::vector<const ChartsPoint*> bounds;
  for (const ChartsPoint* p : points) {
    if (p->preset) {
      presets.push_back(*p);
    } else {
      bounds.push_back(p);
    }
  }
  for (const ChartsPoint* p :
       pareto_front(points, time, [&](const ChartsPoint* q) { return value(*q); })) {
    front.push_back(*p);
    front.back().setting.clear();
  }
  Panel panel{points[0]->mesh, {}, true, value == loss};
  panel.series.push_back({"Pareto front", plotted(front, value), true, false, 3});
  panel.series.push_back({"--preset", plotted(presets, value)});
  panel.series.push_back({"--max-stretch", plotted(joined(bounds, value), value), false, true, 2});
  draw_at_floor(panel, kUnseen);
  return panel;
}

Plot plot_of(const std::vector<ChartsPoint>& points, Value value) {
  Plot plot;
  plot.title = "error against time";
  plot.x_axis = "CPU ms";
  plot.y_axis = value == loss ? "L2 stretch - 1" : "seams / square root of area";
  plot.key = true;
  for (std::size_t first = 0, last = 0; first < points.size(); first = last) {
    std::vector<const ChartsPoint*> of_mesh;
    for (; last < points.size() && points[last].mesh == points[first].mesh; ++last)
      of_mesh.push_back(&points[last]);
    plot.panels.push_back(panel_of(of_mesh, value));
  }
  return plot;
}

}  // namespace

Result<std::vector<ChartsPoint>> charts_sweep(const std::string& name, const LoadedScene& loaded,
                                              int repeats, const Context& context) {
  MeshView view;
  view.positions = loaded.scene.positions;
  view.indices = loaded.scene.indices;
  std::vector<ChartsPoint> points;
  for (const ChartSetting& setting : settings()) {
    ChartsPoint point{name, setting.name, setting.preset};
    point.cpu_seconds = std::numeric_limits<double>::infinity();
    for (int i = 0; i < repeats; ++i) {
      const Result<ChartSet> made = make_charts(view, setting.options, context);
      if (!made.ok()) return made.status();
      point.cpu_seconds = std::min(
          point.cpu_seconds, made->timing.segmentation_cpu + made->timing.parameterization_cpu);
      point.stretch_l2 = made->distortion.stretch_l2;
      point.stretch_999 = made->distortion.stretch_999;
      point.seam = made->seam_length / std::sqrt(std::max(made->surface_area, 1e-300));
      point.charts = made->charts.size();
    }
    points.push_back(point);
  }
  return points;
}

std::string line(const ChartsPoint& p) {
  return fmt::format("{:<20} {:<8} {:>8.1f} ms {:>5} charts  L2 {:.4f}  99.9 % {:.3f}  seam {:.2f}",
                     p.mesh, p.setting, 1000 * p.cpu_seconds, p.charts, p.stretch_l2, p.stretch_999,
                     p.seam);
}

Status draw_sweep(const std::vector<ChartsPoint>& points, const std::filesystem::path& target) {
  for (const Value value : {loss, seams}) {
    Plot plot = plot_of(points, value);
    plot.file = target.filename().string() + (value == loss ? "-stretch.svg" : "-seams.svg");
    if (Status s = draw(plot, target.parent_path()); !s.ok()) return s;
  }
  return {};
}

}  // namespace atlas::bench
