// The parameterisation's linear systems on ill-conditioned discs: condition numbers, errors of the
// solvers, flips before and after the fallbacks, and the cost of these.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "benchmarks/stability/checks.h"
#include "benchmarks/stability/stress.h"
#include "benchmarks/support/measure.h"
#include "libatlas/param/parameterize.h"
#include "libatlas/param/solvers/linear_solver.h"
#include "libatlas/param/solvers/multigrid.h"

namespace atlas::bench {
namespace {

constexpr double kSteepest = 1.0;  // steepest spike that is flattened without a flip
using param::SymmetricMatrix;
using Vector = std::vector<glm::dvec2>;

// A disc in polar coordinates: a vertex in the middle, then rings from the inside out.
struct PolarDisc {
  std::string name;
  double spike = 0;  // height of the spike, if the disc has one
  std::vector<Vec3d> positions;
  std::vector<Vec2d> polar;  // first layout: (r cos a, r sin a) with r along the surface
  std::vector<std::array<std::uint32_t, 3>> triangles;
  LocalMesh mesh() const { return {positions, triangles}; }
};

template <class Profile>  // maps r in (0, 1] to (distance from the axis, height)
PolarDisc polar_disc(std::string name, const std::vector<double>& radii, int around,
                     const Profile& profile) {
  PolarDisc disc;
  disc.name = std::move(name);
  const Vec2d top = profile(0.0);
  disc.positions.push_back({0, 0, top.y});
  disc.polar.push_back({0, 0});
  for (const double r : radii)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * i / around;
      const Vec2d p = profile(r);
      disc.positions.push_back({p.x * std::cos(a), p.x * std::sin(a), p.y});
      disc.polar.push_back({r * std::cos(a), r * std::sin(a)});
    }
  const auto at = [&](std::size_t ring, int i) {
    return std::uint32_t(1 + ring * std::size_t(around) + std::size_t(i % around));
  };
  for (int i = 0; i < around; ++i) disc.triangles.push_back({0, at(0, i), at(0, i + 1)});
  for (std::size_t ring = 0; ring + 1 < radii.size(); ++ring)
    for (int i = 0; i < around; ++i) {
      disc.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)});
      disc.triangles.push_back({at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)});
    }
  return disc;
}

// A geodesic cap with pairs of rings. The triangles between the two rings of a pair have the given
// aspect.
PolarDisc sliver_cap(double aspect, int rings, int around) {
  std::vector<double> radii;
  for (int i = 1; i <= rings; ++i) {
    radii.push_back((i - 0.5) / rings);
    radii.push_back((i - 0.5 + 0.5 / aspect) / rings);
  }
  const double angle = std::numbers::pi / 3;
  return polar_disc(fmt::format("slivers of aspect {:g}", aspect), radii, around, [&](double r) {
    return Vec2d{std::sin(r * angle), std::cos(r * angle)};
  });
}

// A plane with a Gaussian spike of the given height, a tenth as wide as the disc.
PolarDisc spike(double height, int rings, int around) {
  std::vector<double> radii;
  for (int i = 1; i <= 2 * rings; ++i) radii.push_back(i / (2.0 * rings));
  PolarDisc disc =
      polar_disc(fmt::format("spike of height {:g}", height), radii, around, [&](double r) {
        return Vec2d{r, height * std::exp(-100 * r * r)};
      });
  disc.spike = height;
  return disc;
}

// A sphere with a hole of the given angle around the pole.
PolarDisc opened_ball(double hole_degrees, int rings, int around) {
  std::vector<double> radii;
  for (int i = 1; i <= 2 * rings; ++i) radii.push_back(i / (2.0 * rings));
  const double angle = (180 - hole_degrees) * std::numbers::pi / 180;
  return polar_disc(fmt::format("sphere with a hole of {:g} degrees", hole_degrees), radii, around,
                    [&](double r) {
                      return Vec2d{std::sin(r * angle), std::cos(r * angle)};
                    });
}

void multiply(const SymmetricMatrix& k, const Vector& x, Vector& out) {
  for (std::size_t i = 0; i < k.rows(); ++i) {
    glm::dvec2 sum = k.diagonal[i] * x[i];
    for (std::uint32_t e = k.first[i]; e < k.first[i + 1]; ++e) sum += k.value[e] * x[k.column[e]];
    out[i] = sum;
  }
}

// Subtracts the mean, scales to length one and returns the length before.
double normalise(Vector& x) {
  glm::dvec2 mean(0);
  for (const glm::dvec2& v : x) mean += v / double(x.size());
  double squares = 0;
  for (glm::dvec2& v : x) {
    v -= mean;
    squares += v.x * v.x;
  }
  const double length = std::sqrt(squares);
  for (glm::dvec2& v : x) v /= length;
  return length;
}

