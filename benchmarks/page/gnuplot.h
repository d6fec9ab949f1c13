// Draws plots with gnuplot, as SVG.
#pragma once

#include <filesystem>
#include <string>

#include "benchmarks/page/plots.h"

namespace atlas::bench {

// Returns the gnuplot script of one plot, which writes `target`. Labels lie beside their points, in
// a position that covers no other point or label if there is one.
std::string gnuplot_script(const Plot& plot, const std::filesystem::path& target);

// Errors: io if gnuplot is missing or fails.
Status draw(const Plot& plot, const std::filesystem::path& folder);

}  // namespace atlas::bench
