#include "libatlas/charts/merging/fan_measure.h"

#include <algorithm>
#include <cmath>

#include "libatlas/charts/merging/fan_kernels.h"

namespace atlas {

struct FanMeasure::Kernels {
  struct Fan {
    std::uint32_t begin, end;  // range of its triangles
    std::size_t slot = 0;      // a triangle's slot minus its index among all triangles
    Vec2d centre{};
  };
  ATLAS_INLINE static Fan fan_of(const JoinedFans& joined, const Vec2d* uvs, std::size_t c) {
    Fan fan{joined.first[c], joined.first[c + 1]};
    if (fan.begin == fan.end) return fan;
    const JoinedFans::Triangle& first = joined.triangles[fan.begin];
    fan.slot = first.slot - std::size_t{fan.begin};
    fan.centre = uvs[first.centre];
    return fan;
  }

  // The entries written beyond the end of a fan are overwritten by the next fan.
  ATLAS_INLINE static void measure_maps(FanMeasure& m, const JoinedFans& joined, const Vec2d* uvs) {
    double *const squares = m.squares_.data(), *const product = m.product_.data(),
                  *const area = m.area_.data();
    for (std::size_t c = 0; c < joined.cells.size(); ++c) {
      const Fan fan = fan_of(joined, uvs, c);
      for (std::uint32_t i = fan.begin; i < fan.end; i += 4) {
        const std::size_t slot = fan.slot + i;  // one sum: fan.slot alone may be below 0
        const Quad g1x = QuadAt(m.fans_.slot_gradient_x.data() + slot).quad,
                   g1y = QuadAt(m.fans_.slot_gradient_y.data() + slot).quad,
                   g2x = QuadAt(m.fans_.next_gradient_x.data() + slot).quad,
                   g2y = QuadAt(m.fans_.next_gradient_y.data() + slot).quad;
        const Quad inverse = QuadAt(m.fans_.inverse_area.data() + slot).quad;
        Sides d;
        find_sides(joined.triangles.data() + i, uvs, fan.centre, d);
        // The columns of the map, times the area.
        const Quad xx = g1x * d.ax + g2x * d.bx, xy = g1x * d.ay + g2x * d.by;
        const Quad yx = g1y * d.ax + g2y * d.bx, yy = g1y * d.ay + g2y * d.by;
        const Quad scale = inverse * inverse;
        put_quad(squares + i, ((xx * xx + xy * xy) + (yx * yx + yy * yy)) * scale);
        put_quad(product + i, (xx * yy - xy * yx) * scale);
        put_quad(area + i, QuadAt(m.fans_.area.data() + slot).quad);
      }
    }
    put_quad(area + m.count_, Quad{});
  }

  struct Sums {
    double area = 0, uv_area = 0, l2 = 0;
    bool flipped = false;
  };
  ATLAS_INLINE static void sum_up(const FanMeasure& m, Sums& sums) {
    double area = 0, uv_area = 0, l2 = 0;
    auto flipped = Quad{} != Quad{};
    for (std::size_t i = 0; i < m.count_; i += 4) {
      const Quad own = QuadAt(m.area_.data() + i).quad,
                 product = QuadAt(m.product_.data() + i).quad;
      const auto counts = own > 0;
      flipped |= counts & (product <= 0);
      const Quad uv = own * product;
      const Quad stretched =
          counts ? own * (QuadAt(m.squares_.data() + i).quad / (product * product)) : Quad{};
      for (int k = 0; k < 4; ++k) {
        area += own[k];
        uv_area += counts[k] ? uv[k] : 0;
        l2 += stretched[k];
      }
    }
    sums.area = area;
    sums.uv_area = uv_area;
    sums.l2 = l2;
    sums.flipped = flipped[0] | flipped[1] | flipped[2] | flipped[3];
  }

  // Returns the area of the triangles whose larger singular value, or the inverse of whose smaller
  // one, is too large. The squares of both singular values are the roots of x² - squares x +
  // product².
  ATLAS_INLINE static double area_beyond(const FanMeasure& m, double least, double most) {
    double above = 0;
    for (std::size_t i = 0; i < m.count_; i += 4) {
      const Quad squares = QuadAt(m.squares_.data() + i).quad,
                 product = QuadAt(m.product_.data() + i).quad;
      const Quad last = product * product;
      const auto high = (most * (most - squares) + last < 0) | (2 * most < squares) |
                        (least * (least - squares) + last < 0) | (2 * least > squares);
      const Quad own = high ? QuadAt(m.area_.data() + i).quad : Quad{};
      for (int k = 0; k < 4; ++k) above += own[k];
    }
    return above;
  }

