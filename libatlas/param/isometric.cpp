#include "libatlas/param/isometric.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "libatlas/param/descent/arap_solver.h"
#include "libatlas/param/descent/workspace.h"

namespace atlas {

ParamWorkspace::ParamWorkspace() : impl_(std::make_unique<Impl>()) {}
ParamWorkspace::~ParamWorkspace() = default;
ParamWorkspace::ParamWorkspace(ParamWorkspace&&) noexcept = default;
ParamWorkspace& ParamWorkspace::operator=(ParamWorkspace&&) noexcept = default;

IsometricResult flatten_isometric(const LocalMesh& mesh, const IsometricStart& start,
                                  const IsometricOptions& options, ParamWorkspace& workspace) {
  assert(!mesh.triangles.empty());
  std::vector<Vec2d> uvs(mesh.positions.size());
  param::ArapSolver solver(mesh, options, workspace.impl());
  solver.start(start);
  solver.iterate(std::max(options.iterations, 1), uvs);
  const param::MapEnergy measured = solver.measure(uvs);
  return {std::move(uvs), measured.energy, measured.flips};
}

}  // namespace atlas
