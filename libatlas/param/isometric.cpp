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
  param::ArapSolver solver(mesh, options, workspace.impl());
  solver.start(start);
  solver.iterate(std::max(options.iterations, 1), uvs);
  return solver.measure(uvs);
}

}  // namespace atlas
