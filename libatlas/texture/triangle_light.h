// Internal: the light of one triangle as a function of the texel position. The loops of texture/
// and bake/ use it.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/core/lanes.h"
#include "libatlas/raster/scan.h"
#include "libatlas/texture/light_row.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/texture_levels.h"
#include "libatlas/texture/tone.h"

namespace atlas {

// The light over a triangle: display values if there is a tone mapping, and scene-linear luminance
// otherwise. Colours are R, G, B and a 1.
class TriangleLight {
 public:
  // `light` is what the sampler's prepare() returns. `tone` may be null.
  TriangleLight(const LuminanceSampler::Triangle& light, const ToneMapping* tone)
      : tone_(tone),
        level_(light.texture ? &light.texture->levels[light.level] : nullptr),
        wraps_{light.wrap_u, light.wrap_v} {
    for (int k = 0; k < 3; ++k) {
      const float* e = light.illumination[k];
      corner_[k] = Lanes{e[0], e[1], e[2], 1};
      texcoord_[k] = {light.texcoord[k][0], light.texcoord[k][1]};
    }
    if (light.constant && tone_) {
      corner_[0] = corner_[1] = corner_[2] = show(corner_[0]);
      direct_ = true;
    }
  }

  // Prepares row() and inside() for many samples of a triangle. If the tone curve is straight
  // enough between the corners, display values are computed at the corners only, and interpolated
  // between them.
  void set_position(const TexelTriangle& p) {
    if (tone_ && !level_ && !direct_) try_direct();
    const double ax = p[1].x - p[0].x, ay = p[1].y - p[0].y;
    const double bx = p[2].x - p[0].x, by = p[2].y - p[0].y;
    const double inverse = 1 / (ax * by - ay * bx);
    origin_ = p[0];
    gradient_[0] = {by * inverse, -bx * inverse};  // of the second barycentric coordinate
    gradient_[1] = {-ay * inverse, ax * inverse};  // of the third
    const auto g0 = static_cast<float>(gradient_[0].x), g1 = static_cast<float>(gradient_[1].x);
    step_ = g0 * (corner_[1] - corner_[0]) + g1 * (corner_[2] - corner_[0]);
    texture_step_ = {
        g0 * (texcoord_[1].x - texcoord_[0].x) + g1 * (texcoord_[2].x - texcoord_[0].x),
        g0 * (texcoord_[1].y - texcoord_[0].y) + g1 * (texcoord_[2].y - texcoord_[0].y)};
  }

  // Returns the colour at barycentric coordinates.
  Lanes at(const float b[3]) const {
    Lanes e = b[0] * corner_[0] + b[1] * corner_[1] + b[2] * corner_[2];
    e[3] = 1;
    if (direct_) return e;
    Vec2f uv;
    if (level_)
      uv = {b[0] * texcoord_[0].x + b[1] * texcoord_[1].x + b[2] * texcoord_[2].x,
            b[0] * texcoord_[0].y + b[1] * texcoord_[1].y + b[2] * texcoord_[2].y};
    return finish(e, uv);
  }

  // Returns the colour at a texel position. Rounding may have moved the position out of the
  // triangle. It is clamped to the triangle's barycentric range, because the large gradients of a
  // sliver would amplify the excess.
  Lanes inside(Vec2d at) const {
    const double dx = at.x - origin_.x, dy = at.y - origin_.y;
    const auto within = [](double v, double most) { return v > 0 ? std::min(v, most) : 0.0; };
    const double b1 = within(gradient_[0].x * dx + gradient_[0].y * dy, 1);
    const double b2 = within(gradient_[1].x * dx + gradient_[1].y * dy, 1 - b1);
    const float b[3] = {static_cast<float>(1 - b1 - b2), static_cast<float>(b1),
                        static_cast<float>(b2)};
    return this->at(b);
  }

  // Calls take(first, colours, count) repeatedly, with the colours of `count` samples at a time,
  // until n samples are done. The samples come in order, at the texel positions (at.x + i, at.y)
  // with first <= i < first + count.
  template <class Take>
  void row(Vec2d at, int n, Take&& take) const {
    const double dx = at.x - origin_.x, dy = at.y - origin_.y;
    const auto b1 = static_cast<float>(gradient_[0].x * dx + gradient_[0].y * dy);
    const auto b2 = static_cast<float>(gradient_[1].x * dx + gradient_[1].y * dy);
    const Lanes e = corner_[0] + b1 * (corner_[1] - corner_[0]) + b2 * (corner_[2] - corner_[0]);
    Lanes colours[kStretch];
    for (int first = 0; first < n; first += kStretch) {
      const int count = std::min(kStretch, n - first);
      if (direct_ || level_ || !tone_) {
        for (int i = 0; i < count; ++i) colours[i] = e + static_cast<float>(first + i) * step_;
        if (level_) apply_texture({b1, b2}, first, count, colours);
        if (!direct_) finish_all(count, colours);
      } else {
        show_stretch(e + static_cast<float>(first) * step_, count, colours);
      }
      take(first, static_cast<const Lanes*>(colours), count);
    }
  }

