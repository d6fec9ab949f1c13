// Surfaces whose best flattening is known.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "benchmarks/stability/checks.h"
#include "benchmarks/stability/stress.h"
#include "libatlas/param/descent/flatten_disc.h"
#include "libatlas/param/descent/planar.h"

namespace atlas::bench {
namespace {

struct Disc {
  std::vector<Vec3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  explicit Disc(const test::Shape& shape) {
    for (const Vec3f& p : shape.positions) positions.push_back({p.x, p.y, p.z});
    for (std::size_t t = 0; t < shape.triangle_count(); ++t)
      triangles.push_back(
          {shape.indices[3 * t], shape.indices[3 * t + 1], shape.indices[3 * t + 2]});
  }
  LocalMesh mesh() const { return {positions, triangles}; }
};

void check_developable(CheckList& list, const std::string& name, const test::Shape& shape) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Result<ChartSet> set = charts_of(shape, {}, list.context);
  const Distortion d = set.ok() ? set->distortion : Distortion{none, none, none};
  const StressChecks at = list.at("closed forms", name);
  at.add("L2 stretch", d.stretch_l2, 1.001, "developable: 1 is possible");
  at.add("99.9 % stretch", d.stretch_999, 1.001, "default options");
  ChartOptions tight;
  tight.max_stretch = 1.001;
  const Result<ChartSet> exact = charts_of(shape, tight, list.context);
  list.at("closed forms", name + ", bound 1.001")
      .add("99.9 % stretch", exact.ok() ? exact->distortion.stretch_999 : none, 1.001);
  list.at("closed forms", name + ", bound 1.001")
      .add("charts", exact.ok() ? double(exact->charts.size()) : none, 2, "one would do");
}

// Milnor 1969, "A problem in cartography": no map of a geodesic cap of half-angle a has a smaller
// ratio of greatest to least singular value than a / sin a.
void check_cap(CheckList& list, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, optimum = angle / std::sin(angle);
  const int rings = list.options.full ? 48 : 24;
  const Disc cap(test::cap(4 * rings, rings, angle));
  param::FlattenOptions options;
  options.method = ParamMethod::isometric;
  options.iterations = 20;
  options.max_stretch = 1.0001;  // cannot be reached, so that every step is used
  options.squeeze_iterations = 60;
  options.squeeze_ratio = true;
  ParamWorkspace workspace;
  const ParamResult result = param::flatten_disc(cap.mesh(), options, workspace);
  std::vector<TriangleStretch> stretch(cap.triangles.size());
  measure_triangles(cap.mesh(), result.uvs, stretch);
  double greatest = 0, least = std::numeric_limits<double>::infinity();
  for (const TriangleStretch& t : stretch) {
    greatest = std::max<double>(greatest, t.s1);
    least = std::min<double>(least, t.s2);
  }
  const std::string stress = fmt::format("geodesic cap of half-angle {} degrees", degrees);
  const StressChecks at = list.at("closed forms", stress);
  at.add("ratio of singular values over a / sin a - 1", greatest / least / optimum - 1, 0.02,
         fmt::format("optimum {:.4f}", optimum));
  at.add("not injective", result.injective ? 0 : 1, 0);
}

// Projects along an axis. Every triangle has s1 = 1 / cos of its normal's angle and s2 = 1, so the
// set stays within the bound that planar_stretch_bound() gives beforehand.
void check_projection(CheckList& list, double degrees) {
  const Disc cap(
      test::noisy(test::cap(40, 10, degrees * std::numbers::pi / 180), 3e-5 * degrees, 5));
  std::vector<Vec2d> uvs(cap.positions.size());
  std::vector<TriangleStretch> stretch(cap.triangles.size());
  double over = 0, off = 0;
  std::size_t projections = 0;
  for (const Vec3d& axis : {Vec3d{0, 0, 1}, Vec3d{0.2, 0.1, 1}, Vec3d{-0.3, 0.3, 2}}) {
    const double bound = planar_stretch_bound(cap.mesh(), axis);
    if (!std::isfinite(bound)) continue;
    ++projections;
    project_planar(cap.mesh(), axis, uvs);
    measure_triangles(cap.mesh(), uvs, stretch);
    for (const TriangleStretch& t : stretch) {
      over = std::max(over, t.s1 / bound - 1);
      off = std::max(off, std::abs(double(t.s2) - 1));
    }
    // The bound also holds at the area-preserving scale.
    over = std::max(over, measure_distortion(cap.mesh(), uvs).stretch_linf / bound - 1);
  }
  const std::string stress = fmt::format("noisy cap of {} degrees, projected", degrees);
  const StressChecks at = list.at("closed forms", stress);
  at.add("stretch over 1/cos - 1", over, 1e-6,
         fmt::format("{} axes, {} triangles", projections, cap.triangles.size()));
  at.add("smaller singular value - 1", off, 1e-6, "1 exactly");
  at.add("no axis saw all triangles from the front", projections == 0, 0);
}

}  // namespace

void check_closed_forms(CheckList& list) {
  const int n = list.options.full ? 200 : 60;
  check_developable(list, "cylinder", test::cylinder(n, n / 2));
  check_developable(list, "flat cylinder", test::cylinder(n, 2, 1, 0.01));
  check_developable(list, "flat cylinder of 100 quads", test::cylinder(100, 2, 1, 0.01));
  check_developable(list, "ribbon of 80 quads", test::cylinder(80, 4, 1, 0.003));
  check_developable(list, "cone of 30 degrees", test::cone(n, n / 2, std::numbers::pi / 6));
  check_developable(list, "cone of 80 degrees", test::cone(n, n / 2, 1.4));
  check_developable(list, "grid", test::grid(n, n));
  for (const double degrees : {5.0, 30.0, 60.0, 75.0}) check_projection(list, degrees);
  for (const double degrees : {15.0, 30.0, 60.0, 90.0}) check_cap(list, degrees);
}

}  // namespace atlas::bench
