// Internal: the two halves of unwrap_mesh().
#pragma once

#include "libatlas/unwrap/unwrap.h"

namespace atlas {

// Errors: bad_option.
Status check_options(const UnwrapOptions& options);

// Texels between charts, and what boxes are multiples of, with the mip levels' shares.
std::int32_t padding_of(const UnwrapOptions& options);
std::int32_t alignment_of(const UnwrapOptions& options);

// Packs charts that make_charts() has made of the mesh, and finishes their uvs. Errors: those of
// unwrap_mesh().
Result<UnwrappedMesh> place_charts(const MeshView& mesh, ChartSet charts,
                                   const UnwrapOptions& options, const Context& context);

}  // namespace atlas
