#include "tests/support/layout_checks.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace atlas::test {

std::uint64_t Noise::next() {
  std::uint64_t z = state += 0x9E3779B97F4A7C15u;
  z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
  z = (z ^ z >> 27) * 0x94D049BB133111EBu;
  return z ^ z >> 31;
}

int Noise::in(int low, int high) {
  return low + static_cast<int>(next() % static_cast<std::uint64_t>(high - low + 1));
}

double Noise::unit() {
  return static_cast<double>(next() >> 11) * 0x1p-53;
}

std::vector<Extent> log_normal_rects(std::size_t count, std::uint64_t seed) {
  Noise noise{seed};
  const auto normal = [&] {
    double sum = 0;
    for (int k = 0; k < 12; ++k) sum += noise.unit();
    return sum - 6;
  };
  std::vector<Extent> items;
  for (std::size_t i = 0; i < count; ++i) {
    const double z1 = normal(), z2 = normal();
    const double s = 24 * std::exp(0.9 * z1), a = std::exp(0.35 * z2);
    items.push_back({static_cast<int>(std::clamp(std::floor(s * a + 0.5), 2.0, 512.0)),
                     static_cast<int>(std::clamp(std::floor(s / a + 0.5), 2.0, 512.0))});
  }
  return items;
}

namespace {

struct Box {
  std::int64_t x0, y0, x1, y1;
};

bool closer_than(const Box& a, const Box& b, std::int64_t gap) {
  return a.x0 < b.x1 + gap && b.x0 < a.x1 + gap && a.y0 < b.y1 + gap && b.y0 < a.y1 + gap;
}

}  // namespace

std::string check_layout(std::span<const Extent> items, std::span<const Placement> placements,
                         std::span<const Extent> pages, const PackOptions& options) {
  if (placements.size() != items.size()) return "wrong number of placements";
  std::map<std::uint32_t, std::vector<std::pair<std::size_t, Box>>> by_page;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Placement& p = placements[i];
    if (!p.placed() || items[i].area() == 0) continue;
    const std::string who = "item " + std::to_string(i);
    if (p.rotated && !options.allow_rotation) return who + " is turned";
    if (p.page >= pages.size()) return who + " is on no page";
    Extent e = items[i];
    if (p.rotated) std::swap(e.width, e.height);
    const Box b{p.x, p.y, std::int64_t{p.x} + e.width, std::int64_t{p.y} + e.height};
    const Extent page = pages[p.page];
    if (b.x0 < options.border || b.y0 < options.border || b.x1 > page.width - options.border ||
        b.y1 > page.height - options.border)
      return who + " leaves its page";
    if (p.x % options.alignment || p.y % options.alignment) return who + " is not aligned";
    for (const auto& [j, other] : by_page[p.page])
      if (closer_than(b, other, options.padding)) return who + " meets item " + std::to_string(j);
    for (const PinnedRect& pin : options.pinned) {
      const Box r{pin.rect.x, pin.rect.y, std::int64_t{pin.rect.x} + pin.rect.width,
                  std::int64_t{pin.rect.y} + pin.rect.height};
      if (pin.page == p.page && pin.rect.area() > 0 && closer_than(b, r, options.padding))
        return who + " meets a pinned rectangle";
    }
    by_page[p.page].emplace_back(i, b);
  }
  return {};
}

ChartItems::ChartItems(std::vector<std::vector<Vec2d>> charts) : corners(std::move(charts)) {
  for (const auto& c : corners) {
    Vec2d low = c.front(), high = low;
    for (const Vec2d& p : c) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    items.push_back({high.x - low.x, high.y - low.y});
    shapes.push_back({c, {}});
  }
}

std::vector<PlacedShape> placed_shapes(const ChartItems& charts, const FitResult& fit) {
  std::vector<PlacedShape> placed;
  for (std::size_t i = 0; i < charts.shapes.size(); ++i) {
    const FitPlacement& p = fit.placements[i];
    placed.push_back({charts.shapes[i], p.page, p.scale, p.angle, p.offset});
  }
  return placed;
}

