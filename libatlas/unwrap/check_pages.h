// Internal: the ranges of PageOptions that calls of this folder take.
#pragma once

#include <string>

#include "libatlas/core/status.h"
#include "libatlas/pack/pages.h"

namespace atlas {

// Whether there is a page of 64 to 16384 texels, padding and alignment are at most a quarter of it,
// and sides and alignment are powers of two for square or several pages. `call` begins the message.
Status check_pages(const std::string& call, const PageOptions& options);

}  // namespace atlas
