// Internal: the way from the first uvs of a chart to its result.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "libatlas/core/clock.h"
#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/descent/flatten_disc.h"

namespace atlas::param {

// Adds the time since the last call to a phase.
class PhaseClock {
 public:
  PhaseClock(const LocalMesh& mesh, ParamWorkspace& workspace) : timing_(workspace.timing) {
    if (mesh.triangles.size() >= ParamWorkspace::timed_triangles)
      watch_.emplace(thread_cpu_seconds);
  }
  void book(double ParamWorkspace::Timing::*phase) {
    if (watch_) timing_.*phase += watch_->lap();
  }

 private:
  ParamWorkspace::Timing& timing_;
  std::optional<Stopwatch> watch_;
};

// Where first uvs come from.
enum class FirstUvs { solved, joined };

// Removes flips, lowers the stretch, moves crossing borders apart and mends what is ruined.
class Descent {
 public:
  Descent(const LocalMesh& mesh, const FlattenOptions& options, ArapSolver& solver,
          PhaseClock& clock);

  // Continues from r.uvs and fills in the rest of r.
  void run(FirstUvs from, ParamResult& r);

 private:
  std::optional<Distortion> lower_stretch(ParamResult& r);
  void turn_flips(ParamResult& r);
  void lower_tail(ParamResult& r);
  bool worth_squeezing(const Distortion& now, std::span<const Vec2d> uvs) const;
  bool entangled(std::span<const Vec2d> uvs) const;
  void squeeze(double bound, std::span<Vec2d> uvs);
  void draw_apart(ParamResult& r);

  const LocalMesh& mesh_;
  const FlattenOptions& options_;
  ArapSolver& solver_;
  PhaseClock& clock_;
  FirstUvs from_ = FirstUvs::solved;
};

}  // namespace atlas::param
