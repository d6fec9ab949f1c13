// Internal: the text of the page around its data. CMake makes it of the files in html/page.
#pragma once

#include <string_view>

namespace atlas {

extern const std::string_view kPageBeforeTitle, kPageBeforeData, kPageAfterData;

}  // namespace atlas
