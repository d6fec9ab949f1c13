#include "libatlas/c/objects.h"
#include "libatlas/c/structs.h"
#include "libatlas/unwrap/strided.h"

libatlas_packed::libatlas_packed(const atlas::PackResult& result)
    : pages(atlas::c::to_c(result.pages)),
      unplaced(result.unplaced.size()),
      utilization(result.utilization),
      page_lower_bound(result.page_lower_bound) {
  static_assert(LIBATLAS_NO_PAGE == atlas::kNoPage);
  placements.reserve(result.placements.size());
  for (const atlas::Placement& at : result.placements)
    placements.push_back({at.page, at.x, at.y, at.rotated});
}

libatlas_packed_islands::libatlas_packed_islands(atlas::PackedIslands packed)
    : islands(std::move(packed)), pages(atlas::c::to_c(islands.pages)) {
  for (const atlas::PackedIslands::Island& island : islands.islands) {
    page.push_back(island.page);
    angle.push_back(island.angle);
    offset.insert(offset.end(), {island.offset.x, island.offset.y});
  }
}

namespace atlas::c {
namespace {

libatlas_pack_options options_to_c(const PackOptions& options) {
  libatlas_pack_options c{};
  c.page = {options.page.width, options.page.height};
  c.max_pages = options.max_pages;
  c.allow_rotation = options.allow_rotation;
  c.padding = options.padding;
  c.border = options.border;
  c.alignment = options.alignment;
  c.crop = options.crop;
  c.power_of_two = options.power_of_two;
  c.square = options.square;
  c.preset = libatlas_preset(options.preset);
  c.time_budget = options.time_budget;
  c.effort = options.effort;
  c.seed = options.seed;
  return c;
}

Result<PackOptions> from_c(const libatlas_pack_options& c) {
  const char* const name = "libatlas_pack_options";
  if (Status s = check_preset(name, "preset", c.preset); !s.ok()) return s;
  for (const auto& [member, flag] : {std::pair("allow_rotation", c.allow_rotation),
                                     {"crop", c.crop},
                                     {"power_of_two", c.power_of_two},
                                     {"square", c.square}})
    if (Status s = check_flag(name, member, flag); !s.ok()) return s;
  PackOptions options;
  options.page = {c.page.width, c.page.height};
  options.max_pages = c.max_pages;
  options.allow_rotation = c.allow_rotation != 0;
  options.padding = c.padding;
  options.border = c.border;
  options.alignment = c.alignment;
  options.crop = c.crop != 0;
  options.power_of_two = c.power_of_two != 0;
  options.square = c.square != 0;
  options.preset = PackPreset(c.preset);
  options.time_budget = c.time_budget;
  options.effort = c.effort;
  options.seed = c.seed;
  return options;
}

libatlas_packed_info describe(const libatlas_packed& packed) {
  libatlas_packed_info info{};
  info.placement_count = packed.placements.size();
  info.page_count = packed.pages.size();
  info.unplaced_count = packed.unplaced;
  info.placements = packed.placements.data();
  info.pages = packed.pages.data();
  info.utilization = packed.utilization;
  info.page_lower_bound = packed.page_lower_bound;
  return info;
}

libatlas_island_options options_to_c(const IslandOptions& options) {
  libatlas_island_options c{};
  c.texels_per_uv = options.texels_per_uv;
  c.pages = options.pages;
  c.page_size = options.page_size;
  c.padding = options.padding;
  c.alignment = options.alignment;
  c.allow_rotation = options.allow_rotation;
  c.square = options.square;
  c.preset = libatlas_preset(options.preset);
  return c;
}

Result<IslandOptions> from_c(const libatlas_island_options& c) {
  const char* const name = "libatlas_island_options";
  if (Status s = check_preset(name, "preset", c.preset); !s.ok()) return s;
  for (const auto& [member, flag] :
       {std::pair("allow_rotation", c.allow_rotation), {"square", c.square}})
    if (Status s = check_flag(name, member, flag); !s.ok()) return s;
  IslandOptions options;
  options.texels_per_uv = c.texels_per_uv;
  options.pages = c.pages;
  options.page_size = c.page_size;
  options.padding = c.padding;
  options.alignment = c.alignment;
  options.allow_rotation = c.allow_rotation != 0;
  options.square = c.square != 0;
  options.preset = PackPreset(c.preset);
  return options;
}

libatlas_packed_islands_info describe(const libatlas_packed_islands& packed) {
  libatlas_packed_islands_info info{};
  info.uv_count = packed.islands.uvs.size();
  info.triangle_count = packed.islands.triangle_island.size();
  info.island_count = packed.page.size();
  info.page_count = packed.pages.size();
  info.uvs = &packed.islands.uvs.front().x;
  info.triangle_island = packed.islands.triangle_island.data();
  info.island_page = packed.page.data();
  info.island_angle = packed.angle.data();
  info.island_offset = packed.offset.data();
  info.pages = packed.pages.data();
  info.texels_per_uv = packed.islands.texels_per_uv;
  info.utilization = packed.islands.utilization;
  return info;
}

// The options passed in, or the defaults for null, checked and translated.
template <class Options, class COptions>
Result<Options> options_from_c(const COptions* given, const char* name) {
  COptions own = options_to_c(Options{});
  if (given) {
    if (Status s = take_struct(given, name, own); !s.ok()) return s;
  }
  return from_c(own);
}

// The arrays of islands as spans; copies where they are strided or narrow.
struct IslandArrays {
  std::vector<Vec2f> uvs = {};
  std::vector<std::uint32_t> indices = {};
};

Result<IslandArrays> read_islands(const libatlas_islands& c) {
  const StridedSpan<Vec2f> uvs{c.uvs, c.uv_count, c.uv_stride};
  const IndexSpan indices{c.indices, c.index_count, c.index_bytes};
  if (Status s = check_span("islands: uvs", uvs); !s.ok()) return s;
  if (Status s = check_span("islands: indices", indices); !s.ok()) return s;
  IslandArrays arrays;
  arrays.uvs.reserve(uvs.count);
  for (std::size_t i = 0; i < uvs.count; ++i) arrays.uvs.push_back(uvs[i]);
  arrays.indices.reserve(indices.count);
  for (std::size_t i = 0; i < indices.count; ++i) arrays.indices.push_back(indices[i]);
  return arrays;
}

}  // namespace
}  // namespace atlas::c

