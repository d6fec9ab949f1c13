#include "libatlas/param/isometric.h"

#include <algorithm>
#include <cassert>

#include "libatlas/param/arap_solver.h"
#include "libatlas/param/workspace.h"

namespace atlas {

ParamWorkspace::ParamWorkspace() : impl_(std::make_unique<Impl>()) {}
ParamWorkspace::~ParamWorkspace() = default;
ParamWorkspace::ParamWorkspace(ParamWorkspace&&) noexcept = default;
ParamWorkspace& ParamWorkspace::operator=(ParamWorkspace&&) noexcept = default;

IsometricResult flatten_isometric(const LocalMesh& mesh, const IsometricStart& start,
                                  const IsometricOptions& options, std::span<Vec2d> uvs,
                                  ParamWorkspace& workspace) {
  assert(uvs.size() == mesh.positions.size() && !mesh.triangles.empty());
  param::ArapSolver solver(mesh, options.min_altitude, workspace.impl());
  solver.start(start);
  int steps = std::max(options.iterations, 1);
  if (options.promising && options.look_after > 0 && options.look_after < steps) {
    solver.iterate(options.look_after, uvs);
    if (!options.promising()) return options.measure ? solver.measure(uvs) : IsometricResult{};
    steps -= options.look_after;
    solver.start(uvs);
  }
  solver.iterate(steps, uvs);
  return options.measure ? solver.measure(uvs) : IsometricResult{};
}

}  // namespace atlas
