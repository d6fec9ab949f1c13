#include "libatlas/unwrap/blocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libatlas/core/counted.h"
#include "libatlas/core/progress.h"
#include "libatlas/unwrap/place_charts.h"

namespace atlas {
namespace {

// How often densities are tried, and from what share on the largest one that fits is near enough.
constexpr int kRounds = 24, kFreeRounds = 6;
constexpr double kNear = 1.02, kShortOf = 0.98, kMostGrowth = 8;
constexpr int kHalvings = 12;
// Where half the density leaves rectangles this share of their texels, gutters are what is left.
constexpr double kGuttersLeft = 0.98;
// The share of the pages that the first density would fill.
constexpr double kFirstFill = 0.6;

class BlockPacker {
 public:
  BlockPacker(std::span<const BlockMesh> meshes, const UnwrapOptions& options,
              const Context& context)
      : meshes_(meshes), options_(options), context_(context), quiet_(context) {
    quiet_.progress = nullptr;
  }

  Result<Blocks> run() {
    if (Status s = check_options(options_); !s.ok()) return s;
    if (least_room() > double(options_.pages) * options_.page_size * options_.page_size)
      return no_room();
    if (Status s = make_all_charts(); !s.ok()) return s;
    double density = options_.texels_per_unit > 0 ? options_.texels_per_unit : first_density();
    const bool free = !(options_.texels_per_unit > 0);
    // Charts are laid out fast until a density fits, and then as well as is asked for.
    bool last = false;
    for (int round = 0; round < kRounds; ++round) {
      context_.report("packing", double(round) / kRounds);
      const PackPreset preset = last ? options_.preset : PackPreset::fast;
      if (Status s = lay_out(density, preset); !s.ok()) return s;
      density = density_;
      const Result<double> scale = largest_scale(free && !last ? kMostGrowth : 1);
      if (!scale.ok()) return scale.status();
      const bool fits = *scale >= 1;
      if (fits && last) return finish();
      if (!fits && !may_shrink()) break;
      last = last || (fits && (!free || *scale < kNear || round >= kFreeRounds));
      if (!fits || !last) density *= fits ? *scale : std::max(*scale, 1 / kMostGrowth) * kShortOf;
    }
    return no_room();
  }

 private:
  Status make_all_charts() {
    const double count = double(meshes_.size());
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      const Context part =
          part_of_stage(context_, "charts", double(i) / count, double(i + 1) / count);
      Result<ChartSet> made = make_charts(meshes_[i].mesh, options_.charts, part);
      if (!made.ok()) return made.status();
      charts_.push_back(std::move(*made));
    }
    return {};
  }

  double least(std::size_t mesh) const {
    return double{
        *std::min_element(meshes_[mesh].densities.begin(), meshes_[mesh].densities.end())};
  }

  // Returns the texels that the instances' gutters take at least.
  double least_room() const {
    double count = 0;
    for (const BlockMesh& mesh : meshes_) count += double(mesh.densities.size());
    const double side = 1 + 2.0 * padding_of(options_);
    return count * side * side;
  }

  double first_density() const {
    double area = 0;
    for (std::size_t i = 0; i < meshes_.size(); ++i)
      for (const float d : meshes_[i].densities)
        area += double{d} * double{d} * charts_[i].distortion.uv_area;
    const double texels = double(options_.pages) * options_.page_size * options_.page_size;
    return area > 0 ? std::sqrt(kFirstFill * texels / area) : 1;
  }

  // Lays out each mesh at this density, or all at the lower one that a page can hold.
  Status lay_out(double density, PackPreset preset) {
    UnwrapOptions own = options_;
    own.preset = preset;
    own.pages = 1;
    own.square = false;
    own.padding = padding_of(options_);
    // Cells of mip levels are whole in rectangles of the same scale only.
    own.padding += instances_differ() ? alignment_of(options_) : 0;
    for (bool again = true; again;) {
      again = false;
      density_ = density;
      placed_.clear();
      for (std::size_t i = 0; i < meshes_.size(); ++i) {
        own.texels_per_unit = density * least(i);
        Result<UnwrappedMesh> placed = place_charts(meshes_[i].mesh, charts_[i], own, quiet_);
        if (!placed.ok()) return placed.status();
        const double reached = placed->texels_per_unit / own.texels_per_unit;
        again = reached < 1 - 1e-6;
        if (again) density *= reached * kShortOf;
        if (again) break;
        placed_.push_back(std::move(*placed));
      }
    }
    return {};
  }

  // Returns whether the rectangles, which do not fit, have become smaller with their density.
  bool may_shrink() {
    double texels = 0;
    for (const Extent& e : extents(1)) texels += double(e.area());
    const bool may = density_ > failed_density_ / 2 || texels < kGuttersLeft * failed_texels_;
    failed_density_ = density_;
    failed_texels_ = texels;
    return may;
  }

