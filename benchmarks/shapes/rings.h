// Generated parts whose charts are rings, arcs and many strips.
#pragma once

#include <cstdint>

#include "tests/support/shapes.h"

namespace atlas::bench {

// Each has about so many triangles:
//   gasket  a flat ring with 160 holes    seat  thirty arcs of a valve's seat, nearly equal blocks
//   mail    900 rings of chain mail
test::Shape gasket(std::uint64_t triangles);
test::Shape seat(std::uint64_t triangles);
test::Shape mail(std::uint64_t triangles);

}  // namespace atlas::bench
