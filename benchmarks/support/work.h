// Generated meshes to measure on, so that anyone can repeat the run.
#pragma once

#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/scene/reader.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

// The kinds that make_shape knows, for help texts. make_work also knows "cabin".
inline constexpr const char* kShapeKinds =
    "sphere, scan, rough, torus, terrain, assembly, fasteners, genus, soup, needles";

// Makes the work that "KIND:TRIANGLES" names (the number is met within a few per cent), or reads
// "file:PATH". Lengths are in metres. It is lit by a smooth function of the position with one sharp
// shadow edge, except for the cabin, which is lit by its own simulation, and files, which keep
// their light.
//   sphere    smooth closed surface        torus     handle
//   scan      bumpy ball with noise of 13 % of the mean edge at most (deviation 7.6 %)
//   rough     ball of a cube's grid with noise of a standard deviation of 20 % of the mean edge
//   terrain   height field of eight octaves
//   assembly  boxes, tubes and plates in metres, a part every 48 triangles
//   fasteners a dozen standard parts, repeated with random rotations
//   genus     plate with fifty holes       soup      unconnected triangles, like foliage
//   needles   strips of aspect 1000        cabin     what atlas-make-cabin writes
// Errors: bad_option (unknown kind or number; no cabin in this build); those of read_scene.
Result<LoadedScene> make_work(const std::string& name, const Context& context);

// Returns the shape alone. Errors: bad_option.
Result<test::Shape> make_shape(const std::string& kind, std::uint64_t triangles);

// Returns the shape as a lit scene with one white material.
LoadedScene lit(test::Shape shape);

// Writes only positions (and light as vertex colours) and triangles. Errors: io.
Status write_plain_obj(const Scene& scene, const std::filesystem::path& path, bool with_light);

// Defined if the build includes the cabin.
Result<LoadedScene> make_cabin(std::uint64_t triangles, const Context& context);

}  // namespace atlas::bench