// Returns the ratio of the largest to the smallest eigenvalue outside the kernel (the constants),
// by power iteration with the matrix and with its inverse (Cholesky factors).
double condition(const SymmetricMatrix& k) {
  param::EnvelopeSolver solver;
  solver.factorize(k);
  Vector x(k.rows()), y(k.rows());
  double largest = 0, inverse = 0;
  for (const bool invert : {false, true}) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = glm::dvec2(std::sin(1.0 + 7.3 * double(i)));
    normalise(x);
    for (int step = 0; step < 60; ++step) {
      if (invert)
        solver.solve(x, y);
      else
        multiply(k, x, y);
      (invert ? inverse : largest) = normalise(y);
      x.swap(y);
    }
  }
  return largest * inverse;
}

// Returns the backward error |K x - b| / (|K| |x| + |b|), in maximum norms.
double backward_error(const SymmetricMatrix& k, const Vector& x, const Vector& b) {
  double norm = 0, most_x = 0, most_b = 0, worst = 0;
  for (std::size_t i = 0; i < k.rows(); ++i) {
    long double sum_x = (long double)k.diagonal[i] * x[i].x - b[i].x;
    long double sum_y = (long double)k.diagonal[i] * x[i].y - b[i].y;
    double row = std::abs(k.diagonal[i]);
    for (std::uint32_t e = k.first[i]; e < k.first[i + 1]; ++e) {
      sum_x += (long double)k.value[e] * x[k.column[e]].x;
      sum_y += (long double)k.value[e] * x[k.column[e]].y;
      row += std::abs(k.value[e]);
    }
    norm = std::max(norm, row);
    worst = std::max<double>({worst, double(std::abs(sum_x)), double(std::abs(sum_y))});
    most_x = std::max({most_x, std::abs(x[i].x), std::abs(x[i].y)});
    most_b = std::max({most_b, std::abs(b[i].x), std::abs(b[i].y)});
  }
  return worst / (norm * most_x + most_b);
}

// Returns the largest difference from the solution in long double (dense factors, the first vertex
// fixed), relative to the extent of the solution.
double forward_error(const SymmetricMatrix& k, const Vector& x, const Vector& b) {
  using Real = long double;
  const auto n = Eigen::Index(k.rows()) - 1;
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> dense =
      Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>::Zero(n, n);
  Eigen::Matrix<Real, Eigen::Dynamic, 2> load(n, 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto row = std::size_t(i) + 1;
    dense(i, i) = k.diagonal[row];
    load(i, 0) = b[row].x;
    load(i, 1) = b[row].y;
    for (std::uint32_t e = k.first[row]; e < k.first[row + 1]; ++e)
      if (k.column[e] > 0) dense(i, Eigen::Index(k.column[e]) - 1) += k.value[e];
  }
  const Eigen::Matrix<Real, Eigen::Dynamic, 2> exact = dense.llt().solve(load);
  Real worst = 0, extent = 0;
  for (Eigen::Index i = 0; i < n; ++i)
    for (int c = 0; c < 2; ++c) {
      const glm::dvec2 d = x[std::size_t(i) + 1] - x[0];
      worst = std::max(worst, std::abs(Real(d[c]) - exact(i, c)));
      extent = std::max(extent, std::abs(exact(i, c)));
    }
  return double(worst / extent);
}

struct System {
  param::Elements elements;
  SymmetricMatrix matrix;
  Vector load;

  explicit System(const PolarDisc& disc) {
    elements.build(disc.mesh(), 0);
    param::CornerLists corners;
    corners.build(elements, disc.positions.size());
    param::build_stiffness(elements, corners, matrix);
    param::Rotations rotations(elements.size(), glm::vec2(0));
    load.resize(disc.positions.size());
    param::update_rotations(elements, {disc.polar}, rotations, load);
  }
  double area() const {
    double sum = 0;
    for (std::size_t t = 0; t < elements.size(); ++t) sum += elements[t].area();
    return sum;
  }
};

void check_solvers(CheckList& list, const PolarDisc& disc, Row& row) {
  const LocalMesh mesh = disc.mesh();
  System s(disc);
  const double cond = condition(s.matrix);
  Vector x(disc.positions.size(), glm::dvec2(0));
  param::EnvelopeSolver envelope;
  envelope.factorize(s.matrix);
  envelope.solve(s.load, x);
  const double left = backward_error(s.matrix, x, s.load);
  const double error = forward_error(s.matrix, x, s.load);
  param::SparseDirectSolver direct;
  const bool definite = direct.factorize(s.matrix, false);
  double left_direct = 0;
  if (definite) {
    direct.solve(s.load, x);
    left_direct = backward_error(s.matrix, x, s.load);
  }
  param::HalfEdges half_edges;
  half_edges.build(mesh);
  param::MultigridSolver multigrid;
  std::vector<Vec2d> uvs(x.size());
  const bool iterated = multigrid.build(s.elements, half_edges, uvs.size()) &&
                        multigrid.solve({1e-11 * s.area(), 0, 60}, s.load, uvs);
  row.values = {{"condition", cond},
                {"residual", left},
                {"error", error},
                {"direct_residual", definite ? left_direct : NAN},
                {"multigrid_suffices", double(iterated)}};
  const StressChecks at = list.at("conditioning", disc.name);
  at.add("residual of the band solver, backward error", left, 1e-14,
         fmt::format("condition number {:.2g}", cond));
  at.add("residual of the sparse solver, backward error", left_direct, 1e-13,
         definite ? "" : "refused as not definite: the band solver stands in");
  at.add("error over 1e-15 x condition number", error / (1e-15 * std::max(cond, 1.0)), 1,
         "against a dense solve in long double");
}

