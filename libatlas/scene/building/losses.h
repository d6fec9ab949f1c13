// Internal: counts what an export that keeps the scene has to leave out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libatlas/scene/scene.h"

namespace atlas {

// The kind of loss that is alpha of vertices other than 1.
inline constexpr const char* kVertexAlphaLoss = "values of vertices: alpha";

class Losses {
 public:
  // `what` in the plural, for example "animations".
  void add(const std::string& what, std::size_t times = 1) {
    if (times > 0) counts_[what] += times;
  }
  void add(const LossCounts& counts) {
    for (const auto& [what, count] : counts) add(what, count);
  }

  const LossCounts& counts() const { return counts_; }

  // Returns "2 x animations", one string for each kind, sorted by name (WorldFile::not_kept).
  std::vector<std::string> lines() const;

 private:
  LossCounts counts_;
};

// Adds the vertices whose alpha is not 1, for files that have no room for it.
void count_vertex_alpha(const Scene& scene, Losses& losses);

// Returns whether a line of an MTL is `d` with a fraction, which Material::opacity holds. It does
// not hold `d -halo`, where the opacity depends on the view, and values that are no fraction.
bool is_opacity_line(const std::string& mtl_line);

// Adds, by keyword, the Material::mtl_lines that say what no other member of Material holds.
void count_mtl_losses(const Material& material, Losses& losses);

}  // namespace atlas
