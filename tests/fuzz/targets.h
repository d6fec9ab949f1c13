// What the fuzzers call: each target works on any bytes. Crashes and what sanitizers report are
// faults, too. Everything runs on one thread, so that a finding repeats.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace atlas::test {

using FuzzBytes = std::span<const std::uint8_t>;

struct FuzzResult {
  std::string fault = {};  // what is wrong; empty if nothing is
  bool accepted = false;   // the input was not refused: there was a result to judge
};

// Reads the bytes as a scene file with this extension ("obj"), with options that their sum chooses.
// What follows a line `%%` is a second file, second.mtl and second.bin, which the scene may name.
// The reader must return a sound scene, or an error of one line that names a file and a remedy, in
// time.
FuzzResult fuzz_reader(FuzzBytes bytes, const std::string& extension);

// Reads the bytes as the file of a small mesh's illumination, "txt" or a scene file. Likewise a
// sound scene or an error.
FuzzResult fuzz_illumination(FuzzBytes bytes, const std::string& extension);

// Reads them as an image file with this extension ("png"), to bytes, to floats and as a texture,
// and as an image that a scene holds. Sound texels must come back, or an error of one line.
FuzzResult fuzz_image(FuzzBytes bytes, const std::string& extension);

// Packs two such files as atlas-pack does, with options that their sum chooses. The pages must have
// the sizes that their data say.
FuzzResult fuzz_sprites(FuzzBytes bytes, const std::string& extension);

// Reads them as a scene, and makes of it what atlas-play draws, and its camera.
FuzzResult fuzz_view(FuzzBytes bytes, const std::string& extension);

// Packs them as a list of rectangles, "csv" or "json", as atlas-pack does, with options that their
// sum chooses. Items must lie on their pages and apart, and the result must be valid JSON.
FuzzResult fuzz_rects(FuzzBytes bytes, const std::string& extension);

// Reads them as a scene, and packs its uvs anew as atlas-pack does. All triangles must come back.
FuzzResult fuzz_repack(FuzzBytes bytes, const std::string& extension);

// Reads them likewise, exports the scene to any format, lit or as plain uvs, and reads the result
// again. All triangles must come back.
FuzzResult fuzz_export(FuzzBytes bytes, const std::string& extension);

// Unwraps a small mesh, and judges the atlas with the tests' own measures. Bytes 0 and 1 choose
// options, bytes 2 to 4 the kind of mesh, its size and how materials alternate; vertices follow,
// then triangles as three bytes each. They are taken as polygons or as instances, too. Charts must
// be made in time.
FuzzResult fuzz_unwrap(FuzzBytes bytes);

}  // namespace atlas::test
