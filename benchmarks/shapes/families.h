// Families of generated meshes: any number of members each, of different shape and size, so that
// what is measured over them does not hang on single meshes.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "libatlas/core/status.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

//   smooth     blended capsules, one closed surface      scan       the same with scan noise
//   cad        turned parts, plates with holes, boxes    assembly   many small parts
//   terrain    height fields, some with steps            foliage    bent leaves
//   cloth      sheets with folds and holes               tubes      swept knots and tori
//   facade     walls with rows of windows                stairs     surfaces of blocks
//   low        60 to 600 triangles of the families above
std::span<const std::string_view> families();

// Returns member `number` of a family: some 500 to 20 000 triangles unless the family says
// otherwise. Equal arguments give equal meshes. Error: bad_option.
Result<test::Shape> make_member(std::string_view family, std::uint32_t number);

}  // namespace atlas::bench
