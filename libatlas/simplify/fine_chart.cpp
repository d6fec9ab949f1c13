#include "libatlas/simplify/fine_chart.h"

#include <algorithm>

namespace atlas::simplify {
namespace {

void collect_triangles(const Geometry& geometry, std::uint32_t chart,
                       const std::vector<bool>& flipped, FineChart& fine) {
  const ChartSet& charts = *geometry.charts;
  const Chart& range = charts.charts[chart];
  fine.corners.reserve(std::size_t{3} * range.triangle_count);
  fine.source.reserve(range.triangle_count);
  for (std::uint32_t i = 0; i < range.triangle_count; ++i) {
    const std::uint32_t triangle = charts.chart_triangles[range.first_triangle + i];
    std::uint32_t uv[3];
    for (int k = 0; k < 3; ++k) uv[k] = charts.triangle_uv[std::size_t{3} * triangle + k];
    if (flipped[triangle]) std::swap(uv[1], uv[2]);
    const Vec3f &a = geometry.position(uv[0]), &b = geometry.position(uv[1]),
                &c = geometry.position(uv[2]);
    if (uv[0] == uv[1] || uv[1] == uv[2] || uv[2] == uv[0] || a == b || b == c || c == a) {
      ++fine.dropped;
      continue;
    }
    fine.corners.insert(fine.corners.end(), uv, uv + 3);
    fine.source.push_back(triangle);
  }
}

// Fills `opposite`; corners hold uvs relative to `first_uv` .. `first_uv + uv_count` here.
void glue(FineChart& fine, std::uint32_t first_uv, std::uint32_t uv_count) {
  const std::uint32_t halves = static_cast<std::uint32_t>(fine.corners.size());
  fine.opposite.assign(halves, kNone);
  const auto low = [&](std::uint32_t h) { return std::min(fine.from(h), fine.to(h)) - first_uv; };
  std::vector<std::uint32_t> offset(std::size_t{uv_count} + 1, 0), bucket(halves);
  for (std::uint32_t h = 0; h < halves; ++h) ++offset[low(h) + 1];
  for (std::uint32_t v = 0; v < uv_count; ++v) offset[v + 1] += offset[v];
  std::vector<std::uint32_t> cursor(offset.begin(), offset.end() - 1);
  for (std::uint32_t h = 0; h < halves; ++h) bucket[cursor[low(h)]++] = h;
  const auto high = [&](std::uint32_t h) { return std::max(fine.from(h), fine.to(h)); };
  for (std::uint32_t v = 0; v < uv_count; ++v) {
    const auto begin = bucket.begin() + offset[v], end = bucket.begin() + offset[v + 1];
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      return high(a) != high(b) ? high(a) < high(b) : a < b;
    });
    for (auto i = begin; i != end;) {
      auto j = i;
      while (j != end && high(*j) == high(*i)) ++j;
      if (j - i == 2 && fine.from(i[0]) == fine.to(i[1])) {
        fine.opposite[i[0]] = i[1];
        fine.opposite[i[1]] = i[0];
      }
      i = j;
    }
  }
}

// Turns uvs in `corners` into local vertices, one a fan.
void split_fans(FineChart& fine) {
  const std::uint32_t halves = static_cast<std::uint32_t>(fine.corners.size());
  std::vector<std::uint32_t> local(halves, kNone);
  for (std::uint32_t first = 0; first < halves; ++first) {
    if (local[first] != kNone) continue;
    const std::uint32_t vertex = fine.vertex_count();
    fine.vertex_uv.push_back(fine.corners[first]);
    std::uint32_t start = first;  // back to the border, or once around
    while (fine.opposite[start] != kNone) {
      start = next_half(fine.opposite[start]);
      if (start == first) break;
    }
    fine.vertex_half.push_back(start);
    std::uint32_t h = start;
    do {
      local[h] = vertex;
      h = fine.opposite[previous_half(h)];
    } while (h != kNone && h != start);
  }
  fine.corners = std::move(local);
}

}  // namespace

std::uint32_t FineChart::border_into(std::uint32_t v) const {
  std::uint32_t h = previous_half(vertex_half[v]);
  while (opposite[h] != kNone) h = previous_half(opposite[h]);
  return h;
}

FineChart build_fine_chart(const Geometry& geometry, std::uint32_t chart,
                           const std::vector<bool>& flipped) {
  FineChart fine;
  const Chart& range = geometry.charts->charts[chart];
  collect_triangles(geometry, chart, flipped, fine);
  glue(fine, range.first_uv, range.uv_count);
  split_fans(fine);
  return fine;
}

}  // namespace atlas::simplify
