// Checks what the glTF standard requires of the layout of a file, which most readers do not check.
#pragma once

#include <filesystem>

namespace atlas::test {

// Expects that the chunks of a .glb fill the file and are padded as prescribed, that all rows of
// data are aligned, that views say what they are used for, that the bounds of positions are those
// of their values, and that references to files are encoded.
void expect_gltf_layout(const std::filesystem::path& path);

}  // namespace atlas::test
