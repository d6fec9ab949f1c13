#include "benchmarks/light_leak/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "benchmarks/light_leak/baked_surface.h"

namespace atlas::bench {
namespace {

struct Patch {
  glm::dvec3 centre, across, up, normal;
  double side;
};

glm::dvec3 place(const Vec3f& p) {
  return {p.x, p.y, p.z};
}

// Returns the one of 64 points along the edge that has the most others around it.
glm::dvec3 busiest(const std::vector<Vec3f>& points, double radius) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / 64);
  glm::dvec3 best = place(points.front());
  std::size_t most = 0;
  for (std::size_t i = 0; i < points.size(); i += step) {
    std::size_t near = 0;
    for (const Vec3f& p : points) near += glm::distance(place(p), place(points[i])) < radius;
    if (near <= most) continue;
    most = near;
    best = place(points[i]);
  }
  return best;
}

std::array<glm::dvec3, 3> corners(const Scene& scene, std::uint32_t t) {
  return {place(scene.positions[scene.indices[3 * t]]),
          place(scene.positions[scene.indices[3 * t + 1]]),
          place(scene.positions[scene.indices[3 * t + 2]])};
}

// Returns the light of a triangle's corners, summed over corners and channels.
double light_of(const Scene& scene, std::uint32_t t) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3f& e = scene.illumination[scene.indices[3 * t + k]];
    sum += e.x + e.y + e.z;
  }
  return sum;
}

Patch choose_patch(const Scene& scene, const ShadowEdge& edge, double side) {
  Patch patch{busiest(edge.points, side / 2), {}, {}, glm::dvec3(0), side};
  for (const std::uint32_t t : edge.triangles) {
    const auto p = corners(scene, t);
    // Weighted by its light, the lit side of a thin object outweighs its dark back.
    if (glm::distance(p[0], patch.centre) < side / 4)
      patch.normal += light_of(scene, t) * glm::cross(p[1] - p[0], p[2] - p[0]);
  }
  const double length = glm::length(patch.normal);
  patch.normal = length > 0 ? patch.normal / length : glm::dvec3(0, 0, 1);
  const glm::dvec3 vertical =
      std::abs(patch.normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  patch.across = glm::normalize(glm::cross(vertical, patch.normal));
  patch.up = glm::cross(patch.normal, patch.across);
  return patch;
}

void put(Image8& image, int x, int y, glm::dvec3 colour) {
  for (int c = 0; c < 3; ++c)
    image.at(x, y)[c] = std::uint8_t(std::lround(255 * std::clamp(colour[c], 0.0, 1.0)));
}

class Canvas {
 public:
  Canvas(const Patch& patch, int pixels)
      : patch_(patch),
        pixels_(pixels),
        depth_(std::size_t(pixels) * std::size_t(pixels), -std::numeric_limits<double>::infinity()),
        picture_{Image8(pixels, pixels, 3, 255), Image8(pixels, pixels, 3, 255)} {}

  // Returns pixel coordinates and the height above the plane of the patch.
  glm::dvec3 seen(glm::dvec3 p) const {
    const glm::dvec3 d = p - patch_.centre;
    const double scale = pixels_ / patch_.side;
    return {0.5 * pixels_ + scale * glm::dot(d, patch_.across),
            0.5 * pixels_ + scale * glm::dot(d, patch_.up), glm::dot(d, patch_.normal)};
  }

  template <class Surface>
  void draw(const std::array<glm::dvec3, 3>& p, const Surface& surface) {
    const glm::dvec3 a = seen(p[0]), b = seen(p[1]), c = seen(p[2]);
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (!(area > 0)) return;  // seen from behind
    const auto low = [&](double v) { return std::max(0, int(std::ceil(v - 0.5))); };
    const auto high = [&](double v) { return std::min(pixels_ - 1, int(std::floor(v - 0.5))); };
    for (int y = low(std::min({a.y, b.y, c.y})); y <= high(std::max({a.y, b.y, c.y})); ++y)
      for (int x = low(std::min({a.x, b.x, c.x})); x <= high(std::max({a.x, b.x, c.x})); ++x) {
        const glm::dvec2 q(x + 0.5, y + 0.5);
        const auto part = [&](glm::dvec3 s, glm::dvec3 t) {
          return ((t.x - s.x) * (q.y - s.y) - (t.y - s.y) * (q.x - s.x)) / area;
        };
        const glm::dvec3 bary(part(b, c), part(c, a), part(a, b));
        if (std::min({bary.x, bary.y, bary.z}) < 0) continue;
        const double height = bary.x * a.z + bary.y * b.z + bary.z * c.z;
        double& depth = depth_[std::size_t(y) * std::size_t(pixels_) + std::size_t(x)];
        if (std::abs(height) > patch_.side || height <= depth) continue;
        depth = height;
        put(picture_.input, x, y, surface.input(bary));
        put(picture_.baked, x, y, surface.baked(bary));
      }
  }

  LeakPicture take() { return std::move(picture_); }

 private:
  const Patch& patch_;
  int pixels_;
  std::vector<double> depth_;
  LeakPicture picture_;
};

}  // namespace

LeakPicture draw_patch(const Staged& staged, const std::vector<Image8>& pages,
                       const ShadowEdge& edge, const PatchOptions& options) {
  const Patch patch = choose_patch(staged.scene(), edge, options.side);
  Canvas canvas(patch, options.pixels);
  for (const std::uint32_t t : edge.triangles) {
    const auto p = corners(staged.scene(), t);
    const double reach = options.side + glm::distance(p[0], p[1]) + glm::distance(p[0], p[2]);
    if (glm::distance(p[0], patch.centre) > reach) continue;
    canvas.draw(p, BakedSurface(staged, pages, t));
  }
  return canvas.take();
}

Image8 side_by_side(const std::vector<Image8>& tiles) {
  constexpr int kGap = 8;
  int width = -kGap, height = 0;
  for (const Image8& tile : tiles) {
    width += tile.width + kGap;
    height = std::max(height, tile.height);
  }
  Image8 all(std::max(width, 0), height, 3, 255);
  int left = 0;
  for (const Image8& tile : tiles) {
    for (int y = 0; y < tile.height; ++y)
      std::copy_n(tile.at(0, y), std::size_t(3 * tile.width), all.at(left, y));
    left += tile.width + kGap;
  }
  return all;
}

}  // namespace atlas::bench
