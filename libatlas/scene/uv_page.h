// How plain uvs say which page they were made for. Uvs run from 0 to 1 across a page of any shape,
// so a file must say that shape, or its charts would be read as stretched.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace atlas {

// Returns the line for a single page of this many texels.
std::string uv_page_text(std::int32_t width, std::int32_t height);

// Returns width / height of the page if this is such a line, which may have a comment's mark before
// it; else 0.
double uv_aspect_of(std::string_view line);

}  // namespace atlas
