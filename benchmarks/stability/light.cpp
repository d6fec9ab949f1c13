// Luminance, tone curves, outputs and the shadow blend at their limits.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>

#include "benchmarks/stability/checks.h"
#include "benchmarks/support/staged.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/export_world.h"
#include "libatlas/shadow/blend.h"

namespace atlas::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNever = std::numeric_limits<double>::quiet_NaN();
constexpr float kHuge = std::numeric_limits<float>::infinity();

LoadedScene lit_plane(const std::function<float(std::size_t)>& value) {
  LoadedScene loaded = lit(test::grid(40, 40));
  auto& light = loaded.scene.illumination;
  for (std::size_t i = 0; i < light.size(); ++i) light[i] = {value(i), value(i), value(i)};
  return loaded;
}

bool is_finite(Vec3f v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Display values must stay within [0, 1] for all input, and rise with the luminance until far
// beyond the range that the curve was made for. The check states where they first fall.
void check_curve(CheckList& list, const ToneMapping& tone, const std::string& stress) {
  const double white = double(tone.white) / tone.scale;
  double outside = 0, falls = 0, previous = -1, first_fall = kInfinity;
  const auto leave = [&](float c) {
    outside = std::max({outside, double(-c), double(c) - 1, std::isfinite(c) ? 0 : kInfinity});
  };
  for (double e = -45; e <= 38; e += 0.25) {
    const float v = float(std::pow(10, e));
    const Vec3f d = tone.display({v, v, v});
    leave(d.x);
    if (v <= white && v >= 1e-30 * white)
      falls = std::max(falls, previous - d.x);
    else if (v > white && previous - d.x > 1e-5)
      first_fall = std::min(first_fall, v / white);
    previous = d.x;
  }
  for (const float v : {-1.0f, -kHuge, kHuge, std::nanf(""), 0.0f}) {
    const Vec3f d = tone.display({v, 1, v});
    for (const float c : {d.x, d.y, d.z}) leave(c);
  }
  const StressChecks at = list.at("tone", stress);
  at.add("display values outside [0, 1]", outside, 0);
  at.add("fall of a curve that must rise", falls, 1e-5,
         first_fall > 1e6 ? "rises to a million times white at least"
                          : fmt::format("degrades: falls from {:.1e} x white on", first_fall));
}

struct Field {
  const char* name;
  std::function<float(std::size_t)> value;
};

const std::vector<Field>& fields() {
  static const std::vector<Field> list{
      {"1e-6 to 1e9 in one scene",
       [](std::size_t i) { return float(std::pow(10, -6 + double(i % 1681) / 1680 * 15)); }},
      {"one white vertex in black", [](std::size_t i) { return i == 840 ? 1e9f : 0.0f; }},
      {"all black", [](std::size_t) { return 0.0f; }},
      {"all 1e-30", [](std::size_t) { return 1e-30f; }},
      {"all 1e30", [](std::size_t) { return 1e30f; }},
      {"every third negative", [](std::size_t i) { return i % 3 ? 5.0f : -5.0f; }},
      {"every third infinite", [](std::size_t i) { return i % 3 ? 5.0f : kHuge; }},
      {"every third NaN", [](std::size_t i) { return i % 3 ? 5.0f : std::nanf(""); }},
      {"the last NaN", [](std::size_t i) { return i < 1680 ? 5.0f : std::nanf(""); }},
  };
  return list;
}

void check_export(CheckList& list, const Field& field) {
  const auto folder =
      std::filesystem::temp_directory_path() / fmt::format("atlas_light_{}", ::getpid());
  std::filesystem::create_directories(folder);
  ExportOptions options;
  options.target = folder / "world.obj";
  options.atlases = 1;
  options.atlas_size = 256;
  const LoadedScene plane = lit_plane(field.value);
  const Result<ExportReport> report = export_world(plane, options, {}, list.context);
  std::filesystem::remove_all(folder);
  const auto& light = plane.scene.illumination;
  const StressChecks at = list.at("light", field.name);
  // Readers replace such values, but callers must do so themselves.
  if (!std::all_of(light.begin(), light.end(), is_finite)) {
    at.add("exports that are not refused", report.ok() ? 1 : 0, 0,
           report.ok() ? "" : report.status().message());
    return;
  }
  at.add("exports that fail", report.ok() ? 0 : 1, 0, report.ok() ? "" : report.status().message());
  at.add("white is not finite and positive",
         report.ok() && std::isfinite(report->exposure_white) && report->exposure_white > 0 ? 0 : 1,
         0);
}

}  // namespace