libatlas_status libatlas_pack_options_init(libatlas_pack_options* options, size_t size) {
  return atlas::c::set_defaults(options, size, atlas::c::options_to_c(atlas::PackOptions{}));
}

libatlas_status libatlas_pack_rects(libatlas_context* context, const libatlas_extent* rects,
                                    size_t count, const libatlas_pack_options* options,
                                    libatlas_packed** packed) {
  using Made = atlas::Result<std::unique_ptr<libatlas_packed>>;
  return atlas::c::run_making_call(context, packed, [&]() -> Made {
    const auto own = atlas::c::options_from_c<atlas::PackOptions>(options, "libatlas_pack_options");
    if (!own.ok()) return own.status();
    if (!rects && count > 0) return atlas::c::null("rects");
    std::vector<atlas::Extent> items;
    for (std::size_t i = 0; i < count; ++i) items.push_back({rects[i].width, rects[i].height});
    const auto result = atlas::pack_rects(items, *own, context->context);
    if (!result.ok()) return result.status();
    return std::make_unique<libatlas_packed>(*result);
  });
}

void libatlas_packed_destroy(libatlas_packed* packed) {
  delete packed;
}

libatlas_status libatlas_get_packed(libatlas_context* context, const libatlas_packed* packed,
                                    libatlas_packed_info* info) {
  return atlas::c::run_call(context, [&] {
    if (!packed) return atlas::c::null("packed");
    return atlas::c::hand_out(info, "libatlas_packed_info", atlas::c::describe(*packed));
  });
}

libatlas_status libatlas_islands_init(libatlas_islands* islands, size_t size) {
  libatlas_islands defaults{};
  defaults.index_bytes = 4;
  return atlas::c::set_defaults(islands, size, defaults);
}

libatlas_status libatlas_island_options_init(libatlas_island_options* options, size_t size) {
  return atlas::c::set_defaults(options, size, atlas::c::options_to_c(atlas::IslandOptions{}));
}

libatlas_status libatlas_pack_islands(libatlas_context* context, const libatlas_islands* islands,
                                      const libatlas_island_options* options,
                                      libatlas_packed_islands** packed) {
  using Made = atlas::Result<std::unique_ptr<libatlas_packed_islands>>;
  return atlas::c::run_making_call(context, packed, [&]() -> Made {
    const auto own =
        atlas::c::options_from_c<atlas::IslandOptions>(options, "libatlas_island_options");
    if (!own.ok()) return own.status();
    libatlas_islands given;
    if (auto s = atlas::c::take_struct(islands, "libatlas_islands", given); !s.ok()) return s;
    const auto arrays = atlas::c::read_islands(given);
    if (!arrays.ok()) return arrays.status();
    auto result = atlas::pack_islands({arrays->uvs, arrays->indices}, *own, context->context);
    if (!result.ok()) return result.status();
    return std::make_unique<libatlas_packed_islands>(std::move(*result));
  });
}

void libatlas_packed_islands_destroy(libatlas_packed_islands* packed) {
  delete packed;
}

libatlas_status libatlas_get_packed_islands(libatlas_context* context,
                                            const libatlas_packed_islands* packed,
                                            libatlas_packed_islands_info* info) {
  return atlas::c::run_call(context, [&] {
    if (!packed) return atlas::c::null("packed");
    return atlas::c::hand_out(info, "libatlas_packed_islands_info", atlas::c::describe(*packed));
  });
}
