// What the atlases hold: the light that leaves the surface, sampled anywhere on a triangle.
#pragma once

#include <cstdint>
#include <memory>

#include "libatlas/core/vec.h"
#include "libatlas/scene/scene.h"

namespace atlas {

struct TextureLevels;

// What Scene::illumination holds.
enum class Quantity {
  illuminance,  // E: the diffuse reflectance still has to be applied
  luminance,    // already what leaves the surface: taken as it is
};

// "Luminance" here is, as in Barladian et al. (section 2), illuminance times diffuse reflectance,
// linear RGB in the unit of the input. For a Lambertian surface lit with E lux that is the luminous
// exitance M = rho E in lm/m²; its photometric luminance is L = M / pi in cd/m². The factor pi is a
// constant that exposure absorbs, so it is left out: values stay comparable with the input's.
// With Quantity::luminance the values are the input's own (cd/m²).
//
// The sampler refers to the scene, which must outlive it and be as check_scene() asks; it builds
// mip chains of the textures (8-bit, a third of their size), and keeps up to 16 MiB of small ones
// decoded. Thread-safe once built.
class LuminanceSampler {
 public:
  LuminanceSampler(const Scene& scene, Quantity quantity);
  ~LuminanceSampler();
  LuminanceSampler(LuminanceSampler&&) noexcept;
  LuminanceSampler& operator=(LuminanceSampler&&) noexcept;

  // A triangle prepared for many samples: corner illumination (1 where the scene has none) and, if
  // textured, corner texture coordinates in units of texture texels.
  struct Triangle {
    float illumination[3][4];  // corner, RGB (already times Kd), 4th lane 0
    float texcoord[3][2];      // in texels of the mip level `level`
    const TextureLevels* texture = nullptr;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    int level = 0;          // mip level to read
    bool constant = false;  // one colour over the whole triangle, illumination[0]
  };

  // Prepares triangle t. `sample_spacing` is the distance of the samples to be taken, in the same
  // length unit as positions: the texture is read from the finest mip level whose texels are not
  // smaller than about that; 0 reads level 0.
  Triangle prepare(std::uint32_t t, double sample_spacing) const;

  // RGB at barycentric coordinates (b0, b1, b2), which may lie a little outside: linear
  // illumination times bilinear texture.
  static Vec3f sample(const Triangle& triangle, float b0, float b1, float b2);

  // The first of triangle t's corners, 0..2, whose illumination times reflectance is no number
  // or beyond kMostLight, as no reader leaves illumination; 3 if there is none.
  int bad_corner(std::uint32_t t) const;

  // texture_density() of the scene; 0 where it holds luminance, which textures take no part in.
  double texture_density(std::uint32_t t) const;

  const Scene& scene() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

// Texture texels per length unit of the surface of triangle t (geometric mean over directions);
// 0 if it has no texture, no coordinates or no area.
double texture_density(const Scene& scene, std::uint32_t t);

}  // namespace atlas
