// Internal: tests whether two charts of the coarse mesh flatten well as one.
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

namespace atlas {

struct TrialLimits {
  double stretch_l2 = 1.01;    // of the merged chart
  double stretch_high = 1.17;  // the limit everywhere but in an area of high_area
  double high_area = 0;
  double solidity = 0.7;  // least share of its convex hull that it fills
  // The least share of its smallest rectangle that it fills, unless that rectangle is no larger
  // than box.
  double fill = 0.58;
  double box = 0;  // area of both charts' own rectangles together
  // A start whose halves lie farther apart than this share of the square root of their area is
  // hopeless.
  double far_apart = 0.3;
  bool unrolls = false;  // both charts unroll: where they fit each other, no descent is needed
};

struct TrialOutcome {
  bool accepted = false;
  double stretch_l2 = 1, high_area = 0, solidity = 1, fill = 1;
  // Area times (stretch_l2 squared - 1); of a map with flips, a lower bound on what it costs.
  double energy = 0;
  int euler = 1;
  bool unrolled = false;   // with TrialLimits::unrolls: the charts fit each other
  bool settled = false;    // stretch and border were judged after the whole descent
  bool entangled = false;  // then: the border crosses itself deeply
};

// Tries one candidate at a time. Not shared between threads.
class Trial {
 public:
  Trial(const CoarseMesh& mesh, const Fans& fans, TrialScratch& scratch, CoarseUv& uv)
      : mesh_(mesh), fans_(fans), uv_(uv), joined_(mesh, scratch), solver_(fans), measure_(fans) {}

  // Flattens two charts as one, with their glue joined in addition to those arcs where `joined`
  // (one per arc) is set. If the trial is accepted, sets the glue in `joined`, too. The coordinates
  // are not stored until commit().
  TrialOutcome run(const TrialPair& charts, std::vector<std::uint8_t>& joined,
                   const TrialLimits& limits);
  // The same for two charts in one plane: they are aligned but not flattened, and always accepted.
  void join_flat(const TrialPair& charts, std::vector<std::uint8_t>& joined);
  // Returns the Euler characteristic of the union of two charts whose own ones are given.
  int euler(int first, int second, std::span<const std::uint32_t> glue) {
    return joined_.joined_euler(first, second, glue);
  }
  // Returns the area of the smallest rectangle around a chart's current coordinates.
  double box(std::span<const std::uint32_t> cells);
  // Stores the coordinates of the last trial.
  void commit();

 private:
  struct Move;

  void assemble(const TrialPair& charts, const std::vector<std::uint8_t>& joined);
  TrialOutcome judge(std::span<const std::uint32_t> glue, const TrialLimits& limits);
  void align(std::span<const std::uint32_t> glue);
  void place(const Move& of_second);
  bool unrolled() const;
  bool fits_unrolled(TrialOutcome& outcome);
  bool measure_stretch(double stretch_high, TrialOutcome& outcome);
  void descend();
  // The prospects of a descent from the aligned halves: it is not needed, its outcome is open, or
  // it cannot be accepted.
  enum class Start { settled, open, hopeless };
  Start judge_start(std::size_t smaller_half, const TrialLimits& limits, TrialOutcome& outcome);
  bool stretch_fits(const TrialLimits& limits, TrialOutcome& outcome);
  bool shape_fits(const TrialLimits& limits, double slack, TrialOutcome& outcome);
  Crossing border_crossing();

  const CoarseMesh& mesh_;
  const Fans& fans_;
  CoarseUv& uv_;
  TrialMesh joined_;
  FanSolver solver_;
  FanMeasure measure_;
  CrossingFinder crossings_;
  double area_ = 0;  // of all cells
  std::vector<Vec2d> uvs_;
  std::vector<double> weight_;
  std::vector<std::array<std::uint32_t, 2>> pairs_;  // glued slots of the first and the second
                                                     // chart
  std::vector<Vec2d> points_, hull_;
  bool flipped_ = false;  // whether any triangle is, as of the last shape_fits()
  double misfit_ = 0;     // largest distance between two glued slots after alignment
};

}  // namespace atlas
