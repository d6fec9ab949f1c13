#include "libatlas/pack/beside.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libatlas/pack/nesting/nest.h"
#include "libatlas/pack/outlines/mask_runs.h"
#include "libatlas/pack/outlines/shape_check.h"

namespace atlas {
namespace {

using pack::BitPage;
using pack::ChartOutline;
using pack::Mask;
using pack::Nest;
using pack::Piece;

constexpr std::int32_t kLongestPage = 16384;
// Cells are doubled until a page has at most so many along each side, which bounds its memory to
// some 30 MB.
constexpr std::int32_t kMostCellsAlong = 4096;
constexpr std::uint32_t kDirections = 16;

class FreeRoom {
 public:
  FreeRoom(std::span<const ChartShape> shapes, const TakenPages& taken, const PageOptions& options,
           const Context& context)
      : shapes_(shapes), taken_(taken), options_(options), context_(context) {
    pages_.assign(taken.pages.begin(), taken.pages.end());
    for (const TakenShape& t : taken.shapes) outlines_.push_back(pack::outline_of(t.shape));
    shape_outlines_ = pack::outlines_of(shapes, context);
  }

  Result<BesideResult> run() {
    while (!place_all()) {
      if (context_.cancelled()) return Status::cancelled();
      if (!grow())
        return Status(ErrorCode::no_solution,
                      fmt::format("pages: {} of {} shapes find no room beside those that stay, on "
                                  "pages of up to {} texels",
                                  left_over_.size(), shapes_.size(), kLongestPage));
    }
    if (context_.cancelled()) return Status::cancelled();
    return BesideResult{std::move(placements_), std::move(pages_)};
  }

 private:
  // Tries to place all shapes on the present pages.
  bool place_all() {
    placements_.assign(shapes_.size(), {});
    choose_cell();
    if (context_.cancelled()) return false;
    const std::vector<Piece>& pieces = pieces_;
    pack::NestPlan plan = pack::plan_by_size(pieces);
    for (std::uint32_t p = 0; p < pages_.size() && !plan.order.empty(); ++p) {
      BitPage page(pages_[p].width / cell_, pages_[p].height / cell_, pack::longest_run(pieces));
      take(p, page);
      Nest nest;
      pack::place_pieces(pieces, plan, page, nest);
      for (const std::uint32_t i : plan.order) note(pieces[i], nest.places[i], p, i);
      plan.order = nest.left_over;
    }
    left_over_ = plan.order;
    note_empty(pieces);
    return left_over_.empty();
  }

  std::uint32_t directions() const { return options_.allow_rotation ? kDirections : 1; }

  // Chooses cells for the present pages, and draws the shapes in them if they have changed.
  void choose_cell() {
    std::int32_t longest = 1;
    for (const Extent& page : pages_) longest = std::max({longest, page.width, page.height});
    std::int32_t cell = options_.alignment;
    while (longest / cell > kMostCellsAlong) cell *= 2;
    if (cell == cell_) return;
    cell_ = cell;
    pack::PieceOptions how;
    how.padding = options_.padding;
    how.cell = cell_;
    how.directions = directions();
    pieces_ = pack::make_pieces(shape_outlines_, how, context_);
  }

  // Takes the cells of the shapes that stay.
  void take(std::uint32_t p, BitPage& page) const {
    pack::RunSet set;
    for (std::size_t i = 0; i < outlines_.size(); ++i) {
      if (taken_.shapes[i].page == p) add_cells(outlines_[i], page, set);
    }
    if (set.items.empty()) return;
    const Mask mask = set.build();
    page.put(mask, {set.left(), set.bottom()});
  }

  void add_cells(const ChartOutline& outline, const BitPage& page, pack::RunSet& set) const {
    const Vec2d low = pack::low_corner_of(outline);
    const auto beyond = [&](double corner) {
      const double at = options_.padding - corner;
      return cell_ * std::ceil(at / cell_) - at;
    };
    pack::RasterOptions raster;
    raster.padding = options_.padding;
    raster.cell = cell_;
    raster.shift = {beyond(low.x), beyond(low.y)};
    Vec2d origin;
    const Mask mask = pack::rasterize(outline, raster, origin);
    const auto cells = [&](double texels) {
      return static_cast<std::int32_t>(std::lround(-texels / cell_));
    };
    const std::int32_t left = cells(origin.x), bottom = cells(origin.y);
    for (std::int32_t r = 0; r < mask.height; ++r) {
      if (bottom + r < 0 || bottom + r >= page.height()) continue;
      for (const pack::Run& run : mask.row(r)) {
        const std::int32_t begin = std::max(0, left + run.begin),
                           end = std::min(page.width(), left + run.end);
        if (begin < end) set.items.push_back({bottom + r, {begin, end}});
      }
    }
  }

