#include "libatlas/bake/page_owners.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

#include "libatlas/bake/chart_box.h"
#include "libatlas/bake/ownership.h"
#include "libatlas/charts/chart_triangles.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

constexpr std::uint8_t kOne = 1, kSeveral = 2;  // values of `taken`

class OwnerFinder {
 public:
  OwnerFinder(const ChartSet& charts, std::span<const ChartPlacement> placements,
              const BakeOptions& options)
      : charts_(charts), placements_(placements), options_(options) {}

  PageOwners run(const Context& context) {
    out_.runs.resize(placements_.size());
    parallel_for(context, placements_.size(), 1,
                 [&](std::size_t i, std::size_t) { out_.runs[i] = claimed(i); });
    out_.taken.assign(std::size_t(options_.page_width) * std::size_t(options_.page_height), 0);
    for (const std::vector<TexelRun>& runs : out_.runs) {
      for (const TexelRun& run : runs) take(run);
    }
    out_.contested =
        static_cast<std::uint64_t>(std::count(out_.taken.begin(), out_.taken.end(), kSeveral));
    if (out_.contested > 0 && !context.cancelled()) settle(context);
    return std::move(out_);
  }

 private:
  ChartBox box(std::size_t i) const { return {placements_[i], options_}; }

  std::vector<TexelTriangle> triangles(const ChartBox& box) const {
    std::vector<TexelTriangle> triangles;
    for (const std::uint32_t t : triangles_of(charts_, box.chart(charts_)))
      triangles.push_back(box.triangle(charts_, t));
    return triangles;
  }

  OwnershipGrid grid(const ChartBox& box) const {
    return {box.width, box.height, box.pad, 1 << options_.mip_levels};
  }

  std::vector<TexelRun> claimed(std::size_t i) const {
    const ChartBox box = this->box(i);
    std::vector<TexelRun> runs;
    if (!box.placement.outlined) {
      for (int j = 0; j < box.height; ++j)
        runs.push_back({box.left(), box.bottom() + j, box.width});
      return runs;
    }
    const std::vector<std::uint8_t> own = owned_texels(triangles(box), grid(box));
    for (int j = 0; j < box.height; ++j) {
      const auto row = own.begin() + std::ptrdiff_t{j} * box.width, last = row + box.width;
      for (auto at = std::find(row, last, 1), end = at; at != last; at = std::find(end, last, 1)) {
        end = std::find(at, last, 0);
        runs.push_back({box.left() + int(at - row), box.bottom() + j, int(end - at)});
      }
    }
    return runs;
  }

  std::size_t index(const TexelRun& run) const {
    return std::size_t(run.y) * std::size_t(options_.page_width) + std::size_t(run.x);
  }

  void take(const TexelRun& run) {
    const auto first = out_.taken.begin() + static_cast<std::ptrdiff_t>(index(run));
    std::transform(first, first + run.length, first,
                   [](std::uint8_t before) { return before == 0 ? kOne : kSeveral; });
  }

  // Calls visit(texel) for each contested texel of a placement, in the order of its runs.
  template <class Visit>
  void each_contested(std::size_t i, const Visit& visit) const {
    for (const TexelRun& run : out_.runs[i]) {
      for (std::size_t at = index(run), end = at + std::size_t(run.length); at < end; ++at)
        if (out_.taken[at] == kSeveral) visit(at);
    }
  }

  // Returns how far each contested texel of a placement is from its triangles or inner box, in
  // texels.
  std::vector<std::uint16_t> distances(std::size_t i) const {
    std::vector<std::uint16_t> found;
    const ChartBox box = this->box(i);
    std::vector<std::uint16_t> from_triangles;
    const auto width = std::size_t(options_.page_width);
    each_contested(i, [&](std::size_t at) {
      const int x = int(at % width) - box.left(), y = int(at / width) - box.bottom();
      if (!box.placement.outlined) {
        const int across = std::max(box.pad - x, x - (box.pad + box.placement.width - 1)),
                  along = std::max(box.pad - y, y - (box.pad + box.placement.height - 1));
        found.push_back(static_cast<std::uint16_t>(std::max({0, across, along})));
        return;
      }
      if (from_triangles.empty()) from_triangles = texels_to_triangles(triangles(box), grid(box));
      found.push_back(from_triangles[std::size_t(y) * std::size_t(box.width) + std::size_t(x)]);
    });
    return found;
  }

  void settle(const Context& context) {
    std::vector<std::vector<std::uint16_t>> distance(placements_.size());
    parallel_for(context, placements_.size(), 1,
                 [&](std::size_t i, std::size_t) { distance[i] = distances(i); });
    if (context.cancelled()) return;
    std::vector<std::uint32_t> order(placements_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return placements_[a].chart < placements_[b].chart;
    });
    std::vector<std::uint32_t> owner(out_.taken.size(), kNoIndex);
    std::vector<std::uint16_t> nearest(out_.taken.size(), 0);
    for (const std::uint32_t i : order) {
      std::size_t k = 0;
      each_contested(i, [&](std::size_t at) {
        const std::uint16_t d = distance[i][k++];
        if (owner[at] != kNoIndex && d >= nearest[at]) return;
        owner[at] = i;
        nearest[at] = d;
      });
    }
    name_first(order);
    for (std::size_t i = 0; i < placements_.size(); ++i) give_up(i, owner);
  }

  // Stores the lowest contested texel, and the two lowest charts that claim it.
  void name_first(const std::vector<std::uint32_t>& order) {
    const auto first =
        std::size_t(std::find(out_.taken.begin(), out_.taken.end(), kSeveral) - out_.taken.begin());
    out_.x = static_cast<std::int32_t>(first % std::size_t(options_.page_width));
    out_.y = static_cast<std::int32_t>(first / std::size_t(options_.page_width));
    std::size_t named = 0;
    for (const std::uint32_t i : order) {
      const std::vector<TexelRun>& runs = out_.runs[i];
      const bool claims = std::any_of(runs.begin(), runs.end(), [&](const TexelRun& run) {
        return run.y == out_.y && run.x <= out_.x && out_.x < run.x + run.length;
      });
      if (claims && named < 2) out_.charts[named++] = placements_[i].chart;
    }
  }

  // Removes from the runs of a placement the texels that other placements own.
  void give_up(std::size_t i, const std::vector<std::uint32_t>& owner) {
    std::vector<TexelRun> left;
    for (const TexelRun& run : out_.runs[i]) {
      const std::size_t first = index(run);
      const auto own = [&](std::int32_t k) {
        const std::size_t at = first + std::size_t(k);
        return out_.taken[at] != kSeveral || owner[at] == i;
      };
      for (std::int32_t k = 0, end = 0; k < run.length; k = end) {
        for (end = k + 1; end < run.length && own(end) == own(k);) ++end;
        if (own(k)) left.push_back({run.x + k, run.y, end - k});
      }
    }
    out_.runs[i] = std::move(left);
  }

  const ChartSet& charts_;
  std::span<const ChartPlacement> placements_;
  const BakeOptions& options_;
  PageOwners out_;
};

}  // namespace

PageOwners find_owners(const ChartSet& charts, std::span<const ChartPlacement> placements,
                       const BakeOptions& options, const Context& context) {
  return OwnerFinder(charts, placements, options).run(context);
}

}  // namespace atlas
