// Writes the bench's files: CSV, JSON, Markdown, and a gnuplot script with its data.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libatlas/files/atomic_file.h"
#include "libatlas/view/bench.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

double spread_ratio(const Spread& s) {
  return s.p50 > 0 ? s.p95 / s.p50 : 0;
}

// Returns milliseconds with three digits, so that frames of 90 ms and of 0.2 ms are both legible.
std::string ms(double seconds) {
  const double t = seconds * 1e3;
  return fmt::format("{:.{}f}", t, t < 1 ? 3 : t < 10 ? 2 : 1);
}

std::string percentiles(const Spread& s) {
  return fmt::format("{} | {} | {} | {} | {} | {:.2f}", ms(s.p50), ms(s.p95), ms(s.p99), ms(s.p999),
                     ms(s.worst), spread_ratio(s));
}

std::string medians(const Spread& s) {
  return fmt::format("{} | {} | {:.2f}", ms(s.p50), ms(s.p95), spread_ratio(s));
}

// Names what was between two keys while frames were timed.
std::string interval_text(const BenchResult& r) {
  return r.interval_degrees > 0 ? fmt::format("keys every {:g}°", r.interval_degrees)
                                : fmt::format("k = {}", r.interval);
}

json milliseconds(const Spread& s) {
  return {{"mean", s.mean * 1e3},
          {"p50", s.p50 * 1e3},
          {"p95", s.p95 * 1e3},
          {"p99", s.p99 * 1e3},
          {"p999", s.p999 * 1e3},
          {"worst", s.worst * 1e3},
          {"p95_over_p50", spread_ratio(s)}};
}

json summary(const BenchResult& r) {
  json runs = json::array(), errors = json::array();
  for (const BenchRun& run : r.times.runs)
    runs.push_back({{"shading", name_of(run.shading)},
                    {"shadows", name_of(run.method)},
                    {"frames", run.frames.size()},
                    {"fps_mean", run.wall.mean > 0 ? 1 / run.wall.mean : 0},
                    {"wall_ms", milliseconds(run.wall)},
                    {"cpu_ms", milliseconds(run.cpu)},
                    {"gpu_ms", milliseconds(run.gpu)},
                    {"shadow_share", run.shadow_share},
                    {"triangles_mean", run.work_mean},
                    {"triangles_worst", run.work_worst}});
  for (const BenchError& e : r.errors) {
    // JSON has no infinity, so the PSNR of equal pictures is null.
    const json quality = std::isfinite(e.psnr) ? json(e.psnr) : json();
    errors.push_back({{"shadows", name_of(e.method)},
                      {"k", e.interval},
                      {"mean_visibility_error", e.visibility.mean},
                      {"wrong_pixels", e.visibility.wrong},
                      {"mean_visibility_error_off_edges", e.visibility.mean_off_edges},
                      {"wrong_pixels_off_edges", e.visibility.wrong_off_edges},
                      {"edge_band", e.visibility.edge_share},
                      {"psnr_db", quality},
                      {"ssim", e.ssim},
                      {"cpu_ms_median", e.cpu_median * 1e3},
                      {"gpu_ms_median", e.gpu_median * 1e3}});
  }
  return {{"device", r.device},
          {"opengl", r.version},
          {"software_renderer", r.software},
          {"width", r.width},
          {"height", r.height},
          {"map_resolution", r.map_resolution},
          {"k", r.interval_degrees > 0 ? json() : json(r.interval)},
          {"interval_degrees", r.interval_degrees},
          {"pcf", r.pcf},
          {"triangles", r.triangles},
          {"runs", runs},
          {"errors", errors},
          {"control",
           {{"rounds", r.times.control.rounds},
            {"wall_ms", milliseconds(r.times.control.wall)},
            {"cpu_ms", milliseconds(r.times.control.cpu)}}}};
}

