// Internal: the contents of a ParamWorkspace.
#pragma once

#include "libatlas/param/isometric.h"
#include "libatlas/param/mesh/halfedges.h"
#include "libatlas/param/mesh/percentile.h"
#include "libatlas/param/relaxing/relax.h"
#include "libatlas/param/repair/separate.h"
#include "libatlas/param/solvers/linear_solver.h"
#include "libatlas/param/solvers/multigrid.h"
#include "libatlas/param/solvers/stiffness.h"

namespace atlas {

struct ParamWorkspace::Impl {
  param::Elements elements;
  param::CornerLists corners;
  param::SymmetricMatrix stiffness;
  param::Rotations rotations;
  param::EnvelopeSolver envelope;
  param::SparseDirectSolver direct;
  param::MultigridSolver multigrid;
  param::HalfEdges half_edges;
  std::vector<glm::dvec2> load, solution;
  std::vector<std::uint32_t> queue;
  std::vector<double> stretch;
  std::vector<param::WeightedValue> tail;
  std::vector<param::SingularValues> sigma;
  std::vector<Vec2d> before, best;
  std::vector<Vec2d> unsqueezed;  // while squeezing
  param::Relaxer relaxer;
  param::Separator separator;
};

}  // namespace atlas