void check_light(CheckList& list) {
  for (const Field& field : fields()) {
    const LoadedScene loaded = lit_plane(field.value);
    const LuminanceSampler sampler(loaded.scene, Quantity::illuminance);
    const Result<LuminanceStatistics> statistics = measure_luminance(sampler, list.context);
    for (const ToneOperator op : {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago,
                                  ToneOperator::reinhard_devlin}) {
      ToneOptions options;
      options.op = op;
      const std::string stress = fmt::format("{}, {}", tone_operator_name(op), field.name);
      const Result<ToneMapping> tone =
          statistics.ok() ? make_tone_mapping(options, *statistics) : statistics.status();
      if (tone.ok())
        check_curve(list, *tone, stress);
      else
        list.at("tone", stress).add("curves that cannot be made", 1, 0, tone.status().message());
    }
    check_export(list, field);
  }
  ImageF image(64, 1, 3);
  for (int x = 0; x < 64; ++x)
    for (int c = 0; c < 3; ++c) image.at(x, 0)[c] = float(std::pow(10, -4 + 8.5 * x / 63));
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("atlas_half_{}.exr", ::getpid());
  double worst = kNever;
  if (write_exr(path, image).ok()) {
    const Result<ImageF> back = read_image_float(path);
    if (back.ok()) {
      worst = 0;
      for (std::size_t i = 0; i < image.texels.size(); ++i)
        worst = std::max(worst, std::abs(double(back->texels[i]) / image.texels[i] - 1));
    }
  }
  std::filesystem::remove(path);
  list.at("outputs", "half floats, 1e-4 to 3e4")
      .add("relative error", worst, 0x1p-11 * 1.001,
           "half precision; beyond 65504 it is infinite, below 6e-5 it loses digits");
}

void check_downsizing(CheckList& list) {
  Staged staged("plane", lit(test::grid(60, 60)), list.context);
  double least_texels = kInfinity;
  for (const double threshold : {0.0, 1e-300, 1e-9, 1e-3, 2.0 / 255, 0.5, 1.0, 1e300}) {
    double over = kNever, grown = kNever;
    if (staged.need_charts().ok() && staged.need_light().ok()) {
      TextureOptions options;
      options.texel = 1.0 / 256;
      options.threshold = threshold;
      const Result<TextureResult> sized =
          size_chart_textures(staged.light(), options, list.context);
      if (sized.ok()) {
        over = threshold <= 0 ? double(sized->full_texels - sized->final_texels)
                              : sized->max_error - 4 * threshold;
        grown = double(sized->final_texels) - least_texels;
        least_texels = double(sized->final_texels);
      }
    }
    const std::string stress = fmt::format("threshold {:g}", threshold);
    const StressChecks at = list.at("downsizing", stress);
    at.add(threshold <= 0 ? "texels lost although there is no threshold"
                          : "largest error over 4 x threshold",
           over, 1e-6, "halvings add up: 2 of them here at most count");
    if (threshold > 0) {  // there is no smaller threshold before the first
      at.add("texels more than at a smaller threshold", grown, 0);
    }
  }
}

void check_blend(CheckList& list) {
  for (const double angle : {1e-18, 1e-12, 1e-8, 1e-5, 9e-5, 1.1e-4, 1e-2, 0.5, 1.57, 1.5708, 2.5,
                             3.14159, std::numbers::pi}) {
    double error = 0, sum = 0;
    for (double t = 0; t <= 1; t += 1.0 / 64) {
      const BlendWeights raw = blend_weights(KeyBlend::slerp_raw, t, angle);
      const BlendWeights normal = blend_weights(KeyBlend::slerp_normalised, t, angle);
      sum = std::max(sum, std::abs(normal.from + normal.to - 1));
      const long double a = angle, s = std::sin(a);
      const bool fall_back = angle > kMaxKeyDegrees * std::numbers::pi / 180;
      const long double from = fall_back ? 1 - t : std::sin((1 - (long double)t) * a) / s;
      const long double to = fall_back ? (long double)t : std::sin((long double)t * a) / s;
      error = std::max({error, std::abs(double(raw.from - from)), std::abs(double(raw.to - to)),
                        std::isfinite(raw.from + raw.to) ? 0 : kInfinity});
    }
    const std::string stress = fmt::format("angle {:g}", angle);
    const StressChecks at = list.at("SLERP", stress);
    at.add("raw weights against long double", error, 1e-8,
           "below a sine of 1e-4 linear weights stand in; above 90 degrees too, as documented");
    at.add("normalised weights: |sum - 1|", sum, 1e-15);
  }
}

}  // namespace atlas::bench
