#include "libatlas/pack/outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "libatlas/core/clock.h"
#include "libatlas/core/is_enumerator.h"
#include "libatlas/core/parallel.h"
#include "libatlas/pack/nesting/grid_choice.h"
#include "libatlas/pack/nesting/nest.h"
#include "libatlas/pack/outlines/shape_check.h"

namespace atlas {
namespace {

using pack::BitPage;
using pack::Nest;
using pack::NestPlan;
using pack::Piece;

// Runs one task per chain, on up to context.threads threads.
void parallel_chains(const Context& context, std::size_t chains,
                     const std::function<void(std::size_t)>& run) {
  parallel_for(context, chains, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) run(c);
  });
}

// Maximum side of a page, and of a chart on an open page.
constexpr std::int32_t kMostTexels = 1 << 17;

Status check(std::span<const ChartShape> shapes, const OutlineOptions& o) {
  if (o.page.width < 1 || o.page.height < 0 || o.page.width > kMostTexels ||
      o.page.height > kMostTexels || o.alignment < 1 || o.padding < 0 || o.border < 0 ||
      o.alignment > o.page.width || o.padding > (1 << 12) || o.border > (1 << 16))
    return {ErrorCode::bad_option,
            fmt::format("outline: page {} x {}, padding {}, border {}, alignment {} (page in 1 .. "
                        "2^17, height 0 for a strip, alignment 1 .. page width, others not "
                        "negative)",
                        o.page.width, o.page.height, o.padding, o.border, o.alignment)};
  if (!(o.scale > 0) || !std::isfinite(o.scale))
    return {ErrorCode::bad_option, "outline: scale must be finite and above 0"};
  if (!(o.time_budget >= 0))
    return {ErrorCode::bad_option, "outline: time_budget is negative or not a number"};
  if (!is_enumerator(o.preset, PackPreset::best))
    return {ErrorCode::bad_option,
            fmt::format("outline: preset {} (give a PackPreset)", int(o.preset))};
  if (Status s = pack::check_rotations(o.rotations); !s.ok()) return s;
  return pack::check_shapes(shapes);
}

// The page in cells, without its border.
struct Grid {
  std::int32_t cell = 1, origin = 0;  // in texels
  std::uint32_t directions = 4;
  Extent page;  // in cells
  bool open = false;
};

constexpr std::int32_t kOpenRows = 1 << 22;

// `standard` examines about this many words, which take 2 to 5 ns each.
constexpr double kStandardWork = 60e6, kAffordable = 100e6;

Grid make_grid(std::size_t count, const OutlineOptions& o) {
  Grid grid;
  grid.open = o.page.height == 0;
  const std::int32_t side =
      grid.open ? o.page.width
                : static_cast<std::int32_t>(std::sqrt(double(o.page.width) * o.page.height));
  const std::size_t a_page = o.max_pages > 1 ? count / o.max_pages + 1 : count;
  const bool fast = o.preset == PackPreset::fast;
  const pack::GridChoice choice =
      pack::choose_grid({a_page, side, o.alignment, fast ? std::min(o.rotations, 4u) : o.rotations,
                         fast ? 0.2 * kAffordable : kAffordable});
  grid.cell = choice.cell;
  grid.directions = choice.directions;
  // Cells are a power of two times the alignment, but the border is only rounded up to the
  // alignment.
  grid.origin = (o.border + o.alignment - 1) / o.alignment * o.alignment;
  const auto cells = [&](std::int32_t texels) {
    return std::max(0, (texels - o.border - grid.origin) / grid.cell);
  };
  grid.page = {cells(o.page.width), grid.open ? kOpenRows : cells(o.page.height)};
  return grid;
}

struct OnePage {
  Nest nest;
  std::uint64_t layouts_tried = 0;
};

// Searches over plans on a single page. `best` runs a few chains, and the best result is returned.
OnePage search_one_page(std::span<const Piece> pieces, const Grid& grid, const OutlineOptions& o,
                        const Context& context) {
  pack::NestSearchOptions s;
  s.width = grid.page.width;
  s.seed = o.seed;
  s.enough = grid.open ? 0 : grid.page.height;
  const NestPlan start = pack::plan_by_size(pieces);
  if (o.preset == PackPreset::fast) s.layouts = 1;
  if (o.preset == PackPreset::standard) s.work = static_cast<std::uint64_t>(kStandardWork);
  const std::size_t chains = o.preset == PackPreset::best ? 4 : 1;
  double seconds = std::numeric_limits<double>::infinity();
  if (o.preset == PackPreset::best) {
    // If there are fewer threads than chains, the chains run one after another and share the time.
    seconds = o.time_budget * std::min(1.0, double(thread_count(context)) / double(chains));
    if (o.effort) s.layouts = std::max<std::uint64_t>(1, o.effort / chains);
  }
  std::vector<pack::NestSearchResult> found(chains);
  parallel_chains(context, chains, [&](std::size_t c) {
    pack::NestSearchOptions own = s;
    own.seed = s.seed * 0x10001 + c;
    own.deadline = wall_seconds() + seconds;
    found[c] = pack::search_nest(pieces, start, own, context);
  });
  OnePage page;
  std::size_t best = 0;
  for (std::size_t c = 0; c < chains; ++c) {
    page.layouts_tried += found[c].layouts;
    const Nest &nest = found[c].nest, &least = found[best].nest;
    if (nest.left_over.size() < least.left_over.size() ||
        (nest.left_over.size() == least.left_over.size() && nest.used_height < least.used_height))
      best = c;
  }
  page.nest = std::move(found[best].nest);
  return page;
}

