#include "tests/support/fidelity.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "examples/cabin/tracer.h"
#include "libatlas/core/parallel.h"

namespace atlas::test {
namespace {

using cabin::Hit;
using cabin::Tracer;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kImagePlane = 1.6f;  // width of the image at distance 1

float decode(float c) {
  return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}
float encode(float c) {
  c = std::clamp(c, 0.0f, 1.0f);
  return c <= 0.0031308f ? c * 12.92f : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
}

// A bilinear lookup. For a scene, the texture repeats and is decoded to linear values first; a page
// clamps and is shown as it is.
glm::vec3 look_up(const Image8& image, glm::vec2 uv, bool scene) {
  const float x = uv.x * float(image.width) - 0.5f, y = uv.y * float(image.height) - 0.5f;
  const int ix = int(std::floor(x)), iy = int(std::floor(y));
  glm::vec3 sum(0);
  for (int k = 0; k < 4; ++k) {
    const int dx = k & 1, dy = k >> 1;
    const auto index = [&](int i, int n) {
      return scene ? ((i % n) + n) % n : std::clamp(i, 0, n - 1);
    };
    const std::uint8_t* p = image.at(index(ix + dx, image.width), index(iy + dy, image.height));
    const float w = (dx ? x - ix : 1 - x + ix) * (dy ? y - iy : 1 - y + iy);
    for (int c = 0; c < 3; ++c) {
      const float v = p[std::min(c, image.channels - 1)] / 255.0f;
      sum[c] += w * (scene ? decode(v) : v);
    }
  }
  return sum;
}

glm::vec3 shade(const WorldMesh& mesh, const Hit& hit, bool scene) {
  const float w[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  const auto& triangle = mesh.triangles[hit.triangle];
  const auto& uvs = mesh.triangle_texcoords[hit.triangle];
  const WorldMesh::Surface& surface = mesh.surfaces[mesh.triangle_surface[hit.triangle]];
  glm::vec3 colour(1), light(0);
  if (surface.image >= 0 && uvs[0] != WorldMesh::kNoTexcoord) {
    glm::vec2 uv(0);
    for (int k = 0; k < 3; ++k) uv += w[k] * mesh.texcoords[uvs[k]];
    colour = look_up(mesh.images[surface.image], uv, scene);
  }
  if (!scene) return colour;
  for (int k = 0; k < 3; ++k) light += w[k] * mesh.light[triangle[k]];
  return colour * surface.diffuse * light;
}

float radical_inverse(unsigned i, unsigned base) {
  double result = 0, digit = 1.0 / base;
  for (; i > 0; i /= base, digit /= base) result += (i % base) * digit;
  return float(result);
}

struct Camera {
  glm::vec3 eye, forward, right, up;
};

glm::vec3 sphere_point(unsigned i) {
  const float z = 2 * radical_inverse(i, 2) - 1, angle = 2 * kPi * radical_inverse(i, 3);
  const float r = std::sqrt(std::max(0.0f, 1 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

std::vector<Camera> find_cameras(const WorldMesh& scene, const Tracer& tracer, int wanted) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
  for (const glm::vec3& p : scene.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const float diagonal = glm::distance(low, high);
  std::vector<Camera> cameras;
  for (unsigned i = 1; i < 20000 && int(cameras.size()) < wanted; ++i) {
    const glm::vec3 place(radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5));
    const glm::vec3 eye = low + (high - low) * (0.08f + 0.84f * place);
    int hits = 0;
    float nearest = diagonal;
    for (unsigned k = 0; k < 64; ++k) {
      const Hit hit = tracer.nearest(eye, sphere_point(k));
      if (hit.triangle == ~0u) continue;
      ++hits;
      nearest = std::min(nearest, hit.distance);
    }
    if (hits < 40 || nearest < 0.03f * diagonal) continue;
    Camera best;
    float far = -1;
    for (unsigned k = 0; k < 16; ++k) {
      const float yaw = 2 * kPi * radical_inverse(16 * i + k, 2);
      const float pitch = 0.6f * (radical_inverse(16 * i + k, 3) - 0.5f);
      const glm::vec3 d(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw),
                        std::sin(pitch));
      const Hit hit = tracer.nearest(eye, d);
      const float distance = hit.triangle == ~0u ? 0 : hit.distance;
      if (distance <= far) continue;
      far = distance;
      const glm::vec3 right(std::sin(yaw), -std::cos(yaw), 0);
      best = {eye, d, right, glm::cross(right, d)};
    }
    cameras.push_back(best);
  }
  return cameras;
}

struct Pixel {
  glm::vec3 scene{0}, world{0};
  bool in_scene = false, in_world = false;
};

std::vector<Pixel> render(const WorldMesh& scene, const WorldMesh& world,
                          const ViewOptions& options, Fidelity& out) {
  const Tracer scene_tracer(scene.positions, scene.triangles);
  const Tracer world_tracer(world.positions, world.triangles);
  const auto cameras = find_cameras(scene, scene_tracer, options.cameras);
  out.cameras = cameras.size();
  const std::size_t rows = cameras.size() * std::size_t(options.height);
  std::vector<Pixel> pixels(rows * std::size_t(options.width));
  parallel_for({}, rows, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (int x = 0; x < options.width; ++x) {
        const Camera& camera = cameras[row / options.height];
        const int y = int(row % options.height);
        const float px = ((x + 0.5f) / options.width - 0.5f) * kImagePlane;
        const float py = (0.5f * options.height - y - 0.5f) / options.width * kImagePlane;
        const glm::vec3 d = camera.forward + px * camera.right + py * camera.up;
        Pixel& pixel = pixels[row * options.width + x];
        const Hit a = scene_tracer.nearest(camera.eye, d), b = world_tracer.nearest(camera.eye, d);
        if ((pixel.in_scene = a.triangle != ~0u)) pixel.scene = shade(scene, a, true);
        if ((pixel.in_world = b.triangle != ~0u)) pixel.world = shade(world, b, false);
      }
  });
  return pixels;
}

// Returns the mean squared difference over every third pixel. Differences beyond 0.1 count as 0.1,
// so that moved or missing parts do not affect the exposure.
double exposure_error(const std::vector<Pixel>& pixels, double scale) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t i = 0; i < pixels.size(); i += 3) {
    if (!pixels[i].in_scene || !pixels[i].in_world) continue;
    for (int c = 0; c < 3; ++c) {
      const double d = encode(float(scale * pixels[i].scene[c])) - pixels[i].world[c];
      sum += std::min(d * d, 0.01);
    }
    ++n;
  }
  return n > 0 ? sum / double(n) : 0;
}

// Returns the exposure of least error, found by a coarse scan over powers of two and a
// golden-section search.
double fit_scale(const std::vector<Pixel>& pixels, double start) {
  double best = std::log2(start), least = std::numeric_limits<double>::max();
  for (double e = best - 6; e <= std::log2(start) + 6; e += 0.125) {
    const double error = exposure_error(pixels, std::exp2(e));
    if (error < least) {
      least = error;
      best = e;
    }
  }
  double low = best - 0.125, high = best + 0.125;
  for (int i = 0; i < 24; ++i) {
    const double a = low + 0.381966 * (high - low), b = low + 0.618034 * (high - low);
    if (exposure_error(pixels, std::exp2(a)) < exposure_error(pixels, std::exp2(b)))
      high = b;
    else
      low = a;
  }
  return std::exp2((low + high) / 2);
}

double percentile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const std::size_t i = std::min(values.size() - 1, std::size_t(share * double(values.size())));
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(i), values.end());
  return values[i];
}

}  // namespace

