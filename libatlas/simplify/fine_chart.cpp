#include "libatlas/simplify/fine_chart.h"

#include <algorithm>
#include <bit>

#include "libatlas/core/counting_sort.h"
#include "libatlas/core/parallel.h"

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

// Fills `opposite`. At this point `corners` holds uvs between `first_uv` and `first_uv + uv_count`.
void glue(FineChart& fine, std::uint32_t first_uv, std::uint32_t uv_count) {
  const std::uint32_t halves = static_cast<std::uint32_t>(fine.corners.size());
  fine.opposite.assign(halves, kNoIndex);
  const auto low = [&](std::size_t h) { return std::min(fine.from(h), fine.to(h)) - first_uv; };
  Buckets leaving = sort_into_buckets(halves, uv_count, [&](std::size_t h) { return low(h); });
  const auto high = [&](std::uint32_t h) { return std::max(fine.from(h), fine.to(h)); };
  for (std::uint32_t v = 0; v < uv_count; ++v) {
    const auto begin = leaving.items.begin() + leaving.begin[v],
               end = leaving.items.begin() + leaving.begin[v + 1];
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

// Replaces the uvs in `corners` by local vertices, one for each fan of triangles.
void split_fans(FineChart& fine) {
  const std::uint32_t halves = static_cast<std::uint32_t>(fine.corners.size());
  std::vector<std::uint32_t> local(halves, kNoIndex);
  for (std::uint32_t first = 0; first < halves; ++first) {
    if (local[first] != kNoIndex) continue;
    const std::uint32_t vertex = fine.vertex_count();
    fine.vertex_uv.push_back(fine.corners[first]);
    std::uint32_t start = first;  // moved back to the border if there is one, else once around
    while (fine.opposite[start] != kNoIndex) {
      start = next_half_edge(fine.opposite[start]);
      if (start == first) break;
    }
    fine.vertex_half.push_back(start);
    std::uint32_t h = start;
    do {
      local[h] = vertex;
      h = fine.opposite[previous_half_edge(h)];
    } while (h != kNoIndex && h != start);
  }
  fine.corners = std::move(local);
}

std::uint64_t mix(std::uint64_t h) {
  h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93ULL;
  h = (h ^ (h >> 32)) * 0xd6e8feb86659fd93ULL;
  return h ^ (h >> 32);
}

// Equal positions have equal keys (0 and -0, too). Different positions almost certainly have
// different keys. If they have not, the worst result is a needless cut, which does no harm. No key
// is 0, also not that of the origin: cut_chart() marks inner vertices by 0.
std::uint64_t point_key(const Vec3f& p) {
  const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0F)}; };
  return mix(mix(bits(p.x) << 32 | bits(p.y)) + bits(p.z)) | std::uint64_t{1} << 63;
}

std::uint64_t edge_key(std::uint64_t a, std::uint64_t b) {
  return mix(std::min(a, b)) + std::max(a, b);
}

// An index of the border edges of all charts by their end points. A bit filter of the end points
// rules out most other points quickly.
class BorderIndex {
 public:
  BorderIndex(const Geometry& geometry, const std::vector<FineChart>& charts)
      : geometry_(geometry) {
    for (const FineChart& chart : charts) {
      for (std::uint32_t v = 0; v < chart.vertex_count(); ++v) {
        if (!chart.border(v)) continue;
        points_.push_back(key(chart, v));
        edges_.push_back(edge_key(points_.back(), key(chart, chart.to(chart.vertex_half[v]))));
      }
    }
    std::sort(edges_.begin(), edges_.end());
    filter_.resize(std::bit_ceil(std::max<std::size_t>(64, 16 * points_.size())));
    for (const std::uint64_t p : points_) filter_[p & (filter_.size() - 1)] = true;
    points_ = {};
  }
  std::uint64_t key(const FineChart& chart, std::uint32_t v) const {
    return point_key(geometry_.position(chart.vertex_uv[v]));
  }
  bool maybe_point(std::uint64_t point) const { return filter_[point & (filter_.size() - 1)]; }
  bool edge(std::uint64_t a, std::uint64_t b) const {
    return std::binary_search(edges_.begin(), edges_.end(), edge_key(a, b));
  }

 private:
  const Geometry& geometry_;
  std::vector<std::uint64_t> points_, edges_;
  std::vector<bool> filter_;
};

std::uint64_t cut_chart(const BorderIndex& border, FineChart& fine) {
  std::vector<std::uint64_t> keys(fine.vertex_count(), 0);
  bool any = false;
  for (std::uint32_t v = 0; v < fine.vertex_count(); ++v) {
    const std::uint64_t key = border.key(fine, v);
    if (border.maybe_point(key)) keys[v] = key;
    any = any || keys[v] != 0;
  }
  std::uint64_t cuts = 0;
  for (std::uint32_t h = 0; any && h < fine.corners.size(); ++h) {
    const std::uint32_t twin = fine.opposite[h];
    if (twin == kNoIndex || twin < h) continue;
    const std::uint64_t a = keys[fine.from(h)], b = keys[fine.to(h)];
    if (a == 0 || b == 0 || !border.edge(a, b)) continue;
    fine.opposite[h] = fine.opposite[twin] = kNoIndex;
    ++cuts;
  }
  if (cuts == 0) return 0;
  for (std::uint32_t& corner : fine.corners) corner = fine.vertex_uv[corner];
  fine.vertex_uv.clear();
  fine.vertex_half.clear();
  split_fans(fine);
  return cuts;
}

}  // namespace

std::uint32_t FineChart::border_into(std::uint32_t v) const {
  std::uint32_t h = previous_half_edge(vertex_half[v]);
  while (opposite[h] != kNoIndex) h = previous_half_edge(opposite[h]);
  return h;
}

VertexPoints::VertexPoints(const Geometry& geometry, const FineChart& fine) {
  uvs.reserve(fine.vertex_uv.size());
  positions.reserve(fine.vertex_uv.size());
  for (const std::uint32_t id : fine.vertex_uv) {
    uvs.push_back(geometry.uv(id));
    positions.push_back(geometry.position(id));
  }
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

std::uint64_t cut_shared_edges(const Geometry& geometry, std::vector<FineChart>& charts,
                               const Context& context) {
  const BorderIndex border(geometry, charts);
  std::vector<std::uint64_t> cuts(charts.size(), 0);
  parallel_for(context, charts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) cuts[c] = cut_chart(border, charts[c]);
  });
  std::uint64_t sum = 0;
  for (const std::uint64_t n : cuts) sum += n;
  return sum;
}

}  // namespace atlas::simplify
