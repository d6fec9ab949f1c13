// The benchmark page: tables and plots of one or several result files.
#pragma once

#include <filesystem>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// All rows, fits and checks together; machines are listed one a file, each with its command.
struct PageInput {
  std::vector<Results> files;
};

// Writes index.html, stability.html, performance.md, stability.md and the plots (SVG) into
// `folder`, which is created. A plot that cannot be drawn is left out, with its reason on the page.
// Errors: io.
Status write_page(const PageInput& input, const std::filesystem::path& folder);

}  // namespace atlas::bench
