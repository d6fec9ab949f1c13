// Charts under changes of unit, position and orientation, and on degenerate or nearly degenerate
// triangles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "benchmarks/stability/checks.h"
#include "benchmarks/stability/stress.h"

namespace atlas::bench {
namespace {

using test::Shape;

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();  // fails every bound

// Returns the relative growth. It is 0 if both are 0, as for the seams of a single flat chart.
double growth(double value, double reference) {
  return value == reference ? 0 : value / reference - 1;
}

void check_scales(CheckList& list, const Shape& shape, const ChartSet& reference) {
  // A power of two only changes exponents, so every bit of the result has to be the same.
  for (const int exponent : {-40, -20, 20, 40}) {
    const double scale = std::ldexp(1, exponent);
    const Result<ChartSet> set = charts_of(test::moved(shape, scale), {}, list.context);
    list.at("scale", fmt::format("{}, unit x 2^{}", shape.name, exponent))
        .add("uv drift / extent", set.ok() ? uv_drift(*set, reference, scale) : kNever, 1e-12,
             "reference: the same mesh unscaled");
  }
  for (const double scale : {1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12}) {
    const Result<ChartSet> set = charts_of(test::moved(shape, scale), {}, list.context);
    const std::string stress = fmt::format("{}, unit x {:g}", shape.name, scale);
    const auto counts = double(reference.charts.size());
    const StressChecks at = list.at("scale", stress);
    at.add("change of chart count beyond one, relative",
           set.ok() ? std::max(0.0, std::abs(double(set->charts.size()) - counts) - 1) / counts
                    : kNever,
           0.1, "coordinates round anew, so near ties may fall otherwise");
    at.add(
        "change of L2 stretch",
        set.ok() ? std::abs(set->distortion.stretch_l2 - reference.distortion.stretch_l2) : kNever,
        0.01);
    at.add("triangles lost or flipped", set.ok() ? broken(*set) : kNever, 0);
  }
}

void check_offsets(CheckList& list, const Shape& shape, const ChartSet& reference) {
  for (const double offset : {1e0, 1e3, 1e6, 1e7, 1e8, 1e9}) {
    const Result<LoadedScene> scene = read_moved(shape, offset, list.context);
    double change = kNever, bad = kNever;
    if (scene.ok()) {
      const Result<ChartSet> set =
          charts_of({"", scene->scene.positions, scene->scene.indices}, {}, list.context);
      if (set.ok()) {
        change = std::abs(set->distortion.stretch_l2 - reference.distortion.stretch_l2);
        bad = broken(*set);
      }
    }
    const std::string stress = fmt::format("{}, moved by {:g}", shape.name, offset);
    const StressChecks at = list.at("offset", stress);
    at.add("change of L2 stretch", change, 0.01, "the readers subtract an origin in double");
    at.add("triangles lost or flipped", bad, 0);
  }
}

Shape rotated(Shape shape, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (Vec3f& p : shape.positions) {
    const double x = c * p.x - s * p.y, y = s * p.x + c * p.y;
    p = {float(x), float(c * y - s * p.z), float(s * y + c * p.z)};
  }
  return shape;
}

void check_rotations(CheckList& list, const Shape& shape, const ChartSet& reference) {
  for (const double angle : {1e-6, 0.3, 1.0, 2.5}) {
    const Result<ChartSet> set = charts_of(rotated(shape, angle), {}, list.context);
    const std::string stress = fmt::format("{}, turned by {:g}", shape.name, angle);
    const StressChecks at = list.at("rotation", stress);
    at.add(
        "change of L2 stretch",
        set.ok() ? std::abs(set->distortion.stretch_l2 - reference.distortion.stretch_l2) : kNever,
        0.02);
    const double seam = reference.seam_length;
    at.add("relative growth of seams", set.ok() ? growth(set->seam_length, seam) : kNever, 0.25,
           "seeds are found anew: charts may differ, their cost must not");
  }
}

}  // namespace

void check_scale_and_place(CheckList& list) {
  for (const Shape& shape : subjects(list)) {
    const Result<ChartSet> reference = charts_of(shape, {}, list.context);
    list.at("place", shape.name)
        .add("triangles lost or flipped", reference.ok() ? broken(*reference) : kNever, 0);
    if (!reference.ok()) continue;
    check_scales(list, shape, *reference);
    check_offsets(list, shape, *reference);
    check_rotations(list, shape, *reference);
  }
}

void check_bad_triangles(CheckList& list) {
  const auto try_shape = [&](const std::string& stress, const Shape& shape) {
    const Result<ChartSet> set = charts_of(shape, {}, list.context);
    const StressChecks at = list.at("bad triangles", stress);
    at.add("triangles lost or flipped", set.ok() ? broken(*set) : kNever, 0);
    at.add("99.9 % stretch", set.ok() ? set->distortion.stretch_999 : kNever, 1.26, "option: 1.25");
  };
  for (const double aspect : {1e2, 1e4, 1e6, 1e8, 1e10, 1e12})
    try_shape(fmt::format("needles of aspect {:g}", aspect), test::needles(64, aspect));
  for (const int valence :
       list.options.full ? std::vector{100, 10000, 100000} : std::vector{100, 3000})
    try_shape(fmt::format("fan of valence {}", valence), test::fan(valence));
  Shape torn = test::icosphere(3);
  for (std::size_t i = 0; i + 7 < torn.positions.size(); i += 7)  // pairs one ulp apart
    torn.positions[i + 1] = {std::nextafter(torn.positions[i].x, 9.0f), torn.positions[i].y,
                             torn.positions[i].z};
  try_shape("vertices one ulp apart", torn);
  Shape crushed = test::icosphere(3);
  for (std::size_t t = 0; t + 5 < crushed.triangle_count(); t += 5)
    crushed.indices[3 * t + 1] = crushed.indices[3 * t];
  const Result<ChartSet> set = charts_of(crushed, {}, list.context);
  list.at("bad triangles", "every fifth triangle names a vertex twice")
      .add("triangles lost or flipped", set.ok() ? broken(*set) : kNever, 0);
}

void check_cones(CheckList& list) {
  const Shape ball = test::icosphere(list.options.full ? 5 : 3);
  for (const double cone : {1e-3, 15.0, 45.0, 60.0, 89.0, 90.0, 120.0, 180.0}) {
    ChartOptions options;
    options.cone_degrees = cone;
    const Result<ChartSet> set = charts_of(ball, options, list.context);
    double widest = set.ok() ? 0 : kNever, excess = widest;
    std::size_t projected = 0;
    if (set.ok()) {
      for (const Chart& chart : set->charts) {
        widest = std::max(widest, chart.cone_degrees);
        if (!chart.planar_projection || chart.cone_degrees >= 90) continue;
        ++projected;
        const double bound = 1 / std::cos(chart.cone_degrees * std::numbers::pi / 180);
        excess = std::max(excess, chart.distortion.stretch_linf / bound - 1);
      }
    }
    const std::string stress = fmt::format("cone of {:g} degrees", cone);
    const StressChecks at = list.at("cones", stress);
    at.add("widest cone, degrees", widest, cone + 1e-4, "float normals: 1e-4 degrees");
    at.add("planar stretch over 1/cos", excess, 1e-6,
           fmt::format("{} charts were projected; see closed forms, too", projected));
    at.add("triangles lost or flipped", set.ok() ? broken(*set) : kNever, 0);
  }
  // Two planes whose normals lie exactly at the limit, or one ulp of the cosine to either side.
  for (const int ulps : {-1, 0, 1}) {
    ChartOptions options;
    options.cone_degrees = 45;
    const double limit = std::cos(std::numbers::pi / 4);
    const double cosine = ulps == 0 ? limit : std::nextafter(limit, ulps < 0 ? 0.0 : 1.0);
    Shape roof = test::grid(2, 1, 2, 1);
    for (Vec3f& p : roof.positions)
      if (p.x > 1) p = {1.0f + float(cosine), p.y, float(std::sqrt(1 - cosine * cosine))};
    const Result<ChartSet> set = charts_of(roof, options, list.context);
    list.at("cones", fmt::format("fold of 45 degrees {:+d} ulp", ulps))
        .add("triangles lost or flipped", set.ok() ? broken(*set) : kNever, 0);
  }
}

}  // namespace atlas::bench
