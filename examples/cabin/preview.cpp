#include "examples/cabin/preview.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "examples/cabin/tracer.h"
#include "libatlas/core/parallel.h"
#include "libatlas/image/image_io.h"

namespace cabin {
namespace {

// The view of somebody who has just come in: the door to the left, the galley to the right, the
// rows ahead.
const glm::vec3 kEye(0.08f, -0.46f, 1.50f), kTarget(3.0f, 0.44f, 1.03f);
constexpr float kTanHalfWidth = 0.83f;

std::array<float, 256> decode_table() {
  std::array<float, 256> table;
  for (int i = 0; i < 256; ++i) {
    const double c = i / 255.0;
    table[i] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
  }
  return table;
}

glm::vec3 texel(const atlas::Image8& image, int x, int y) {
  static const std::array<float, 256> table = decode_table();
  const auto wrap = [](int i, int n) { return ((i % n) + n) % n; };
  const std::uint8_t* p = image.at(wrap(x, image.width), wrap(y, image.height));
  return {table[p[0]], table[p[1]], table[p[2]]};
}

glm::vec3 bilinear(const atlas::Image8& image, glm::vec2 uv) {
  const float x = uv.x * image.width - 0.5f, y = uv.y * image.height - 0.5f;
  const int ix = int(std::floor(x)), iy = int(std::floor(y));
  const float fx = x - ix, fy = y - iy;
  return (texel(image, ix, iy) * (1 - fx) + texel(image, ix + 1, iy) * fx) * (1 - fy) +
         (texel(image, ix, iy + 1) * (1 - fx) + texel(image, ix + 1, iy + 1) * fx) * fy;
}

glm::vec3 shade(const Mesh& mesh, const Tracer& tracer, glm::vec3 eye, glm::vec3 d) {
  const Hit hit = tracer.nearest(eye, d);
  if (hit.triangle == ~0u) {
    const float up = std::clamp(d.z * 2.5f + 0.35f, 0.0f, 1.0f);
    return glm::mix(glm::vec3(1900, 1650, 1350), glm::vec3(800, 1150, 1750), up);
  }
  if (!hit.front) return glm::vec3(0);
  const Triangle& t = mesh.triangles[hit.triangle];
  const float w[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  glm::vec3 light(0);
  glm::vec2 uv(0);
  for (int k = 0; k < 3; ++k) {
    light += w[k] * (mesh.direct[t.vertex[k]] + mesh.indirect[t.vertex[k]]);
    uv += w[k] * mesh.texcoords[t.texcoord[k]];
  }
  const SurfaceMaterial& m = mesh.materials[t.material];
  return light * m.diffuse * (m.texture_file.empty() ? glm::vec3(1) : bilinear(m.texture, uv));
}

// Applies Reinhard's global operator (2002) with its white point at 5 times the exposure, and
// encodes as sRGB.
std::uint8_t display(float luminance, float exposure) {
  const float x = luminance * exposure;
  const float c = std::clamp(x * (1 + x / 25) / (1 + x), 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return std::uint8_t(std::lround(255 * s));
}

}  // namespace

atlas::Status write_preview(const std::filesystem::path& path, const Mesh& mesh,
                            const PreviewOptions& options, const atlas::Context& context) {
  const Shell shell = shell_of(mesh);
  const Tracer tracer(shell.positions, shell.triangles);
  const glm::vec3 forward = glm::normalize(kTarget - kEye);
  const glm::vec3 right = glm::normalize(glm::cross(forward, glm::vec3(0, 0, 1)));
  const glm::vec3 up = glm::cross(right, forward);
  atlas::ImageF light(options.width, options.height, 3);
  const int n = options.samples;
  atlas::parallel_for(
      context, std::size_t(options.height), 4, [&](std::size_t begin, std::size_t end) {
        for (int y = int(begin); y < int(end); ++y)
          for (int x = 0; x < options.width; ++x)
            for (int s = 0; s < n * n; ++s) {
              const float px = ((x + (s % n + 0.5f) / n) / options.width * 2 - 1) * kTanHalfWidth;
              const float py =
                  ((y + (s / n + 0.5f) / n) * 2 - options.height) / options.width * kTanHalfWidth;
              const glm::vec3 c =
                  shade(mesh, tracer, kEye, glm::normalize(forward + px * right + py * up));
              for (int k = 0; k < 3; ++k) light.at(x, y)[k] += c[k] / float(n * n);
            }
      });
  if (context.cancelled()) return atlas::Status::cancelled();
  // The picture's mean luminance is mapped slightly below the middle of the curve.
  double mean = 0;
  for (float v : light.texels) mean += std::log(1.0 + v);
  const float exposure = float(0.36 / std::expm1(mean / double(light.texels.size())));
  atlas::Image8 image(options.width, options.height, 3);
  for (std::size_t i = 0; i < light.texels.size(); ++i)
    image.texels[i] = display(light.texels[i], exposure);
  return atlas::write_png(path, image, {});
}

}  // namespace cabin
