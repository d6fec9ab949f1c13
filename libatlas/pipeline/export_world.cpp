#include "libatlas/pipeline/export_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "libatlas/charts/tiles.h"
#include "libatlas/core/atomic_file.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/progress.h"
#include "libatlas/core/srgb.h"
#include "libatlas/image/image_io.h"
#include "libatlas/pipeline/advice.h"
#include "libatlas/pipeline/assemble_world.h"
#include "libatlas/pipeline/bake_pages.h"
#include "libatlas/pipeline/false_colour.h"
#include "libatlas/pipeline/finish_mesh.h"
#include "libatlas/pipeline/layout_options.h"
#include "libatlas/pipeline/lightmap.h"
#include "libatlas/pipeline/longest_sides.h"
#include "libatlas/pipeline/more_mip_levels.h"
#include "libatlas/pipeline/report_pictures.h"
#include "libatlas/pipeline/size_textures.h"
#include "libatlas/pipeline/stage_recorder.h"
#include "libatlas/pipeline/suit_pages.h"
#include "libatlas/pipeline/texture_gaps.h"
#include "libatlas/pipeline/write_export.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/uv_page.h"
#include "libatlas/simplify/simplify.h"
#include "libatlas/texture/chart_textures.h"
#include "libatlas/texture/light_seams.h"
#include "libatlas/unwrap/fill_pages.h"
#include "libatlas/unwrap/page_layout.h"
#include "libatlas/unwrap/part_gaps.h"

namespace atlas {
namespace {

MeshView view_of(const Scene& scene) {
  MeshView view;
  view.positions = scene.positions;
  view.indices = scene.indices;
  view.materials = scene.triangle_material;
  view.texcoords = scene.texcoords;
  view.texcoord_indices = scene.texcoord_indices;
  return view;
}

// Holds the state that one stage hands to the next. Each method is one stage: it fills its part of
// the report, and returns early if it fails.
class Export {
 public:
  Export(const LoadedScene& loaded, const ExportOptions& options,
         const std::function<void(const StageReport&)>& stage_done, const Context& context)
      : scene_(loaded.scene),
        view_(loaded.view),
        further_views_(loaded.further_views),
        options_(planned_options(loaded.scene, options)),
        context_(context),
        plan_(make_plan(scene_, options_)),
        report_(planned_report(loaded, plan_, options_)),
        record_(report_, stage_done, context) {
    if (std::string line = colours_text(scene_, options); !line.empty())
      report_.advice.push_back(std::move(line));
  }

  Result<ExportReport> run() {
    const double cpu = own_cpu_seconds(), wall = wall_seconds();
    if (Status s = check_plan(plan_, options_); !s.ok()) return s;
    const bool textured = plan_.bake && options_.quantity == Quantity::illuminance;
    if (Status s = textured ? check_images(scene_) : Status(); !s.ok()) return s;
    if (Status s = check_module(); !s.ok()) return s;
    if (plan_.bake) {
      if (Status s = expose(); !s.ok()) return s;
    }
    if (Status s = cut_charts(); !s.ok()) return s;
    if (plan_.bake) {
      if (Status s = cut_long_charts(); !s.ok()) return s;
      if (Status s = size_all_textures(); !s.ok()) return s;
    }
    if (Status s = pack(); !s.ok()) return s;
    if (plan_.bake) {
      if (Status s = bake(); !s.ok()) return s;
    }
    if (plan_.simplify) {
      if (Status s = simplify(); !s.ok()) return s;
    }
    if (Status s = finish(); !s.ok()) return s;
    if (Status s = write(); !s.ok()) return s;
    report_.carried_out = true;
    for (std::string& line : advice_on(report_, options_))
      report_.advice.push_back(std::move(line));
    if (plan_.bake)
      for (std::string& line : advice_on_missing_light(scene_, report_.defects, options_))
        report_.advice.push_back(std::move(line));
    if (plan_.bake && !options_.keep_scene) {
      for (std::string& line : advice_on_materials(scene_, options_.quantity))
        report_.advice.push_back(std::move(line));
    }
    if (report_.thin_triangles > 0)
      report_.advice.push_back(thin_triangles_text(report_.thin_triangles, report_.triangles_out));
    for (const std::string& line : report_.advice) context_.say(line);
    report_.cpu_seconds = own_cpu_seconds() - cpu;
    report_.wall_seconds = wall_seconds() - wall;
    report_.peak_memory = peak_memory();
    return std::move(report_);
  }

