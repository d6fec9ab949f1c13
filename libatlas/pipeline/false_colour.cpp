#include "libatlas/pipeline/false_colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libatlas/core/bounds.h"
#include "libatlas/core/luma.h"
#include "libatlas/raster/scan.h"
#include "libatlas/scene/triangle_area.h"

namespace atlas {
namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr int kPlanSide = 900, kPageSide = 288, kGap = 16, kLegendWidth = 130;
constexpr Colour kUnlit{110, 110, 110}, kBlack{0, 0, 0}, kFrame{190, 190, 190};

// Anchors of the colour map Turbo (Mikhailov 2019), from dark to bright.
constexpr std::array<Colour, 9> kTurbo{{{48, 18, 59},
                                        {70, 107, 227},
                                        {40, 187, 236},
                                        {50, 242, 152},
                                        {163, 253, 60},
                                        {237, 208, 58},
                                        {251, 128, 34},
                                        {210, 49, 5},
                                        {122, 4, 3}}};

// What the legend and the scale are written with: seven rows of five pixels a glyph.
struct Glyph {
  char letter;
  std::array<std::uint8_t, 7> rows;
};
constexpr std::array<Glyph, 14> kGlyphs{{{'0', {14, 17, 19, 21, 25, 17, 14}},
                                         {'1', {4, 12, 4, 4, 4, 4, 14}},
                                         {'2', {14, 17, 1, 2, 4, 8, 31}},
                                         {'3', {31, 2, 4, 2, 1, 17, 14}},
                                         {'4', {2, 6, 10, 18, 31, 2, 2}},
                                         {'5', {31, 16, 30, 1, 1, 17, 14}},
                                         {'6', {6, 8, 16, 30, 17, 17, 14}},
                                         {'7', {31, 1, 2, 4, 8, 8, 8}},
                                         {'8', {14, 17, 17, 14, 17, 17, 14}},
                                         {'9', {14, 17, 17, 15, 1, 2, 12}},
                                         {'.', {0, 0, 0, 0, 0, 12, 12}},
                                         {'e', {0, 0, 14, 17, 31, 16, 14}},
                                         {'-', {0, 0, 0, 31, 0, 0, 0}},
                                         {'m', {0, 0, 26, 21, 21, 21, 21}}}};

void fill(Image8& image, Rect box, Colour colour) {
  for (int y = std::max(0, box.y); y < std::min(image.height, box.top()); ++y)
    for (int x = std::max(0, box.x); x < std::min(image.width, box.right()); ++x)
      std::copy(colour.begin(), colour.end(), image.at(x, y));
}

// Writes text of two pixels a dot; (x, y) is its lower left corner.
void write_text(Image8& image, int x, int y, std::string_view text) {
  for (const char letter : text) {
    for (const Glyph& glyph : kGlyphs) {
      if (glyph.letter != letter) continue;
      for (int row = 0; row < 7; ++row)
        for (int column = 0; column < 5; ++column)
          if (glyph.rows[std::size_t(row)] >> (4 - column) & 1)
            fill(image, {x + 2 * column, y + 2 * (6 - row), 2, 2}, kBlack);
    }
    x += 12;
  }
}

// The values at which colours change, and their colours.
class Bands {
 public:
  Bands(double low, double high) {
    constexpr std::size_t kMost = 10;
    for (int decade = -36; decade <= 36; ++decade)
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double value = factor * std::pow(10.0, decade);
        if (value * 2.5 > low && (values_.empty() || values_.back() < high))
          values_.push_back(value);
      }
    if (values_.size() > kMost) values_.erase(values_.begin(), values_.end() - kMost);
  }
  const std::vector<double>& values() const { return values_; }

  // Returns the colour of the range `i`: the first lies below all values, the last above them.
  Colour colour(std::size_t i) const {
    const double at = double(i) / double(values_.size()) * (kTurbo.size() - 1);
    const std::size_t from = std::min(kTurbo.size() - 2, std::size_t(at));
    Colour mixed;
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = kTurbo[from][k], b = kTurbo[from + 1][k];
      mixed[k] = std::uint8_t(std::lround(a + (at - double(from)) * (b - a)));
    }
    return mixed;
  }
  Colour of(float value) const {
    if (!(value > 0)) return kUnlit;
    return colour(std::size_t(std::upper_bound(values_.begin(), values_.end(), double(value)) -
                              values_.begin()));
  }

 private:
  std::vector<double> values_;
};