  ATLAS_INLINE static double twice_area(FanMeasure& m, const JoinedFans& joined, const Vec2d* uvs,
                                        bool& any_flipped) {
    double *const twice = m.product_.data(), *const area = m.area_.data();
    for (std::size_t c = 0; c < joined.cells.size(); ++c) {
      const Fan fan = fan_of(joined, uvs, c);
      for (std::uint32_t i = fan.begin; i < fan.end; i += 4) {
        Sides d;
        find_sides(joined.triangles.data() + i, uvs, fan.centre, d);
        put_quad(twice + i, d.ax * d.by - d.ay * d.bx);
        put_quad(area + i, QuadAt(m.fans_.area.data() + (fan.slot + i)).quad);
      }
    }
    put_quad(area + m.count_, Quad{});
    put_quad(twice + m.count_, Quad{});
    double sum = 0;
    auto flipped = Quad{} != Quad{};
    for (std::size_t i = 0; i < m.count_; i += 4) {
      const Quad own = QuadAt(twice + i).quad;
      flipped |= (own <= 0) & (QuadAt(area + i).quad > 0);
      for (int k = 0; k < 4; ++k) sum += own[k];
    }
    any_flipped = flipped[0] | flipped[1] | flipped[2] | flipped[3];
    return sum;
  }

  ATLAS_WIDE static void maps_wide(FanMeasure& m, const JoinedFans& joined, const Vec2d* uvs,
                                   Sums& sums) {
    measure_maps(m, joined, uvs);
    sum_up(m, sums);
  }
  static void maps_narrow(FanMeasure& m, const JoinedFans& joined, const Vec2d* uvs, Sums& sums) {
    measure_maps(m, joined, uvs);
    sum_up(m, sums);
  }
  ATLAS_WIDE static double area_beyond_wide(const FanMeasure& m, double least, double most) {
    return area_beyond(m, least, most);
  }
  static double area_beyond_narrow(const FanMeasure& m, double least, double most) {
    return area_beyond(m, least, most);
  }
  ATLAS_WIDE static double twice_area_wide(FanMeasure& m, const JoinedFans& joined,
                                           const Vec2d* uvs, bool& flipped) {
    return twice_area(m, joined, uvs, flipped);
  }
  static double twice_area_narrow(FanMeasure& m, const JoinedFans& joined, const Vec2d* uvs,
                                  bool& flipped) {
    return twice_area(m, joined, uvs, flipped);
  }
};

void FanMeasure::resize(const JoinedFans& joined) {
  count_ = joined.triangles.size();
  if (area_.size() >= count_ + 2 * JoinedFans::kBeyond) return;
  for (std::vector<double>* const values : {&squares_, &product_, &area_}) {
    values->resize(count_ + 2 * JoinedFans::kBeyond);
  }
}

FanStretch FanMeasure::stretch(const JoinedFans& joined, std::span<const Vec2d> uvs, double high) {
  resize(joined);
  Kernels::Sums sums;
  (has_wide_vectors ? Kernels::maps_wide : Kernels::maps_narrow)(*this, joined, uvs.data(), sums);
  FanStretch result;
  result.flipped = sums.flipped;
  if (sums.flipped) {
    result.energy = rigid_energy();
    return result;
  }
  // The square of the map's linear scale.
  const double squared = sums.area > 0 ? sums.uv_area / sums.area : 1;
  const double l2 = sums.l2 * (0.5 * squared);
  const double most = high * high * squared, least = squared / (high * high);
  result.high_area = (has_wide_vectors ? Kernels::area_beyond_wide : Kernels::area_beyond_narrow)(
      *this, least, most);
  result.l2 = sums.area > 0 ? std::sqrt(l2 / sums.area) : 1;
  result.energy = l2 - sums.area;
  return result;
}

// Returns the sum of area times (s1 - 1)² + (s2 - 1)² over all triangles, where the smaller
// singular value s2 has the sign of the determinant.
double FanMeasure::rigid_energy() const {
  double rigid = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const double sum = std::sqrt(std::max(squares_[i] + 2 * product_[i], 0.0));
    rigid += area_[i] * (squares_[i] - 2 * sum + 2);
  }
  return rigid;
}

double FanMeasure::twice_area(const JoinedFans& joined, std::span<const Vec2d> uvs, bool& flipped) {
  resize(joined);
  return (has_wide_vectors ? Kernels::twice_area_wide : Kernels::twice_area_narrow)(
      *this, joined, uvs.data(), flipped);
}

double FanMeasure::mapped_area(const JoinedFans& joined, std::span<const Vec2d> uvs) {
  resize(joined);
  Kernels::Sums sums;
  (has_wide_vectors ? Kernels::maps_wide : Kernels::maps_narrow)(*this, joined, uvs.data(), sums);
  double area = 0;
  for (std::size_t i = 0; i < count_; ++i) area += area_[i] * product_[i];
  return area;
}

}  // namespace atlas
