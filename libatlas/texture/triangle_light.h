// Internal: the light of one triangle as a function of texel position, for the loops of texture/
// and bake/.
#pragma once

#include <algorithm>
#include <cmath>

#include "libatlas/raster/scan.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/texture_levels.h"
#include "libatlas/texture/tone.h"

namespace atlas {

// Display values (with a tone mapping) or scene-linear luminance (without) over a triangle.
class TriangleLight {
 public:
  // `light` as prepared by the sampler; `tone` may be null.
  TriangleLight(const LuminanceSampler::Triangle& light, const ToneMapping* tone)
      : light_(light), tone_(tone) {
    if (light_.constant && tone_) show_corners();
  }

  // For many samples of a triangle: prepares row(), and where the curve is straight enough between
  // the corners shows those only and interpolates display values.
  void set_position(const TexelTriangle& p) {
    if (tone_ && !light_.texture && !direct_) try_direct();
    const double ax = p[1].x - p[0].x, ay = p[1].y - p[0].y;
    const double bx = p[2].x - p[0].x, by = p[2].y - p[0].y;
    const double inverse = 1 / (ax * by - ay * bx);
    origin_ = p[0];
    gradient_[0] = {by * inverse, -bx * inverse};  // of the second barycentric coordinate
    gradient_[1] = {-ay * inverse, ax * inverse};  // of the third
    for (int k = 0; k < 3; ++k) {
      const float* e0 = light_.illumination[0];
      step_[k] = slope(light_.illumination[1][k] - e0[k], light_.illumination[2][k] - e0[k]);
    }
    for (int k = 0; light_.texture && k < 2; ++k)
      texture_step_[k] = slope(light_.texcoord[1][k] - light_.texcoord[0][k],
                               light_.texcoord[2][k] - light_.texcoord[0][k]);
  }

  // rgb[4] (4th lane unspecified) at barycentric coordinates.
  void at(const float b[3], float rgb[4]) const {
    float e[3], uv[2] = {0, 0};
    for (int k = 0; k < 3; ++k)
      e[k] = b[0] * light_.illumination[0][k] + b[1] * light_.illumination[1][k] +
             b[2] * light_.illumination[2][k];
    for (int k = 0; light_.texture && k < 2; ++k)
      uv[k] = b[0] * light_.texcoord[0][k] + b[1] * light_.texcoord[1][k] +
              b[2] * light_.texcoord[2][k];
    finish(e, uv, rgb);
  }

  // Calls sample(i, rgb) for i in [0, n) at texel positions (at.x + i, at.y).
  template <class Sample>
  void row(Vec2d at, int n, Sample&& sample) const {
    const double dx = at.x - origin_.x, dy = at.y - origin_.y;
    const double b1 = gradient_[0].x * dx + gradient_[0].y * dy;
    const double b2 = gradient_[1].x * dx + gradient_[1].y * dy;
    float e[3], uv[2] = {0, 0};
    for (int k = 0; k < 3; ++k) e[k] = lerp(light_.illumination, k, b1, b2);
    alignas(16) float rgb[4] = {0, 0, 0, 1};
    if (direct_) {
      for (int i = 0; i < n; ++i) {
        const auto f = static_cast<float>(i);
        for (int k = 0; k < 3; ++k) rgb[k] = e[k] + f * step_[k];
        sample(i, rgb);
      }
      return;
    }
    for (int k = 0; light_.texture && k < 2; ++k) uv[k] = lerp(light_.texcoord, k, b1, b2);
    for (int i = 0; i < n; ++i) {
      const auto f = static_cast<float>(i);
      float ei[3], uvi[2] = {0, 0};
      for (int k = 0; k < 3; ++k) ei[k] = e[k] + f * step_[k];
      if (light_.texture)
        for (int k = 0; k < 2; ++k) uvi[k] = uv[k] + f * texture_step_[k];
      finish(ei, uvi, rgb);
      sample(i, rgb);
    }
  }

 private:
  float slope(float d1, float d2) const {
    return static_cast<float>(gradient_[0].x * d1 + gradient_[1].x * d2);
  }
  template <int N>
  static float lerp(const float (&v)[3][N], int k, double b1, double b2) {
    return static_cast<float>(v[0][k] + b1 * (v[1][k] - v[0][k]) + b2 * (v[2][k] - v[0][k]));
  }

  void finish(const float e[3], const float uv[2], float rgb[4]) const {
    if (direct_) {
      for (int k = 0; k < 3; ++k) rgb[k] = e[k];
      return;
    }
    float r[4] = {1, 1, 1, 1};
    if (light_.texture) look_up(light_.texture->levels[light_.level], uv[0], uv[1], r);
    Vec3f c{r[0] * e[0], r[1] * e[1], r[2] * e[2]};
    if (tone_) c = tone_->display(c);
    rgb[0] = c.x;
    rgb[1] = c.y;
    rgb[2] = c.z;
  }

  void show_corners() {
    for (auto& e : light_.illumination) {
      const Vec3f d = tone_->display({e[0], e[1], e[2]});
      e[0] = d.x;
      e[1] = d.y;
      e[2] = d.z;
    }
    direct_ = true;
  }

  // A tenth of an 8-bit step at the middle of the edges is far below what the atlas can hold.
  void try_direct() {
    constexpr float kTolerance = 0.1f / 255;
    Vec3f d[3];
    for (int i = 0; i < 3; ++i) {
      const float* e = light_.illumination[i];
      d[i] = tone_->display({e[0], e[1], e[2]});
    }
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1;
      const float *a = light_.illumination[i], *b = light_.illumination[j];
      const Vec3f m =
          tone_->display({0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]), 0.5f * (a[2] + b[2])});
      const float off = std::max({std::fabs(m.x - 0.5f * (d[i].x + d[j].x)),
                                  std::fabs(m.y - 0.5f * (d[i].y + d[j].y)),
                                  std::fabs(m.z - 0.5f * (d[i].z + d[j].z))});
      if (!(off <= kTolerance)) return;
    }
    for (int i = 0; i < 3; ++i) {
      light_.illumination[i][0] = d[i].x;
      light_.illumination[i][1] = d[i].y;
      light_.illumination[i][2] = d[i].z;
    }
    direct_ = true;
  }

  LuminanceSampler::Triangle light_;
  const ToneMapping* tone_;
  bool direct_ = false;  // illumination holds display values
  Vec2d origin_, gradient_[2];
  float step_[3] = {0, 0, 0}, texture_step_[2] = {0, 0};
};

}  // namespace atlas
