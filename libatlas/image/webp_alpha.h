// Internal: hides the alpha channel of WebP files, so that readers cannot multiply colours by it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace atlas {

// Returns a copy of a WebP file that claims to have no alpha channel, with the colours unchanged.
// Any bytes are allowed: nothing is read beyond their end, and what is no WebP file stays as it is.
std::vector<std::uint8_t> without_webp_alpha(std::span<const std::uint8_t> file);

}  // namespace atlas
