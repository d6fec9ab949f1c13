#include "libatlas/param/parameterize.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/arap_solver.h"
#include "libatlas/param/judge.h"
#include "libatlas/param/mend.h"
#include "libatlas/param/planar.h"
#include "libatlas/param/rest_shape.h"

namespace atlas {
namespace {

// Writes the projection along `axis` to uvs. Returns its distortion if that is within the bound.
std::optional<Distortion> project(const LocalMesh& mesh, Vec3d axis, double bound,
                                  std::span<Vec2d> uvs) {
  // At the area-preserving scale the square root of this product is 1 / s2 of every triangle.
  if (mesh.density.empty() && !(bound * bound * projected_share(mesh, axis) >= 1)) return {};
  project_planar(mesh, axis, uvs);
  const Distortion d = measure_distortion(mesh, uvs);
  if (!param::is_within(d, bound) || d.flips > 0) return {};
  return d;
}

// A chart with at most this mean stretch can be unrolled, and a few more steps do it exactly.
constexpr double kUnrolls = 1 + 1e-4, kUnrolled = 1 + 2e-4;
constexpr double kUnrollsExactly = 1 + 2e-6, kUnrolledStretch = 1.001;
constexpr int kUnrollingRounds = 4;
// In the last step, the energy must have fallen by more than this multiple of the L2 stretch minus
// 1. Of 60 charts of more than 400 triangles where it fell by less, none came down by more than a
// fifth in a round.
constexpr double kUnrollingFall = 3;

// On rough surfaces, borders that cross themselves in more places can hardly ever be moved apart,
// and closing the cuts that cross is cheaper: with 16, eight noisy meshes took a quarter more time
// for as many charts. Charts on trial as one (`joined`) are then given up: further attempts would
// have removed 50 of 17 100 charts, for a quarter of the time that joining takes (208 meshes).
constexpr std::size_t kMostSeparable = 2;

// Flat parts that stretch by this multiple of the bound when they are joined never came within it
// (measured).
constexpr double kPoorJoint = 1.75;

// With a bound this tight, charts still folded after flips were removed never came within it (25
// charts of 170 meshes).
constexpr double kTightBound = 1.5;
// The most flips, as a number and as 1 / kMostFlipsShare of the triangles, that are removed with
// such a bound. Of 1340 charts with flips in 240 meshes, 31 began with more, and none of them came
// within it.
constexpr std::size_t kMostFlips = 150, kMostFlipsShare = 100;

// Charts that stretch by more than this multiple of the bound are not squeezed: only 22 of 420 of
// them came within it (measured on 60 meshes; of those closer to it, 800 of 1190). Smaller charts
// may try from farther away, since that is cheap.
double most_squeezed(std::size_t triangles) {
  return triangles < 50     ? std::numeric_limits<double>::infinity()
         : triangles < 300  ? 4
         : triangles < 1000 ? 2.5
                            : 1.6;
}

// Measured on 180 meshes: of 55 charts of at least kManyTriangles whose border crossed itself in
// more places before they were squeezed, none could be saved.
constexpr std::size_t kMostCrossings = 12, kManyTriangles = 3000;

bool entangled(const LocalMesh& mesh, const ParamOptions& options, std::span<const Vec2d> uvs) {
  const bool joined = !options.joined.empty();
  if (!joined && mesh.triangles.size() < kManyTriangles) return false;
  const std::size_t most = joined ? kMostSeparable : kMostCrossings;
  return check_injectivity(mesh, uvs, {.max_crossings = most + 1}).crossings.size() > most;
}

// Adds the time since the last call to a phase.
class PhaseClock {
 public:
  PhaseClock(std::size_t triangles, ParamWorkspace& workspace) : timing_(workspace.timing) {
    if (triangles >= ParamWorkspace::timed_triangles) watch_.emplace(thread_cpu_seconds);
  }
  void book(double ParamWorkspace::Timing::*phase) {
    if (watch_) timing_.*phase += watch_->lap();
  }

 private:
  ParamWorkspace::Timing& timing_;
  std::optional<Stopwatch> watch_;
};
using Phase = ParamWorkspace::Timing;

std::size_t count_flips(const LocalMesh& mesh, std::span<const Vec2d> uvs) {
  const auto flipped = [&](const auto& v) {
    const glm::dvec2 a = to_glm(uvs[v[0]]);
    return !(param::cross(to_glm(uvs[v[1]]) - a, to_glm(uvs[v[2]]) - a) > 0);
  };
  return std::size_t(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), flipped));
}

// The data that all parts of a descent share.
struct Descent {
  const LocalMesh& mesh;
  const ParamOptions& options;
  param::ArapSolver& solver;
  bool laid = false;  // r.uvs contain what to start from
};