  bool instances_differ() const {
    const auto differ = [](const BlockMesh& mesh) {
      const auto& all = mesh.densities;
      return std::any_of(all.begin(), all.end(), [&](float d) { return d != all.front(); });
    };
    return options_.mip_levels > 0 && std::any_of(meshes_.begin(), meshes_.end(), differ);
  }

  // Returns the rectangles of all instances, mesh by mesh.
  std::vector<Extent> extents(double scale) const {
    std::vector<Extent> all;
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      const Extent own = placed_[i].pages[0];
      for (const float d : meshes_[i].densities) {
        const double by = scale * double{d} / least(i);
        const auto side = [&](std::int32_t texels) {
          const double most = 2.0 * options_.page_size;  // which is too large anyway
          return std::int32_t(std::ceil(std::min(by * texels, most) * (1 - 1e-12)));
        };
        all.push_back({side(own.width), side(own.height)});
      }
    }
    return all;
  }

  Result<PackResult> pack(double scale, PackPreset preset) const {
    PackOptions pack;
    pack.page = {options_.page_size, options_.page_size};
    pack.max_pages = options_.pages;
    pack.padding = 2 * padding_of(options_);  // each side keeps its own
    pack.alignment = alignment_of(options_);
    pack.crop = true;
    pack.power_of_two = pack.square = options_.square || options_.pages > 1;
    pack.preset = preset;
    return pack_rects(extents(scale), pack, quiet_);
  }

  // Returns the largest scale of the rectangles at which all fit, up to `most`; below 1 /
  // kMostGrowth, 0.
  Result<double> largest_scale(double most) const {
    const auto fits = [&](double scale) -> Result<bool> {
      const Result<PackResult> packed = pack(scale, PackPreset::fast);
      if (!packed.ok()) return packed.status();
      return packed->unplaced.empty();
    };
    double low = 0, high = most;
    for (const double scale : {1.0, most}) {
      const Result<bool> ok = fits(scale);
      if (!ok.ok()) return ok.status();
      if (!*ok) {
        high = scale;
        break;
      }
      low = scale;
    }
    if (low == most) return most;
    if (low == 0) low = 1 / kMostGrowth;
    for (int i = 0; i < kHalvings && high / low > 1.002; ++i) {
      const double middle = std::sqrt(low * high);
      const Result<bool> ok = fits(middle);
      if (!ok.ok()) return ok.status();
      (*ok ? low : high) = middle;
    }
    return low;
  }

  Result<Blocks> finish() {
    const PackPreset preset =
        options_.preset == PackPreset::fast ? PackPreset::fast : PackPreset::standard;
    const Result<PackResult> packed = pack(1, preset);
    if (!packed.ok()) return packed.status();
    if (!packed->unplaced.empty()) return no_room();
    Blocks out;
    out.pages = packed->pages;
    out.texels_per_unit = density_;
    double used = 0, room = 0;
    for (const Extent& page : out.pages) room += double(page.area());
    const std::vector<Extent> sides = extents(1);
    std::size_t next = 0;
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
      out.instances.emplace_back();
      out.rects.emplace_back();
      const Extent own = placed_[i].pages[0];
      for (const float d : meshes_[i].densities) {
        const Placement& at = packed->placements[next];
        const Extent page = out.pages[at.page];
        const double by = double{d} / least(i);
        out.instances.back().push_back(
            {at.page,
             {float(by * own.width / page.width), float(by * own.height / page.height)},
             {float(double(at.x) / page.width), float(double(at.y) / page.height)}});
        out.rects.back().push_back({at.x, at.y, sides[next].width, sides[next].height});
        used += by * by * placed_[i].utilization * double(own.area());
        ++next;
      }
    }
    out.utilization = room > 0 ? used / room : 0;
    out.meshes = std::move(placed_);
    context_.report("packing", 1);
    return out;
  }

  Status no_room() const {
    std::size_t count = 0;
    for (const BlockMesh& mesh : meshes_) count += mesh.densities.size();
    return {ErrorCode::no_solution,
            fmt::format("unwrap: {} of meshes do not fit {} of {} x {} (ask for more pages, a "
                        "larger page_size, less padding or fewer mip_levels)",
                        counted(count, "instance"), counted(options_.pages, "page"),
                        options_.page_size, options_.page_size)};
  }

  std::span<const BlockMesh> meshes_;
  const UnwrapOptions& options_;
  const Context& context_;
  Context quiet_;
  std::vector<ChartSet> charts_;  // of each mesh, before they are cut for a page
  double density_ = 0;            // of placed_
  // Of the last rectangles that did not fit.
  double failed_density_ = 0, failed_texels_ = 0;
  std::vector<UnwrappedMesh> placed_;
};

}  // namespace

Result<Blocks> unwrap_blocks(std::span<const BlockMesh> meshes, const UnwrapOptions& options,
                             const Context& context) {
  return BlockPacker(meshes, options, context).run();
}

}  // namespace atlas
