// Internal: the light of one triangle as a function of texel position, for the loops of texture/
// and bake/.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/raster/scan.h"
#include "libatlas/texture/lanes.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/texture_levels.h"
#include "libatlas/texture/tone.h"

namespace atlas {

// Display values (with a tone mapping) or scene-linear luminance (without) over a triangle. Colours
// are R, G, B and a 1.
class TriangleLight {
 public:
  // `light` as prepared by the sampler; `tone` may be null.
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

  // For many samples of a triangle: prepares row(). Where the curve is straight enough between the
  // corners, only those are shown, and display values are interpolated.
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

  // The colour at barycentric coordinates.
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

  // The colour at a texel position of the triangle, which rounding may have put outside: slivers'
  // gradients would make much of that.
  Lanes inside(Vec2d at) const {
    const double dx = at.x - origin_.x, dy = at.y - origin_.y;
    const auto within = [](double v, double most) { return v > 0 ? std::min(v, most) : 0.0; };
    const double b1 = within(gradient_[0].x * dx + gradient_[0].y * dy, 1);
    const double b2 = within(gradient_[1].x * dx + gradient_[1].y * dy, 1 - b1);
    const float b[3] = {static_cast<float>(1 - b1 - b2), static_cast<float>(b1),
                        static_cast<float>(b2)};
    return this->at(b);
  }

  // Calls sample(i, colour) for i in [0, n), in this order, at texel positions (at.x + i, at.y).
  template <class Sample>
  void row(Vec2d at, int n, Sample&& sample) const {
    const double dx = at.x - origin_.x, dy = at.y - origin_.y;
    const auto b1 = static_cast<float>(gradient_[0].x * dx + gradient_[0].y * dy);
    const auto b2 = static_cast<float>(gradient_[1].x * dx + gradient_[1].y * dy);
    const Lanes e = corner_[0] + b1 * (corner_[1] - corner_[0]) + b2 * (corner_[2] - corner_[0]);
    if (direct_) {
      for (int i = 0; i < n; ++i) sample(i, e + static_cast<float>(i) * step_);
      return;
    }
    Vec2f uv;
    if (level_)
      uv = {texcoord_[0].x + b1 * (texcoord_[1].x - texcoord_[0].x) +
                b2 * (texcoord_[2].x - texcoord_[0].x),
            texcoord_[0].y + b1 * (texcoord_[1].y - texcoord_[0].y) +
                b2 * (texcoord_[2].y - texcoord_[0].y)};
    for (int i = 0; i < n; ++i) {
      const auto f = static_cast<float>(i);
      sample(i, finish(e + f * step_, {uv.x + f * texture_step_.x, uv.y + f * texture_step_.y}));
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

  Lanes show(Lanes e) const {
    if (tone_->op == ToneOperator::linear) return srgb_encode_lanes(e * tone_->scale);
    const Vec3f v = tone_->map({e[0], e[1], e[2]});
    return srgb_encode_lanes(Lanes{v.x, v.y, v.z, 1});
  }

  // A tenth of an 8-bit step at the middle of the edges is far below what the atlas can hold.
  void try_direct() {
    constexpr float kTolerance = 0.1f / 255;
    Lanes d[3];
    for (int i = 0; i < 3; ++i) d[i] = show(corner_[i]);
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1;
      const Lanes off = show(0.5f * (corner_[i] + corner_[j])) - 0.5f * (d[i] + d[j]);
      for (int k = 0; k < 3; ++k)
        if (!(std::fabs(off[k]) <= kTolerance)) return;
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
