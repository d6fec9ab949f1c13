#include "libatlas/c/earlier.h"
#include "libatlas/c/objects.h"
#include "libatlas/c/structs.h"

libatlas_unwrapped::libatlas_unwrapped(atlas::UnwrappedAtlas unwrapped)
    : atlas(std::move(unwrapped)), pages(atlas::c::to_c(atlas.all().pages)) {
  const atlas::UnwrappedMesh& all = atlas.all();
  for (std::size_t i = 0; i < atlas.mesh_count(); ++i) {
    instances.emplace_back();
    for (const atlas::MeshInstance& at : atlas.mesh(i).instances)
      instances.back().push_back({at.page, {at.scale.x, at.scale.y}, {at.offset.x, at.offset.y}});
  }
  page.resize(all.charts.charts.size());
  for (const atlas::ChartPlacement& placement : all.placements)
    page[placement.chart] = std::uint32_t(placement.page);
  for (std::size_t c = 0; c < all.charts.charts.size(); ++c) {
    const atlas::Chart& chart = all.charts.charts[c];
    mesh.push_back(std::uint32_t(atlas.mesh_of_chart(c)));
    material.push_back(chart.material);
    triangle_count.push_back(chart.triangle_count);
    kept.push_back(chart.kept);
    area.push_back(chart.distortion.surface_area);
    stretch_l2.push_back(chart.distortion.stretch_l2);
    stretch_999.push_back(chart.distortion.stretch_999);
    stretch_max.push_back(chart.distortion.stretch_linf);
  }
  static_assert(LIBATLAS_MADE == int(atlas::ChartOrigin::made) &&
                LIBATLAS_REPAIRED == int(atlas::ChartOrigin::repaired) &&
                LIBATLAS_KEPT == int(atlas::ChartOrigin::kept));
  for (const atlas::ChartOrigin origin : all.origins) origins.push_back(std::uint8_t(origin));
}

