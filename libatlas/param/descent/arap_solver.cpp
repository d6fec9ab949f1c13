#include "libatlas/param/descent/arap_solver.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libatlas/core/clock.h"
#include "libatlas/param/descent/first_rotations.h"

namespace atlas::param {
namespace {

// Up to these numbers of vertices each solver is the fastest (measured); multigrid takes the rest.
constexpr std::size_t envelope_limit = 4500;
constexpr std::size_t direct_limit = 6000;
// The most work of elimination within the envelope, relative to the number of vertices to the power
// of 1.5. Discs take 0.4 to 1.1 on average. 12 of 43 000 took more than this limit, up to 190:
// there, needles meet in a few vertices that are adjacent to all others.
constexpr double most_envelope_work = 4;
// The energy of the error that an inexact solve may leave: in the first step, which starts from
// nothing, as a share of the area; later, as a share of what it finds. Exact solves are hardly
// better: an error of a twentieth disappears in what the next local step changes, and with a
// thousandth in the last step each column of the results stays as it was (measured on meshes of 70
// thousand and a million triangles).
constexpr double first_inexactness = 1e-6, rough_share = 0.05;
// If no more energy than this share of the area is left, the shape may unroll, and each step must
// be exact: errors of a solve are smooth, and later steps take long to remove them.
constexpr double may_unroll = 3e-4, exact_first = 1e-9;
// An iteration is given up after this number of steps times the square root of the number of
// vertices, and after `most_iterations` at the latest. So many steps take a little longer than to
// order and factorize the matrix instead (24 steps for 9000 vertices), so no solve takes much more
// than twice as long as with the better method. Scans take 1 to 15 steps, parts from CAD with
// needles 15 to more than 60.
constexpr double most_steps = 0.25;
constexpr int most_iterations = 60;
// Lengths of steps, relative to the step to the minimum for the current rotations: of every other
// step, and of those in between. A step mends at once what a long step before it overshoots: three
// steps end where four plain ones do (measured on 240 meshes).
constexpr double long_step = 3, short_step = 1.3;
// If one local step lowers the energy by less than this share of the area, exact solves change no
// more than inexact ones leave.
constexpr double converged = 3e-11;

}  // namespace

ArapSolver::ArapSolver(const LocalMesh& mesh, const IsometricOptions& options,
                       ParamWorkspace::Impl& workspace)
    : mesh_(mesh), options_(options), w_(workspace) {
  build();
}

void ArapSolver::build() {
  w_.elements.build(mesh_, options_.min_altitude);
}

void ArapSolver::rest() {
  if (mesh_.positions.size() < large_mesh || method_ != Method::multigrid) return;
  w_.elements.give_back();
  give_back(w_.load);
  give_back(w_.solution);
  give_back(w_.rotations);
  w_.multigrid = {};
  factorized_ = weighted_ = false;
  resting_ = true;
}

void ArapSolver::wake(std::span<const Vec2d> uvs) {
  if (resting_) start(uvs);
}

const CornerLists& ArapSolver::corners() {
  if (!cornered_) w_.corners.build(w_.elements, mesh_.positions.size());
  cornered_ = true;
  return w_.corners;
}

void ArapSolver::factorize() {
  factorized_ = true;
  area_ = 0;
  for (std::size_t t = 0; t < w_.elements.size(); ++t) {
    const Element e = w_.elements[t];
    area_ += e.weight * e.area();
  }
  const std::size_t n = mesh_.positions.size();
  // With other weights an iteration that was slow is slow again. Large meshes try it each time, for
  // they cannot rest with a factor.
  if (n > direct_limit && (!slow_ || n >= large_mesh)) {
    w_.half_edges.build(mesh_);
    method_ = Method::multigrid;
    if (w_.multigrid.build(w_.elements, w_.half_edges, n)) {
      // The set-up leaves gaps, a twenty-fifth of the memory that the program holds by now.
      if (n >= large_mesh && !weighted_) return_freed_memory();
      // Not earlier, since the set-up has arrays of its own.
      w_.load.resize(n);
      return;
    }
  }
  w_.load.resize(n);
  w_.solution.resize(n);
  if (n > envelope_limit || wide()) {
    factorize_directly();
  } else {
    factorize_envelope();
  }
}

// Whether the envelope is so wide that a sparse factor is faster.
bool ArapSolver::wide() {
  const auto n = static_cast<double>(mesh_.positions.size());
  if (!ordered_)
    wide_ = w_.envelope.analyze(w_.elements, mesh_.positions.size()) >
            most_envelope_work * n * std::sqrt(n);
  ordered_ = true;
  return wide_;
}

void ArapSolver::factorize_directly() {
  method_ = Method::direct;
  build_stiffness(w_.elements, corners(), w_.stiffness);
  if (!w_.direct.factorize(w_.stiffness, analyzed_)) {
    factorize_envelope();  // it can do without some pivots
  }
  analyzed_ = true;
}

void ArapSolver::factorize_envelope() {
  method_ = Method::envelope;
  if (!ordered_) w_.envelope.analyze(w_.elements, mesh_.positions.size());
  ordered_ = true;
  w_.envelope.factorize(w_.elements);
}

// Solves for w_.load, which is overwritten. `uvs` come in as an initial guess.
void ArapSolver::solve(const Inexactness& inexactness, std::span<Vec2d> uvs) {
  if (method_ == Method::multigrid) {
    const int most = static_cast<int>(most_steps * std::sqrt(static_cast<double>(uvs.size())));
    const MultigridAccuracy accuracy{inexactness.area_share * area_, inexactness.found_share,
                                     std::min(most, most_iterations)};
    if (w_.multigrid.solve(accuracy, w_.load, uvs)) return;
    slow_ = true;
    w_.solution.resize(uvs.size());
    factorize_directly();  // slivers can make the iteration slow
    solve_directly();
    for (std::size_t v = 0; v < uvs.size(); ++v) {
      uvs[v] = from_glm(to_glm(uvs[v]) + w_.solution[v]);
    }
    return;
  }
  solve_directly();
  for (std::size_t v = 0; v < uvs.size(); ++v) uvs[v] = from_glm(w_.solution[v]);
}

// The same, but the step from the given uvs is `relaxation` times as long.
void ArapSolver::solve_relaxed(double relaxation, const Inexactness& inexactness,
                               std::span<Vec2d> uvs) {
  // Large meshes have no memory for a copy.
  if (relaxation == 1 || uvs.size() >= large_mesh) return solve(inexactness, uvs);
  w_.before.assign(uvs.begin(), uvs.end());
  solve(inexactness, uvs);
  for (std::size_t v = 0; v < uvs.size(); ++v) {
    const glm::dvec2 from = to_glm(w_.before[v]);
    uvs[v] = from_glm(from + relaxation * (to_glm(uvs[v]) - from));
  }
}

void ArapSolver::solve_directly() {
  if (method_ == Method::direct) w_.direct.solve(w_.load, w_.solution);
  if (method_ == Method::envelope) w_.envelope.solve(w_.load, w_.solution);
}

void ArapSolver::start(const IsometricStart& start) {
  if (resting_) build();
  resting_ = false;
  if (weighted_) {
    w_.elements.reset_weights();
    factorize();
    weighted_ = false;
  }
  if (!start.uvs.empty()) {
    this->start(start.uvs);
    first_shear_weight_ = start.rough ? 1 : options_.shear_weight;
    return;
  }
  guess_ = {};
  if (start.frames) {
    rotations_from_frames(mesh_, start.frames, w_);
  } else {
    carry_rotations(mesh_, w_);
  }
}

void ArapSolver::start(std::span<const Vec2d> uvs) {
  if (resting_) build();
  resting_ = false;
  guess_ = uvs;
  first_shear_weight_ = options_.shear_weight;
  w_.rotations.assign(w_.elements.size(), glm::vec2(0));
}

void ArapSolver::join(std::span<const Vec2d> corner_uvs, std::span<Vec2d> uvs) {
  if (!factorized_) factorize();
  std::fill(w_.load.begin(), w_.load.end(), glm::dvec2(0));
  for (std::size_t t = 0; t < w_.elements.size(); ++t) {
    const Element e = w_.elements[t];
    const auto& corners = mesh_.triangles[t];  // the element may begin at another corner
    const std::size_t first = corners[0] == e.v[0] ? 0 : corners[1] == e.v[0] ? 1 : 2;
    std::array<glm::dvec2, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = to_glm(corner_uvs[3 * t + (first + i) % 3]);
    const Jacobian j = e.jacobian(p[0], p[1], p[2]);
    const auto gradients = e.area_gradients();
    for (std::size_t i = 0; i < 3; ++i) {
      w_.load[e.v[i]] += double(e.weight) * (gradients[i].x * j.x + gradients[i].y * j.y);
      uvs[e.v[i]] = from_glm(p[i]);
    }
  }
  solve(Inexactness{fine, 0}, uvs);
  start(uvs);
}

// Makes uvs the initial guess of the first solve.
void ArapSolver::take_guess(std::span<Vec2d> uvs) {
  if (guess_.empty()) {
    std::fill(uvs.begin(), uvs.end(), Vec2d{});
  } else if (guess_.data() != uvs.data()) {
    std::copy(guess_.begin(), guess_.end(), uvs.begin());
  }
  guess_ = uvs;  // of the next call
}

// The local step. Returns by how much it lowers the energy.
double ArapSolver::update(std::span<const Vec2d> uvs) {
  return update_rotations(w_.elements, {uvs, options_.shear_weight}, w_.rotations, w_.load);
}

void ArapSolver::iterate(int steps, std::span<Vec2d> uvs) {
  wake(uvs);
  if (!factorized_) factorize();
  if (guess_.empty()) {
    rotation_load(w_.elements, w_.rotations, w_.load);
  } else {
    update_rotations(w_.elements, {guess_, first_shear_weight_}, w_.rotations, w_.load);
    first_shear_weight_ = options_.shear_weight;
  }
  take_guess(uvs);
  solve({steps == 1 ? fine : first_inexactness, 0}, uvs);
  bool exact = true;
  for (int i = 1; i < steps; ++i) {
    if (i == 1 && method_ == Method::multigrid) {
      exact = !energy_exceeds(may_unroll * area_, w_.elements, uvs);
      if (exact) {
        rotation_load(w_.elements, w_.rotations, w_.load);
        solve({exact_first, 0}, uvs);
      }
    }
    const bool still = update(uvs) <= converged * area_;
    if (still && method_ != Method::multigrid) return;
    if (still) steps = i + 1;
    const bool last = i + 1 == steps;
    const Inexactness rough{fine, last ? fine_share : rough_share};
    const double times = (steps - i) % 2 == 0 ? long_step : short_step;
    solve_relaxed(times, exact ? Inexactness{last ? fine : exact_first, 0} : rough, uvs);
  }
}

Relaxer::Outcome ArapSolver::remove_flips(std::span<Vec2d> uvs) {
  wake(uvs);
  // By Euler's formula, if the mesh says which edges are on the boundary.
  const auto borders = std::count(mesh_.opposite.begin(), mesh_.opposite.end(), kNoIndex);
  const bool holed = !mesh_.opposite.empty() &&
                     2 * mesh_.positions.size() < mesh_.triangles.size() + std::size_t(borders) + 2;
  return w_.relaxer.remove_flips(w_.elements, corners(), holed, uvs);
}

Tail ArapSolver::lower_tail(double bound, std::span<Vec2d> uvs) {
  wake(uvs);
  return w_.relaxer.lower_tail(w_.elements, corners(), bound, uvs);
}

void ArapSolver::smooth(std::span<const std::uint32_t> triangles, bool border_moves,
                        std::span<Vec2d> uvs) {
  wake(uvs);
  w_.relaxer.smooth(w_.elements, corners(), {triangles, border_moves}, uvs);
}

bool ArapSolver::separate_borders(std::span<Vec2d> uvs) {
  wake(uvs);
  w_.separator.take(mesh_, w_.elements, corners());
  return w_.separator.separate(w_.relaxer, uvs);
}

void ArapSolver::settle_borders(std::span<Vec2d> uvs) {
  wake(uvs);
  w_.separator.settle_further(w_.relaxer, uvs);
}

MapEnergy ArapSolver::measure(std::span<const Vec2d> uvs) {
  wake(uvs);
  return measure_energy(w_.elements, uvs);
}

}  // namespace atlas::param
