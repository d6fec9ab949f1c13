#include "libatlas/unwrap/like/take_uvs.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/sort_total.h"
#include "libatlas/uvs/thin_uvs.h"

namespace atlas {
namespace {

// The charts of the earlier mesh.
class EarlierCharts {
 public:
  EarlierCharts(const JoinedMesh& mesh, const EarlierUvs& uvs) : mesh_(mesh), uvs_(uvs) {
    const std::size_t n = mesh.triangle_count();
    texels_.resize(n);
    chart_.assign(n, kNoIndex);
    std::vector<std::uint8_t> usable(n);
    for (std::uint32_t t = 0; t < n; ++t) usable[t] = take(t);
    DisjointSets sets(n);
    for (std::uint32_t h = 0; h < mesh.across.size(); ++h) {
      const std::uint32_t o = mesh.across[h];
      if (o != kNoIndex && h < o && usable[h / 3] && usable[o / 3] && continues(h))
        sets.join(h / 3, o / 3);
    }
    for (std::uint32_t t = 0; t < n; ++t) {
      if (!usable[t]) continue;
      const std::uint32_t first = sets.find(t);
      if (first == t) {
        chart_[t] = std::uint32_t(pages_.size());
        pages_.push_back(page_of(t));
        triangles_.push_back(0);
      }
      chart_[t] = chart_[first];
      ++triangles_[chart_[t]];
    }
  }

  const TexelCorners& texels(std::uint32_t t) const { return texels_[t]; }
  std::uint32_t chart(std::uint32_t t) const { return chart_[t]; }  // kNoIndex: no usable uvs
  std::vector<std::uint32_t> pages() const { return pages_; }
  std::vector<std::uint32_t> triangles() const { return triangles_; }

  // Whether a chart goes on across the edge.
  bool continues(std::uint32_t h) const {
    const std::uint32_t o = mesh_.across[h];
    if (o == kNoIndex || page_of(h / 3) != page_of(o / 3)) return false;
    const bool along = mesh_.corners[h] == mesh_.corners[o];
    const std::uint32_t from = along ? o : next_half_edge(o), to = along ? next_half_edge(o) : o;
    return at(h) == at(from) && at(next_half_edge(h)) == at(to);
  }

 private:
  std::uint32_t page_of(std::uint32_t t) const {
    return uvs_.triangle_page.empty() ? 0 : uvs_.triangle_page[t];
  }
  Vec2d at(std::uint32_t corner) const { return texels_[corner / 3][corner % 3]; }

  // Returns whether the triangle has usable uvs.
  bool take(std::uint32_t t) {
    const std::uint32_t p = page_of(t);
    if (p >= uvs_.pages.size()) return false;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t i =
          uvs_.uv_indices.empty() ? uvs_.indices[3 * t + k] : uvs_.uv_indices[3 * t + k];
      if (i >= uvs_.uvs.size()) return false;
      const Vec2f uv = uvs_.uvs[i];
      if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return false;
      // Exact, so that dividing by the page's side gives the same float again.
      texels_[t][k] = {double(uv.x) * uvs_.pages[p].width, double(uv.y) * uvs_.pages[p].height};
    }
    return true;
  }

  const JoinedMesh& mesh_;
  const EarlierUvs& uvs_;
  std::vector<TexelCorners> texels_;
  std::vector<std::uint32_t> chart_, pages_, triangles_;
};

class UvTaker {
 public:
  UvTaker(const UvPair& pair, PageGrid& grid)
      : pair_(pair), grid_(grid), charts_(pair.earlier_mesh, pair.earlier) {}

  TakenUvs run() {
    matches_ = match_triangles(pair_.mesh, pair_.earlier_mesh,
                               pair_.earlier.tolerance * mean_edge(pair_.earlier_mesh));
    const std::size_t n = pair_.mesh.triangle_count();
    taken_.state.assign(n, TakenState::none);
    taken_.texels.resize(n);
    taken_.chart.assign(n, kNoIndex);
    taken_.chart_page = charts_.pages();
    taken_.chart_triangles = charts_.triangles();
    taken_.with_uvs = std::accumulate(taken_.chart_triangles.begin(), taken_.chart_triangles.end(),
                                      std::size_t{0});
    for (std::uint32_t t = 0; t < n; ++t) take(t);
    leave_out_overlaps();
    mark_seams();
    return std::move(taken_);
  }

