#include "benchmarks/shapes/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "benchmarks/shapes/kinds.h"
#include "libatlas/core/glm_bridge.h"

namespace atlas::bench {

using test::Shape;

Shape turned(const std::vector<Vec2d>& profile, int around) {
  std::vector<Vec2d> points;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vec2d a = profile[i], b = profile[(i + 1) % profile.size()];
    const double arc = 2 * std::numbers::pi * std::max(a.x, b.x) / around;
    const int pieces = std::max(1, int(std::lround(std::hypot(b.x - a.x, b.y - a.y) / arc / 2)));
    for (int k = 0; k < pieces; ++k) {
      const double t = double(k) / pieces;
      points.push_back({a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
    }
  }
  Shape shape;
  const auto rows = std::uint32_t(points.size()), columns = std::uint32_t(around);
  for (const Vec2d& p : points)
    for (std::uint32_t k = 0; k < columns; ++k) {
      const double angle = 2 * std::numbers::pi * k / columns;
      shape.positions.push_back(
          {float(p.x * std::cos(angle)), float(p.x * std::sin(angle)), float(p.y)});
    }
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t k = 0; k < columns; ++k) {
      const std::uint32_t s = (r + 1) % rows, l = (k + 1) % columns;
      const std::uint32_t a = r * columns + k, b = r * columns + l, c = s * columns + l,
                          d = s * columns + k;
      for (const std::uint32_t v : {a, b, c, a, c, d}) shape.indices.push_back(v);
    }
  return shape;
}

namespace {

double distance(const Blob& blob, const glm::dvec3& p) {
  const glm::dvec3 a = to_glm(blob.a), d = to_glm(blob.b) - a;
  const double length2 = glm::dot(d, d);
  const double t = length2 > 0 ? std::clamp(glm::dot(p - a, d) / length2, 0.0, 1.0) : 0;
  return glm::length(p - a - t * d) - (blob.radius_a + t * (blob.radius_b - blob.radius_a));
}

// A field that is sampled on a regular grid, and the surface net of its zero set.
class SurfaceNet {
 public:
  SurfaceNet(const std::vector<Blob>& blobs, double smoothing, int resolution)
      : blobs_(blobs), smoothing_(smoothing) {
    glm::dvec3 low(1e30), high(-1e30);
    for (const Blob& b : blobs) {
      for (const auto& [end, radius] : {std::pair{b.a, b.radius_a}, std::pair{b.b, b.radius_b}}) {
        low = glm::min(low, to_glm(end) - radius);
        high = glm::max(high, to_glm(end) + radius);
      }
    }
    const glm::dvec3 extent = high - low;
    step_ = std::max({extent.x, extent.y, extent.z}) / resolution;
    origin_ = low - 3.0 * step_;
    for (int c = 0; c < 3; ++c) size_[c] = int(std::ceil(extent[c] / step_)) + 7;
  }

  Shape run() {
    sample();
    vertex_.assign(value_.size(), 0xffffffffu);
    for (int z = 0; z + 1 < size_[2]; ++z)
      for (int y = 0; y + 1 < size_[1]; ++y)
        for (int x = 0; x + 1 < size_[0]; ++x) add_vertex(x, y, z);
    for (int z = 1; z + 1 < size_[2]; ++z)
      for (int y = 1; y + 1 < size_[1]; ++y)
        for (int x = 1; x + 1 < size_[0]; ++x) add_faces(x, y, z);
    return std::move(shape_);
  }

 private:
  std::size_t at(int x, int y, int z) const {
    return (std::size_t(z) * size_[1] + y) * size_[0] + x;
  }
  glm::dvec3 place(int x, int y, int z) const {
    return origin_ + step_ * glm::dvec3(x + 0.137, y + 0.291, z + 0.419);  // avoids exact zeros
  }

  // Computes the smooth minimum of all distances: -s log sum exp(-d / s).
  void sample() {
    value_.resize(std::size_t(size_[0]) * size_[1] * size_[2]);
    for (int z = 0; z < size_[2]; ++z)
      for (int y = 0; y < size_[1]; ++y)
        for (int x = 0; x < size_[0]; ++x) {
          double sum = 0;
          for (const Blob& b : blobs_) sum += std::exp(-distance(b, place(x, y, z)) / smoothing_);
          value_[at(x, y, z)] = float(-smoothing_ * std::log(std::max(sum, 1e-300)));
        }
  }

  void add_vertex(int x, int y, int z) {
    glm::dvec3 sum(0);
    int crossings = 0;
    for (int e = 0; e < 12; ++e) {
      const int axis = e / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
      int p[3] = {x, y, z};
      p[u] += e & 1;
      p[v] += (e >> 1) & 1;
      int q[3] = {p[0], p[1], p[2]};
      ++q[axis];
      const double f = value_[at(p[0], p[1], p[2])], g = value_[at(q[0], q[1], q[2])];
      if ((f < 0) == (g < 0)) continue;
      glm::dvec3 crossing = place(p[0], p[1], p[2]);
      crossing[axis] += step_ * f / (f - g);
      sum += crossing;
      ++crossings;
    }
    if (crossings == 0) return;
    vertex_[at(x, y, z)] = std::uint32_t(shape_.positions.size());
    shape_.positions.push_back(from_glm(glm::vec3(sum / double(crossings))));
  }