class Picture {
 public:
  Picture(const Scene& scene, Up up) : scene_(scene), up_(up), bands_(range(scene)) {}

  Image8 draw(const ChartSet& charts, const PageLayout& layout) {
    const Image8 seen = plan();
    std::vector<Image8> pages = pages_of(charts, layout);
    const int across =
        std::max<int>(1, (std::max(seen.width, kPlanSide) + kGap) / (kPageSide + kGap));
    const int lines = (int(pages.size()) + across - 1) / across;
    const int below = lines * (kPageSide + kGap);
    const int columns = std::min(across, int(pages.size())) * (kPageSide + kGap);
    const int height = std::max(seen.height, int(bands_.values().size() + 1) * 34);
    Image8 out(std::max(seen.width + kLegendWidth, columns) + 2 * kGap, height + below + 5 * kGap,
               3, 255);
    paste(seen, out, kGap, out.height - kGap - seen.height);
    legend(out, kGap + seen.width + kGap, out.height - kGap);
    scale(out, kGap, out.height - 2 * kGap - seen.height - 8);
    for (std::size_t p = 0; p < pages.size(); ++p)
      paste(pages[p], out, kGap + int(p) % across * (kPageSide + kGap),
            below - kPageSide - int(p) / across * (kPageSide + kGap));
    return out;
  }

 private:
  static float value(const Vec3f& light) {
    return luma(std::max(light.x, 0.0f), std::max(light.y, 0.0f), std::max(light.z, 0.0f));
  }

