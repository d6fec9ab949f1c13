// The light that leaves the surface, sampled at any point of a triangle. Atlases store this light.
#pragma once

#include <cstdint>
#include <memory>

#include "libatlas/core/vec.h"
#include "libatlas/scene/scene.h"

namespace atlas {

struct TextureLevels;

// The quantity that Scene::illumination holds.
enum class Quantity {
  illuminance,  // E; the diffuse reflectance still has to be applied
  luminance,    // the light that leaves the surface; it is taken as it is
  // The linear colour that the surface is to show, within 0..1 (ReadOptions::srgb_colours decodes
  // it). It is taken as it is, and an export shows 1 white unless ToneOptions::white is given.
  colour,
};

// "Luminance" here is, as in Barladian et al. (section 2), illuminance times diffuse reflectance,
// linear RGB in the unit of the input. For a Lambertian surface lit with E lux that is the luminous
// exitance M = rho E in lm/m²; its photometric luminance is L = M / pi in cd/m². The factor pi is a
// constant that exposure absorbs, so it is left out: values stay comparable with the input's.
// With Quantity::luminance (cd/m²) and Quantity::colour the values are the input's own.
//
// The sampler refers to the scene, which must outlive it and pass check_scene(). It builds mip
// chains of the textures (8-bit, a third of the textures' size), and keeps up to 16 MiB of small
// textures decoded. It is thread-safe once built.
class LuminanceSampler {
 public:
  LuminanceSampler(const Scene& scene, Quantity quantity);
  ~LuminanceSampler();
  LuminanceSampler(LuminanceSampler&&) noexcept;
  LuminanceSampler& operator=(LuminanceSampler&&) noexcept;

  // A triangle prepared for many samples. It holds the illumination at the corners (1 if the scene
  // has none) and, if the triangle is textured, the texture coordinates at the corners in texels.
  struct Triangle {
    float illumination[3][4];  // of each corner: RGB (already times Kd), and 0 in the 4th lane
    float texcoord[3][2];      // in texels of the mip level `level`
    const TextureLevels* texture = nullptr;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    int level = 0;          // mip level to read
    bool constant = false;  // one colour over the whole triangle, illumination[0]
  };

  // Prepares triangle t. `sample_spacing` is the distance of the samples to be taken, in the length
  // unit of positions. The texture is read from the finest mip level whose texels are not smaller
  // than about this distance. With 0, level 0 is read.
  Triangle prepare(std::uint32_t t, double sample_spacing) const;

  // Returns the RGB value at the barycentric coordinates (b0, b1, b2), which may lie a little
  // outside the triangle. It is the linearly interpolated illumination times the bilinearly
  // interpolated texture.
  static Vec3f sample(const Triangle& triangle, float b0, float b1, float b2);

  // Returns the first of triangle t's corners, 0..2, whose illumination times reflectance is not a
  // number or is beyond kMostLight, and 3 if there is none. Readers leave no such illumination.
  int bad_corner(std::uint32_t t) const;

  // Returns texture_density() of the scene, or 0 unless the scene holds illuminance, because
  // textures are applied to that only.
  double texture_density(std::uint32_t t) const;

  const Scene& scene() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

// Returns the texture's texels per length unit of the surface of triangle t (geometric mean over
// directions). It is 0 if the triangle has no texture, no texture coordinates or no area.
double texture_density(const Scene& scene, std::uint32_t t);

}  // namespace atlas