// Compares four plain local/global steps with parameterize(), which adds the fallbacks: unfolding
// again, the barrier step, reweighting towards the bound, overlap removal at borders, and the exact
// check.
void check_fallbacks(CheckList& list, const PolarDisc& disc, Row& row) {
  ParamWorkspace workspace;
  const LocalMesh mesh = disc.mesh();
  IsometricResult plain;
  Row bare = row;
  measure(3, bare, [&]() -> Status {
    plain = flatten_isometric(mesh, {}, {4, 0}, workspace);
    return {};
  });
  ParamOptions options;
  options.method = ParamMethod::isometric;
  ParamResult full;
  measure(3, row, [&]() -> Status {
    Result<ParamResult> made = parameterize(mesh, options, workspace);
    if (!made.ok()) return made.status();
    full = std::move(*made);
    return {};
  });
  const double plain_stretch = measure_distortion(mesh, plain.uvs).stretch_999;
  const double cost = bare.cpu_seconds > 0 ? row.cpu_seconds / bare.cpu_seconds : 0;
  row.size_out = full.distortion.flips;
  row.values.insert(row.values.end(), {{"flips_without", double(plain.flips)},
                                       {"flips_with", double(full.distortion.flips)},
                                       {"stretch_without", plain_stretch},
                                       {"stretch_with", full.distortion.stretch_999},
                                       {"injective", double(full.injective)},
                                       {"cost_times", cost}});
  const StressChecks at = list.at("conditioning", disc.name);
  // A spike above kSteepest cannot be flattened in one piece; make_charts cuts it.
  if (disc.spike <= kSteepest)
    at.add("flips with the fallbacks", double(full.distortion.flips), 0,
           fmt::format("{} without them", plain.flips));
  at.add("overlaps although nothing flips", full.distortion.flips == 0 && !full.injective ? 1 : 0,
         0, "exact predicates");
}

// If parameterize() reports that one piece is impossible, make_charts has to cut.
void check_cutting(CheckList& list, const PolarDisc& disc) {
  test::Shape shape;
  for (const Vec3d& p : disc.positions)
    shape.positions.push_back({float(p.x), float(p.y), float(p.z)});
  for (const auto& t : disc.triangles)
    shape.indices.insert(shape.indices.end(), t.begin(), t.end());
  const Result<ChartSet> set = charts_of(shape, {}, list.context);
  list.at("conditioning", disc.name)
      .add("triangles lost or flipped in charts", set.ok() ? broken(*set) : NAN, 0,
           set.ok() ? fmt::format("{} charts, 99.9 % stretch {:.3f}", set->charts.size(),
                                  set->distortion.stretch_999)
                    : set.status().message());
}

// Finds the heights from which a spike flips triangles, in rows that were measured before.
void find_onsets(CheckList& list, const std::vector<PolarDisc>& discs) {
  double without = INFINITY, with = INFINITY;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    if (discs[i].spike <= 0) continue;
    if (list.rows[i].value("flips_without") > 0) without = std::min(without, discs[i].spike);
    if (list.rows[i].value("flips_with") > 0) with = std::min(with, discs[i].spike);
  }
  const auto onset = [&](const std::string& what, double documented, double measured) {
    list.at("conditioning", "height of a spike, disc of radius 1")
        .add(what, documented / measured, 1,
             fmt::format("documented from {:g}; measured from {:g}", documented, measured));
  };
  onset("local/global steps alone flip: documented / measured", 0.6, without);
  onset("parameterize() leaves flips to be cut: documented / measured", kSteepest, with);
}

}  // namespace

void check_conditioning(CheckList& list) {
  const int rings = list.options.full ? 9 : 6, around = list.options.full ? 36 : 24;
  std::vector<PolarDisc> discs;
  for (const double aspect : {1e0, 1e2, 1e4, 1e6, 1e8, 1e10, 1e12})
    discs.push_back(sliver_cap(aspect, rings, around));
  for (const double height : {0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 10.0})
    discs.push_back(spike(height, rings, around));
  for (const double hole : {90.0, 60.0, 30.0}) discs.push_back(opened_ball(hole, rings, around));
  for (const PolarDisc& disc : discs) {
    Row row;
    row.stage = "conditioning";
    row.mesh = disc.name;
    row.setting = "standard";
    row.unit = "triangles -> flips";
    row.triangles = row.size_in = disc.triangles.size();
    check_solvers(list, disc, row);
    check_fallbacks(list, disc, row);
    check_cutting(list, disc);
    list.rows.push_back(row);
  }
  find_onsets(list, discs);
}

}  // namespace atlas::bench
