// Internal: the shapes of the pages that given texcoords run over.
#pragma once

#include <cstdint>
#include <span>

#include "libatlas/charts/charts.h"

namespace atlas {

// Widths / heights of pages, see ChartOptions::material_uv_aspects. What `of_material` points at
// must outlive this object.
struct UvAspects {
  std::span<const double> of_material = {};
  double other = 1;

  double of(std::uint32_t material) const {
    return material < of_material.size() ? of_material[material] : other;
  }
};

inline UvAspects uv_aspects(const ChartOptions& options) {
  return {options.material_uv_aspects, options.uv_aspect};
}

}  // namespace atlas
