// Plots by gnuplot, as SVG.
#pragma once

#include <filesystem>
#include <string>

#include "benchmarks/page/plots.h"

namespace atlas::bench {

// The gnuplot script of one plot, which writes `target`. Labels lie beside their points, where they
// cover no other point or label if there is such a place.
std::string gnuplot_script(const Plot& plot, const std::filesystem::path& target);

// Errors: io when gnuplot is missing or fails.
Status draw(const Plot& plot, const std::filesystem::path& folder);

}  // namespace atlas::bench
