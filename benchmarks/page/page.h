// The benchmark page: tables and plots of one or several result files.
#pragma once

#include <filesystem>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// Files with checks make up the stability page, with their rows; all others the performance page.
// Rows, fits and checks of the files of one page are combined. Machines are listed per file, each
// with its command.
struct PageInput {
  std::vector<Results> files;
};

// Writes index.html, stability.html, performance.md, stability.md and the plots (SVG) into
// `folder`, which is created. If a plot cannot be drawn, the page states the reason instead.
// Errors: io.
Status write_page(const PageInput& input, const std::filesystem::path& folder);

}  // namespace atlas::bench