 private:
  // Without the module for such image files, all stages up to the first page would run in vain.
  Status check_module() const {
    return plan_.bake && options_.exr ? check_image_module(options_.target.string()) : Status();
  }

  Status cut_charts() {
    const Context& context = record_.begin("charts");
    MeshView mesh = view_of(scene_);
    const LightSeams seams = light_seams(context);
    if (context.cancelled()) return Status::cancelled();
    mesh.seams = seams.edges;
    report_.light_seam_length = seams.length;
    Result<ChartSet> charts = make_charts(mesh, options_.charts, context);
    if (!charts.ok()) return charts.status();
    charts_ = std::move(*charts);
    if (plan_.bake) light_.emplace(ChartLight{*sampler_, charts_, tone_});
    report_charts();
    report_.surface_area = charts_.surface_area;
    report_.repairs = charts_.repairs;
    report_.noise = charts_.noise;
    report_.chart_timing = charts_.timing;
    std::string quality = fmt::format("L2 {:.4f}, 99.9 % {:.3f}", charts_.distortion.stretch_l2,
                                      charts_.distortion.stretch_999);
    if (options_.charts.keep_uv_charts) {
      quality += fmt::format(", {} kept, {} reflattened", charts_.repairs.kept_charts,
                             charts_.repairs.reflattened_charts);
    }
    record_.finish({scene_.triangle_count(), charts_.charts.size(), "charts", quality});
    return {};
  }

  LightSeams light_seams(const Context& context) const {
    if (!plan_.bake || !options_.split_at_light || options_.charts.keep_uv_charts) return {};
    const double texel = plan_.texel_metres / scene_.metres_per_unit;
    const double room = double(options_.atlases) * options_.atlas_size * options_.atlas_size;
    const double afforded = std::sqrt(plan_.surface_area_m2 / room) / scene_.metres_per_unit;
    LightSeamOptions seams;
    seams.texel = std::max(texel, afforded);
    return find_light_seams(*sampler_, tone_, seams, context);
  }

  // Must be called again whenever charts were cut.
  void report_charts() {
    report_.charts = charts_.charts;
    report_.distortion = charts_.distortion;
    report_.seam_length = charts_.seam_length;
  }

  Status expose() {
    const Context& context = record_.begin("exposure");
    sampler_.emplace(scene_, options_.quantity);
    Result<LuminanceStatistics> statistics = measure_luminance(*sampler_, context);
    if (!statistics.ok()) return statistics.status();
    Result<ToneMapping> tone = make_tone_mapping(tone_options(options_), *statistics);
    if (!tone.ok()) return tone.status();
    tone_ = *tone;
    report_.luminance = *statistics;
    report_.tone = tone_;
    report_.exposure_white = double(tone_.white) / tone_.scale;
    const auto median = static_cast<float>(report_.luminance.median);
    record_.finish(
        {scene_.triangle_count(), 1, "tone curve",
         fmt::format("white {:.4g}, the median {:.4g} shown as {} of 255", report_.exposure_white,
                     median, quantize8(tone_.display({median, median, median}).y))});
    return {};
  }

  Status cut_long_charts() {
    const Context& context = record_.begin("tiling");
    const TextureOptions texture = texture_options(plan_, report_, options_);
    const Result<std::vector<double>> densities = wanted_densities(*light_, texture, context);
    if (!densities.ok()) return densities.status();
    const std::size_t before = charts_.charts.size();
    const std::vector<double> sides = longest_sides(charts_, *densities, {texture, options_});
    const Result<std::size_t> cut =
        cut_to_limits(view_of(scene_), {sides, options_.charts.max_stretch}, charts_, context);
    if (!cut.ok()) return cut.status();
    report_charts();
    record_.finish(
        {before, charts_.charts.size(), "charts", fmt::format("{} longer than half a page", *cut)});
    return {};
  }