 private:
  Lanes finish(Lanes e, Vec2f uv) const {
    if (level_) {
      e *= look_up(*level_, uv, wraps_);
      e[3] = 1;
    }
    return tone_ ? show(e) : e;
  }

  static constexpr int kStretch = 16;

  // `b` holds the second and third barycentric coordinate at the beginning of the row.
  void apply_texture(Vec2f b, int first, int count, Lanes* colours) const {
    const Vec2f uv = {texcoord_[0].x + b.x * (texcoord_[1].x - texcoord_[0].x) +
                          b.y * (texcoord_[2].x - texcoord_[0].x),
                      texcoord_[0].y + b.x * (texcoord_[1].y - texcoord_[0].y) +
                          b.y * (texcoord_[2].y - texcoord_[0].y)};
    multiply_by_texture({*level_, wraps_, uv, texture_step_, first}, count, colours);
  }

  void finish_all(int count, Lanes* colours) const {
    if (tone_ && tone_->op == ToneOperator::linear)
      return srgb_encode_row(tone_->scale, count, colours);
    for (int i = 0; i < count; ++i) {
      colours[i][3] = 1;
      if (tone_) colours[i] = show(colours[i]);
    }
  }

  // Computes display values of untextured light, beginning with the light e. show() costs more than
  // everything else that is done for a sample. Where the tone curve hardly differs from lines,
  // values are therefore interpolated.
  void show_stretch(Lanes e, int count, Lanes* shown) const {
    const int last = count - 1;
    shown[0] = show(e);
    if (last > 0) shown[last] = show(e + static_cast<float>(last) * step_);
    show_between(e, 0, last, shown);
  }

  // Fills shown[i] for first < i < last. shown[first] and shown[last] must be set. The middle is
  // computed; if it lies on the line between the ends, the rest is interpolated, and otherwise both
  // halves are filled in the same way.
  void show_between(Lanes start, int first, int last, Lanes* shown) const {
    if (last - first < 2) return;
    const int middle = (first + last) / 2;
    const float share = static_cast<float>(middle - first) / static_cast<float>(last - first);
    shown[middle] = show(start + static_cast<float>(middle) * step_);
    const Lanes chord = shown[first] + share * (shown[last] - shown[first]);
    const int ends[3] = {first, middle, last};
    if (!negligible(shown[middle] - chord)) {
      for (int k = 0; k < 2; ++k) show_between(start, ends[k], ends[k + 1], shown);
      return;
    }
    for (int k = 0; k < 2; ++k) {
      const int from = ends[k], to = ends[k + 1];
      const Lanes slope = (shown[to] - shown[from]) / static_cast<float>(to - from);
      for (int i = from + 1; i < to; ++i)
        shown[i] = shown[from] + static_cast<float>(i - from) * slope;
    }
  }

  Lanes show(Lanes e) const {
    if (tone_->op == ToneOperator::linear) return srgb_encode_lanes(e * tone_->scale);
    const Vec3f v = tone_->map({e[0], e[1], e[2]});
    return srgb_encode_lanes(Lanes{v.x, v.y, v.z, 1});
  }

  // Returns whether a difference is negligible. A tenth of an 8-bit step is far below what the
  // atlas can store.
  static bool negligible(Lanes off) {
    constexpr float kTolerance = 0.1f / 255;
    return std::fabs(off[0]) <= kTolerance && std::fabs(off[1]) <= kTolerance &&
           std::fabs(off[2]) <= kTolerance;
  }

  // Replaces the light at the corners by display values if interpolating these is accurate enough
  // at the middles of the edges.
  void try_direct() {
    Lanes d[3];
    for (int i = 0; i < 3; ++i) d[i] = show(corner_[i]);
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1;
      if (!negligible(show(0.5f * (corner_[i] + corner_[j])) - 0.5f * (d[i] + d[j]))) return;
    }
    std::copy_n(d, 3, corner_);
    direct_ = true;
  }

  const ToneMapping* tone_;
  const TextureLevels::Level* level_;
  TextureWraps wraps_;
  bool direct_ = false;  // corner_ holds display values
  Lanes corner_[3], step_{};
  Vec2f texcoord_[3], texture_step_;
  Vec2d origin_, gradient_[2];
};

}  // namespace atlas
