#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "benchmarks/charts/charts_bench.h"
#include "benchmarks/support/chart_setting.h"
#include "benchmarks/support/pareto.h"
#include "libatlas/charts/charts.h"

namespace atlas::bench {
namespace {

std::vector<ChartSetting> settings() {
  std::vector<ChartSetting> list = chart_presets();
  list[1].name = "default";  // as on the command line
  for (const double stretch : {1.05, 1.1, 1.15, 1.5, 2.0}) list.push_back(with_stretch(stretch));
  return list;
}

using Value = double (*)(const ChartsPoint&);
double loss(const ChartsPoint& p) {
  return std::max(p.stretch_l2 - 1, 1e-6);
}
double seams(const ChartsPoint& p) {
  return p.seam;
}

double time(const ChartsPoint* p) {
  return p->cpu_seconds;
}

std::string block(const std::string& name, const std::vector<const ChartsPoint*>& points,
                  Value value) {
  std::string text = fmt::format("${} << EOD\n", name);
  for (const ChartsPoint* p : points)
    text += fmt::format("{:.6g} {:.6g} \"{}\"\n", 1000 * p->cpu_seconds, value(*p), p->setting);
  return text + "EOD\n";
}

// Bounds that come to the same place share a point and its label.
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

std::string script(const std::vector<ChartsPoint>& points, const std::string& terminal,
                   const std::filesystem::path& target) {
  std::vector<std::string> meshes;
  for (const ChartsPoint& p : points)
    if (std::find(meshes.begin(), meshes.end(), p.mesh) == meshes.end()) meshes.push_back(p.mesh);
  std::string data, plots;
  for (int row = 0; row < 2; ++row)
    for (std::size_t k = 0; k < meshes.size(); ++k) {
      std::vector<const ChartsPoint*> all, presets, bounds;
      for (const ChartsPoint& p : points)
        if (p.mesh == meshes[k]) {
          all.push_back(&p);
          (p.preset ? presets : bounds).push_back(&p);
        }
      const Value value = row == 0 ? loss : seams;
      const std::string id = fmt::format("{}_{}", row, k);
      data +=
          block("front" + id,
                pareto_front(all, time, [&](const ChartsPoint* p) { return value(*p); }), value) +
          block("presets" + id, presets, value);
      const std::vector<ChartsPoint> apart = joined(bounds, value);
      bounds.clear();
      for (const ChartsPoint& p : apart) bounds.push_back(&p);
      data += block("bounds" + id, bounds, value);
      plots += fmt::format("set title \"{}\"\n", row == 0 ? meshes[k] : "");
      plots += row == 0 ? "set logscale y\nset format y '10^{%L}'\nset xlabel ''\n"
                        : "unset logscale y\nset format y '%g'\nset xlabel 'CPU ms'\n";
      plots += fmt::format("set ylabel '{}'\n", k > 0      ? ""
                                                : row == 0 ? "L2 stretch - 1"
                                                           : "seams / square root of area");
      plots += fmt::format(
          "plot $front{0} using 1:2 with lines lw 2 lc rgb '#b0b0b0',"
          " $bounds{0} using 1:2 with points pt 7 ps 0.8 lc rgb '#1f6fb4',"
          " $bounds{0} using 1:2:3 with labels left offset 0.8,0.1 tc rgb '#1f6fb4',"
          " $presets{0} using 1:2 with points pt 5 ps 1.1 lc rgb '#c8402a'",
          id);
      // The presets lie close together: each label on a side of its own.
      for (const char* side :
           {"fast right offset -0.9,0", "default center offset 0,-0.9", "best left offset 0.9,0"}) {
        const std::string text = side, word = text.substr(0, text.find(' '));
        plots += fmt::format(
            ", $presets{0} using 1:(strcol(3) eq '{1}' ? $2 : NaN):3 with labels{2} tc rgb "
            "'#c8402a'",
            id, word, text.substr(word.size()));
      }
      plots += "\n";
    }
  return data + "set terminal " + terminal +
         fmt::format(
             "\nset output '{}'\nset grid lc rgb '#e4e4e4'\nunset key\nset logscale x\n"
             "set xtics (5,10,20,50,100,200,500,1000,2000,5000,10000)\n"
             "set autoscale xfix\nset autoscale yfix\n"
             "set offsets graph 0.25, graph 0.22, graph 0.12, graph 0.12\n"
             "set multiplot layout 2,{} title \"error against time: red --preset, blue "
             "--max-stretch, grey the Pareto front\"\n",
             target.string(), meshes.size()) +
         plots + "unset multiplot\n";
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
  const auto columns = std::max<std::size_t>(1, points.size() / settings().size());
  for (const char* extension : {".svg", ".png"}) {
    const bool svg = std::string(extension) == ".svg";
    const std::string size = fmt::format("size {},700", 400 * columns);
    const std::string terminal = svg ? "svg " + size + " font 'sans,12' background rgb 'white'"
                                     : "pngcairo " + size + " font 'sans,10'";
    std::filesystem::path file = target;
    file += extension;
    const std::string text = script(points, terminal, file);
    FILE* pipe = popen("gnuplot", "w");
    if (!pipe) return {ErrorCode::io, "gnuplot cannot be started (package gnuplot-nox)"};
    std::fwrite(text.data(), 1, text.size(), pipe);
    if (pclose(pipe) != 0)
      return {ErrorCode::io,
              file.string() + ": gnuplot failed (is the package gnuplot-nox there?)"};
  }
  return {};
}

}  // namespace atlas::bench
