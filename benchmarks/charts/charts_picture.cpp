#include "benchmarks/charts/charts_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libatlas/core/glm_bridge.h"

namespace atlas::bench {
namespace {

constexpr int kSamples = 3;  // per side of a pixel
constexpr std::uint32_t kEmpty = 0xffffffffu;
constexpr glm::dvec3 kPaper(1, 1, 1);

glm::dvec3 colour(std::uint32_t chart) {
  const double hue = std::fmod(0.11 + chart * 0.61803398875, 1.0), soft = 0.35 + 0.12 * (chart % 3);
  glm::dvec3 rgb;
  for (int c = 0; c < 3; ++c) {
    const double x = std::abs(std::fmod(6 * hue + 2 * (3 - c), 6.0) - 3) - 1;
    rgb[c] = 0.96 * (1 - soft * (1 - std::clamp(x, 0.0, 1.0)));
  }
  return rgb;
}

// A square of samples with the chart of the nearest face and its brightness.
class Canvas {
 public:
  explicit Canvas(int side)
      : side_(side * kSamples),
        depth_(std::size_t(side_) * side_, -1e300),
        chart_(depth_.size(), kEmpty),
        light_(depth_.size(), 1) {}

  int side() const { return side_; }

  // Draws a triangle. Corners have x, y in samples and z towards the eye.
  void draw(const std::array<glm::dvec3, 3>& p, std::uint32_t chart, double light) {
    const auto cross = [](const glm::dvec3& o, const glm::dvec3& a, const glm::dvec3& b) {
      return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
    };
    const double area = cross(p[0], p[1], p[2]);
    if (area == 0) return;
    const int x0 = std::max(0, int(std::min({p[0].x, p[1].x, p[2].x})));
    const int x1 = std::min(side_ - 1, int(std::max({p[0].x, p[1].x, p[2].x})) + 1);
    const int y0 = std::max(0, int(std::min({p[0].y, p[1].y, p[2].y})));
    const int y1 = std::min(side_ - 1, int(std::max({p[0].y, p[1].y, p[2].y})) + 1);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const glm::dvec3 q(x + 0.5, y + 0.5, 0);
        const double a = cross(q, p[1], p[2]) / area, b = cross(q, p[2], p[0]) / area,
                     c = 1 - a - b;
        if (a < 0 || b < 0 || c < 0) continue;
        const double z = a * p[0].z + b * p[1].z + c * p[2].z;
        const std::size_t at = std::size_t(y) * side_ + x;
        if (z <= depth_[at]) continue;
        depth_[at] = z;
        chart_[at] = chart;
        light_[at] = light;
      }
  }

  // Averages the samples into `image` with the lower left corner at (left, bottom).
  void finish(Image8& image, int left, int bottom) const {
    for (int y = 0; y < side_ / kSamples; ++y)
      for (int x = 0; x < side_ / kSamples; ++x) {
        glm::dvec3 sum(0);
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i) sum += sample(kSamples * x + i, kSamples * y + j);
        std::uint8_t* texel = image.at(left + x, bottom + y);
        for (int c = 0; c < 3; ++c)
          texel[c] = std::uint8_t(std::lround(255 * sum[c] / (kSamples * kSamples)));
      }
  }

 private:
  std::uint32_t chart(int x, int y) const {
    return chart_[std::size_t(std::clamp(y, 0, side_ - 1)) * side_ + std::clamp(x, 0, side_ - 1)];
  }
  glm::dvec3 sample(int x, int y) const {
    const std::uint32_t own = chart(x, y);
    const bool seam = chart(x + 1, y) != own || chart(x - 1, y) != own || chart(x, y + 1) != own ||
                      chart(x, y - 1) != own;
    if (seam) return glm::dvec3(0.15);
    return own == kEmpty ? kPaper : colour(own) * light_[std::size_t(y) * side_ + x];
  }

  int side_;
  std::vector<double> depth_;
  std::vector<std::uint32_t> chart_;
  std::vector<double> light_;
};

void draw_in_space(const test::UvMesh& mesh, const std::vector<std::uint32_t>& chart,
                   Canvas& canvas) {
  const double turn = -0.6, tilt = 0.35;
  const glm::dvec3 right(std::cos(turn), std::sin(turn), 0);
  const glm::dvec3 back(std::sin(turn) * std::cos(tilt), -std::cos(turn) * std::cos(tilt),
                        std::sin(tilt));  // towards the eye
  const glm::dvec3 up = glm::cross(back, right),
                   lamp = glm::normalize(back + 0.7 * up - 0.4 * right);
  std::vector<glm::dvec3> seen;
  glm::dvec3 low(1e300), high(-1e300);
  for (const Vec3d& v : mesh.positions) {
    const glm::dvec3 p = to_glm(v);
    seen.emplace_back(glm::dot(p, right), glm::dot(p, up), glm::dot(p, back));
    low = glm::min(low, seen.back());
    high = glm::max(high, seen.back());
  }
  const double scale = 0.94 * canvas.side() / std::max(high.x - low.x, high.y - low.y);
  const glm::dvec3 middle = 0.5 * (low + high);
  for (auto& p : seen) p = scale * (p - middle) + 0.5 * glm::dvec3(canvas.side(), canvas.side(), 0);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& v = mesh.faces[f].position;
    const glm::dvec3 a = to_glm(mesh.positions[v[0]]);
    const glm::dvec3 n =
        glm::cross(to_glm(mesh.positions[v[1]]) - a, to_glm(mesh.positions[v[2]]) - a);
    const double length = glm::length(n);
    const double light = length > 0 ? std::abs(glm::dot(n, lamp)) / length : 1;
    canvas.draw({seen[v[0]], seen[v[1]], seen[v[2]]}, chart[f], 0.45 + 0.55 * light);
  }
}

void draw_page(const UnwrappedMesh& unwrapped, const std::vector<std::uint32_t>& chart,
               Canvas& canvas) {
  const test::UvMesh& mesh = unwrapped.mesh;
  const double margin = 0.03 * canvas.side(), scale = canvas.side() - 2 * margin;
  const double wide = scale * std::min(1.0, unwrapped.aspect),
               high = scale * std::min(1.0, 1 / unwrapped.aspect);
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f].page != 0) continue;
    std::array<glm::dvec3, 3> p;
    for (int c = 0; c < 3; ++c) {
      const Vec2d uv = mesh.uvs[mesh.faces[f].uv[c]];
      p[c] = {margin + 0.5 * (scale - wide) + wide * uv.x,
              margin + 0.5 * (scale - high) + high * uv.y, 0};
    }
    canvas.draw(p, chart[f], 1);
  }
}

}  // namespace

Image8 charts_picture(const std::vector<UnwrappedMesh>& meshes, int side) {
  Image8 image(side * int(meshes.size()), 2 * side, 3, 255);
  for (std::size_t k = 0; k < meshes.size(); ++k) {
    const std::vector<std::uint32_t> chart = test::charts_by_texcoord(meshes[k].mesh);
    Canvas space(side), page(side);
    draw_in_space(meshes[k].mesh, chart, space);
    draw_page(meshes[k], chart, page);
    space.finish(image, side * int(k), side);
    page.finish(image, side * int(k), 0);
  }
  return image;
}

}  // namespace atlas::bench
