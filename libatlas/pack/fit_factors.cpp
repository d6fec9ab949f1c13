#include "libatlas/pack/fit_factors.h"

#include <algorithm>
#include <cmath>

namespace atlas::pack {

std::vector<double> chart_factors(std::span<const FitItem> items, const FitOptions& options,
                                  double scale) {
  std::vector<double> factors(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const double side = std::max(items[i].width, items[i].height);
    const double least = std::min<double>(options.minimum_side, std::ceil(side));
    factors[i] = side > 0 ? std::max(scale, std::min(options.max_scale, least / side)) : scale;
  }
  return factors;
}

bool below_minimum_side(std::span<const FitItem> items, const FitOptions& options, double scale) {
  return std::any_of(items.begin(), items.end(), [&](const FitItem& item) {
    const double side = std::max(item.width, item.height);
    return side * scale < std::min<double>(options.minimum_side, std::ceil(side));
  });
}

}  // namespace atlas::pack
