// The cabin's materials, with generated textures: wood grain, fabric weave, carpet, terrazzo.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <numbers>

#include "examples/cabin/layout.h"

namespace cabin {
namespace {

std::uint32_t mix_bits(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

double lattice(int x, int y, glm::ivec2 cells, std::uint32_t seed) {
  x = ((x % cells.x) + cells.x) % cells.x;
  y = ((y % cells.y) + cells.y) % cells.y;
  return mix_bits(seed * 0x9E3779B9u + std::uint32_t(y) * 7919u + std::uint32_t(x)) / 4294967296.0;
}

// Returns value noise in [0, 1] with so many cells in the unit square, beyond which it repeats.
double noise(double u, double v, glm::ivec2 cells, std::uint32_t seed) {
  const double x = cells.x * u, y = cells.y * v;
  const int ix = int(std::floor(x)), iy = int(std::floor(y));
  const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
  const double fx = smooth(x - ix), fy = smooth(y - iy);
  const auto at = [&](int i, int j) { return lattice(ix + i, iy + j, cells, seed); };
  return (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) +
         (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
}

// Returns the sRGB-encoded colour, 0 to 1. It must repeat in u and v, which run over [0, 1).
using Shader = std::function<glm::dvec3(double u, double v, int x, int y)>;

atlas::Image8 paint(int size, const Shader& shader) {
  atlas::Image8 image(size, size, 3);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const glm::dvec3 c = shader((x + 0.5) / size, (y + 0.5) / size, x, y);
      for (int k = 0; k < 3; ++k)
        image.at(x, y)[k] = std::uint8_t(std::lround(255 * std::clamp(c[k], 0.0, 1.0)));
    }
  return image;
}

// Draws grain along v: bands whose position wanders, with fine fibres over them.
atlas::Image8 wood_texture() {
  return paint(256, [](double u, double v, int, int) {
    const double wander = 0.7 * noise(u, v, {4, 2}, 11) + 0.3 * noise(u, v, {8, 4}, 12);
    const double ring = 0.5 + 0.5 * std::sin(2 * std::numbers::pi * (6 * u + 2.2 * wander));
    const double fibre = noise(u, v, {96, 6}, 13), pore = noise(u, v, {128, 16}, 14);
    const double tone = 0.55 * std::pow(ring, 1.6) + 0.3 * fibre + 0.15 * noise(u, v, {3, 3}, 15);
    glm::dvec3 c = glm::mix(glm::dvec3(0.46, 0.29, 0.17), glm::dvec3(0.74, 0.54, 0.35), tone);
    return pore > 0.88 ? c * 0.92 : c;
  });
}

// Draws a twill: threads that pass over and under on a grid, with their tone from noise.
atlas::Image8 weave_texture(glm::dvec3 warp_colour, glm::dvec3 weft_colour, std::uint32_t seed) {
  return paint(128, [=](double u, double v, int x, int y) {
    const int tx = x / 4, ty = y / 4;
    const bool over = ((tx + ty) & 3) < 2;
    const double across = over ? (x % 4 + 0.5) / 4 : (y % 4 + 0.5) / 4;
    const double round = 0.72 + 0.28 * std::sin(std::numbers::pi * across);
    const double slub =
        0.86 + 0.28 * (over ? noise(u, v, {32, 6}, seed) : noise(u, v, {6, 32}, seed + 1));
    return (over ? warp_colour : weft_colour) * (round * slub);
  });
}

atlas::Image8 carpet_texture(glm::dvec3 dark, glm::dvec3 light, bool pattern) {
  return paint(128, [=](double u, double v, int, int) {
    const double tuft = noise(u, v, {64, 64}, 31), patch = noise(u, v, {10, 10}, 32);
    double tone = 0.55 * tuft + 0.35 * patch;
    if (pattern) {
      const double du = std::abs(2 * u - 1), dv = std::abs(2 * v - 1);
      if (std::abs(du + dv - 0.75) < 0.07) tone += 0.45;
    }
    return glm::mix(dark, light, std::min(1.0, tone));
  });
}

atlas::Image8 terrazzo_texture() {
  return paint(128, [](double u, double v, int, int) {
    const double chip = noise(u, v, {20, 20}, 41), grit = noise(u, v, {64, 64}, 42);
    glm::dvec3 c(0.52, 0.50, 0.48);
    if (chip > 0.74) c = glm::dvec3(0.72, 0.69, 0.64);
    if (chip < 0.24) c = glm::dvec3(0.36, 0.34, 0.33);
    return c * (0.92 + 0.16 * grit);
  });
}

double decode(double c) {
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

void finish_material(SurfaceMaterial& m) {
  glm::dvec3 mean(1);
  if (!m.texture_file.empty()) {
    mean = glm::dvec3(0);
    for (std::size_t i = 0; i < m.texture.texels.size(); ++i)
      mean[int(i % 3)] += decode(m.texture.texels[i] / 255.0);
    mean /= double(m.texture.width) * m.texture.height;
  }
  m.reflectance = m.diffuse * glm::vec3(mean);
}

SurfaceMaterial plain(const char* name, glm::vec3 diffuse) {
  SurfaceMaterial m;
  m.name = name;
  m.diffuse = diffuse;
  return m;
}

SurfaceMaterial textured(const char* name, const char* file, atlas::Image8 texture) {
  SurfaceMaterial m = plain(name, glm::vec3(1));
  m.texture_file = file;
  m.texture = std::move(texture);
  return m;
}

SurfaceMaterial emitter(const char* name, glm::vec3 exitance) {
  SurfaceMaterial m = plain(name, glm::vec3(1));
  m.emission = exitance;
  return m;
}

}  // namespace

std::vector<SurfaceMaterial> cabin_materials() {
  std::vector<SurfaceMaterial> list;
  list.push_back(plain("lining", {0.72f, 0.70f, 0.66f}));
  list.push_back(plain("dado", {0.40f, 0.37f, 0.33f}));
  list.push_back(plain("trim", {0.80f, 0.79f, 0.77f}));
  list.push_back(plain("blind", {0.66f, 0.64f, 0.60f}));
  list.push_back(plain("ceiling", {0.84f, 0.83f, 0.81f}));
  list.push_back(plain("bin", {0.70f, 0.69f, 0.66f}));
  list.push_back(plain("armrest", {0.10f, 0.10f, 0.11f}));
  list.push_back(plain("metal", {0.46f, 0.46f, 0.48f}));
  list.push_back(plain("glass", {0.10f, 0.13f, 0.16f}));
  list.push_back(plain("door_panel", {0.70f, 0.69f, 0.66f}));
  list.push_back(plain("head_fabric", {0.62f, 0.58f, 0.50f}));
  list.push_back(textured("wood", "wood.png", wood_texture()));
  list.push_back(textured("wood_panel", "wood.png", wood_texture()));
  list.back().diffuse = {0.85f, 0.8f, 0.78f};
  list.push_back(textured("seat_fabric", "fabric.png",
                          weave_texture({0.17, 0.25, 0.36}, {0.30, 0.40, 0.50}, 21)));
  list.push_back(textured("carpet", "carpet.png",
                          carpet_texture({0.20, 0.22, 0.27}, {0.42, 0.43, 0.47}, false)));
  list.push_back(textured("aisle_carpet", "aisle_carpet.png",
                          carpet_texture({0.26, 0.16, 0.14}, {0.62, 0.46, 0.34}, true)));
  list.push_back(textured("entry_floor", "terrazzo.png", terrazzo_texture()));
  list.push_back(textured("counter", "terrazzo.png", terrazzo_texture()));
  list.back().diffuse = {0.6f, 0.6f, 0.62f};
  list.push_back(emitter("strip", {1900, 1840, 1700}));
  list.push_back(emitter("cove", {1900, 1850, 1760}));
  list.push_back(emitter("wash", {1700, 1500, 1160}));
  list.push_back(emitter("entry_light", {1900, 1820, 1640}));
  list.push_back(emitter("sign", {25, 330, 90}));
  for (SurfaceMaterial& m : list) finish_material(m);
  return list;
}

}  // namespace cabin
