// Internal: ArapSolver, which flattens one chart by isometric descent.
#pragma once

#include <span>

#include "libatlas/param/descent/workspace.h"
#include "libatlas/param/isometric.h"
#include "libatlas/param/relaxing/relax.h"

namespace atlas::param {

// Works in the given workspace. Only one solver may use a workspace at a time.
class ArapSolver {
 public:
  // Builds the elements. The matrix and its factor are built when a step first needs them.
  ArapSolver(const LocalMesh& mesh, const IsometricOptions& options,
             ParamWorkspace::Impl& workspace);

  // Sets what the first global step starts from. Weights of an earlier squeeze are dropped.
  void start(const IsometricStart& start);
  void start(std::span<const Vec2d> uvs);

  // Joins flat parts: uvs become those whose gradients are closest to those of corner_uvs. These
  // are three per triangle and need not agree where triangles meet. The next step starts from the
  // result.
  void join(std::span<const Vec2d> corner_uvs, std::span<Vec2d> uvs);

  // Makes global steps, with local steps in between, from the current rotations. Except in large
  // meshes, all steps after the first are over-relaxed, every other one by much, the last one by
  // little. For given rotations the energy is quadratic and an upper bound on the energy that is
  // minimized, so any step up to twice as long as that to its minimum descends (Salakhutdinov and
  // Roweis 2003, "Adaptive overrelaxed bound optimization methods"). The long steps exceed that and
  // may raise the energy; the step after each more than mends this, and slowly converging parts
  // take fewer steps.
  void iterate(int steps, std::span<Vec2d> uvs);

  // Lowers the stretch that 99.9 % of the area stays within: triangles are weighted by a power of
  // their stretch and the system is solved again (iteratively reweighted least squares towards the
  // maximum norm; Burrus, Barreto and Selesnick 1994, "Iterative reweighted least-squares design of
  // FIR filters"). No weight falls below a share of the largest; otherwise faces that hardly
  // stretch would give way without limit for the sake of a few others. Ends when that stretch is
  // within `bound`, after `iterations`, or when at this rate it will not come there. uvs become the
  // state with the least stretch; within the bound, moved back as far as the bound allows and as it
  // lowers the L2 stretch. With `ratio`, stretch is measured at the scale in the middle of its
  // range instead of the area-preserving one.
  struct Squeeze {
    double bound;
    int iterations;
    bool ratio;
    bool rough;  // FlattenOptions::rough
  };
  void squeeze(const Squeeze& options, std::span<Vec2d> uvs);

  Relaxer::Outcome remove_flips(std::span<Vec2d> uvs);

  // Relaxer::lower_tail.
  Tail lower_tail(double bound, std::span<Vec2d> uvs);

  // Relaxer::smooth.
  void smooth(std::span<const std::uint32_t> triangles, bool border_moves, std::span<Vec2d> uvs);

  // Moves borders apart that overlap a little. All triangles must be positive. Returns whether uvs
  // are injective now.
  bool separate_borders(std::span<Vec2d> uvs);
  // To be called after that: spreads the distortion that it left further than it does itself.
  void settle_borders(std::span<Vec2d> uvs);
  // If the last call failed: the crossings of the round with the fewest.
  std::span<const BorderCrossing> crossings_left() const { return w_.separator.left(); }

  MapEnergy measure(std::span<const Vec2d> uvs);

  // Frees the memory that a large mesh takes; later calls build again what they need. Steps then
  // continue from the current uvs.
  void rest();

 private:
  enum class Method { envelope, multigrid, direct };

  void build();
  void wake(std::span<const Vec2d> uvs);
  void factorize();
  void factorize_directly();
  void factorize_envelope();
  bool wide();
  const CornerLists& corners();
  // The energy of the error that multigrid may leave: the larger of a share of the area and a share
  // of the energy that it finds.
  struct Inexactness {
    double area_share, found_share;
  };
  // Meshes of at least this many vertices do not keep the data for solving and for measuring in
  // memory at the same time.
  static constexpr std::size_t large_mesh = 100000;
  // 3e-11 of the area means a mean stretch of some millionths, and at worst a hundred times that.
  static constexpr double fine = 3e-11, fine_share = 1e-3;
  void solve(const Inexactness& inexactness, std::span<Vec2d> uvs);
  void solve_relaxed(double relaxation, const Inexactness& inexactness, std::span<Vec2d> uvs);
  void solve_directly();
  void take_guess(std::span<Vec2d> uvs);
  double update(std::span<const Vec2d> uvs);
  double update_stretch(std::span<const Vec2d> uvs, bool ratio);
  double stretch_energy();
  void weight_by_stretch(double largest, double least);
  void ease(double bound, bool ratio, std::span<Vec2d> uvs);

  const LocalMesh& mesh_;
  IsometricOptions options_;
  ParamWorkspace::Impl& w_;
  std::span<const Vec2d> guess_;   // where the first solve starts; empty: from zero
  double first_shear_weight_ = 1;  // of the local step from there
  Method method_ = Method::envelope;
  bool analyzed_ = false, ordered_ = false;  // by the direct and the envelope solver
  bool wide_ = false;                        // valid once ordered_
  bool cornered_ = false;                    // the workspace's corner lists are this mesh's
  bool slow_ = false;                        // multigrid failed once
  double area_ = 0;                          // weighted
  bool weighted_ = false;
  bool factorized_ = false, resting_ = false;
};

}  // namespace atlas::param
