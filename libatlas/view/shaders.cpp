#include "libatlas/view/shaders.h"

#include <fmt/format.h>

#include "libatlas/view/shadow_text.h"

namespace atlas {
namespace {

// Must agree with struct FrameBlock in lit_pass.cpp (std140).
constexpr const char* kFrameBlock = R"(
layout(std140, binding = 0) uniform Frame {
  mat4 view_projection;
  mat4 to_map0, to_map1;
  vec4 eye;         // least bias (depth)
  vec4 light;       // direction towards it, intensity
  vec4 ambient;     // rgb, exposure
  vec4 weights;     // of the two keys, normal offset (world), texel (uv)
  vec4 ray0, ray1;  // march, in each map: uv for each unit of depth gained towards the light, depth
                    // gained in a world unit, the map's layer
  vec4 behind;      // march: uv of a step back along the ray's trace, in each map
  vec4 march;       // texels for each unit of depth gained in each map; least height of a blocker
                    // (depth); number of different maps
  vec4 corner;      // of the scene's box where rays to the light leave it; slope bias (depth)
  vec4 inverse;     // 1 / the light's direction; factor on baked light
  vec4 specular;    // strength, Blinn-Phong exponent, Ward alpha, 1 / texel
  vec4 first_ray, ray_x, ray_y;  // from the eye, one unit of view depth long: through the image's
                                 // corner, and its change for each pixel; w: view depth is 1 / (w + w
                                 // * depth) with the first two, 1 / march's samples the third
  vec4 map_x0, map_x1, map_y0, map_y1;  // axes of each map; x0: how far a point may be off for each
                                        // unit of view depth (world), y0: factor on the lightmap
  vec4 background;  // rgb, encoded as the image is
} frame;
)";

// The first pass of a lit scene stores in each pixel, 16 bits per value: the reflectance (negative
// where the moving light is not added), the light
// that shadows do not affect (exposed; from 2 on, the pixel is white whatever is added), and the
// normal in octahedral encoding (Meyer et al. 2010).
constexpr const char* kWriteSurface = R"(
vec2 fold(vec3 n) {
  n /= max(abs(n.x) + abs(n.y) + abs(n.z), 1e-30);
  vec2 turned = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return n.z < 0.0 ? turned : n.xy;
}
uvec4 surface_of(vec3 n, vec3 reflectance, vec3 own) {
  own = min(own, 2.0);
  return uvec4(packHalf2x16(reflectance.rg), packHalf2x16(vec2(reflectance.b, own.r)),
               packHalf2x16(own.gb), packSnorm2x16(fold(n)));
}
)";
constexpr const char* kReadSurface = R"(
layout(binding = 0) uniform usampler2D surfaces;
layout(binding = 3) uniform sampler2D surface_depths;
vec3 unfold(vec2 f) {
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  float below = max(-n.z, 0.0);
  n.xy -= vec2(n.x < 0.0 ? -below : below, n.y < 0.0 ? -below : below);
  return normalize(n);
}
)";

// Draws one triangle over the whole image, at the depth of the background.
constexpr const char* kWholeImage = R"(#version 450 core
void main() {
  gl_Position = vec4(4.0 * (gl_VertexID & 1) - 1.0, 4.0 * (gl_VertexID >> 1) - 1.0, 0.0, 1.0);
}
)";

constexpr const char* kBlinnPhong = R"(
float specular(vec3 n, vec3 l, vec3 v, float nl) {
  return frame.specular.x * pow(max(dot(n, normalize(l + v)), 0.0), frame.specular.y);
}
)";

// exp(-tan^2(delta) / a^2) / (4 pi a^2 sqrt(cos_i cos_o)), times cos_i.
constexpr const char* kWard = R"(
float specular(vec3 n, vec3 l, vec3 v, float nl) {
  float nv = max(dot(n, v), 1e-3);
  float nh = max(dot(n, normalize(l + v)), 1e-3);
  float a2 = max(frame.specular.z * frame.specular.z, 1e-30);  // 0 would make the quotients NaN
  float tangent2 = max(1.0 / (nh * nh) - 1.0, 0.0);
  return frame.specular.x * nl * exp(-tangent2 / a2) /
         (12.5663706 * a2 * sqrt(max(nl, 1e-3) * nv));
}
)";

bool lit(const ShaderFeatures& f) {
  return f.shading != Shading::unlit;
}
bool shiny(const ShaderFeatures& f) {
  return f.shading == Shading::blinn_phong || f.shading == Shading::ward;
}
bool coloured(const ShaderFeatures& f) {
  return !f.visibility;
}

bool samples_texture(const ShaderFeatures& f) {
  return (coloured(f) && f.textured) || f.holes;
}

