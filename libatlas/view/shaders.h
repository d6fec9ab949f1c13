// The player's shaders, assembled from the pieces that a scene and its settings need: what the
// features do not list is not in the text that the driver compiles.
#pragma once

#include <string>
#include <vector>

namespace atlas {

// How the moving light is reflected. Shadows never darken the ambient term.
enum class Shading {
  unlit,        // no moving light: baked light or plain colours
  lambert,      // ambient + diffuse
  blinn_phong,  // + specular (N.H)^n (Blinn 1977)
  ward,         // + isotropic Ward 1992, normalised by 1/(4 pi a^2 sqrt(cos_i cos_o))
};

// What the fragment shader does with the shadow maps.
enum class ShadowSampling {
  none,
  one,    // one map, in its own matrix: classic and hold
  two,    // two keys, each in its own matrix, blended: linear and SLERP
  march,  // the depths of two keys, searched along the ray to the current light
};

struct ShaderFeatures {
  Shading shading = Shading::lambert;
  ShadowSampling shadow = ShadowSampling::none;
  bool textured = false;        // diffuse textures
  bool baked_vertices = false;  // illumination at the vertices
  bool lightmap = false;        // illumination in a texture, which is added to that
  // Unlit materials show their colours and textures as light (those of an exported atlas). If only
  // some are unlit, the moving light leaves them alone; if all are, it is added to them as to
  // surfaces that reflect what their colours do without the textures.
  bool some_unlit = false, all_unlit = false;
  bool emission = false;    // materials that emit light
  bool holes = false;       // where a texture's alpha is below the uniform at location 0
  int pcf = 3;              // 0: nearest texel; 1: bilinear; 3, 5: that many bilinear taps per side
  bool visibility = false;  // write the light's visibility instead of a colour
  bool operator==(const ShaderFeatures&) const = default;
};

// Unlit scenes are drawn in one pass. Lit scenes are drawn as surfaces (reflectance, own light and
// normal in four 32-bit integers, and a depth), which a second pass over the image lights: shadows
// are then never computed for fragments that are hidden later, or that cover only part of a pixel's
// neighbourhood.
struct ShaderText {
  std::string vertex, fragment;
  std::string lighting_vertex, lighting_fragment;  // of the second pass; empty if there is none
};

ShaderText shader_text(const ShaderFeatures& features);

// Returns one word for each thing that is compiled in, for the plan: "lambert", "march", "pcf 3",
// ...
std::vector<std::string> feature_names(const ShaderFeatures& features);

const char* name_of(Shading shading);

}  // namespace atlas