  Status size_all_textures() {
    // Without a threshold, textures get their sizes all the same, but none is halved.
    const bool downsizing = options_.threshold > 0;
    const Context& context = record_.begin(downsizing ? "downsizing" : "sizing");
    const TextureOptions texture = texture_options(plan_, report_, options_);
    Result<SizedTextures> sized = size_textures(*light_, {texture, options_}, context);
    if (!sized.ok()) return sized.status();
    sizing_ = sized->sizing;
    TextureResult& textures = sized->textures;
    const PagesOfCharts pages{view_of(scene_), options_.charts.max_stretch,
                              double(options_.atlases) * options_.atlas_size * options_.atlas_size};
    const TexturesOfCharts opened{textures.charts, texture.max_side};
    report_.opened_charts = open_texture_gaps(pages, opened, charts_, context).charts;
    if (context.cancelled()) return Status::cancelled();
    report_charts();
    for (const ChartTexture& t : textures.charts) {
      densities_.push_back(t.texels_per_unit);
      full_densities_.push_back(t.full_texels_per_unit);
    }
    report_.texel = texture.texel;
    report_textures(textures, report_);
    record_.finish(
        {std::uint64_t(textures.full_texels), std::uint64_t(textures.final_texels), "texels",
         fmt::format("{} charts halved, {} unlit, rms {:.5f} ({} sampled)", textures.halved,
                     textures.unlit, textures.rms_error, textures.sampled)});
    return {};
  }

  // Given charts keep their borders. Raises report_.mip_levels.
  Result<PageLayout> lay_out_lit(const LayoutOptions& options, const Context& context) {
    if (!options_.charts.keep_uv_charts) {
      SizedCharts sized{std::move(charts_), std::move(densities_), std::move(full_densities_)};
      const Result<std::size_t> cut =
          suit_pages({view_of(scene_), options_.charts.max_stretch}, options, sized, context);
      charts_ = std::move(sized.charts);
      densities_ = std::move(sized.densities);
      full_densities_ = std::move(sized.full_densities);
      if (!cut.ok()) return cut.status();
      report_charts();
    }
    const double first = options_.more_mip_levels ? kFirstLayout : 1;
    Result<PageLayout> layout =
        lay_out_pages(charts_, densities_, options, part_of_stage(context, "packing", 0, first));
    if (!layout.ok() || !options_.more_mip_levels) return layout;
    Result<GuardedLayout> guarded =
        guard_more_levels({charts_, densities_}, options, {std::move(*layout), options_.mip_levels},
                          part_of_stage(context, "packing", first, 1));
    if (!guarded.ok()) return guarded.status();
    report_.mip_levels = guarded->mip_levels;
    return std::move(guarded->layout);
  }

  // Refuses plain uvs of less than the density asked for: pages have no image whose texels could
  // become coarser, and the texture that comes on them would be.
  Status check_density(const PlainUvs& uvs, const PageLayout& layout) const {
    constexpr double kRounding = 1e-6;
    if (options_.texel_metres == 0) return {};
    const double texel = scene_.metres_per_unit / (uvs.density * layout.scale);
    if (texel <= options_.texel_metres * (1 + kRounding)) return {};
    return {ErrorCode::no_solution,
            fmt::format("ExportOptions::texel_metres: {:g} m needs more room than the pages have, "
                        "whose texels are {:.3g} m (give {}, or longer texels)",
                        options_.texel_metres, texel, more_room(options_, false))};
  }

  // Without light, pages are filled as well as packing can, unless a texel density is asked for.
  // One above what full pages hold is lowered to that, which also keeps sizes in texels finite.
  Result<PageLayout> lay_out_plain(const LayoutOptions& options, const Context& context) {
    const double texels = double(options.pages) * options.page_size * options.page_size;
    double density = filling_density(charts_, texels);
    if (options_.texel_metres > 0)
      density = std::min(density, scene_.metres_per_unit / options_.texel_metres);
    const PlainUvs uvs{view_of(scene_), options_.charts, density};
    Result<PageLayout> layout = fill_plain(uvs, options, context);
    if (!layout.ok()) return layout;
    if (Status s = check_density(uvs, *layout); !s.ok()) return s;
    if (options_.texel_metres > 0)
      report_.texel = report_.packed_texel = options_.texel_metres / scene_.metres_per_unit;
    return layout;
  }

  Result<PageLayout> fill_plain(const PlainUvs& uvs, const LayoutOptions& options,
                                const Context& context) {
    if (!options_.keep_scene) {
      Result<PageLayout> layout = fill_pages(uvs, options, charts_, context);
      report_charts();
      return layout;
    }
    // With keep_scene, the uvs are for a lightmap.
    Result<PagesOfParts> apart = fill_pages_apart(uvs, options, charts_, context);
    report_charts();
    if (!apart.ok()) return apart.status();
    report_.opened_charts = apart->opened;
    report_.gaps = apart->left;
    return std::move(apart->layout);
  }