namespace atlas::c {
namespace {

libatlas_unwrap_options options_to_c(const UnwrapOptions& options) {
  libatlas_unwrap_options c{};
  c.max_stretch = options.charts.max_stretch;
  c.cone_degrees = options.charts.cone_degrees;
  c.crease_degrees = options.charts.crease_degrees;
  c.min_fill = options.charts.min_fill;
  c.seam_weight = options.charts.seam_weight;
  c.uv_aspect = options.charts.uv_aspect;
  c.texels_per_unit = options.texels_per_unit;
  c.pages = options.pages;
  c.page_size = options.page_size;
  c.padding = options.padding;
  c.mip_levels = options.mip_levels;
  c.alignment = options.alignment;
  c.charts = libatlas_preset(options.charts.preset);
  c.packing = libatlas_preset(options.preset);
  c.split_at_materials = options.charts.split_at_materials;
  c.keep_uvs = options.charts.keep_uv_charts;
  c.allow_rotation = options.allow_rotation;
  c.square = options.square;
  c.part_gaps = options.part_gaps;
  return c;
}

UnwrapOptions from_c(const libatlas_unwrap_options& c) {
  UnwrapOptions options;
  options.charts.max_stretch = c.max_stretch;
  options.charts.cone_degrees = c.cone_degrees;
  options.charts.crease_degrees = c.crease_degrees;
  options.charts.min_fill = c.min_fill;
  if (c.seam_weight != 0) options.charts.seam_weight = c.seam_weight;  // 0: an earlier header
  options.charts.uv_aspect = c.uv_aspect;
  options.charts.preset = ChartPreset(c.charts);
  options.charts.split_at_materials = c.split_at_materials != 0;
  options.charts.keep_uv_charts = c.keep_uvs != 0;
  options.texels_per_unit = c.texels_per_unit;
  options.pages = c.pages;
  options.page_size = c.page_size;
  options.padding = c.padding;
  options.mip_levels = c.mip_levels;
  options.alignment = c.alignment;
  options.preset = PackPreset(c.packing);
  options.allow_rotation = c.allow_rotation != 0;
  options.square = c.square != 0;
  options.part_gaps = c.part_gaps != 0;
  return options;
}

Status check_flags(const libatlas_unwrap_options& c) {
  const char* const name = "libatlas_unwrap_options";
  for (const auto& [member, preset] : {std::pair("charts", c.charts), {"packing", c.packing}})
    if (Status s = check_preset(name, member, preset); !s.ok()) return s;
  for (const auto& [member, flag] : {std::pair("split_at_materials", c.split_at_materials),
                                     {"keep_uvs", c.keep_uvs},
                                     {"allow_rotation", c.allow_rotation},
                                     {"square", c.square},
                                     {"part_gaps", c.part_gaps}})
    if (Status s = check_flag(name, member, flag); !s.ok()) return s;
  return {};
}

libatlas_atlas_info describe(const libatlas_unwrapped& unwrapped) {
  const UnwrappedMesh& all = unwrapped.atlas.all();
  const Distortion& distortion = all.charts.distortion;
  libatlas_atlas_info info{};
  info.mesh_count = unwrapped.atlas.mesh_count();
  info.chart_count = all.charts.charts.size();
  info.page_count = unwrapped.pages.size();
  info.pages = unwrapped.pages.data();
  info.texels_per_unit = all.texels_per_unit;
  info.utilization = all.utilization;
  info.stretch_l2 = distortion.stretch_l2;
  info.stretch_999 = distortion.stretch_999;
  info.stretch_max = distortion.stretch_linf;
  info.conformal_mean = distortion.conformal_mean;
  info.seam_length = all.charts.seam_length;
  info.surface_area = all.charts.surface_area;
  info.flipped_triangles = all.charts.flipped_triangles.size();
  info.thin_triangles = all.thin_triangles;
  info.texels_drawn_twice = all.texels_drawn_twice;
  info.kept_charts = all.charts.repairs.kept_charts;
  info.reflattened_charts = all.charts.repairs.reflattened_charts;
  return info;
}

Status check_mesh(const libatlas_unwrapped* unwrapped, std::uint32_t mesh) {
  if (!unwrapped) return null("unwrapped");
  if (mesh < unwrapped->atlas.mesh_count()) return {};
  return {ErrorCode::bad_input, fmt::format("mesh {}: there are {} (counted from 0)", mesh,
                                            unwrapped->atlas.mesh_count())};
}

libatlas_mesh_uvs describe(const UnwrappedAtlas::Mesh& mesh) {
  static_assert(sizeof(Vec2f) == 2 * sizeof(float));
  libatlas_mesh_uvs uvs{};
  uvs.vertex_count = mesh.vertices.size();
  uvs.triangle_count = mesh.triangle_page.size();
  uvs.vertices = mesh.vertices.data();
  uvs.uvs = mesh.uvs.empty() ? nullptr : &mesh.uvs.front().x;
  uvs.indices = mesh.indices.data();
  uvs.triangle_page = mesh.triangle_page.data();
  uvs.triangle_chart = mesh.triangle_chart.data();
  return uvs;
}

libatlas_polygon_uvs describe_polygons(const UnwrappedAtlas::Mesh& mesh) {
  libatlas_polygon_uvs uvs{};
  if (mesh.polygon_corners.empty()) return uvs;
  uvs.polygon_count = mesh.triangle_polygon.back() + std::size_t{1};
  uvs.corner_count = mesh.polygon_corners.size();
  uvs.corners = mesh.polygon_corners.data();
  uvs.triangle_polygon = mesh.triangle_polygon.data();
  uvs.cut_count = mesh.cut_polygons.size();
  uvs.cut_polygons = mesh.cut_polygons.data();
  return uvs;
}

libatlas_charts describe_charts(const libatlas_unwrapped& unwrapped) {
  libatlas_charts charts{};
  charts.chart_count = unwrapped.mesh.size();
  charts.mesh = unwrapped.mesh.data();
  charts.page = unwrapped.page.data();
  charts.material = unwrapped.material.data();
  charts.triangle_count = unwrapped.triangle_count.data();
  charts.kept = unwrapped.kept.data();
  charts.area = unwrapped.area.data();
  charts.stretch_l2 = unwrapped.stretch_l2.data();
  charts.stretch_999 = unwrapped.stretch_999.data();
  charts.stretch_max = unwrapped.stretch_max.data();
  charts.origins = unwrapped.origins.empty() ? nullptr : unwrapped.origins.data();
  return charts;
}

}  // namespace
}  // namespace atlas::c

libatlas_status libatlas_unwrap_options_init(libatlas_unwrap_options* options, size_t size) {
  return atlas::c::set_defaults(options, size, atlas::c::options_to_c(atlas::UnwrapOptions{}));
}

libatlas_status libatlas_lightmap_options_init(libatlas_unwrap_options* options, size_t size,
                                               double texels_per_metre, double metres_per_unit) {
  return atlas::c::set_defaults(
      options, size,
      atlas::c::options_to_c(atlas::lightmap_options(texels_per_metre, metres_per_unit)));
}