std::string frames_csv(const BenchResult& r) {
  std::string csv =
      "shading,shadows,frame,wall_ms,cpu_ms,gpu_shadow_ms,gpu_lit_ms,triangles_shadow,"
      "triangles_lit\n";
  for (const BenchRun& run : r.times.runs)
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      const FrameTime& f = run.frames[i];
      csv += fmt::format("{},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{},{}\n", name_of(run.shading),
                         name_of(run.method), i, f.wall * 1e3, f.cpu * 1e3, f.gpu_shadow * 1e3,
                         f.gpu_lit * 1e3, f.triangles_shadow, f.triangles_lit);
    }
  return csv;
}

// Returns frames per second of every run of a method, one gnuplot block per run (the paper's
// figures 2 to 5).
std::string fps_data(const BenchResult& r, ShadowMethod method, std::string& plot) {
  std::string data;
  int block = 0;
  for (const BenchRun& run : r.times.runs) {
    if (run.method != method) continue;
    plot += fmt::format("{}'fps-{}.dat' index {} with lines title '{}'", block ? ", " : "plot ",
                        name_of(method), block, name_of(run.shading));
    ++block;
    for (std::size_t i = 0; i < run.frames.size(); ++i)
      data += fmt::format("{} {:.3f}\n", i, 1 / std::max<double>(run.frames[i].wall, 1e-9));
    data += "\n\n";
  }
  return data;
}

// Names the processor whose time a frame costs: the software renderer draws on the CPU.
const char* cost_name(const BenchResult& r) {
  return r.software ? "cpu" : "gpu";
}

double cost_of(const BenchResult& r, const FrameTime& f) {
  return r.software ? f.cpu : f.gpu();
}

// Returns what every frame cost, one block per method: it shows which method stalls, whatever
// else the machine does.
std::string cost_data(const BenchResult& r, Shading shading, std::string& plot) {
  std::string data;
  int block = 0;
  for (const BenchRun& run : r.times.runs) {
    if (run.shading != shading) continue;
    plot += fmt::format("{}'{}-{}.dat' index {} with lines title '{}'", block ? ", " : "plot ",
                        cost_name(r), name_of(shading), block, name_of(run.method));
    ++block;
    for (std::size_t i = 0; i < run.frames.size(); ++i)
      data += fmt::format("{} {:.4f}\n", i, cost_of(r, run.frames[i]) * 1e3);
    data += "\n\n";
  }
  return data;
}

// Returns the median cost of a frame and the mean visibility error, one block per method, one
// row per k.
std::string error_data(const BenchResult& r, std::string& plot) {
  std::string data;
  int block = 0;
  for (ShadowMethod method : kAllMethods) {
    std::vector<const BenchError*> of_method;
    for (const BenchError& e : r.errors)
      if (e.method == method) of_method.push_back(&e);
    std::stable_sort(of_method.begin(), of_method.end(),
                     [](const auto* a, const auto* b) { return a->interval < b->interval; });
    std::string rows;
    for (const BenchError* e : of_method)
      rows += fmt::format("{:.4f} {:.8f} {}\n", (r.software ? e->cpu_median : e->gpu_median) * 1e3,
                          e->visibility.mean, e->interval);
    if (rows.empty()) continue;
    plot += fmt::format(
        "{0}'error.dat' index {1} using 1:2 with linespoints lc {3} title '{2}', '' index {1} "
        "using 1:2:3 with labels offset {4} tc lt {3} notitle",
        block ? ", " : "plot ", block, name_of(method), block + 1,
        // So that both labels of coinciding curves are legible.
        block % 2 == 0 ? "-1,-0.8" : "1,0.6");
    ++block;
    data += rows + "\n\n";
  }
  return data;
}

}  // namespace

