// Internal: checks of the shapes and options that pack_outlines and fit_pages have in common.
#pragma once

#include <span>

#include "libatlas/pack/outline.h"

namespace atlas::pack {

Status check_shapes(std::span<const ChartShape> shapes);
Status check_rotations(std::uint32_t rotations);

}  // namespace atlas::pack
