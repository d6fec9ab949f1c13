// Internal: reads the Appearance nodes of VRML97.
#pragma once

#include <string_view>

#include "libatlas/scene/building/scene_builder.h"
#include "libatlas/scene/vrml/vrml_scanner.h"

namespace atlas {

// Reads an Appearance, whose first token is `token`, except for its highlights. The material has
// the name that DEF gives its Material, else its Appearance, else that of its image, or none. The
// texture is one of the builder's.
RawMaterial read_vrml_appearance(std::string_view token, VrmlScanner& scan, SceneBuilder& builder);

// Skips a node of a kind that is not read, after its type. Adds the files that it names to the
// builder's other files.
void note_vrml_files(VrmlScanner& scan, SceneBuilder& builder);

}  // namespace atlas
