// Internal: colours of texels that a mask leaves out.
#pragma once

#include <cstdint>
#include <span>

namespace atlas {

// Gives the texels of an RGBA image whose alpha is below `least` the mean colour of the others
// around them. Such texels are never shown themselves, but filters mix their colours, which are
// often black or white, into the rims of what is. Alpha stays, and so does an image without other
// texels. `rgba` holds width * height texels of four bytes.
void spread_mask_colours(std::span<std::uint8_t> rgba, int width, int height, int least);

}  // namespace atlas
