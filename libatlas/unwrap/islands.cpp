#include "libatlas/unwrap/islands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "libatlas/core/counted.h"
#include "libatlas/core/disjoint_sets.h"
#include "libatlas/core/no_index.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/pack/fit.h"
#include "libatlas/param/orient.h"
#include "libatlas/unwrap/check_pages.h"

namespace atlas {
namespace {

constexpr float kFarthestUv = 1e6f;
// Effort is limited instead of time, so that results do not depend on how busy the machine is.
constexpr std::uint64_t kMostLayouts = 2000;

Status check(const IslandOptions& o) {
  if (Status s = check_pages("islands", o); !s.ok()) return s;
  if (!(o.texels_per_uv >= 0) || !std::isfinite(o.texels_per_uv))
    return {ErrorCode::bad_option,
            fmt::format("islands: texels_per_uv is {} (a number above 0, or 0 for as many as fit)",
                        o.texels_per_uv)};
  return {};
}

Status check(const IslandView& view) {
  const std::size_t corners = view.indices.size();
  const auto bad = [](const std::string& text) {
    return Status(ErrorCode::bad_input, "islands: " + text);
  };
  if (corners < 3) return bad("no triangle (nothing to pack)");
  if (corners % 3 != 0) return bad(fmt::format("{} indices are not whole triangles", corners));
  if (corners / 3 >= std::size_t{1} << 30)
    return {ErrorCode::unsupported, "islands: more than 2^30 triangles (split them)"};
  for (std::size_t i = 0; i < corners; ++i) {
    const std::uint32_t uv = view.indices[i];
    if (uv >= view.uvs.size())
      return bad(
          fmt::format("triangle {}: index {} names none of the {} uvs (indices count from 0)",
                      i / 3, uv, view.uvs.size()));
    const Vec2f at = view.uvs[uv];
    if (!(std::abs(at.x) < kFarthestUv && std::abs(at.y) < kFarthestUv))
      return bad(
          fmt::format("triangle {}: uv {} is ({}, {}) (must be below 1e6)", i / 3, uv, at.x, at.y));
  }
  return {};
}

// An island as it is packed: its uvs turned into their smallest box.
struct FlatIsland {
  std::vector<std::uint32_t> uvs;        // of the input
  std::vector<std::uint32_t> triangles;  // 3 indices into uvs each
  std::vector<Vec2d> corners;            // one per uv
  Orientation turned;
  Vec2d base = {};  // what was subtracted before turning
};

// The island of each triangle, and of each uv (kNoIndex: no triangle names it).
struct IslandNumbers {
  std::vector<std::uint32_t> of_triangle, of_uv;
};

IslandNumbers number_islands(const IslandView& view) {
  DisjointSets sets(view.uvs.size());
  for (std::size_t i = 0; i < view.indices.size(); i += 3) {
    sets.join(view.indices[i], view.indices[i + 1]);
    sets.join(view.indices[i], view.indices[i + 2]);
  }
  IslandNumbers numbers{{}, std::vector<std::uint32_t>(view.uvs.size(), kNoIndex)};
  std::vector<std::uint32_t> of_set(view.uvs.size(), kNoIndex);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < view.indices.size(); ++i) {
    std::uint32_t& island = of_set[sets.find(view.indices[i])];
    if (island == kNoIndex) island = count++;
    numbers.of_uv[view.indices[i]] = island;
    if (i % 3 == 0) numbers.of_triangle.push_back(island);
  }
  return numbers;
}

std::vector<FlatIsland> flat_islands(const IslandView& view, const IslandNumbers& numbers) {
  const std::uint32_t count =
      1 + *std::max_element(numbers.of_triangle.begin(), numbers.of_triangle.end());
  std::vector<FlatIsland> islands(count);
  std::vector<std::uint32_t> place(view.uvs.size());
  for (std::uint32_t uv = 0; uv < view.uvs.size(); ++uv) {
    if (numbers.of_uv[uv] == kNoIndex) continue;
    FlatIsland& island = islands[numbers.of_uv[uv]];
    const Vec2f at = view.uvs[uv];
    if (island.uvs.empty()) island.base = {at.x, at.y};
    place[uv] = std::uint32_t(island.uvs.size());
    island.uvs.push_back(uv);
    island.corners.push_back({at.x - island.base.x, at.y - island.base.y});
  }
  for (std::size_t i = 0; i < view.indices.size(); ++i)
    islands[numbers.of_triangle[i / 3]].triangles.push_back(place[view.indices[i]]);
  return islands;
}

double area_of(const FlatIsland& island) {
  double area = 0;
  for (std::size_t i = 0; i < island.triangles.size(); i += 3) {
    const Vec2d a = island.corners[island.triangles[i]],
                b = island.corners[island.triangles[i + 1]],
                c = island.corners[island.triangles[i + 2]];
    area += std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
  }
  return area;
}

// Turns all islands and scales them so that their triangles have the area of the pages, or by the
// density asked for. Returns the texels per unit of uv; 0 if no island has an extent.
double scale_islands(const IslandOptions& options, std::vector<FlatIsland>& islands,
                     const Context& context) {
  parallel_for(context, islands.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (options.allow_rotation) islands[i].turned = orient_for_packing(islands[i].corners);
  });
  double area = 0, longest = 0;
  for (const FlatIsland& island : islands) {
    area += area_of(island);
    for (const Vec2d p : island.corners)
      longest = std::max({longest, std::abs(p.x), std::abs(p.y)});
  }
  if (longest == 0) return 0;
  const double side = options.page_size;
  // Islands that are lines only are as long as the page at most.
  double density = area > 0 ? side * std::sqrt(double(options.pages) / area) : side / longest;
  density = std::min(density, 1e8 / longest);  // within what outlines may be
  if (options.texels_per_uv > 0) density = std::min(density, options.texels_per_uv);
  for (FlatIsland& island : islands)
    for (Vec2d& p : island.corners) p = {p.x * density, p.y * density};
  return density;
}

