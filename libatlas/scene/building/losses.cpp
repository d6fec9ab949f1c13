#include "libatlas/scene/building/losses.h"

#include <fmt/format.h>

#include <algorithm>

#include "libatlas/scene/files/text_scanner.h"

namespace atlas {

std::vector<std::string> Losses::lines() const {
  std::vector<std::string> result;
  for (const auto& [what, count] : counts_) result.push_back(fmt::format("{} x {}", count, what));
  return result;
}

void count_vertex_alpha(const Scene& scene, Losses& losses) {
  const auto& values = scene.vertex_opacity;
  const auto open = std::count_if(values.begin(), values.end(), [](float v) { return v != 1; });
  losses.add(kVertexAlphaLoss, std::size_t(open));
}

bool is_opacity_line(const std::string& mtl_line) {
  const std::string text = mtl_line + '\n';  // scanners need a newline at the end
  TextScanner scan(text.data(), text.data() + text.size());
  double share = 0;
  return scan.word() == "d" && scan.number(share) && share >= 0 && share <= 1 && scan.at_line_end();
}

void count_mtl_losses(const Material& material, Losses& losses) {
  for (const std::string& line : material.mtl_lines) {
    const std::string keyword = line.substr(0, line.find_first_of(" \t"));
    if (keyword == "map_Kd" || is_opacity_line(line)) continue;
    if (keyword == "Ke" && !material.emission_textured) continue;
    if (keyword == "illum" && material.unlit) continue;
    losses.add("lines of the MTL: " + keyword);
  }
}

}  // namespace atlas