Status write_bench(const BenchResult& result, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return {ErrorCode::io,
            fmt::format("{}: the folder cannot be made ({})", folder.string(), error.message())};
  std::string script =
      "set terminal pngcairo size 800,480\nset linetype 5 lc rgb '#c00000'\n"
      "set key outside\nset xlabel 'frame'\n"
      "set ylabel 'frames a second'\nset yrange [0:*]\n";
  Status status = write_file(folder / "summary.json", summary(result).dump(2) + "\n");
  if (status.ok()) status = write_file(folder / "frames.csv", frames_csv(result));
  if (status.ok()) status = write_file(folder / "summary.md", bench_table(result));
  for (ShadowMethod method : kAllMethods) {
    std::string plot;
    const std::string data = fps_data(result, method, plot);
    if (data.empty()) continue;
    if (status.ok()) status = write_file(folder / fmt::format("fps-{}.dat", name_of(method)), data);
    script += fmt::format("set title 'shadows: {0}'\nset output 'fps-{0}.png'\n{1}\n",
                          name_of(method), plot);
  }
  const std::string cost = result.software ? "CPU time of a frame, ms" : "GPU time of a frame, ms";
  script += fmt::format("set ylabel '{}'\n", cost);
  for (Shading shading : {Shading::unlit, Shading::lambert, Shading::blinn_phong, Shading::ward}) {
    std::string plot;
    const std::string data = cost_data(result, shading, plot);
    if (data.empty()) continue;
    if (status.ok())
      status =
          write_file(folder / fmt::format("{}-{}.dat", cost_name(result), name_of(shading)), data);
    script += fmt::format("set title 'shading: {0}'\nset output '{2}-{0}.png'\n{1}\n",
                          name_of(shading), plot, cost_name(result));
  }
  std::string plot;
  if (const std::string data = error_data(result, plot); !data.empty()) {
    if (status.ok()) status = write_file(folder / "error.dat", data);
    script += fmt::format(
        "set title 'error against frame time, labels: k'\nset output 'error.png'\n"
        "set xlabel '{}'\nset ylabel 'mean |visibility error|'\n"
        "set logscale y\nset yrange [*:*]\nset offsets graph 0.06, graph 0.06, 0, 0\n{}\n",
        cost, plot);
  }
  if (status.ok()) status = write_file(folder / "plots.gp", script);
  return status;
}

std::string bench_table(const BenchResult& r) {
  std::string s = fmt::format("{} ({}), {} x {}, maps {}², {}, pcf {}, {} triangles\n\n", r.device,
                              r.software ? "software renderer" : "GPU", r.width, r.height,
                              r.map_resolution, interval_text(r), r.pcf, r.triangles);
  if (!r.times.runs.empty())
    s += "| shading | shadows | mean fps | wall ms: p50 | p95 | p99 | p99.9 | worst | p95 / p50 | "
         "CPU ms: p50 | p95 | p95 / p50 | GPU ms: p50 | p95 | p95 / p50 | shadow share | "
         "triangles: mean | worst |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
         "---|---|---|\n";
  for (const BenchRun& b : r.times.runs)
    s += fmt::format("| {} | {} | {:.1f} | {} | {} | {} | {:.0f} % | {:.0f} | {:.0f} |\n",
                     name_of(b.shading), name_of(b.method), b.wall.mean > 0 ? 1 / b.wall.mean : 0,
                     percentiles(b.wall), medians(b.cpu), medians(b.gpu), b.shadow_share * 100,
                     b.work_mean, b.work_worst);
  if (r.times.control.rounds > 0)
    s += fmt::format("| control | fixed arithmetic | | {} | {} | | | | | | |\n",
                     percentiles(r.times.control.wall), medians(r.times.control.cpu));
  if (!r.errors.empty())
    s +=
        "\n| shadows | k | mean \\|Δ visibility\\| | wrong pixels | off edges: mean | wrong | PSNR "
        "dB | SSIM |\n|---|---|---|---|---|---|---|---|\n";
  for (const BenchError& e : r.errors)
    s += fmt::format("| {} | {} | {:.5f} | {:.5f} | {:.5f} | {:.5f} | {:.2f} | {:.4f} |\n",
                     name_of(e.method), e.interval, e.visibility.mean, e.visibility.wrong,
                     e.visibility.mean_off_edges, e.visibility.wrong_off_edges, e.psnr, e.ssim);
  return s;
}

}  // namespace atlas
