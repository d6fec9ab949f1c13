// Where a method degrades: compares the measured stress at which that starts with the one that
// docs/stability.md states. Every row is documented onset / measured onset (or the inverse, where
// small values are the stress) and must not exceed one, so nothing may start earlier than
// documented.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "benchmarks/stability/checks.h"
#include "benchmarks/stability/stress.h"
#include "libatlas/image/image_io.h"
#include "libatlas/shadow/blend.h"
#include "libatlas/texture/tone.h"

namespace atlas::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr const char* kGroup = "where methods degrade";

// `documented` and `measured` are the stress from which the quantity leaves its tolerance.
void onset(const StressChecks& at, const std::string& what, double documented, double measured) {
  at.add(what, documented / measured, 1,
         std::isinf(measured)
             ? fmt::format("documented from {:g}; none seen", documented)
             : fmt::format("documented from {:g}; measured from {:g}", documented, measured));
}

void check_unit(CheckList& list, const test::Shape& shape, const ChartSet& reference) {
  double most = 0;
  for (const double unit : {0.001, 0.01, 0.0254, 0.1, 0.3048, 3.0, 10.0, 39.37, 1000.0}) {
    const Result<ChartSet> set = charts_of(test::moved(shape, unit), {}, list.context);
    const double change =
        set.ok() ? std::abs(double(set->charts.size()) - double(reference.charts.size()))
                 : kInfinity;
    most = std::max(most, change);
  }
  list.at(kGroup, shape.name + ", units that are no power of two")
      .add("change of chart count", most, std::max(1.0, 0.05 * double(reference.charts.size())),
           "coordinates round anew, so near ties fall otherwise; powers of two change nothing");
}

// Finds the smallest power of ten at which an OBJ in doubles, moved that far, gives other charts.
void check_offset(CheckList& list, const test::Shape& shape, const ChartSet& reference) {
  double from = kInfinity;
  bool lost = false;
  for (int e = 6; e <= 16; ++e) {
    const double offset = std::pow(10, e);
    const Result<LoadedScene> scene = read_moved(shape, offset, list.context);
    if (!scene.ok()) {
      lost = true;
      continue;
    }
    const Result<ChartSet> set =
        charts_of({"", scene->scene.positions, scene->scene.indices}, {}, list.context);
    lost |= !set.ok() || broken(*set) > 0;
    if (!set.ok() || std::abs(set->seam_length / reference.seam_length - 1) > 0.1)
      from = std::min(from, offset);
  }
  onset(list.at(kGroup, shape.name + ", offset in parts of its size"), "seams change by 10 %", 1e10,
        from);
  list.at(kGroup, shape.name + ", offsets to 10^16 of its size")
      .add("runs that lose triangles", lost, 0, "degraded or not, every triangle gets a place");
}

void check_drago(CheckList& list) {
  double from = kInfinity;
  for (double ratio = 10; ratio < 1e12; ratio *= 1.5) {  // white relative to the log-average
    LuminanceStatistics statistics;
    statistics.lit_area = statistics.log_average = statistics.mean = 1;
    statistics.maximum = statistics.percentile98 = ratio;
    ToneOptions options;
    options.op = ToneOperator::drago;
    const Result<ToneMapping> tone = make_tone_mapping(options, statistics);
    if (!tone.ok()) {
      from = std::min(from, ratio);
      continue;
    }
    const double white = double(tone->white) / tone->scale;
    double previous = tone->display({float(white), float(white), float(white)}).x;
    for (double over = 1.2; over < 1e6; over *= 1.2) {
      const auto v = float(white * over);
      const double d = tone->display({v, v, v}).x;
      if (previous - d > 1e-5) from = std::min(from, ratio);
      previous = d;
    }
  }
  onset(list.at(kGroup, "Drago's curve, white over the log-average"),
        "highlights above white turn darker", 4e4, from);
}

void check_half(CheckList& list) {
  ImageF image(2000, 1, 3);
  const auto value = [](int x) { return float(std::pow(10, -9 + 15.0 * x / 1999)); };
  for (int x = 0; x < image.width; ++x)
    for (int c = 0; c < 3; ++c) image.at(x, 0)[c] = value(x);
  const TemporaryFile file("half.exr");
  const Status written = write_exr(file.path, image);
  const Result<ImageF> back = written.ok() ? read_image_float(file.path) : Result<ImageF>(written);
  double low = back.ok() ? 0 : kInfinity, high = back.ok() ? kInfinity : 0;
  for (int x = 0; back.ok() && x < image.width; ++x) {
    const double error = std::abs(double(back->at(x, 0)[0]) / value(x) - 1);
    if (error <= 0x1p-11 * 1.001) continue;
    if (value(x) < 1)
      low = std::max(low, double(value(x)));
    else
      high = std::min(high, double(value(x)));
  }
  onset(list.at(kGroup, "half-float outputs, large values"), "relative error above 2^-11", 65504,
        high);
  onset(list.at(kGroup, "half-float outputs, 1 / small values"), "relative error above 2^-11",
        1 / 6.2e-5, low > 0 ? 1 / low : kInfinity);
}

// Compares raw SLERP weights with their formula in long double.
void check_slerp(CheckList& list) {
  double small = kInfinity, large = kInfinity;
  for (double angle = 1e-9; angle < std::numbers::pi; angle *= 1.05) {
    const long double a = angle, t = 0.25L;
    const BlendWeights w = blend_weights(KeyBlend::slerp_raw, double(t), angle);
    const bool linear = w.from == 0.75 && w.to == 0.25;
    const bool off = std::abs(double(std::sin((1 - t) * a) / std::sin(a)) - w.from) > 1e-8;
    if (angle < 1 && linear) small = std::min(small, 1 / angle);
    if (angle > 1 && off) large = std::min(large, angle * 180 / std::numbers::pi);
  }
  onset(list.at(kGroup, "SLERP, 1 / angle in radians"),
        "linear weights stand in (differ by less than 1e-8)", 1e4, small);
  onset(list.at(kGroup, "SLERP, degrees between the keys"), "linear weights stand in", 90, large);
}

}  // namespace

void check_degradation(CheckList& list) {
  for (const test::Shape& shape : subjects(list)) {
    const Result<ChartSet> reference = charts_of(shape, {}, list.context);
    list.at(kGroup, shape.name).add("charts that cannot be made", reference.ok() ? 0 : 1, 0);
    if (!reference.ok()) continue;
    check_unit(list, shape, *reference);
    check_offset(list, shape, *reference);
  }
  check_drago(list);
  check_half(list);
  check_slerp(list);
}

}  // namespace atlas::bench