  // The range of most light by area.
  static Bands range(const Scene& scene) {
    std::vector<std::pair<float, double>> lit;
    double area = 0;
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
      float sum = 0;
      for (int k = 0; k < 3; ++k)
        sum += value(scene.illumination[scene.indices[3 * t + std::size_t(k)]]);
      if (!(sum > 0)) continue;
      lit.emplace_back(sum / 3, triangle_area(scene, t));
      area += lit.back().second;
    }
    std::sort(lit.begin(), lit.end());
    double low = 1, high = 1, passed = 0;
    for (const auto& [light, of] : lit) {
      if (passed <= 0.05 * area) low = double(light);
      if (passed <= 0.99 * area) high = double(light);
      passed += of;
    }
    return {low, high};
  }

  // Calls give(x, y, weights) for each pixel of a triangle.
  template <class Give>
  static void scan(const TexelTriangle& p, const Image8& on, const Give& give) {
    const double area =
        (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
    scan_triangle(p, {0, 0, on.width, on.height}, {0.5, 0.5}, [&](int y, int x0, int x1) {
      for (int x = x0; x < x1; ++x) {
        const double px = x + 0.5 - p[0].x, py = y + 0.5 - p[0].y;
        const double b1 = (px * (p[2].y - p[0].y) - py * (p[2].x - p[0].x)) / area;
        const double b2 = (py * (p[1].x - p[0].x) - px * (p[1].y - p[0].y)) / area;
        give(x, y, std::array{1 - b1 - b2, b1, b2});
      }
    });
  }

  std::array<float, 3> values(std::size_t t) const {
    std::array<float, 3> out;
    for (std::size_t k = 0; k < 3; ++k)
      out[k] = value(scene_.illumination[scene_.indices[3 * t + k]]);
    return out;
  }
  static float mixed(const std::array<float, 3>& v, const std::array<double, 3>& b) {
    return float(b[0] * v[0] + b[1] * v[1] + b[2] * v[2]);
  }

  // Returns the place on the plan, and the height above it.
  Vec3d on_plan(std::size_t corner) const {
    const Vec3f& p = scene_.positions[scene_.indices[corner]];
    return up_ == Up::z ? Vec3d{p.x, p.y, p.z} : Vec3d{p.x, -double(p.z), p.y};
  }

  Image8 plan() {
    Vec3d low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (std::size_t c = 0; c < scene_.indices.size(); ++c) {
      const Vec3d p = on_plan(c);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const double side = std::max({high.x - low.x, high.y - low.y, 1e-30});
    pixels_ = (kPlanSide - 1) / side;
    Image8 out(int((high.x - low.x) * pixels_) + 1, int((high.y - low.y) * pixels_) + 1, 3, 255);
    const double cut = low.z + kPlanCutMetres / scene_.metres_per_unit;
    std::vector<float> top(std::size_t(out.width) * std::size_t(out.height),
                           -std::numeric_limits<float>::infinity());
    for (std::size_t t = 0; t < scene_.triangle_count(); ++t) {
      TexelTriangle corners;
      std::array<float, 3> heights;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d p = on_plan(3 * t + k);
        corners[k] = {(p.x - low.x) * pixels_, (p.y - low.y) * pixels_};
        heights[k] = float(p.z);
      }
      if (*std::min_element(heights.begin(), heights.end()) > cut) continue;
      const std::array<float, 3> light = values(t);
      scan(corners, out, [&](int x, int y, const std::array<double, 3>& b) {
        const float height = mixed(heights, b);
        float& highest = top[std::size_t(y) * std::size_t(out.width) + std::size_t(x)];
        if (height > cut || height <= highest) return;
        highest = height;
        const Colour colour = bands_.of(mixed(light, b));
        std::copy(colour.begin(), colour.end(), out.at(x, y));
      });
    }
    return out;
  }

  std::vector<Image8> pages_of(const ChartSet& charts, const PageLayout& layout) const {
    std::vector<Image8> pages;
    std::vector<double> pixels;
    for (const Extent& page : layout.pages) {
      pixels.push_back(double(kPageSide) / std::max(page.width, page.height));
      pages.emplace_back(std::max(1, int(page.width * pixels.back())),
                         std::max(1, int(page.height * pixels.back())), 3, 255);
      fill(pages.back(), {0, 0, pages.back().width, pages.back().height}, {235, 235, 235});
    }
    for (const ChartPlacement& placement : layout.placements) {
      const auto page = std::size_t(placement.page);
      const Chart& chart = charts.charts[placement.chart];
      for (std::uint32_t i = 0; i < chart.triangle_count; ++i) {
        const std::size_t t = charts.chart_triangles[chart.first_triangle + i];
        TexelTriangle corners;
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec2d at = page_texel(placement, charts.uvs[charts.triangle_uv[3 * t + k]]);
          corners[k] = {pixels[page] * at.x, pixels[page] * at.y};
        }
        const std::array<float, 3> light = values(t);
        scan(corners, pages[page], [&](int x, int y, const std::array<double, 3>& b) {
          const Colour colour = bands_.of(mixed(light, b));
          std::copy(colour.begin(), colour.end(), pages[page].at(x, y));
        });
      }
    }
    return pages;
  }

  static void paste(const Image8& from, Image8& to, int x, int y) {
    fill(to, {x - 1, y - 1, from.width + 2, from.height + 2}, kFrame);
    for (int row = 0; row < from.height; ++row)
      std::copy_n(from.at(0, row), 3 * std::size_t(from.width), to.at(x, y + row));
  }

  // The brightest range is at the top, and each value stands where its colours meet.
  void legend(Image8& out, int x, int top) const {
    constexpr int kStep = 34, kWidth = 28;
    const std::size_t ranges = bands_.values().size() + 1;
    for (std::size_t i = 0; i < ranges; ++i)
      fill(out, {x, top - int(ranges - i) * kStep, kWidth, kStep}, bands_.colour(i));
    for (std::size_t i = 0; i + 1 < ranges; ++i)
      write_text(out, x + kWidth + 8, top - int(ranges - i - 1) * kStep - 7,
                 fmt::format("{:.6g}", bands_.values()[i]));
  }

  // Draws the length that is the longest of 1, 2 or 5 times a power of ten within a third of the
  // plan.
  void scale(Image8& out, int x, int y) const {
    const double third = kPlanSide / 3 / pixels_ * scene_.metres_per_unit;
    const double decade = std::pow(10, std::floor(std::log10(third)));
    const double metres = third >= 5 * decade   ? 5 * decade
                          : third >= 2 * decade ? 2 * decade
                                                : decade;
    const int length = int(metres / scene_.metres_per_unit * pixels_);
    fill(out, {x, y, length, 3}, kBlack);
    write_text(out, x + length + 8, y - 5, fmt::format("{:.6g} m", metres));
  }

  const Scene& scene_;
  const Up up_;
  const Bands bands_;
  double pixels_ = 1;  // of the plan, a scene unit
};

}  // namespace

Image8 draw_false_colours(const Scene& scene, Up up, const ChartSet& charts,
                          const PageLayout& layout) {
  return Picture(scene, up).draw(charts, layout);
}

}  // namespace atlas