std::string vertex_text(const ShaderFeatures& f) {
  std::string s = "#version 450 core\n";
  s += kFrameBlock;
  std::string body = "  gl_Position = frame.view_projection * vec4(position, 1.0);\n";
  s += "layout(location = 0) in vec3 position;\n";
  const auto pass = [&](int location, const char* type, const char* name) {
    s += fmt::format("layout(location = {0}) in {1} {2};\nlayout(location = {0}) out {1} v_{2};\n",
                     location, type, name);
    body += fmt::format("  v_{0} = {0};\n", name);
  };
  if (lit(f)) pass(1, "vec3", "normal");
  if (coloured(f)) pass(2, f.some_unlit ? "vec4" : "vec3", "colour");
  if (samples_texture(f)) pass(3, "vec2", "texcoord");
  if (coloured(f) && f.baked_vertices) pass(4, "vec3", "illumination");
  if (coloured(f) && f.emission) pass(5, "vec3", "emission");
  if (coloured(f) && f.lightmap) pass(6, "vec2", "lightcoord");
  return s + "void main() {\n" + body + "}\n";
}

// Computes `reflectance`, and `own`, the exposed light that the surface shows without the moving
// light.
std::string colours_text(const ShaderFeatures& f) {
  const char* shown = f.all_unlit ? "colour" : "reflectance";
  std::string s =
      fmt::format("  vec3 reflectance = {};\n", f.some_unlit ? "v_colour.rgb" : "v_colour");
  if (f.all_unlit) s += "  vec3 colour = reflectance;\n";
  if (f.some_unlit) s += "  bool unlit = v_colour.a < 0.5;\n";
  if (f.textured) s += fmt::format("  {} *= texture(diffuse, v_texcoord).rgb;\n", shown);
  if (f.baked_vertices)
    s += "  vec3 light = v_illumination * frame.inverse.w;\n";
  else if (f.all_unlit)
    s += "  vec3 light = vec3(frame.inverse.w);\n";
  else
    s += lit(f) || f.lightmap ? "  vec3 light = vec3(0.0);\n" : "  vec3 light = vec3(1.0);\n";
  if (f.some_unlit && !f.baked_vertices) s += "  if (unlit) light = vec3(frame.inverse.w);\n";
  if (f.lightmap) s += "  light += texture(lightmap, v_lightcoord).rgb * frame.map_y0.w;\n";
  if (lit(f)) s += f.some_unlit ? "  if (!unlit)" : "";
  if (lit(f)) s += "  light += frame.ambient.rgb;\n";
  s += fmt::format("  vec3 own = {} * light;\n", shown);
  if (f.emission) s += "  own += v_emission;\n";
  if (lit(f) && f.some_unlit) s += "  if (unlit) reflectance = vec3(-1.0);\n";
  return s + "  own *= frame.ambient.w;\n";
}

// sRGB's own curve: textures are decoded with it, so pages of baked light show what they hold.
constexpr const char* kEncode = R"(
vec4 encoded(vec3 colour) {
  colour = clamp(colour, 0.0, 1.0);
  vec3 curve = 1.055 * pow(colour, vec3(1.0 / 2.4)) - 0.055;
  return vec4(mix(curve, 12.92 * colour, lessThanEqual(colour, vec3(0.0031308))), 1.0);
}
)";

std::string fragment_text(const ShaderFeatures& f) {
  std::string s = "#version 450 core\n";
  s += kFrameBlock;
  if (lit(f)) s += "layout(location = 1) in vec3 v_normal;\n";
  if (coloured(f))
    s += fmt::format("layout(location = 2) in {} v_colour;\n", f.some_unlit ? "vec4" : "vec3");
  if (samples_texture(f))
    s += "layout(location = 3) in vec2 v_texcoord;\nlayout(binding = 0) uniform sampler2D "
         "diffuse;\n";
  if (coloured(f) && f.baked_vertices) s += "layout(location = 4) in vec3 v_illumination;\n";
  if (coloured(f) && f.emission) s += "layout(location = 5) in vec3 v_emission;\n";
  if (coloured(f) && f.lightmap)
    s += "layout(location = 6) in vec2 v_lightcoord;\nlayout(binding = 4) uniform sampler2D "
         "lightmap;\n";
  s += lit(f) ? "layout(location = 0) out uvec4 result;\n"
              : "layout(location = 0) out vec4 result;\n";
  if (lit(f)) s += kWriteSurface;
  if (!lit(f) && coloured(f)) s += kEncode;
  if (f.holes) s += "layout(location = 0) uniform float cutoff;\n";
  s += "void main() {\n";
  if (f.holes) s += "  if (textureLod(diffuse, v_texcoord, 0.0).a < cutoff) discard;\n";
  if (coloured(f)) s += colours_text(f);
  if (lit(f)) {
    s += coloured(f) ? "  result = surface_of(v_normal, reflectance, own);\n"
                     : "  result = uvec4(0, 0, 0, packSnorm2x16(fold(v_normal)));\n";
  } else if (coloured(f))
    s += "  result = encoded(own);\n";
  else
    s += "  result = vec4(1.0);\n";
  return s + "}\n";
}