  Status pack() {
    const Context& context = record_.begin("packing");
    const std::size_t uncut = charts_.charts.size();
    const LayoutOptions layout = layout_options(charts_, options_, plan_.bake);
    report_.mip_levels = plan_.bake ? options_.mip_levels : options_.plain_mip_levels;
    Result<PageLayout> laid =
        plan_.bake ? lay_out_lit(layout, context) : lay_out_plain(layout, context);
    if (!laid.ok()) return laid.status();
    layout_ = std::move(*laid);
    if (plan_.bake)
      report_.gaps = left_part_gaps(view_of(scene_), charts_, layout_.placements, context);
    report_.grouping = layout_.grouping;
    report_.scale = sizing_ * layout_.scale;
    report_.utilization = layout_.utilization;
    report_.uv_utilization = layout_.uv_utilization;
    report_.outlines = layout_.outlines;
    if (plan_.bake) {
      report_.packed_texel =
          packed_texel(charts_, full_densities_, layout_.scale, report_.texel / sizing_);
      report_.least_side_share = least_side_share(charts_, densities_, layout_);
    }
    std::string quality = fmt::format("scale {:.3f}, {:.0f} % used by charts", report_.scale,
                                      100 * layout_.uv_utilization);
    if (charts_.charts.size() > uncut)
      quality += fmt::format(", cut into {}", charts_.charts.size());
    record_.finish({uncut, layout_.pages.size(), "pages", quality});
    for (const ChartPlacement& p : layout_.placements) {
      report_.chart_pages.push_back(p.page);
      report_.chart_densities.push_back((p.texels_per_unit.x + p.texels_per_unit.y) / 2);
    }
    if (!plan_.bake) {
      for (const Extent& page : layout_.pages) {
        report_.pages.push_back({"", page.width, page.height, 0, 0});
      }
      for (const ChartPlacement& p : layout_.placements) {
        ++report_.pages[std::size_t(p.page)].charts;
      }
    }
    return {};
  }

  Status bake() {
    const Context& context = record_.begin("baking");
    Result<BakedPages> baked =
        bake_pages({*light_, layout_, options_, report_.mip_levels}, files_, context, context_);
    if (!baked.ok()) return files_.told_by_target(baked.status());
    report_.pages = baked->pages;
    image_sources_ = std::move(baked->image_sources);
    error_ = std::move(baked->error);
    std::uint64_t bytes = 0;
    for (const PageReport& page : baked->pages) {
      bytes += page.image_bytes;
      report_.gpu_bytes += std::uint64_t(page.width) * page.height * 4 * 4 / 3;
    }
    const std::uint64_t charts = charts_.charts.size(), pages = baked->pages.size();
    record_.add("baking", baked->bake_cpu, baked->bake_wall,
                {scene_.triangle_count(), baked->covered_texels, "texels",
                 fmt::format("{} charts, {} shifts", charts, options_.shifts)});
    record_.add("images", baked->write_cpu, baked->write_wall, {pages, bytes, "bytes", ""});
    if (options_.measure_error) {
      context_.report("error", 1);
      report_.error_measured = true;
      const Fidelity& fidelity = report_.fidelity = baked->fidelity;
      record_.add("error", baked->measure_cpu, baked->measure_wall,
                  {fidelity.lit + fidelity.unlit, pages, "pages",
                   fidelity.lit == 0 ? "nothing is lit" : error_text(fidelity)});
    }
    return {};
  }

  static std::string error_text(const Fidelity& fidelity) {
    if (!(fidelity.psnr < kPerfectDecibels)) return "no difference";
    return fmt::format("PSNR {:.2f} dB, 95 % {:.4f}", fidelity.psnr, fidelity.p95);
  }

  Status simplify() {
    const Context& context = record_.begin("simplify");
    std::vector<double> density(charts_.charts.size());
    for (std::size_t c = 0; c < density.size(); ++c) {
      // A texture that shrank because its light is even must not let the surface slip further. A
      // texel is therefore at most as long as that of the full texture at the pages' common scale.
      const Vec2d final = layout_.placements[c].texels_per_unit;
      const Vec2d full = full_densities_[c];
      density[c] = std::max({final.x, final.y, layout_.scale * std::min(full.x, full.y)});
    }
    SimplifyOptions simplify;
    simplify.max_slip_texels = options_.simplify_slip;
    Result<SimplifiedMesh> coarse =
        simplify_charts({view_of(scene_), charts_, density}, simplify, context);
    if (!coarse.ok()) return coarse.status();
    coarse_ = std::move(*coarse);
    report_.simplified = true;
    report_.slip_texels = coarse_->max_slip_texels;
    report_.turn_degrees = coarse_->max_turn_degrees;
    record_.finish({coarse_->triangles_in, coarse_->triangles_out, "triangles",
                    fmt::format("slip {:.3f} texels", coarse_->max_slip_texels)});
    return {};
  }