FitItem box_of(const std::vector<Vec2d>& corners) {
  Vec2d low = corners.front(), high = low;
  for (const Vec2d p : corners) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  return {high.x - low.x, high.y - low.y};
}

Result<FitResult> fit_islands(const IslandOptions& options, const std::vector<FlatIsland>& islands,
                              const Context& context) {
  std::vector<FitItem> items;
  std::vector<ChartShape> shapes;
  for (const FlatIsland& island : islands) {
    items.push_back(box_of(island.corners));
    shapes.push_back({island.corners, island.triangles});
  }
  FitOptions fit{options};
  fit.power_of_two = options.square || options.pages > 1;
  fit.free_aspect = !fit.power_of_two;
  fit.minimum_side = 0;
  fit.rotations = options.allow_rotation ? 4 : 1;
  fit.any_angle = options.allow_rotation;
  fit.effort = kMostLayouts;
  fit.shapes = shapes;
  Result<double> covered = covered_area(shapes, context);
  if (!covered.ok()) return covered.status();
  fit.shapes_area = *covered;
  const double room = double(options.pages) * options.page_size * options.page_size;
  // Islands that lie on themselves cover less than their triangles, so more of them fits.
  if (options.texels_per_uv == 0 && *covered > 0)
    fit.max_scale = std::max(1.0, std::sqrt(room / *covered));
  return fit_boxes_or_outlines(items, fit, context);
}

// Adds what was done to an island before it was fitted to what the fit does to it.
PackedIslands::Island placed(const FlatIsland& island, const FitPlacement& at, double density) {
  // A turned corner is R p + t, which sends the first uv, whose difference to the base is 0, to t.
  const Vec2d t = island.corners.front();
  const double c = portable::cos(at.angle) * at.scale, s = portable::sin(at.angle) * at.scale;
  PackedIslands::Island result{at.page, 0, {}};
  result.angle = at.angle + portable::atan2(island.turned.sine, island.turned.cosine);
  const double all = density * at.scale, x = portable::cos(result.angle) * all,
               y = portable::sin(result.angle) * all;
  result.offset = {at.offset.x + c * t.x - s * t.y - (x * island.base.x - y * island.base.y),
                   at.offset.y + s * t.x + c * t.y - (y * island.base.x + x * island.base.y)};
  return result;
}

}  // namespace

Result<PackedIslands> pack_islands(const IslandView& view, const IslandOptions& options,
                                   const Context& context) {
  if (Status s = check(options); !s.ok()) return s;
  if (Status s = check(view); !s.ok()) return s;
  IslandNumbers numbers = number_islands(view);
  std::vector<FlatIsland> islands = flat_islands(view, numbers);
  const double density = scale_islands(options, islands, context);
  if (context.cancelled()) return Status::cancelled();
  if (density == 0)
    return Status(ErrorCode::bad_input, "islands: all uvs of each island are equal");
  Result<FitResult> fitted = fit_islands(options, islands, context);
  if (!fitted.ok() && fitted.status().code() == ErrorCode::no_solution)
    return Status(ErrorCode::no_solution,
                  fmt::format("{} do not fit {} of {} x {} even as small as allowed (ask for more "
                              "pages, a larger page_size or less padding)",
                              counted(islands.size(), "island"), counted(options.pages, "page"),
                              options.page_size, options.page_size));
  if (!fitted.ok()) return fitted.status();
  PackedIslands packed;
  packed.uvs.resize(view.uvs.size());
  packed.triangle_island = std::move(numbers.of_triangle);
  packed.pages = fitted->pages;
  packed.texels_per_uv = density * fitted->scale;
  packed.utilization = fitted->filled;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    const FitPlacement& at = fitted->placements[i];
    packed.islands.push_back(placed(islands[i], at, density));
    const double c = portable::cos(at.angle) * at.scale, s = portable::sin(at.angle) * at.scale;
    const Extent page = packed.pages[at.page];
    for (std::size_t k = 0; k < islands[i].uvs.size(); ++k) {
      const Vec2d p = islands[i].corners[k];
      const double x = at.offset.x + c * p.x - s * p.y, y = at.offset.y + s * p.x + c * p.y;
      packed.uvs[islands[i].uvs[k]] = {float(std::clamp(x / page.width, 0.0, 1.0)),
                                       float(std::clamp(y / page.height, 0.0, 1.0))};
    }
  }
  return packed;
}

}  // namespace atlas
