#include "libatlas/view/bench.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libatlas/core/clock.h"
#include "libatlas/core/progress.h"

namespace atlas {
namespace {

struct Contender {
  Renderer renderer;
  BenchRun run;
  double total = 0;
};

FrameLight light_at(const LightPath& path, double step, int frame) {
  return {path.direction(frame * step),
          [&path, step, frame](int n) { return path.direction((frame + n) * step); }};
}

Result<FrameTime> timed_frame(Renderer& renderer, const Camera& camera, const FrameLight& light) {
  const double wall = wall_seconds(), cpu = cpu_seconds();
  Result<FrameStats> stats = renderer.draw(camera, light);
  if (!stats.ok()) return stats.status();
  renderer.finish();
  FrameTime t;
  t.wall = float(wall_seconds() - wall);
  t.cpu = float(cpu_seconds() - cpu);
  t.gpu_shadow = float(renderer.shadow_seconds());
  t.gpu_lit = float(renderer.lit_seconds());
  t.triangles_shadow = stats->triangles_shadow;
  t.triangles_lit = stats->triangles_lit;
  return t;
}

// A chain of dependent multiplications: takes no memory and cannot be shortened.
std::uint64_t spin(std::uint64_t rounds) {
  std::uint64_t x = rounds | 1;
  for (std::uint64_t i = 0; i < rounds; ++i) x = x * 6364136223846793005u + i;
  return x;
}

class Control {
 public:
  // Sets the number of rounds so that they last about `seconds`.
  void fit(double seconds) {
    constexpr std::uint64_t kTrial = 1 << 20;
    double fastest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 5; ++i) {
      const double start = wall_seconds();
      sink_ = sink_ + spin(kTrial);
      fastest = std::min(fastest, wall_seconds() - start);
    }
    rounds_ = std::uint64_t(double(kTrial) * seconds / std::max(fastest, 1e-9)) + 1;
  }
  void run() {
    const double wall = wall_seconds(), cpu = cpu_seconds();
    sink_ = sink_ + spin(rounds_);
    wall_.push_back(wall_seconds() - wall);
    cpu_.push_back(cpu_seconds() - cpu);
  }
  BenchControl result() const { return {rounds_, spread_of(wall_), spread_of(cpu_)}; }

 private:
  std::uint64_t rounds_ = 0;
  volatile std::uint64_t sink_ = 0;  // keeps the compiler from removing the work
  std::vector<double> wall_, cpu_;
};

void summarise(BenchRun& run) {
  std::vector<double> wall, cpu, gpu;
  double shadow = 0, lit = 0;
  for (const FrameTime& f : run.frames) {
    wall.push_back(f.wall);
    cpu.push_back(f.cpu);
    if (std::isfinite(f.gpu())) {
      gpu.push_back(f.gpu());
      shadow += f.gpu_shadow;
      lit += f.gpu_lit;
    }
    const double work = f.triangles_shadow + f.triangles_lit;
    run.work_mean += work / double(run.frames.size());
    run.work_worst = std::max(run.work_worst, work);
  }
  run.wall = spread_of(wall);
  run.cpu = spread_of(cpu);
  run.gpu = spread_of(gpu);
  run.shadow_share = shadow + lit > 0 ? shadow / (shadow + lit) : 0;
}

// Sums over the light positions of one method and interval.
struct ErrorSums {
  VisibilityError v;
  double squares = 0, ssim = 0;
  std::vector<double> cpu, gpu;
  int count = 0;
};

void add(ErrorSums& sums, const VisibilityError& e) {
  sums.v.mean += e.mean;
  sums.v.wrong += e.wrong;
  sums.v.mean_off_edges += e.mean_off_edges;
  sums.v.wrong_off_edges += e.wrong_off_edges;
  sums.v.edge_share += e.edge_share;
  ++sums.count;
}

BenchError finish(const ErrorSums& s, ShadowMethod method, int interval) {
  const double n = s.count;
  BenchError e;
  e.method = method;
  e.interval = interval;
  e.visibility = {s.v.mean / n, s.v.wrong / n, s.v.mean_off_edges / n, s.v.wrong_off_edges / n,
                  s.v.edge_share / n};
  e.psnr = s.squares > 0 ? 10 * std::log10(n / s.squares) : std::numeric_limits<double>::infinity();
  e.ssim = s.ssim / n;
  e.cpu_median = spread_of(s.cpu).p50;
  e.gpu_median = spread_of(s.gpu).p50;
  return e;
}

// Draws visibility and colours with one method at one interval, and sums their errors.
class ErrorProbe {
 public:
  static Result<ErrorProbe> make(const Renderer& first, RenderOptions options) {
    options.show_visibility = true;
    Result<Renderer> v = first.share(options);
    if (!v.ok()) return v.status();
    options.show_visibility = false;
    Result<Renderer> c = first.share(options);
    if (!c.ok()) return c.status();
    return ErrorProbe(std::move(*v), std::move(*c));
  }

  // Colours are drawn in every frame too, so that their keys are as old as those of the visibility.
  Status step(const Camera& camera, const FrameLight& light) {
    Result<FrameTime> t = timed_frame(visibility_, camera, light);
    if (!t.ok()) return t.status();
    sums.cpu.push_back(t->cpu);
    if (std::isfinite(t->gpu())) sums.gpu.push_back(t->gpu());
    Result<FrameStats> s = colours_.draw(camera, light);
    return s.ok() ? Status{} : s.status();
  }
  Image8 visibility() const { return visibility_.read_image(); }
  Image8 colours() const { return colours_.read_image(); }

  ErrorSums sums;

