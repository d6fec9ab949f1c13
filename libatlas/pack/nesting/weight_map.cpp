#include "libatlas/pack/nesting/weight_map.h"

#include <algorithm>
#include <cstring>

#include "libatlas/core/wide_vectors.h"

// GCC warns that functions pass such vectors differently with and without AVX. Here only inlined
// functions take or return them.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace atlas::pack {
namespace {

using Column = std::uint32_t __attribute__((vector_size(32)));
static_assert(sizeof(Column) == WeightMap::kColumn * sizeof(std::uint32_t));

ATLAS_INLINE Column load(const std::uint32_t* from) {
  Column column;
  std::memcpy(&column, from, sizeof column);
  return column;
}

ATLAS_INLINE std::uint32_t least(const Column& column) {
  std::uint32_t low = column[0];
  for (int k = 1; k < WeightMap::kColumn; ++k) low = std::min(low, column[k]);
  return low;
}

// Sums over the runs of the mask. `base` is the cell at which the mask's box begins.
ATLAS_INLINE Column weights(const Mask& mask, const std::uint32_t* base, std::int32_t stride,
                            std::int32_t most) {
  constexpr std::int32_t kRows = 16;  // rows between two looks at whether it is too heavy
  Column sum{};
  for (std::int32_t r = 0; r < mask.height;) {
    const std::int32_t end = std::min(mask.height, r + kRows);
    for (; r < end; ++r)
      for (const Run& run : mask.row(r)) {
        sum += load(base + std::ptrdiff_t(run.end) * stride + r);
        sum -= load(base + std::ptrdiff_t(run.begin) * stride + r);
      }
    if (least(sum) > std::uint32_t(most)) break;
  }
  return sum;
}

ATLAS_WIDE Column* weights_wide(const Mask& mask, const std::uint32_t* base, std::int32_t stride,
                                std::int32_t most, Column* to) {
  *to = weights(mask, base, stride, most);
  return to;
}

// Rows that are summed together: those of a cache line. They are summed from their first column
// that changed.
constexpr std::int32_t kColumnsABand = 2, kBand = kColumnsABand * WeightMap::kColumn;

ATLAS_INLINE void sum_band(const std::uint32_t* steps, std::uint32_t* sums, std::int32_t columns,
                           std::ptrdiff_t stride) {
  Column weight[kColumnsABand], sum[kColumnsABand];
  for (int k = 0; k < kColumnsABand; ++k) {
    const std::uint32_t* const before = sums + k * WeightMap::kColumn;
    sum[k] = load(before);
    weight[k] = sum[k] - load(before - stride);
  }
  for (; columns > 0; --columns) {
    for (int k = 0; k < kColumnsABand; ++k) {
      weight[k] += load(steps + k * WeightMap::kColumn);
      sum[k] += weight[k];
      std::memcpy(sums + stride + k * WeightMap::kColumn, &sum[k], sizeof sum[k]);
    }
    steps += stride;
    sums += stride;
  }
}

ATLAS_WIDE void sum_band_wide(const std::uint32_t* steps, std::uint32_t* sums, std::int32_t columns,
                              std::ptrdiff_t stride) {
  sum_band(steps, sums, columns, stride);
}

}  // namespace

// The stride leaves room for a column that begins with the highest row.
WeightMap::WeightMap(std::int32_t width, std::int32_t height)
    : width_(width), stride_((height + kColumn - 1 + kBand - 1) / kBand * kBand) {
  steps_.resize(index(width + 1, 0));
  sums_.resize(index(width + 2, 0));
  changed_.resize(std::size_t(stride_ / kBand));
  clear();
}

void WeightMap::clear() {
  std::fill(steps_.begin(), steps_.end(), 0);
  std::fill(changed_.begin(), changed_.end(), 0);
}

void WeightMap::add(const Mask& mask, BitPage::Place at, std::int32_t weight) {
  for (std::int32_t r = 0; r < mask.height; ++r)
    for (const Run& run : mask.row(r)) {
      steps_[index(at.x + run.begin, at.y + r)] += std::uint32_t(weight);
      steps_[index(at.x + run.end, at.y + r)] -= std::uint32_t(weight);
    }
  for (std::int32_t band = at.y / kBand; band * kBand < at.y + mask.height; ++band)
    changed_[std::size_t(band)] = std::min(changed_[std::size_t(band)], at.x);
}

void WeightMap::sum() {
  for (std::size_t band = 0; band < changed_.size(); ++band) {
    const std::int32_t x = changed_[band];
    changed_[band] = width_;
    if (x >= width_) continue;
    const std::int32_t y = std::int32_t(band) * kBand;
    const auto sum = has_wide_vectors ? sum_band_wide : sum_band;
    sum(steps_.data() + index(x, y), sums_.data() + index(x + 1, y), width_ - x, stride_);
  }
}

WeightMap::Lightest WeightMap::weigh(const Mask& mask, BitPage::Place lowest, std::int32_t count,
                                     std::int32_t most) const {
  Column column;
  const std::uint32_t* const base = sums_.data() + index(lowest.x + 1, lowest.y);
  if (has_wide_vectors)
    weights_wide(mask, base, stride_, most, &column);
  else
    column = weights(mask, base, stride_, most);
  Lightest best{std::int32_t(column[0]), lowest};
  for (std::int32_t k = 1; k < count; ++k)
    if (column[k] < std::uint32_t(best.weight))
      best = {std::int32_t(column[k]), {lowest.x, lowest.y + k}};
  return best;
}

}  // namespace atlas::pack