 private:
  void take(std::uint32_t t) {
    const TriangleMatch& match = matches_[t];
    if (match.earlier == kNoIndex) return;
    ++taken_.matched;
    const std::uint32_t chart = charts_.chart(match.earlier);
    if (chart == kNoIndex) return;
    taken_.chart[t] = chart;
    taken_.state[t] = match.moved ? TakenState::moved : TakenState::same;
    for (std::uint32_t k = 0; k < 3; ++k)
      taken_.texels[t][k] = charts_.texels(match.earlier)[match.corners[k]];
  }

  void leave(std::uint32_t t) {
    taken_.chart[t] = kNoIndex;
    taken_.state[t] = TakenState::none;
  }

  // Larger charts first; those of one size in the order of their corners on the page.
  std::vector<std::uint32_t> charts_by_size(
      const std::vector<std::vector<std::uint32_t>>& of) const {
    struct Rank {
      double area, x, y;
      std::uint32_t chart;
      bool operator==(const Rank&) const = default;
    };
    std::vector<Rank> ranks;
    for (std::uint32_t c = 0; c < of.size(); ++c) {
      if (of[c].empty()) continue;
      Rank rank{0, taken_.texels[of[c][0]][0].x, taken_.texels[of[c][0]][0].y, c};
      for (const std::uint32_t t : of[c]) {
        rank.area += std::abs(twice_area(taken_.texels[t]));
        for (const Vec2d p : taken_.texels[t])
          rank.x = std::min(rank.x, p.x), rank.y = std::min(rank.y, p.y);
      }
      ranks.push_back(rank);
    }
    sort_total(ranks.begin(), ranks.end(), [](const Rank& a, const Rank& b) {
      return std::tuple(-a.area, a.x, a.y, a.chart) < std::tuple(-b.area, b.x, b.y, b.chart);
    });
    std::vector<std::uint32_t> order;
    for (const Rank& rank : ranks) order.push_back(rank.chart);
    return order;
  }

  void leave_out_overlaps() {
    std::vector<std::vector<std::uint32_t>> of(taken_.chart_page.size());
    for (std::uint32_t t = 0; t < taken_.chart.size(); ++t) {
      if (taken_.chart[t] != kNoIndex) of[taken_.chart[t]].push_back(t);
    }
    const double rounding = rounding_of(pair_.earlier.pages);
    const auto gap = [&](std::uint32_t) { return -rounding; };
    std::vector<std::uint32_t> added;
    for (const std::uint32_t c : charts_by_size(of)) {
      added.clear();
      bool overlaps = false;
      for (std::size_t i = 0; i < of[c].size() && !overlaps; ++i) {
        PageGrid::Place place{taken_.chart_page[c], taken_.texels[of[c][i]]};
        if (twice_area(place.corners) < 0) std::swap(place.corners[1], place.corners[2]);
        if (twice_area(place.corners) <= rounding * rounding) continue;  // closed by rounding
        // A moved triangle has no place yet of its own.
        if (taken_.state[of[c][i]] == TakenState::moved) continue;
        overlaps = grid_.meets(place, gap, 0);
        if (!overlaps) added.push_back(grid_.add(place, c));
      }
      if (!overlaps) continue;
      for (const std::uint32_t number : added) grid_.remove(number);
      for (const std::uint32_t t : of[c]) leave(t);
    }
  }

  // An edge of a triangle that has its uvs is a seam where it was one.
  void mark_seams() {
    taken_.seams.assign(pair_.mesh.corners.size(), 0);
    for (std::uint32_t h = 0; h < taken_.seams.size(); ++h) {
      if (taken_.chart[h / 3] == kNoIndex) continue;
      const TriangleMatch& match = matches_[h / 3];
      const std::uint32_t from = match.corners[h % 3], to = match.corners[(h + 1) % 3];
      const std::uint32_t was = 3 * match.earlier + ((from + 1) % 3 == to ? from : to);
      const std::uint32_t across = pair_.earlier_mesh.across[was];
      const bool known = across != kNoIndex && charts_.chart(across / 3) != kNoIndex;
      taken_.seams[h] = known && !charts_.continues(was);
    }
  }

  const UvPair& pair_;
  PageGrid& grid_;
  EarlierCharts charts_;
  std::vector<TriangleMatch> matches_;
  TakenUvs taken_;
};

}  // namespace

double rounding_of(std::span<const Extent> pages) {
  std::int32_t longest = 1;
  for (const Extent& page : pages) longest = std::max({longest, page.width, page.height});
  return 4 * kUvSlack * longest;
}

TakenUvs take_uvs(const UvPair& pair, PageGrid& grid) {
  return UvTaker(pair, grid).run();
}

}  // namespace atlas