 private:
  ErrorProbe(Renderer v, Renderer c) : visibility_(std::move(v)), colours_(std::move(c)) {}
  Renderer visibility_, colours_;
};

// Measures all methods at the interval of options.render.
Result<std::vector<BenchError>> errors_of_interval(const Renderer& first, const LightPath& path,
                                                   const BenchOptions& options,
                                                   const Context& context) {
  RenderOptions render = options.render;
  render.shading = Shading::lambert;
  render.shadows = ShadowMethod::classic;
  Result<ErrorProbe> truth = ErrorProbe::make(first, render);
  if (!truth.ok()) return truth.status();
  std::vector<std::pair<ShadowMethod, ErrorProbe>> probes;
  for (ShadowMethod method : options.methods) {
    if (method == ShadowMethod::classic || method == ShadowMethod::none) continue;
    render.shadows = method;
    Result<ErrorProbe> probe = ErrorProbe::make(first, render);
    if (!probe.ok()) return probe.status();
    probes.emplace_back(method, std::move(*probe));
  }
  const int k = render.schedule.interval_frames;
  // A whole number of intervals, so that every t occurs equally often.
  const int count = (options.error_frames + k - 1) / k * k;
  for (int f = 0; f < count; ++f) {
    if (context.cancelled()) return Status::cancelled();
    const FrameLight light = light_at(path, options.degrees_per_frame, f);
    if (Status s = truth->step(options.camera, light); !s.ok()) return s;
    const Image8 v = truth->visibility(), c = truth->colours();
    for (auto& [method, probe] : probes) {
      if (Status s = probe.step(options.camera, light); !s.ok()) return s;
      add(probe.sums, visibility_error(probe.visibility(), v));
      const Image8 shown = probe.colours();
      probe.sums.squares += std::pow(10, -psnr(shown, c) / 10);
      probe.sums.ssim += ssim(shown, c);
    }
    context.report("errors", double(f + 1) / count);
  }
  std::vector<BenchError> errors;
  for (const auto& [method, probe] : probes) errors.push_back(finish(probe.sums, method, k));
  return errors;
}

// Returns which part of its frames and of its time the combination that is least far has had.
double done_of(const std::vector<Contender>& contenders, const BenchOptions& options) {
  double done = 1;
  for (const Contender& c : contenders) {
    done = std::min(done, double(c.run.frames.size()) / std::max(options.frames, 1));
    if (options.seconds > 0) done = std::min(done, c.total / options.seconds);
  }
  return done;
}

// Makes a renderer for every shading with every method.
Result<std::vector<Contender>> make_contenders(const Renderer& first, const BenchOptions& options) {
  std::vector<Contender> contenders;
  for (Shading shading : options.shadings)
    for (ShadowMethod method : options.methods) {
      RenderOptions render = options.render;
      render.shading = shading;
      render.shadows = method;
      render.show_visibility = false;
      Result<Renderer> made = first.share(render);
      if (!made.ok()) return made.status();
      Contender c{std::move(*made), {}, 0};
      c.run.shading = shading;
      c.run.method = method;
      contenders.push_back(std::move(c));
    }
  return contenders;
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  Spread s;
  if (values.empty()) return s;
  std::sort(values.begin(), values.end());
  for (double v : values) s.mean += v / double(values.size());
  const auto at = [&](double q) {  // nearest rank
    const double rank = std::ceil(q * double(values.size()));
    return values[std::size_t(std::max(rank - 1, 0.0))];
  };
  s.p50 = at(0.5);
  s.p95 = at(0.95);
  s.p99 = at(0.99);
  s.p999 = at(0.999);
  s.worst = values.back();
  return s;
}

Result<BenchTimes> bench_times(const Renderer& first, const LightPath& path,
                               const BenchOptions& options, const Context& context) {
  Result<std::vector<Contender>> made = make_contenders(first, options);
  if (!made.ok()) return made.status();
  std::vector<Contender>& contenders = *made;
  const int warm_up = std::max(options.warm_up, 2 * options.render.schedule.interval_frames);
  bool more = true;
  Control control;
  std::vector<double> warm;
  for (int f = 0; more; ++f) {
    if (context.cancelled()) return Status::cancelled();
    const FrameLight light = light_at(path, options.degrees_per_frame, f);
    more = f < warm_up;
    for (Contender& c : contenders) {
      Result<FrameTime> t = timed_frame(c.renderer, options.camera, light);
      if (!t.ok()) return t.status();
      if (f < warm_up) {
        warm.push_back(t->wall);
        continue;
      }
      c.run.frames.push_back(*t);
      c.total += t->wall;
      more |= int(c.run.frames.size()) < options.frames || c.total < options.seconds;
    }
    if (f + 1 == warm_up) control.fit(spread_of(warm).p50);
    if (f >= warm_up) control.run();
    context.report("times", done_of(contenders, options));
  }
  BenchTimes times;
  for (Contender& c : contenders) {
    summarise(c.run);
    times.runs.push_back(std::move(c.run));
  }
  times.control = control.result();
  return times;
}

Result<std::vector<BenchError>> bench_errors(const Renderer& first, const LightPath& path,
                                             const BenchOptions& options, const Context& context) {
  std::vector<BenchError> errors;
  const double share = 1.0 / double(std::max<std::size_t>(options.error_intervals.size(), 1));
  for (std::size_t i = 0; i < options.error_intervals.size(); ++i) {
    const int k = options.error_intervals[i];
    const Context part = part_of_stage(context, "errors", double(i) * share, double(i + 1) * share);
    BenchOptions with_k = options;
    with_k.render.schedule.interval_frames = k;
    with_k.render.schedule.interval_degrees = 0;
    Result<std::vector<BenchError>> of_k = errors_of_interval(first, path, with_k, part);
    if (!of_k.ok()) return of_k.status();
    errors.insert(errors.end(), of_k->begin(), of_k->end());
  }
  return errors;
}

}  // namespace atlas