Fidelity compare_views(const WorldMesh& scene, const WorldMesh& world, const ViewOptions& options) {
  Fidelity out;
  out.triangles_in = scene.triangles.size();
  out.triangles_out = world.triangles.size();
  out.pages = world.images.size();
  const auto pixels = render(scene, world, options, out);
  std::vector<double> brightness, error;
  for (const Pixel& p : pixels)
    if (p.in_scene) brightness.push_back(std::max({p.scene.x, p.scene.y, p.scene.z}));
  const double bright = std::max(1e-30, percentile(brightness, 0.99));
  out.scale = fit_scale(pixels, 1 / bright);
  out.white = out.scale * bright;
  double squares = 0;
  std::size_t bad = 0, missed = 0;
  for (const Pixel& p : pixels) {
    if (!p.in_scene && !p.in_world) continue;
    missed += p.in_scene != p.in_world;
    double largest = 0;
    for (int c = 0; c < 3; ++c) {
      const double shown = p.in_scene ? encode(float(out.scale * p.scene[c])) : 0;
      const double d = std::min(1.0, std::abs(shown - p.world[c]));
      squares += d * d;
      largest = std::max(largest, d);
    }
    bad += largest > 8 / 255.0;
    error.push_back(largest);
  }
  const double n = std::max(1.0, double(error.size()));
  out.psnr = -10 * std::log10(std::max(squares / (3 * n), 1e-12));
  out.bad8 = double(bad) / n;
  out.miss = double(missed) / n;
  out.p50 = percentile(error, 0.5);
  out.p99 = percentile(error, 0.99);
  out.p999 = percentile(error, 0.999);
  return out;
}

}  // namespace atlas::test
