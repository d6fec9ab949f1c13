// Internal: the state of one chart's isometric descent.
#pragma once

#include <span>

#include "libatlas/param/isometric.h"
#include "libatlas/param/relax.h"
#include "libatlas/param/workspace.h"

namespace atlas::param {

// Works in the workspace it is given; one at a time for each workspace.
class ArapSolver {
 public:
  // Builds the elements; the matrix and its factor when a step first needs them.
  ArapSolver(const LocalMesh& mesh, const IsometricOptions& options,
             ParamWorkspace::Impl& workspace);

  // What the first global step goes on from. Weights of an earlier squeeze are dropped.
  void start(const IsometricStart& start);
  void start(std::span<const Vec2d> uvs);

  // Joins flat parts: uvs become those whose gradients come nearest to the given ones', 3 a
  // triangle, which need not agree where triangles meet. The next step goes on from them.
  void join(std::span<const Vec2d> corner_uvs, std::span<Vec2d> uvs);

  // Global steps, with local steps between them, from the current rotations. But in large
  // meshes all after the first are relaxed, every other one far, the last a little: for given
  // rotations the energy is quadratic and nowhere below the one that falls, so that any step up to
  // twice as long as to its minimum descends (Salakhutdinov and Roweis 2003, "Adaptive overrelaxed
  // bound optimization methods"). Those that go far are longer and may rise; the step after each
  // more than mends that, and what is slow to settle does in fewer. Returns by how much the last
  // local step lowered the energy, as part of the area; infinite if there was none.
  double iterate(int steps, std::span<Vec2d> uvs);

  // Lowers the stretch that 99.9 % of the area stays within: triangles are weighted by a power of
  // their stretch and the system is solved again (iteratively reweighted least squares towards the
  // maximum norm; Burrus, Barreto and Selesnick 1994, "Iterative reweighted least-squares design of
  // FIR filters"). No weight falls below a share of the largest, or faces that hardly stretch would
  // give way without limit for the little that does. Ends when that stretch is at most `goal`,
  // after `iterations`, or when it will not come within `bound` at this rate or, once it is there,
  // not soon reach the goal. uvs becomes the state of least stretch; but where that costs much of
  // the mean stretch, the first one within the bound, drawn back as far as the bound allows. With
  // `ratio` the stretch is taken at the scale in the middle of its range instead of the
  // area-preserving one.
  struct Squeeze {
    double goal, bound;
    int iterations;
    bool ratio;
    bool rough;  // ParamOptions::rough
  };
  void squeeze(const Squeeze& options, std::span<Vec2d> uvs);

  Relaxer::Outcome remove_flips(std::span<Vec2d> uvs);

  // Relaxer::lower_tail.
  Tail lower_tail(double bound, std::span<Vec2d> uvs);

  // Draws apart what overlaps a little; all triangles positive. Returns whether uvs are injective
  // now.
  bool separate_borders(std::span<Vec2d> uvs);
  // After that: spreads the distortion that it left, further than it does itself.
  void settle_borders(std::span<Vec2d> uvs);
  // Of the last call, if it failed: the crossings when they were fewest.
  std::span<const BorderCrossing> crossings_left() const { return w_.separator.left(); }

  IsometricResult measure(std::span<const Vec2d> uvs);

  // Gives the memory back that a large mesh took; what is asked for next makes anew what it needs.
  // Steps then go on from the uvs at hand.
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
  // The energy of the error that multigrid may leave: the larger of a part of the area and a part
  // of what it finds.
  struct Inexactness {
    double area_share, found_share;
  };
  // Vertices from which on what is solved and what is measured do not lie in memory together.
  static constexpr std::size_t large_mesh = 100000;
  // 3e-11 of the area is a mean stretch of some millionths, and at worst a hundred times that.
  static constexpr double fine = 3e-11, fine_share = 1e-3;
  void solve(const Inexactness& inexactness, std::span<Vec2d> uvs);
  void solve_relaxed(double relaxation, const Inexactness& inexactness, std::span<Vec2d> uvs);
  void solve_directly();
  void take_guess(std::span<Vec2d> uvs);
  double update(std::span<const Vec2d> uvs);
  double update_stretch(std::span<const Vec2d> uvs, bool ratio);
  double stretch_energy();
  void weight_by_stretch(double largest, double least);
  void ease(double log_bound, bool ratio, std::span<Vec2d> uvs);

  const LocalMesh& mesh_;
  IsometricOptions options_;
  ParamWorkspace::Impl& w_;
  std::span<const Vec2d> guess_;   // where the first solve starts; empty: from zero
  double first_shear_weight_ = 1;  // of the local step from there
  Method method_ = Method::envelope;
  bool analyzed_ = false, ordered_ = false;  // by the direct and the envelope solver
  bool wide_ = false;                        // once ordered_
  bool cornered_ = false;                    // the workspace's corner lists are this mesh's
  double area_ = 0;                          // weighted
  bool weighted_ = false;
  bool factorized_ = false, resting_ = false;
};

}  // namespace atlas::param
