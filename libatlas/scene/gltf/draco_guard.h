// Internal: decodes a mesh by the Draco library, without a count that it believes.
#pragma once

#include <draco/core/decoder_buffer.h>
#include <draco/mesh/mesh.h>

namespace atlas {

// Decodes the mesh that the buffer is at, of the edgebreaker method. Draco's own decoder takes the
// number of bits by which texture coordinates are predicted from the data, up to 2^31, and decodes
// so many: a file of two kilobytes took eight seconds. A mesh needs at most one for each corner.
bool decode_edgebreaker(draco::DecoderBuffer& buffer, draco::Mesh& mesh);

}  // namespace atlas