  void note(const Piece& piece, const pack::NestPlace& place, std::uint32_t page,
            std::uint32_t shape) {
    if (!place.placed) return;
    OutlinePlacement& out = placements_[shape];
    const Mask& mask = piece.masks[place.direction];
    out.page = page;
    out.angle = 2 * std::numbers::pi * place.direction / directions();
    out.box = {place.at.x * cell_, place.at.y * cell_, mask.width * cell_, mask.height * cell_};
    out.offset = {out.box.x + piece.origins[place.direction].x,
                  out.box.y + piece.origins[place.direction].y};
  }

  // Shapes without corners take no space.
  void note_empty(const std::vector<Piece>& pieces) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (pieces[i].cells() == 0 && !pieces[i].too_large) placements_[i].page = 0;
    }
  }

  // Adds a page or makes pages larger. Returns false if they cannot become larger.
  bool grow() {
    Extent& last = pages_.back();
    if (pages_.size() < options_.pages) {
      pages_.push_back(Extent{last});
      return true;
    }
    if (options_.square) {
      for (Extent& page : pages_) {
        if (2 * std::max(page.width, page.height) > kLongestPage) return false;
        page = {2 * page.width, 2 * page.height};
      }
      return true;
    }
    // A quarter more each time: a page keeps little room that nothing needs.
    const auto longer = [&](std::int32_t side) {
      const std::int32_t cells = std::max(1, side / options_.alignment);
      return std::min(kLongestPage, options_.alignment * (cells + std::max(1, cells / 4)));
    };
    std::int32_t& side =
        last.height <= last.width || last.width == kLongestPage ? last.height : last.width;
    const std::int32_t grown = longer(side);
    if (grown <= side) return false;
    side = grown;
    return true;
  }

  std::span<const ChartShape> shapes_;
  const TakenPages& taken_;
  const PageOptions& options_;
  const Context& context_;
  std::vector<Extent> pages_;
  std::vector<ChartOutline> outlines_, shape_outlines_;  // of the taken shapes; of the others
  std::int32_t cell_ = 0;                                // texels
  std::vector<Piece> pieces_;                            // of the others, in cells
  std::vector<OutlinePlacement> placements_;
  std::vector<std::uint32_t> left_over_;
};

Status check(const TakenPages& taken, const PageOptions& options) {
  const auto bad = [](std::string text) { return Status(ErrorCode::bad_input, std::move(text)); };
  if (options.padding < 0 || options.padding > (1 << 12) || options.alignment < 1 ||
      options.alignment > (1 << 12))
    return {ErrorCode::bad_option,
            fmt::format("pages: padding {}, alignment {} (0 .. 4096 and 1 .. 4096)",
                        options.padding, options.alignment)};
  if (taken.pages.empty()) return bad("pages: none (give at least one)");
  for (std::size_t p = 0; p < taken.pages.size(); ++p) {
    const auto [width, height] = taken.pages[p];
    if (width < 1 || height < 1 || std::max(width, height) > kLongestPage)
      return bad(fmt::format("pages: page {} is {} x {} (sides of 1 .. {})", p, width, height,
                             kLongestPage));
  }
  for (std::size_t i = 0; i < taken.shapes.size(); ++i) {
    if (taken.shapes[i].page >= taken.pages.size())
      return bad(fmt::format("pages: taken shape {} is on page {} of {}", i, taken.shapes[i].page,
                             taken.pages.size()));
  }
  return {};
}

}  // namespace

Result<BesideResult> pack_beside(std::span<const ChartShape> shapes, const TakenPages& taken,
                                 const PageOptions& options, const Context& context) {
  if (Status s = check(taken, options); !s.ok()) return s;
  if (Status s = pack::check_shapes(shapes); !s.ok()) return s;
  std::vector<ChartShape> fixed;
  for (const TakenShape& t : taken.shapes) fixed.push_back(t.shape);
  if (Status s = pack::check_shapes(fixed); !s.ok()) return s;
  return FreeRoom(shapes, taken, options, context).run();
}

}  // namespace atlas