std::vector<Vec2d> blob(Noise& noise, double radius, int corners) {
  std::vector<Vec2d> ring;
  const double stretch = 0.4 + 0.6 * noise.unit();
  for (int k = 0; k < corners; ++k) {
    const double a = 2 * 3.14159265358979 * k / corners, r = radius * (0.4 + 0.6 * noise.unit());
    ring.push_back({r * std::cos(a), stretch * r * std::sin(a)});
  }
  std::vector<Vec2d> fan;
  for (int k = 0; k < corners; ++k) {
    fan.push_back({0, 0});
    fan.push_back(ring[static_cast<std::size_t>(k)]);
    fan.push_back(ring[static_cast<std::size_t>((k + 1) % corners)]);
  }
  return fan;
}

namespace {

// Returns whether the open square around texel (x, y), grown by `reach`, meets the triangle. They
// do not meet if an axis of the square or a normal of the triangle separates them.
bool meets(const Vec2d* t, int x, int y, double reach) {
  const double half = 0.5 + reach, cx = x + 0.5, cy = y + 0.5;
  const auto separated = [&](double nx, double ny) {
    const double extent = half * (std::abs(nx) + std::abs(ny));
    double low = 1e300, high = -1e300;
    for (int k = 0; k < 3; ++k) {
      const double d = nx * (t[k].x - cx) + ny * (t[k].y - cy);
      low = std::min(low, d);
      high = std::max(high, d);
    }
    return low >= extent || high <= -extent;
  };
  if (separated(1, 0) || separated(0, 1)) return false;
  for (int k = 0; k < 3; ++k) {
    const Vec2d a = t[k], b = t[(k + 1) % 3];
    if ((a.x != b.x || a.y != b.y) && separated(a.y - b.y, b.x - a.x)) return false;
  }
  return true;
}

// Records the owner of every texel of a page; a texel can have only one.
class Claims {
 public:
  explicit Claims(Extent page)
      : page_(page), owner_(static_cast<std::size_t>(page.area()), kNobody) {}

  std::string claim(const Vec2d* t, std::uint32_t i, double reach) {
    const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [bottom, top] = std::minmax({t[0].y, t[1].y, t[2].y});
    const int x0 = int(std::floor(left - reach)), x1 = int(std::floor(right + reach));
    const int y0 = int(std::floor(bottom - reach)), y1 = int(std::floor(top + reach));
    if (x0 < 0 || y0 < 0 || x1 >= page_.width || y1 >= page_.height)
      return "shape " + std::to_string(i) + " leaves its page";
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        std::uint32_t& owner = owner_[std::size_t(y) * std::size_t(page_.width) + std::size_t(x)];
        if (owner == i || !meets(t, x, y, reach)) continue;
        if (owner != kNobody)
          return "shapes " + std::to_string(owner) + " and " + std::to_string(i) + " are too close";
        owner = i;
      }
    return {};
  }

 private:
  static constexpr std::uint32_t kNobody = 0xffffffffu;
  Extent page_;
  std::vector<std::uint32_t> owner_;
};

}  // namespace

std::string check_outlines(std::span<const PlacedShape> placed, std::span<const Extent> pages,
                           int padding) {
  // Every triangle claims the texels that lie within the padding of it. No texel may have two
  // owners.
  const double reach = padding - 0.001;
  std::vector<Claims> claims(pages.begin(), pages.end());
  for (std::uint32_t i = 0; i < placed.size(); ++i) {
    const PlacedShape& s = placed[i];
    if (s.page >= pages.size()) return "shape " + std::to_string(i) + " is on no page";
    const double c = s.scale * std::cos(s.angle), d = s.scale * std::sin(s.angle);
    for (std::size_t k = 0; k + 2 < s.shape.corners.size(); k += 3) {
      Vec2d t[3];
      for (std::size_t j = 0; j < 3; ++j) {
        const Vec2d p = s.shape.corners[k + j];
        t[j] = {c * p.x - d * p.y + s.offset.x, d * p.x + c * p.y + s.offset.y};
      }
      if (std::string wrong = claims[s.page].claim(t, i, reach); !wrong.empty()) return wrong;
    }
  }
  return {};
}

}  // namespace atlas::test
