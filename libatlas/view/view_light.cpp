#include "libatlas/view/view_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "libatlas/core/luma.h"

namespace atlas {
namespace {

// The two texels of a row or column between whose centres a place lies.
struct Between {
  int low, high;
  float share;  // of the upper one
};

Between between(float t, int size) {
  const float at = std::clamp(t * float(size) - 0.5f, 0.0f, float(size - 1));
  const int low = std::min(int(at), size - 1);
  return {low, std::min(low + 1, size - 1), at - float(low)};
}

float luma_of(const Vec3f& e) {
  return luma(e.x, e.y, e.z);
}

// Appends the light of each vertex on the lightmap. Returns which vertices these are.
std::vector<bool> add_mapped(const ViewScene& view, std::vector<float>& lumas) {
  std::vector<bool> mapped(view.positions.size());
  for (const ViewScene::Cluster& c : view.clusters) {
    if (c.look.light_page < 0) continue;
    const ImageF& page = view.lightmap->pages[std::size_t(c.look.light_page)];
    for (std::uint32_t i = c.first; i < c.first + c.count; ++i) {
      const std::uint32_t v = view.indices[i];
      if (mapped[v]) continue;
      mapped[v] = true;
      lumas.push_back(luma_of(light_on_page(page, view.light_texcoords[v])));
    }
  }
  return mapped;
}

}  // namespace

Vec3f light_on_page(const ImageF& page, const Vec2f& uv) {
  const Between x = between(uv.x, page.width), y = between(uv.y, page.height);
  float rgb[3];
  for (int c = 0; c < 3; ++c) {
    const auto row = [&](int r) {
      return std::lerp(page.at(x.low, r)[c], page.at(x.high, r)[c], x.share);
    };
    rgb[c] = std::lerp(row(y.low), row(y.high), y.share);
  }
  return {rgb[0], rgb[1], rgb[2]};
}

double light_scale_of(const ViewScene& view) {
  if (view.lightmap && view.lightmap->white > 0) return 1.0 / double(view.lightmap->white);
  std::vector<float> lumas;
  lumas.reserve(view.positions.size());
  const std::vector<bool> mapped = add_mapped(view, lumas);
  for (std::size_t v = 0; v < view.illumination.size(); ++v)
    if (!mapped[v]) lumas.push_back(luma_of(view.illumination[v]));
  if (lumas.empty()) return 1;
  const auto at = lumas.begin() + std::ptrdiff_t(double(lumas.size() - 1) * 0.99);
  std::nth_element(lumas.begin(), at, lumas.end());
  return *at > 0 ? 1.0 / *at : 1.0;
}

}  // namespace atlas