  // Draws the pictures that were asked for, while the pages' images are still at hand.
  Status draw() {
    if (options_.report_pictures) {
      Result<ReportPictures> pictures =
          report_pictures({charts_, layout_, image_sources_, report_.fidelity.worst}, context_);
      if (!pictures.ok()) return files_.told_by_target(pictures.status());
      report_.pictures = std::move(*pictures);
    }
    if (options_.false_colour.empty()) return {};
    return files_.told_by_target(
        write_png(files_.path_for(options_.false_colour),
                  draw_false_colours(scene_, options_.up, charts_, layout_), {}));
  }

  Status finish() {
    const Context& context = record_.begin("uvs");
    const SimplifiedMesh* coarse = coarse_ ? &*coarse_ : nullptr;
    finished_ =
        finish_mesh({scene_, options_, charts_, layout_, coarse, plan_.bake}, report_, context);
    if (context.cancelled()) return Status::cancelled();
    record_.finish({charts_.uvs.size(), report_.triangles_out, "triangles",
                    fmt::format("99.9 % {:.3f} as written", report_.written_stretch_999)});
    return {};
  }

  Status write() {
    const Context& context = record_.begin("writing");
    if (Status s = draw(); !s.ok()) return s;
    ExportToWrite made{scene_,          options_,
                       charts_,         layout_,
                       finished_->mesh, std::move(finished_->uvs),
                       plan_.bake,      sampler_ ? &*sampler_ : nullptr,
                       image_sources_,  error_,
                       view_,           further_views_};
    Result<StageOutcome> written = write_export(std::move(made), files_, report_, context);
    if (!written.ok()) return written.status();
    record_.finish(std::move(*written));
    return {};
  }

  static constexpr double kFirstLayout = 0.7;  // share of packing's progress

  const Scene& scene_;
  const std::optional<FileView> view_;
  const std::vector<FileView> further_views_;
  const ExportOptions options_;
  const Context& context_;
  const ExportPlan plan_;

  ChartSet charts_;
  std::optional<LuminanceSampler> sampler_;
  ToneMapping tone_;
  std::optional<ChartLight> light_;
  double sizing_ = 1;  // factor of the densities asked for at which textures are sized, see
                       // sizing_factor()
  std::vector<Vec2d> densities_, full_densities_;  // texels per unit, one per chart
  PageLayout layout_;
  std::optional<SimplifiedMesh> coarse_;
  std::optional<FinishedMesh> finished_;
  std::vector<std::filesystem::path> image_sources_;  // where the pages' images lie until commit
  std::vector<FidelityMeter::Cells> error_;           // one per page, or none
  AtomicFiles files_;
  ExportReport report_;
  StageRecorder record_;
};

}  // namespace

std::string plain_pages_text(std::span<const Extent> pages, bool udim) {
  const auto wider = [](const Extent& a, const Extent& b) { return a.width < b.width; };
  const auto [least, most] = std::minmax_element(pages.begin(), pages.end(), wider);
  // Pages of a given density are no larger than what is on them.
  const std::string sides =
      fmt::format("{0} x {0}", most->width) +
      (least->width < most->width ? fmt::format(" to {0} x {0}", least->width) : std::string());
  if (pages.size() > 1 && udim)
    return fmt::format("uvs of UDIM tiles 1001 to {}, packed for {} texels each",
                       1000 + pages.size(), sides);
  if (pages.size() > 1)
    return fmt::format("uvs of {} square pages, packed for {} texels", pages.size(), sides);
  return uv_page_text(pages[0].width, pages[0].height);
}

Result<ExportReport> export_world(const LoadedScene& loaded, const ExportOptions& options,
                                  const std::function<void(const StageReport&)>& stage_done,
                                  const Context& context) {
  if (Status s = check_options(options); !s.ok()) return s;
  if (Status s = check_scene(loaded.scene); !s.ok()) return s;
  return Export(loaded, options, stage_done, context).run();
}

}  // namespace atlas