// Computes the first uvs. Returns what ArapSolver::iterate() does, or infinity.
double first_uvs(const Descent& d, std::span<Vec2d> uvs) {
  const auto& [mesh, options, solver, laid] = d;
  double fall = std::numeric_limits<double>::infinity();
  if (laid) {
    solver.start(IsometricStart{.uvs = uvs});
  } else if (!options.joined.empty()) {
    solver.join(options.joined, uvs);
  } else if (options.resume) {
    std::copy(options.start.uvs.begin(), options.start.uvs.end(), uvs.begin());
  } else {
    fall = solver.iterate(std::max(options.iterations, 1), uvs);
  }
  solver.rest();
  return fall;
}

void turn_flips(const Descent& d, ParamResult& r) {
  const auto& [mesh, options, solver, laid] = d;
  const std::size_t flips = count_flips(mesh, r.uvs);
  const std::size_t most = std::max(kMostFlips, mesh.triangles.size() / kMostFlipsShare);
  if (flips == 0 || (flips > most && options.max_stretch <= kTightBound)) return;
  r.unflipped += static_cast<int>(solver.remove_flips(r.uvs).turned);
}

// Takes more steps with what may unroll, as long as they change much: the last one changed by
// `fall`.
Distortion unroll(const Descent& d, double fall, Distortion now, std::span<Vec2d> uvs) {
  for (int round = 0; round < kUnrollingRounds; ++round) {
    if (fall <= kUnrollingFall * (now.stretch_l2 - 1)) break;
    fall = d.solver.iterate(std::max(d.options.iterations, 1), uvs);
    now = measure_distortion(d.mesh, uvs);
  }
  return now;
}

// For rough surfaces. If the stretch is too high in more than a few places, first squeezes the
// whole, since cuts would not help there.
void lower_tail(const Descent& d, ParamResult& r) {
  const auto& [mesh, options, solver, laid] = d;
  const double bound = param::just_within * options.max_stretch;
  if (solver.lower_tail(bound, r.uvs) != param::Tail::wide) return;
  solver.squeeze({bound, bound, options.squeeze_iterations, options.squeeze_ratio, options.rough},
                 r.uvs);
  turn_flips(d, r);
  if (count_flips(mesh, r.uvs) == 0) solver.lower_tail(bound, r.uvs);
}

// Moves crossing borders apart, if all else is within the bound. If that fails, the result lists
// the crossings that remained.
void draw_apart(const Descent& d, ParamResult& r) {
  const auto& [mesh, options, solver, laid] = d;
  if (r.injective || !r.within_bound || r.distortion.flips > 0) return;
  const bool few = options.local || !options.joined.empty();
  if (few && r.crossings.size() > kMostSeparable) return;
  ParamResult crossed;
  if (options.leave_crossings) crossed = r;
  if (!solver.separate_borders(r.uvs)) {
    const auto left = solver.crossings_left();
    r.stubborn_crossings.assign(left.begin(), left.end());
    return;
  }
  param::judge(mesh, options, r);
  if (!r.within_bound && r.injective) {
    solver.settle_borders(r.uvs);
    param::judge(mesh, options, r);
  }
  const bool stretched = !r.within_bound && r.distortion.flips == 0;
  if (options.local && stretched &&
      solver.lower_tail(param::just_within * options.max_stretch, r.uvs) == param::Tail::lowered) {
    param::judge(mesh, options, r);
  }
  if (!r.within_bound && options.leave_crossings) r = std::move(crossed);
}

// From the solver's rotations to a finished result: removes flips, then lowers the stretch.
// Squeezing may flip triangles again, hence the second round.
void descend(const Descent& d, PhaseClock& clock, ParamResult& r) {
  const auto& [mesh, options, solver, laid] = d;
  const bool joining = !options.joined.empty();
  const double fall = first_uvs(d, r.uvs);
  double aim =
      options.aimed_stretch > 0 && !options.local ? options.aimed_stretch : options.max_stretch;
  std::optional<Distortion> last;  // of the current r.uvs
  for (int round = 0; round < 2; ++round) {
    clock.book(&Phase::solve);
    turn_flips(d, r);
    clock.book(&Phase::flips);
    if (options.squeeze_iterations <= 0 || round > 0) break;
    Distortion now = measure_distortion(mesh, r.uvs);
    if (now.flips > 0 && options.max_stretch <= kTightBound) break;
    // Not if flips were removed, since the rotations are those of the folded state.
    if (!options.resume && r.unflipped == 0 && now.stretch_l2 < kUnrolls &&
        now.stretch_999 > kUnrolled && now.stretch_999 <= aim) {
      now = unroll(d, fall, now, r.uvs);
      if (now.stretch_l2 < kUnrollsExactly) aim = std::min(aim, kUnrolledStretch);
    }
    if (now.stretch_999 <= aim) {
      last = now;
      break;
    }
    if (options.local) {
      if (now.flips > 0 || (joining && now.stretch_999 > kPoorJoint * options.max_stretch)) break;
      lower_tail(d, r);
      break;
    }
    if (now.flips == 0 &&
        now.stretch_999 > most_squeezed(mesh.triangles.size()) * options.max_stretch) {
      break;
    }
    if (entangled(mesh, options, r.uvs)) break;
    solver.squeeze({aim, options.max_stretch, options.squeeze_iterations, options.squeeze_ratio,
                    options.rough},
                   r.uvs);
  }
  clock.book(&Phase::solve);
  param::judge(mesh, options, r, last ? &*last : nullptr);
  clock.book(&Phase::overlaps);
  draw_apart(d, r);
  param::mend_ruined(mesh, options, solver, r);
  clock.book(&Phase::overlaps);
}

