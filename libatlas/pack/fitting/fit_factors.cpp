#include "libatlas/pack/fitting/fit_factors.h"

#include <algorithm>
#include <cmath>

namespace atlas::pack {
namespace {

double longer_side(const FitItem& item) {
  return std::max(item.width, item.height);
}

// Returns the least length of a longer side.
double least_side(double side, const FitOptions& options) {
  return std::min<double>(options.minimum_side, std::ceil(side));
}

}  // namespace

std::vector<double> chart_factors(std::span<const FitItem> items, const FitOptions& options,
                                  double scale) {
  std::vector<double> factors(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const double side = longer_side(items[i]), least = least_side(side, options);
    factors[i] = side > 0 ? std::max(scale, std::min(options.max_scale, least / side)) : scale;
  }
  return factors;
}

bool below_minimum_side(std::span<const FitItem> items, const FitOptions& options, double scale) {
  return std::any_of(items.begin(), items.end(), [&](const FitItem& item) {
    return longer_side(item) * scale < least_side(longer_side(item), options);
  });
}

}  // namespace atlas::pack
