// Internal: finds the rotations of a mesh's triangles that the solver starts from.
#pragma once

#include "libatlas/param/isometric.h"
#include "libatlas/param/local_mesh.h"
#include "libatlas/param/parameterize.h"

namespace atlas::param {

// These functions fill ParamWorkspace::Impl::rotations; its elements must be the mesh's.

// Unfolds each triangle along the edge by which it is reached, breadth-first from the middle.
void carry_rotations(const LocalMesh& mesh, ParamWorkspace::Impl& w);

// Takes the rotations nearest to the frames; where that is doubtful, carries them over from
// neighbours.
void rotations_from_frames(const LocalMesh& mesh, const FrameView& frames, ParamWorkspace::Impl& w);

}  // namespace atlas::param