// Parts that fit this well, relative to the shortest edge at a vertex, need no solving.
constexpr double kExactFit = 1e-3;

// Places each vertex at the mean of its corners in corner_uvs. Returns the largest distance of a
// corner from there, relative to the shorter edge of its triangle.
double lay_side_by_side(const LocalMesh& mesh, std::span<const Vec2d> corner_uvs,
                        std::span<Vec2d> uvs) {
  std::vector<glm::dvec3> sum(uvs.size(), glm::dvec3(0));
  for (std::size_t c = 0; c < corner_uvs.size(); ++c) {
    sum[mesh.triangles[c / 3][c % 3]] += glm::dvec3(to_glm(corner_uvs[c]), 1);
  }
  for (std::size_t v = 0; v < uvs.size(); ++v) uvs[v] = from_glm(glm::dvec2(sum[v]) / sum[v].z);
  double misfit = 0;
  for (std::size_t c = 0; c < corner_uvs.size(); ++c) {
    const auto& v = mesh.triangles[c / 3];
    const glm::dvec2 at = to_glm(uvs[v[c % 3]]);
    const double shorter = std::min(glm::distance(at, to_glm(uvs[v[(c + 1) % 3]])),
                                    glm::distance(at, to_glm(uvs[v[(c + 2) % 3]])));
    misfit = std::max(misfit, glm::distance(at, to_glm(corner_uvs[c])) / shorter);
  }
  return misfit;
}

void join(const LocalMesh& mesh, const ParamOptions& options, ParamWorkspace& workspace,
          ParamResult& r) {
  PhaseClock clock(mesh.triangles.size(), workspace);
  const double misfit = lay_side_by_side(mesh, options.joined, r.uvs);
  param::ArapSolver solver(mesh, {.min_altitude = options.min_altitude}, workspace.impl());
  descend({mesh, options, solver, options.patch || misfit < kExactFit}, clock, r);
}

}  // namespace

ParamResult parameterize(const LocalMesh& mesh, const ParamOptions& options,
                         ParamWorkspace& workspace) {
  PhaseClock clock(mesh.triangles.size(), workspace);
  ParamResult r;
  r.uvs.resize(mesh.positions.size());
  if (options.resume) {
    param::ArapSolver solver(mesh, {.min_altitude = options.min_altitude}, workspace.impl());
    descend({mesh, options, solver}, clock, r);
    return r;
  }
  const bool given_axis = options.axis.x != 0 || options.axis.y != 0 || options.axis.z != 0;
  const Vec3d axis = given_axis ? options.axis : mean_normal(mesh);
  const double planar_bound =
      options.max_planar_stretch > 0 ? options.max_planar_stretch : options.max_stretch;
  const bool only_planar = options.method == ParamMethod::planar;
  std::optional<Distortion> projected;
  if (only_planar) {
    project_planar(mesh, axis, r.uvs);
  } else if (options.method != ParamMethod::isometric) {
    projected = project(mesh, axis, planar_bound, r.uvs);
  }
  if (only_planar || projected) {
    r.planar = true;
    param::judge(mesh, options, r, projected ? &*projected : nullptr);
    if (r.injective || only_planar) return r;
    r = {};
    r.uvs.resize(mesh.positions.size());
  }
  if (!options.joined.empty()) {
    join(mesh, options, workspace, r);
    return r;
  }
  IsometricStart start = options.start;
  // Within a hemisphere the projection is as good a start as any, and free of holonomy.
  if (start.uvs.empty() && !start.frames && planar_stretch_bound(mesh, axis) < 4) {
    project_planar(mesh, axis, r.uvs);
    start.uvs = r.uvs;
    start.rough = true;
  }
  const bool unfolded = start.uvs.empty() && !start.frames;
  param::ArapSolver solver(mesh, {.min_altitude = options.min_altitude}, workspace.impl());
  solver.start(start);
  descend({mesh, options, solver}, clock, r);
  const bool folded = r.unflipped > 0 || r.distortion.flips > 0;
  if (r.injective || unfolded || !folded) return r;
  // A bad start leaves folds that no descent removes well; unfolding triangle by triangle has none.
  ParamResult other;
  other.uvs.resize(mesh.positions.size());
  solver.start(IsometricStart{});
  descend({mesh, options, solver}, clock, other);
  return other.injective ? other : r;
}

}  // namespace atlas
