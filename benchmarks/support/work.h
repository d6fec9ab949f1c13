// Generated meshes to measure on, so that anyone can repeat the run.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/shapes/kinds.h"
#include "libatlas/core/context.h"
#include "libatlas/scene/reader.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

// Makes the work that "KIND:TRIANGLES" names, a kind of make_shape or "cabin" (what
// atlas-make-cabin writes), or reads "file:PATH". The number is met within a few per cent; lengths
// are in metres. It is lit by a smooth function of the position with one sharp shadow edge, except
// for the cabin, which is lit by its own simulation, and files, which keep their light. Errors:
// bad_option (unknown kind or number; no cabin in this build); those of read_scene.
Result<LoadedScene> make_work(const std::string& name, const Context& context);

// Returns the shape as a lit scene with one white material.
LoadedScene lit(test::Shape shape);

// Writes only positions (and light as vertex colours) and triangles. Errors: io.
Status write_plain_obj(const Scene& scene, const std::filesystem::path& path, bool with_light);

// Defined if the build includes the cabin.
Result<LoadedScene> make_cabin(std::uint64_t triangles, const Context& context);

}  // namespace atlas::bench