  void add_faces(int x, int y, int z) {
    const float here = value_[at(x, y, z)];
    for (int axis = 0; axis < 3; ++axis) {
      int n[3] = {x, y, z};
      ++n[axis];
      const float there = value_[at(n[0], n[1], n[2])];
      if ((here < 0) == (there < 0)) continue;
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      std::uint32_t corner[4];
      for (int k = 0; k < 4; ++k) {  // the four cells around the edge, anticlockwise about +axis
        int p[3] = {x, y, z};
        p[u] -= k == 0 || k == 3;
        p[v] -= k < 2;
        corner[k] = vertex_[at(p[0], p[1], p[2])];
      }
      if (here >= 0) std::swap(corner[1], corner[3]);
      for (const int k : {0, 1, 2, 0, 2, 3}) shape_.indices.push_back(corner[k]);
    }
  }

  const std::vector<Blob>& blobs_;
  double smoothing_, step_ = 0;
  glm::dvec3 origin_{0};
  int size_[3] = {0, 0, 0};
  std::vector<float> value_;
  std::vector<std::uint32_t> vertex_;
  Shape shape_;
};

void both_sides(std::vector<Blob>& blobs, Blob blob) {
  blobs.push_back(blob);
  blob.a.x = -blob.a.x;
  blob.b.x = -blob.b.x;
  blobs.push_back(blob);
}

std::vector<Blob> figure() {
  std::vector<Blob> b{{{0, 0, 1.0}, {0, 0.01, 1.38}, 0.15, 0.19},
                      {{0, 0.01, 1.45}, {0, 0.03, 1.58}, 0.07, 0.06},
                      {{0, 0.03, 1.68}, {0, 0.05, 1.74}, 0.10, 0.11},
                      {{0, 0.14, 1.68}, {0, 0.17, 1.66}, 0.02, 0.015}};
  both_sides(b, {{0.10, 0, 0.95}, {0.13, 0.03, 0.5}, 0.10, 0.065});
  both_sides(b, {{0.13, 0.03, 0.5}, {0.14, -0.02, 0.08}, 0.065, 0.045});
  both_sides(b, {{0.14, -0.02, 0.05}, {0.17, 0.16, 0.03}, 0.045, 0.035});
  b.push_back({{0.20, 0, 1.42}, {0.42, -0.02, 1.2}, 0.07, 0.05});
  b.push_back({{0.42, -0.02, 1.2}, {0.40, 0.24, 1.12}, 0.05, 0.04});
  b.push_back({{-0.20, 0, 1.42}, {-0.34, 0, 1.65}, 0.07, 0.05});
  b.push_back({{-0.34, 0, 1.65}, {-0.36, 0.05, 1.95}, 0.05, 0.035});
  return b;
}

std::vector<Blob> hound() {
  std::vector<Blob> b{{{0, -0.35, 0.62}, {0, 0.3, 0.66}, 0.15, 0.18},
                      {{0, 0.35, 0.72}, {0, 0.55, 0.95}, 0.11, 0.08},
                      {{0, 0.58, 0.98}, {0, 0.80, 0.92}, 0.10, 0.05},
                      {{0, -0.48, 0.68}, {0, -0.8, 0.9}, 0.05, 0.02}};
  both_sides(b, {{0.11, 0.28, 0.58}, {0.12, 0.30, 0.30}, 0.075, 0.05});
  both_sides(b, {{0.12, 0.30, 0.30}, {0.12, 0.34, 0.04}, 0.05, 0.045});
  both_sides(b, {{0.11, -0.36, 0.56}, {0.13, -0.30, 0.32}, 0.10, 0.055});
  both_sides(b, {{0.13, -0.30, 0.32}, {0.12, -0.40, 0.04}, 0.05, 0.045});
  both_sides(b, {{0.07, 0.56, 1.05}, {0.16, 0.54, 1.16}, 0.04, 0.012});
  return b;
}

std::vector<Blob> bust() {
  std::vector<Blob> b{{{0, 0, 0.1}, {0, 0, 0.16}, 0.16, 0.15},
                      {{0, 0, 0.2}, {0, 0, 0.4}, 0.1, 0.09},
                      {{0, 0, 0.48}, {0, 0.01, 0.56}, 0.2, 0.14},
                      {{0, 0.01, 0.6}, {0, 0.03, 0.74}, 0.07, 0.065},
                      {{0, 0.03, 0.86}, {0, 0.05, 0.93}, 0.1, 0.12},
                      {{0, 0.15, 0.87}, {0, 0.18, 0.83}, 0.014, 0.02}};
  both_sides(b, {{0.12, 0.03, 0.9}, {0.13, 0.02, 0.86}, 0.02, 0.015});
  both_sides(b, {{0.1, 0, 0.56}, {0.26, -0.01, 0.5}, 0.09, 0.08});
  for (int i = 0; i < 9; ++i) {  // folds, each across a shoulder
    const double x = 0.05 * (i - 4);
    b.push_back({{x, 0.15, 0.58 - 0.4 * x * x}, {0.7 * x + 0.03, 0.19, 0.42}, 0.018, 0.012});
  }
  return b;
}

Shape shaft(std::uint64_t triangles) {
  const std::vector<Vec2d> profile{{0.008, 0},    {0.02, 0},      {0.022, 0.002}, {0.022, 0.04},
                                   {0.019, 0.04}, {0.019, 0.045}, {0.022, 0.045}, {0.022, 0.06},
                                   {0.04, 0.06},  {0.04, 0.075},  {0.03, 0.075},  {0.03, 0.12},
                                   {0.018, 0.16}, {0.018, 0.195}, {0.016, 0.2},   {0.008, 0.2}};
  return turned(profile, std::max(12, int(std::lround(std::sqrt(double(triangles) / 5.6)))));
}

Shape bracket(std::uint64_t triangles) {
  const int n = std::max(2, int(std::lround(std::sqrt(double(triangles) / 90))));
  Shape shape = test::box(n, {0.12, 0.08, 0.008});
  shape = test::together(shape, test::moved(test::box(n, {0.008, 0.08, 0.06}), 1, {0, 0, 0.008f}));
  const std::vector<Vec2d> bush{{0.006, 0}, {0.01, 0}, {0.01, 0.015}, {0.006, 0.015}};
  for (const double y : {0.02, 0.06})
    for (const double x : {0.04, 0.1})
      shape =
          test::together(shape, test::moved(turned(bush, 6 * n), 1, {float(x), float(y), 0.008f}));
  Shape plate = test::plate_with_holes(4, std::max(1, n / 6));
  return test::together(shape, test::moved(plate, 0.012, {0.02f, 0.1f, 0}));
}

Shape terraces(std::uint64_t triangles) {
  const int n = std::max(3, int(std::lround(std::sqrt(double(triangles) / 2))));
  Shape shape = test::grid(n, n, 1000, 1000);
  for (Vec3f& p : shape.positions) {
    double h = 0, amplitude = 90, wave = 1.0 / 180;
    for (int octave = 0; octave < 6; ++octave, amplitude *= 0.5, wave *= 2.1) {
      const double c = std::cos(2.1 * octave), s = std::sin(2.1 * octave);
      const double x = wave * (c * p.x - s * p.y), y = wave * (s * p.x + c * p.y);
      h += amplitude * (1 - std::abs(std::sin(x + octave) * std::cos(y)));  // ridges
    }
    const double step = 14, level = std::floor(h / step), rest = h / step - level;
    p.z = float(step * (level + std::pow(rest, 3.0)));
  }
  return shape;
}

Result<std::uint64_t> number_after(const std::string& name, std::size_t colon) {
  std::uint64_t triangles = 0;
  const char *begin = name.data() + colon + 1, *end = name.data() + name.size();
  const auto parsed = colon == std::string::npos
                          ? std::from_chars_result{begin, std::errc::invalid_argument}
                          : std::from_chars(begin, end, triangles);
  if (parsed.ec != std::errc() || parsed.ptr != end || triangles < 100 || triangles > 20000000)
    return Status{
        ErrorCode::bad_option,
        fmt::format("{}: a figure is NAME:TRIANGLES, with 100 to 2*10^7 triangles", name)};
  return triangles;
}

}  // namespace

Shape blend(const std::vector<Blob>& blobs, double smoothing, std::uint64_t triangles) {
  const auto coarse = double(SurfaceNet(blobs, smoothing, 24).run().triangle_count());
  return SurfaceNet(blobs, smoothing, int(std::lround(24 * std::sqrt(double(triangles) / coarse))))
      .run();
}

Result<Shape> make_figure(const std::string& name) {
  const auto colon = name.find(':');
  const std::string kind = name.substr(0, colon);
  const Result<std::uint64_t> triangles = number_after(name, colon);
  if (!triangles.ok()) return triangles.status();
  Shape shape;
  if (kind == "figure")
    shape = blend(figure(), 0.02, *triangles);
  else if (kind == "hound")
    shape = blend(hound(), 0.025, *triangles);
  else if (kind == "bust")
    shape = blend(bust(), 0.008, *triangles);
  else if (kind == "figure-scan")
    shape = test::noisy_along_normals(blend(figure(), 0.02, *triangles), 0.15, 9);
  else if (kind == "terraces")
    shape = terraces(*triangles);
  else if (kind == "shaft")
    shape = shaft(*triangles);
  else if (kind == "bracket")
    shape = bracket(*triangles);
  else
    return make_shape(kind, *triangles);
  shape.name = name;
  return shape;
}

}  // namespace atlas::bench