// Returns the second pass of a lit scene. It lights each pixel's surface once, however many
// triangles were drawn there.
std::string lighting_text(const ShaderFeatures& f) {
  const bool shadows = f.shadow != ShadowSampling::none;
  std::string s = "#version 450 core\n";
  s += kFrameBlock;
  s += kReadSurface;
  s += "layout(location = 0) out vec4 result;\n";
  if (shadows) s += shadow_text(f);
  if (coloured(f)) s += kEncode;
  if (coloured(f) && shiny(f)) s += f.shading == Shading::ward ? kWard : kBlinnPhong;
  s += R"(void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(surface_depths, pixel, 0).x;
  if (depth == 0.0) {
    result = frame.background;
    return;
  }
  uvec4 surface = texelFetch(surfaces, pixel, 0);
)";
  if (coloured(f) && f.some_unlit)
    s += R"(  if (unpackHalf2x16(surface.x).x < 0.0) {
    result = encoded(vec3(unpackHalf2x16(surface.y).y, unpackHalf2x16(surface.z)));
    return;
  }
)";
  s +=
      R"(  vec3 ray = frame.first_ray.xyz + gl_FragCoord.x * frame.ray_x.xyz + gl_FragCoord.y * frame.ray_y.xyz;
  float far = 1.0 / (frame.first_ray.w + frame.ray_x.w * depth);
  vec3 away = ray * far;
  vec3 n = unfold(unpackSnorm2x16(surface.w));
  if (dot(n, away) > 0.0) n = -n;
  vec3 l = frame.light.xyz;
  float nl = dot(n, l);
)";
  if (!shadows)
    s += "  float seen = nl > 0.0 ? 1.0 : 0.0;\n";
  else
    // Graphics hardware snaps corners to fractions of a pixel before it interpolates depths, so the
    // point may be off by what lies between two such fractions.
    s += R"(  vec3 p = frame.eye.xyz + away;
  float seen = nl > 0.0 ? visibility(p, n, far * frame.map_x0.w) : 0.0;
)";
  if (!coloured(f)) return s + "  result = vec4(seen);\n}\n";
  s += R"(  vec2 blue_red = unpackHalf2x16(surface.y);
  vec3 reflectance = vec3(unpackHalf2x16(surface.x), blue_red.x);
  vec3 own = vec3(blue_red.y, unpackHalf2x16(surface.z));
  float reach = seen * max(nl, 0.0) * frame.light.w;
  vec3 added = reflectance * reach;
)";
  if (shiny(f))
    s += "  if (reach > 0.0) added += vec3(seen * frame.light.w * specular(n, l, -normalize(away), "
         "nl));\n";
  return s + "  result = encoded(own + added * frame.ambient.w);\n}\n";
}

}  // namespace

const char* name_of(Shading shading) {
  switch (shading) {
    case Shading::unlit:
      return "unlit";
    case Shading::lambert:
      return "lambert";
    case Shading::blinn_phong:
      return "blinn-phong";
    case Shading::ward:
      return "ward";
  }
  return "";
}

ShaderText shader_text(const ShaderFeatures& features) {
  ShaderText text{vertex_text(features), fragment_text(features), "", ""};
  if (!lit(features)) return text;
  text.lighting_vertex = kWholeImage;
  text.lighting_fragment = lighting_text(features);
  return text;
}

std::vector<std::string> feature_names(const ShaderFeatures& f) {
  std::vector<std::string> names{name_of(f.shading)};
  if (lit(f) && f.shadow != ShadowSampling::none) {
    constexpr const char* kSampling[] = {"", "one map", "two keys", "march"};
    names.push_back(kSampling[int(f.shadow)]);
    names.push_back(fmt::format("pcf {}", f.pcf));
  }
  if (f.textured) names.push_back(f.all_unlit ? "baked textures" : "diffuse textures");
  if (f.some_unlit || (f.all_unlit && !f.textured)) names.push_back("unlit materials");
  if (f.baked_vertices) names.push_back("baked vertex light");
  if (f.lightmap) names.push_back("lightmap");
  if (f.emission) names.push_back("emission");
  if (f.visibility) names.push_back("visibility output");
  return names;
}

}  // namespace atlas
