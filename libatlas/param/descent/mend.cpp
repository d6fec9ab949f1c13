#include "libatlas/param/descent/mend.h"

#include <array>
#include <utility>
#include <vector>

#include "libatlas/core/glm_bridge.h"
#include "libatlas/param/descent/judge.h"

namespace atlas::param {
namespace {

// A triangle that stretches by more than this is mended, together with those that stretch by more
// than `strained`. In large charts a triangle is small, and each attempt measures the whole chart:
// with 2, a bunny of a million triangles took 5 % more time.
constexpr std::size_t large_chart = 20000;
constexpr double ruined_in_small = 2, ruined_in_large = 4, strained = 1.5;

// If the smooth state exceeds the bound, the chart goes only this share of the way to it. A quarter
// of the way already makes a triangle a quarter as large as it should be.
constexpr std::array shares{1.0, 0.5, 0.25};

// The places are smoothed again while that lowers the largest stretch to this share.
constexpr int rounds = 4;
constexpr double worth = 0.7;

enum class Outcome { mended, beyond_bound, crossing };

class Mender {
 public:
  Mender(const LocalMesh& mesh, const ParamOptions& options, ArapSolver& solver, ParamResult& r)
      : mesh_(mesh), options_(options), solver_(solver), r_(r) {}

  // Returns whether a mended state was found, which may be no better.
  bool run(std::span<const std::uint32_t> triangles, bool border_moves) {
    smooth_ = r_.uvs;
    solver_.smooth(triangles, border_moves, smooth_);
    for (const double share : shares) {
      const Outcome outcome = go(share, border_moves);
      if (outcome == Outcome::mended) return true;
      if (outcome == Outcome::crossing) return false;
    }
    return false;
  }

 private:
  Outcome go(double share, bool border_moves) {
    ParamResult mended = r_;
    for (std::size_t v = 0; v < smooth_.size(); ++v) {
      const glm::dvec2 from = to_glm(r_.uvs[v]);
      mended.uvs[v] = from_glm(from + share * (to_glm(smooth_[v]) - from));
    }
    judge(mesh_, options_, mended);
    if (mended.injective && !mended.within_bound && border_moves) {  // lowering moves the border
      solver_.lower_tail(just_within * options_.max_stretch, mended.uvs);
      judge(mesh_, options_, mended);
    }
    if (!mended.injective) return Outcome::crossing;
    if (!mended.within_bound) return Outcome::beyond_bound;
    const Distortion &before = r_.distortion, &after = mended.distortion;
    if (after.stretch_linf < before.stretch_linf && after.stretch_l2 <= before.stretch_l2)
      r_ = std::move(mended);
    return Outcome::mended;
  }

  const LocalMesh& mesh_;
  const ParamOptions& options_;
  ArapSolver& solver_;
  ParamResult& r_;
  std::vector<Vec2d> smooth_;
};

}  // namespace

void mend_ruined(const LocalMesh& mesh, const ParamOptions& options, ArapSolver& solver,
                 ParamResult& r) {
  const double ruined = mesh.triangles.size() < large_chart ? ruined_in_small : ruined_in_large;
  for (int round = 0; round < rounds; ++round) {
    if (!r.within_bound || !r.injective || !(r.distortion.stretch_linf > ruined)) return;
    const double before = r.distortion.stretch_linf;
    std::vector<double> stretch(mesh.triangles.size());
    measure_distortion(mesh, r.uvs, stretch);
    const std::vector<std::uint32_t> triangles = beyond_bound(stretch, strained);
    Mender mender(mesh, options, solver, r);
    if (!mender.run(triangles, true)) mender.run(triangles, false);
    if (!(r.distortion.stretch_linf < worth * before)) return;
  }
}

}  // namespace atlas::param
