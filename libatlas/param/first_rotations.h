// Internal: the rotations of a mesh's triangles that the solver begins with.
#pragma once

#include "libatlas/param/isometric.h"
#include "libatlas/param/local_mesh.h"
#include "libatlas/param/parameterize.h"

namespace atlas::param {

// Fill ParamWorkspace::Impl::rotations; its elements must be the mesh's.

// Each triangle unfolded along the edge by which it is reached, breadth-first from the middle.
void carry_rotations(const LocalMesh& mesh, ParamWorkspace::Impl& w);

// Nearest to what the frames make of the triangles; where that is doubtful, carried from
// neighbours.
void rotations_from_frames(const LocalMesh& mesh, const FrameView& frames, ParamWorkspace::Impl& w);

}  // namespace atlas::param
