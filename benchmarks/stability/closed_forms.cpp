// Surfaces whose best flattening is known.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "benchmarks/stability/checks.h"
#include "libatlas/charts/charts.h"
#include "libatlas/param/parameterize.h"

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

// The default bound on stretch lets projections stand that are within it, so the flattening itself
// is seen where the bound is tight.
void check_developable(CheckList& list, const std::string& name, const test::Shape& shape) {
  MeshView view;
  view.positions = shape.positions;
  view.indices = shape.indices;
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Result<ChartSet> set = make_charts(view, {}, list.context);
  list.add("closed forms", name, "L2 stretch", set.ok() ? set->distortion.stretch_l2 : none, 1.001,
           "developable: 1 is possible");
  ChartOptions tight;
  tight.max_stretch = 1.001;
  const Result<ChartSet> exact = make_charts(view, tight, list.context);
  list.add("closed forms", name + ", bound 1.001", "99.9 % stretch",
           exact.ok() ? exact->distortion.stretch_999 : none, 1.001);
  list.add("closed forms", name + ", bound 1.001", "charts",
           exact.ok() ? double(exact->charts.size()) : none, 12, "few: it was not cut to pieces");
}

// Milnor 1969, "A problem in cartography": no map of a geodesic cap of half-angle a has a smaller
// ratio of greatest to least singular value than a / sin a.
void check_cap(CheckList& list, double degrees) {
  const double angle = degrees * std::numbers::pi / 180, optimum = angle / std::sin(angle);
  const int rings = list.options.full ? 48 : 24;
  const Disc cap(test::cap(4 * rings, rings, angle));
  ParamOptions options;
  options.method = ParamMethod::isometric;
  options.iterations = 20;
  options.max_stretch = 1.0001;  // out of reach, so that every step is spent
  options.squeeze_iterations = 60;
  options.squeeze_ratio = true;
  ParamWorkspace workspace;
  const ParamResult result = parameterize(cap.mesh(), options, workspace);
  std::vector<TriangleStretch> stretch(cap.triangles.size());
  measure_triangles(cap.mesh(), result.uvs, stretch);
  double greatest = 0, least = std::numeric_limits<double>::infinity();
  for (const TriangleStretch& t : stretch) {
    greatest = std::max<double>(greatest, t.s1);
    least = std::min<double>(least, t.s2);
  }
  const std::string stress = fmt::format("geodesic cap of half-angle {} degrees", degrees);
  list.add("closed forms", stress, "ratio of singular values over a / sin a - 1",
           greatest / least / optimum - 1, 0.02, fmt::format("optimum {:.4f}", optimum));
  list.add("closed forms", stress, "not injective", result.injective ? 0 : 1, 0);
}

}  // namespace

void check_closed_forms(CheckList& list) {
  const int n = list.options.full ? 200 : 60;
  check_developable(list, "cylinder", test::cylinder(n, n / 2));
  check_developable(list, "flat cylinder", test::cylinder(n, 2, 1, 0.01));
  check_developable(list, "cone of 30 degrees", test::cone(n, n / 2, std::numbers::pi / 6));
  check_developable(list, "cone of 80 degrees", test::cone(n, n / 2, 1.4));
  check_developable(list, "grid", test::grid(n, n));
  for (const double degrees : {15.0, 30.0, 60.0, 90.0}) check_cap(list, degrees);
}

}  // namespace atlas::bench
