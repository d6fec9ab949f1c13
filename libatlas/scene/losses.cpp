#include "libatlas/scene/losses.h"

#include <fmt/format.h>

namespace atlas {

std::vector<std::string> Losses::lines() const {
  std::vector<std::string> result;
  for (const auto& [what, count] : counts_) result.push_back(fmt::format("{} x {}", count, what));
  return result;
}

void count_mtl_losses(const Material& material, Losses& losses) {
  for (const std::string& line : material.mtl_lines) {
    const std::string keyword = line.substr(0, line.find_first_of(" \t"));
    const bool halo = line.find("-halo") != line.npos;  // then the opacity depends on the view
    if (keyword == "map_Kd" || (keyword == "d" && !halo)) continue;
    if (keyword == "Ke" && !material.emission_textured) continue;
    losses.add("lines of the MTL: " + keyword);
  }
}

}  // namespace atlas
