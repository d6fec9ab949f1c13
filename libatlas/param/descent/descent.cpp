#include "libatlas/param/descent/descent.h"

#include <algorithm>
#include <utility>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/descent/judge.h"
#include "libatlas/param/descent/mend.h"
#include "libatlas/param/mesh/rest_shape.h"

namespace atlas::param {
namespace {

using Phase = ParamWorkspace::Timing;

// On rough surfaces, borders that cross themselves in more places can hardly ever be moved apart,
// and closing the cuts that cross is cheaper: with 16, eight noisy meshes took a quarter more time
// for as many charts. Charts on trial as one (FlatParts) are then given up: further attempts would
// have removed 50 of 17 100 charts, for a quarter of the time that joining takes (208 meshes).
constexpr std::size_t kMostSeparable = 2;

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

std::size_t count_flips(const LocalMesh& mesh, std::span<const Vec2d> uvs) {
  const auto flipped = [&](const auto& v) {
    const glm::dvec2 a = to_glm(uvs[v[0]]);
    return !(cross(to_glm(uvs[v[1]]) - a, to_glm(uvs[v[2]]) - a) > 0);
  };
  return std::size_t(std::count_if(mesh.triangles.begin(), mesh.triangles.end(), flipped));
}

}  // namespace

Descent::Descent(const LocalMesh& mesh, const FlattenOptions& options, ArapSolver& solver,
                 PhaseClock& clock)
    : mesh_(mesh), options_(options), solver_(solver), clock_(clock) {}

void Descent::run(FirstUvs from, ParamResult& r) {
  from_ = from;
  clock_.book(&Phase::solve);
  const std::optional<Distortion> last = lower_stretch(r);
  clock_.book(&Phase::solve);
  judge(mesh_, options_, r, last ? &*last : nullptr);
  clock_.book(&Phase::overlaps);
  draw_apart(r);
  mend_ruined(mesh_, options_, solver_, r);
  clock_.book(&Phase::overlaps);
}

// Lowers the stretch to the bound, where that may succeed. Returns the distortion of r.uvs if it
// was there.
std::optional<Distortion> Descent::lower_stretch(ParamResult& r) {
  turn_flips(r);
  clock_.book(&Phase::flips);
  if (options_.squeeze_iterations <= 0) return {};
  Distortion now = measure_distortion(mesh_, r.uvs);
  if (now.flips > 0 && options_.max_stretch <= kTightBound) return {};
  if (now.stretch_999 <= options_.max_stretch) return now;
  if (options_.local) {
    lower_tail(r);
  } else if (worth_squeezing(now, r.uvs)) {
    squeeze(options_.max_stretch, r.uvs);
    clock_.book(&Phase::solve);
    turn_flips(r);  // squeezing may have flipped triangles again
    clock_.book(&Phase::flips);
  }
  return {};
}

void Descent::turn_flips(ParamResult& r) {
  const std::size_t flips = count_flips(mesh_, r.uvs);
  const std::size_t most = std::max(kMostFlips, mesh_.triangles.size() / kMostFlipsShare);
  if (flips > 0 && (flips <= most || options_.max_stretch > kTightBound))
    r.unflipped += static_cast<int>(solver_.remove_flips(r.uvs).turned);
}

// For rough surfaces. If the stretch is too high in more than a few places, first squeezes the
// whole, since cuts would not help there.
void Descent::lower_tail(ParamResult& r) {
  const double bound = just_within * options_.max_stretch;
  if (solver_.lower_tail(bound, r.uvs) != Tail::wide) return;
  squeeze(bound, r.uvs);
  turn_flips(r);
  if (count_flips(mesh_, r.uvs) == 0) solver_.lower_tail(bound, r.uvs);
}

bool Descent::worth_squeezing(const Distortion& now, std::span<const Vec2d> uvs) const {
  const double most = most_squeezed(mesh_.triangles.size()) * options_.max_stretch;
  return !(now.flips == 0 && now.stretch_999 > most) && !entangled(uvs);
}

bool Descent::entangled(std::span<const Vec2d> uvs) const {
  const bool joined = from_ == FirstUvs::joined;
  if (!joined && mesh_.triangles.size() < kManyTriangles) return false;
  const std::size_t most = joined ? kMostSeparable : kMostCrossings;
  return check_injectivity(mesh_, uvs, {.max_crossings = most + 1}).crossings.size() > most;
}

void Descent::squeeze(double bound, std::span<Vec2d> uvs) {
  solver_.squeeze({bound, options_.squeeze_iterations, options_.squeeze_ratio, options_.rough},
                  uvs);
}

// Moves crossing borders apart, if all else is within the bound. If that fails, the result lists
// the crossings that remained.
void Descent::draw_apart(ParamResult& r) {
  if (r.injective || !r.within_bound || r.distortion.flips > 0) return;
  const bool few = options_.local || from_ == FirstUvs::joined;
  if (few && r.crossings.size() > kMostSeparable) return;
  if (!solver_.separate_borders(r.uvs)) {
    const auto left = solver_.crossings_left();
    r.stubborn_crossings.assign(left.begin(), left.end());
    return;
  }
  judge(mesh_, options_, r);
  if (!r.within_bound && r.injective) {
    solver_.settle_borders(r.uvs);
    judge(mesh_, options_, r);
  }
  const bool stretched = !r.within_bound && r.distortion.flips == 0;
  if (options_.local && stretched &&
      solver_.lower_tail(just_within * options_.max_stretch, r.uvs) == Tail::lowered) {
    judge(mesh_, options_, r);
  }
}

}  // namespace atlas::param
