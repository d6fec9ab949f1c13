// Internal: would two charts of the coarse mesh flatten well as one?
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/charts/merging/coarse.h"
#include "libatlas/charts/merging/coarse_uv.h"
#include "libatlas/charts/merging/crossing_finder.h"
#include "libatlas/charts/merging/fan_measure.h"
#include "libatlas/charts/merging/fan_solver.h"
#include "libatlas/charts/merging/trial_mesh.h"
#include "libatlas/charts/merging/trial_patch.h"

namespace atlas {

struct TrialLimits {
  double stretch_l2 = 1.01;    // of the merged chart
  double stretch_high = 1.17;  // over all but this area:
  double high_area = 0;
  double solidity = 0.7;  // share of its convex hull that it fills
  double fill = 0.58;     // share of its smallest rectangle, unless
  double box = 0;         // that is no larger: both charts' own ones together
  bool unrolls = false;   // both charts unroll: where they fit each other, no descent is needed
};

struct TrialOutcome {
  bool accepted = false;
  double stretch_l2 = 1, high_area = 0, solidity = 1, fill = 1;
  double energy =
      0;  // area times (stretch_l2 squared - 1); of a map with flips what it costs at least
  int euler = 1;
  bool unrolled = false;   // TrialLimits::unrolls, and they fit
  bool settled = false;    // stretch and border were judged after all steps of the descent
  bool entangled = false;  // then the border crosses itself, and not just by a little
};

// Works on one candidate at a time; not shared between threads.
class Trial {
 public:
  Trial(const CoarseMesh& mesh, const Fans& fans, TrialScratch& scratch, CoarseUv& uv)
      : mesh_(mesh), fans_(fans), uv_(uv), joined_(mesh, scratch), solver_(fans), measure_(fans) {}

  // Flattens the cells of two charts (`second` may be empty) with the arcs `glue` joined besides
  // those where `joined` (1 an arc) is set. If accepted, `glue` is set in `joined`, too; the
  // coordinates are not kept until commit().
  TrialOutcome run(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                   std::span<const std::uint32_t> glue, std::vector<std::uint8_t>& joined,
                   const TrialLimits& limits);
  // The same for two charts of one plane: aligned, not flattened, always accepted.
  void join_flat(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                 std::span<const std::uint32_t> glue, std::vector<std::uint8_t>& joined);
  // TrialOutcome::euler of two charts of which it is known.
  int euler(int first, int second, std::span<const std::uint32_t> glue) {
    return joined_.joined_euler(first, second, glue);
  }
  // Area of the smallest rectangle around a chart, as it lies now.
  double box(std::span<const std::uint32_t> cells);
  // Stores the last trial's coordinates.
  void commit();

 private:
  struct Move;

  void assemble(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second,
                std::span<const std::uint32_t> glue, const std::vector<std::uint8_t>& joined);
  TrialOutcome judge(std::span<const std::uint32_t> glue, const TrialLimits& limits);
  void align(std::span<const std::uint32_t> glue);
  void place(const Move& of_second);
  bool unrolled() const;
  bool fits_unrolled(TrialOutcome& outcome);
  bool measure_stretch(double stretch_high, TrialOutcome& outcome);
  bool descend(const TrialLimits& limits, TrialOutcome& outcome);
  // What a descent from the aligned halves would come to: nothing new, who knows, or no acceptance.
  enum class Start { settled, open, hopeless };
  Start judge_start(std::size_t smaller_half, const TrialLimits& limits, TrialOutcome& outcome);
  bool promising(const TrialLimits& limits, TrialOutcome& outcome);
  bool stretch_fits(const TrialLimits& limits, TrialOutcome& outcome);
  bool shape_fits(const TrialLimits& limits, double slack, TrialOutcome& outcome);
  Crossing border_crossing();

  const CoarseMesh& mesh_;
  const Fans& fans_;
  CoarseUv& uv_;
  TrialMesh joined_;
  TrialPatch patch_;
  FanSolver solver_;
  FanMeasure measure_;
  CrossingFinder crossings_;
  double area_ = 0;  // of all cells
  std::vector<Vec2d> uvs_;
  std::vector<double> weight_;
  std::vector<std::array<std::uint32_t, 2>> pairs_;  // slots of first and second chart
  std::vector<Vec2d> points_, hull_;
  bool flipped_ = false;  // a triangle, when shape_fits() last looked
  double misfit_ = 0;     // largest distance of two glued slots, as aligned
};

}  // namespace atlas
