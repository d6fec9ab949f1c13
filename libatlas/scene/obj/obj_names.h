// Internal: names as OBJ can hold them, for all that write it.
#pragma once

#include <cstdint>
#include <string>

#include "libatlas/scene/scene.h"

namespace atlas {

// Replaces line ends and backslashes by blanks, so that a comment or a name stays on its line.
std::string one_line(std::string text);

// Returns a name as OBJ can hold it: there, a name ends with its line, or at a '#' after a blank.
std::string obj_name(const std::string& name);

// Returns the line that begins an object. The first object may have no name, as in the scene's own
// file; others without a name get one.
std::string obj_object_line(const Scene& scene, std::uint32_t object);

}  // namespace atlas
