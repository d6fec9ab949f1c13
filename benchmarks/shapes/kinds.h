// Generated meshes of any size: surfaces that are easy and hard to unwrap.
#pragma once

#include <cstdint>
#include <string>

#include "libatlas/core/status.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

// The kinds that make_shape knows, for help texts.
inline constexpr const char* kShapeKinds =
    "sphere, scan, rough, torus, terrain, assembly, fasteners, genus, gasket, seat, mail, soup, "
    "needles";

// Returns a shape of about so many triangles, in metres:
//   sphere    smooth closed surface        torus     handle
//   scan      bumpy ball with noise of 13 % of the mean edge at most (deviation 7.6 %)
//   rough     ball of a cube's grid with noise of a standard deviation of 20 % of the mean edge
//   terrain   height field of eight octaves
//   assembly  boxes, tubes and plates in metres, a part every 48 triangles
//   fasteners a dozen standard parts, repeated with random rotations
//   genus     plate with fifty holes       soup      unconnected triangles, like foliage
//   gasket    flat ring with 160 holes  seat      thirty arcs, nearly equal blocks
//   mail      900 rings of chain mail
//   needles   strips of aspect 1000
// Errors: bad_option (unknown kind).
Result<test::Shape> make_shape(const std::string& kind, std::uint64_t triangles);

}  // namespace atlas::bench