// Fills page after page with the remaining pieces, largest first.
std::vector<Nest> fill_pages(std::span<const Piece> pieces, const Grid& grid,
                             const OutlineOptions& o) {
  std::vector<Nest> nests;
  NestPlan plan = pack::plan_by_size(pieces);
  const std::int32_t longest = pack::longest_run(pieces);
  while (!plan.order.empty() && (o.max_pages == 0 || nests.size() < o.max_pages)) {
    BitPage page(grid.page.width, grid.page.height, longest);
    Nest nest;
    pack::place_pieces(pieces, plan, page, nest);
    if (nest.left_over.size() == plan.order.size()) break;  // nothing fits an empty page
    plan.order = nest.left_over;
    nests.push_back(std::move(nest));
  }
  return nests;
}

// Writes one page's nest into the result. The caller lists the pieces that no page holds.
void write_page(std::span<const Piece> pieces, const Nest& nest, const Grid& grid,
                OutlineResult& result) {
  const auto page = static_cast<std::uint32_t>(result.pages.size());
  result.pages.emplace_back();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const pack::NestPlace& p = nest.places[i];
    if (!p.placed) continue;
    OutlinePlacement& out = result.placements[i];
    const pack::Mask& mask = pieces[i].masks[p.direction];
    out.page = page;
    out.angle = 2 * std::numbers::pi * p.direction / grid.directions;
    out.box = {grid.origin + p.at.x * grid.cell, grid.origin + p.at.y * grid.cell,
               mask.width * grid.cell, mask.height * grid.cell};
    out.offset = {out.box.x + pieces[i].origins[p.direction].x,
                  out.box.y + pieces[i].origins[p.direction].y};
  }
}

// Returns the place of a chart that covers no cell.
OutlinePlacement corner_place(const pack::ChartOutline& outline, double scale) {
  const Vec2d low = pack::low_corner_of(outline);
  OutlinePlacement place;
  place.page = 0;
  place.offset = {-scale * low.x, -scale * low.y};
  return place;
}

}  // namespace

Result<OutlineResult> pack_outlines(std::span<const ChartShape> shapes,
                                    const OutlineOptions& options, const Context& context) {
  if (Status status = check(shapes, options); !status.ok()) return status;
  OutlineResult result;
  result.placements.resize(shapes.size());
  const Grid grid = make_grid(shapes.size(), options);
  pack::PieceOptions piece_options;
  piece_options.factor = options.scale;
  piece_options.padding = options.padding;
  piece_options.cell = grid.cell;
  piece_options.directions = grid.directions;
  piece_options.page = grid.page;
  if (grid.open) piece_options.page.height = kMostTexels / grid.cell;
  const std::vector<pack::ChartOutline> outlines = pack::outlines_of(shapes, context);
  const std::vector<Piece> pieces = pack::make_pieces(outlines, piece_options, context);
  if (context.cancelled()) return Status::cancelled();

  // A search for one page is only useful if all charts may fit it.
  double cells = 0;
  bool one_page = options.max_pages == 1 || grid.open;
  for (const Piece& p : pieces) {
    cells += static_cast<double>(p.cells());
    one_page = one_page && !p.too_large;
  }
  one_page = one_page && (grid.open || cells <= static_cast<double>(grid.page.area()));
  std::vector<Nest> nests;
  if (one_page) {
    OnePage one = search_one_page(pieces, grid, options, context);
    result.layouts_tried = one.layouts_tried;
    const bool fits = one.nest.left_over.empty() && one.nest.used_height <= grid.page.height;
    if (fits)
      nests.push_back(std::move(one.nest));
    else
      nests = fill_pages(pieces, grid, options);
  } else {
    nests = fill_pages(pieces, grid, options);
    result.layouts_tried = 1;
  }
  if (context.cancelled()) return Status::cancelled();

  double area = 0;
  for (const Nest& nest : nests) {
    write_page(pieces, nest, grid, result);
    Extent& page = result.pages.back();
    page = options.page;
    if (grid.open) page.height = grid.origin + nest.used_height * grid.cell + options.border;
    area += static_cast<double>(page.area());
  }
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    if (result.placements[i].page != kNoPage)
      result.shape_area += outlines[i].area * options.scale * options.scale;
    else if (pieces[i].cells() > 0 || pieces[i].too_large)
      result.unplaced.push_back(i);
    else
      result.placements[i] = corner_place(outlines[i], options.scale);
  }
  result.utilization = area > 0 ? result.shape_area / area : 0;
  return result;
}

}  // namespace atlas