libatlas_status libatlas_unwrap(libatlas_context* context, const libatlas_atlas* atlas,
                                const libatlas_unwrap_options* options,
                                libatlas_unwrapped** unwrapped) {
  using Made = atlas::Result<std::unique_ptr<libatlas_unwrapped>>;
  return atlas::c::run_making_call(context, unwrapped, [&]() -> Made {
    if (!atlas) return atlas::c::null("atlas");
    libatlas_unwrap_options own = atlas::c::options_to_c(atlas::UnwrapOptions{});
    if (options) {
      if (auto s = atlas::c::take_struct(options, "libatlas_unwrap_options", own); !s.ok())
        return s;
      if (auto s = atlas::c::check_flags(own); !s.ok()) return s;
    }
    atlas::UnwrapOptions cpp = atlas::c::from_c(own);
    atlas::c::EarlierArrays earlier;
    if (own.like) {
      if (auto s = earlier.take(*own.like); !s.ok()) return s;
      cpp.like = &earlier.uvs();
    }
    auto result = atlas->atlas.unwrap(cpp, context->context);
    if (!result.ok()) return result.status();
    return std::make_unique<libatlas_unwrapped>(std::move(*result));
  });
}

void libatlas_unwrapped_destroy(libatlas_unwrapped* unwrapped) {
  delete unwrapped;
}

libatlas_status libatlas_get_info(libatlas_context* context, const libatlas_unwrapped* unwrapped,
                                  libatlas_atlas_info* info) {
  return atlas::c::run_call(context, [&] {
    if (!unwrapped) return atlas::c::null("unwrapped");
    return atlas::c::hand_out(info, "libatlas_atlas_info", atlas::c::describe(*unwrapped));
  });
}

libatlas_status libatlas_get_mesh(libatlas_context* context, const libatlas_unwrapped* unwrapped,
                                  uint32_t mesh, libatlas_mesh_uvs* uvs) {
  return atlas::c::run_call(context, [&] {
    if (auto s = atlas::c::check_mesh(unwrapped, mesh); !s.ok()) return s;
    return atlas::c::hand_out(uvs, "libatlas_mesh_uvs",
                              atlas::c::describe(unwrapped->atlas.mesh(mesh)));
  });
}

libatlas_status libatlas_get_polygons(libatlas_context* context,
                                      const libatlas_unwrapped* unwrapped, uint32_t mesh,
                                      libatlas_polygon_uvs* polygons) {
  return atlas::c::run_call(context, [&] {
    if (auto s = atlas::c::check_mesh(unwrapped, mesh); !s.ok()) return s;
    return atlas::c::hand_out(polygons, "libatlas_polygon_uvs",
                              atlas::c::describe_polygons(unwrapped->atlas.mesh(mesh)));
  });
}

libatlas_status libatlas_get_instances(libatlas_context* context,
                                       const libatlas_unwrapped* unwrapped, uint32_t mesh,
                                       libatlas_instances* instances) {
  return atlas::c::run_call(context, [&] {
    if (auto s = atlas::c::check_mesh(unwrapped, mesh); !s.ok()) return s;
    libatlas_instances own{};
    own.instance_count = unwrapped->instances[mesh].size();
    own.instances = unwrapped->instances[mesh].data();
    return atlas::c::hand_out(instances, "libatlas_instances", own);
  });
}

libatlas_status libatlas_get_charts(libatlas_context* context, const libatlas_unwrapped* unwrapped,
                                    libatlas_charts* charts) {
  return atlas::c::run_call(context, [&] {
    if (!unwrapped) return atlas::c::null("unwrapped");
    return atlas::c::hand_out(charts, "libatlas_charts", atlas::c::describe_charts(*unwrapped));
  });
}

libatlas_status libatlas_get_seams(libatlas_context* context, const libatlas_atlas* atlas,
                                   const libatlas_unwrapped* unwrapped, uint32_t mesh,
                                   uint8_t* seams, size_t count) {
  return atlas::c::run_call(context, [&]() -> atlas::Status {
    if (!atlas) return atlas::c::null("atlas");
    if (auto s = atlas::c::check_mesh(unwrapped, mesh); !s.ok()) return s;
    if (!seams) return atlas::c::null("seams");
    const auto found = atlas->atlas.seams(unwrapped->atlas, mesh);
    if (!found.ok()) return found.status();
    if (count != found->size())
      return {atlas::ErrorCode::bad_input,
              fmt::format("mesh {}: room for {} seams, but it has {} half-edges", mesh, count,
                          found->size())};
    std::copy(found->begin(), found->end(), seams);
    return {};
  });
}
