// Meshes to measure on, made in code so that anyone can repeat the run.
#pragma once

#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/scene/reader.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

// The kinds that make_shape knows, for help texts; make_work knows "cabin", too.
inline constexpr const char* kShapeKinds =
    "sphere, scan, torus, terrain, assembly, fasteners, genus, soup, needles";

// Makes the work that "KIND:TRIANGLES" names (the number is met within a few per cent), or reads
// "file:PATH". Metres; lit by a smooth function of the place with one sharp shadow edge, but for
// the cabin, which is lit by its own simulation, and files, which keep their light.
//   sphere    smooth closed surface        scan      the same with scan-like noise
//   torus     handle                       terrain   height field of eight octaves
//   assembly  boxes, tubes and plates in metres, a part every 48 triangles
//   fasteners a dozen standard parts, repeated at any turn
//   genus     plate with fifty holes       soup      unconnected triangles, like foliage
//   needles   strips of aspect 1000        cabin     what atlas-make-cabin writes
// Errors: bad_option (unknown kind or number; no cabin in this build); those of read_scene.
Result<LoadedScene> make_work(const std::string& name, const Context& context);

// The shape alone. Errors: bad_option.
Result<test::Shape> make_shape(const std::string& kind, std::uint64_t triangles);

// The shape as a lit scene of one white material.
LoadedScene lit(test::Shape shape);

// Writes positions (and light as vertex colours) and triangles, nothing else. Errors: io.
Status write_plain_obj(const Scene& scene, const std::filesystem::path& path, bool with_light);

// Defined where the build has the cabin.
Result<LoadedScene> make_cabin(std::uint64_t triangles, const Context& context);

}  // namespace atlas::bench
