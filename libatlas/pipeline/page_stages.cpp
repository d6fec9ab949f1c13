#include "libatlas/pipeline/page_stages.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace atlas {
namespace {

std::string error_text(const Fidelity& fidelity) {
  if (fidelity.lit == 0) return "nothing is lit";
  if (!(fidelity.psnr < kPerfectDecibels)) return "no difference";
  return fmt::format("PSNR {:.2f} dB, 95 % {:.4f}", fidelity.psnr, fidelity.p95);
}

// Reports the stages that baking does at the same time.
void report_baking(ExportJob& job, const BakedPages& baked, std::size_t charts) {
  ExportReport& report = job.report;
  report.pages = baked.pages;
  std::uint64_t bytes = 0;
  for (const PageReport& page : baked.pages) {
    bytes += page.image_bytes;
    report.gpu_bytes += std::uint64_t(page.width) * page.height * 4 * 4 / 3;
  }
  const std::uint64_t pages = baked.pages.size();
  job.record.add("baking", baked.bake_cpu, baked.bake_wall,
                 {job.scene.triangle_count(), baked.covered_texels, "texels",
                  fmt::format("{} charts, {} shifts", charts, job.options.shifts)});
  job.record.add("images", baked.write_cpu, baked.write_wall, {pages, bytes, "bytes", ""});
  if (!job.options.measure_error) return;
  job.context.report("error", 1);
  report.error_measured = true;
  report.fidelity = baked.fidelity;
  job.record.add(
      "error", baked.measure_cpu, baked.measure_wall,
      {baked.fidelity.lit + baked.fidelity.unlit, pages, "pages", error_text(baked.fidelity)});
}

}  // namespace

Result<BakedPages> bake(ExportJob& job, const SceneLight& light, const PackedCharts& packed) {
  const Context& context = job.record.begin("baking");
  const ChartLight lit{light.sampler, packed.charts, light.tone};
  Result<BakedPages> baked = bake_pages({lit, packed.layout, job.options, job.report.mip_levels},
                                        job.files, context, job.context);
  if (!baked.ok()) return job.files.told_by_target(baked.status());
  report_baking(job, *baked, packed.charts.charts.size());
  return baked;
}

Result<SimplifiedMesh> simplify(ExportJob& job, const PackedCharts& packed) {
  const Context& context = job.record.begin("simplify");
  std::vector<double> density(packed.charts.charts.size());
  for (std::size_t c = 0; c < density.size(); ++c) {
    // A texture that shrank because its light is even must not let the surface slip further. A
    // texel is therefore at most as long as that of the full texture at the pages' common scale.
    const Vec2d final = packed.layout.placements[c].texels_per_unit;
    const Vec2d full = packed.full_densities[c];
    density[c] = std::max({final.x, final.y, packed.layout.scale * std::min(full.x, full.y)});
  }
  SimplifyOptions options;
  options.max_slip_texels = job.options.simplify_slip;
  Result<SimplifiedMesh> coarse =
      simplify_charts({view_of(job.scene), packed.charts, density}, options, context);
  if (!coarse.ok()) return coarse;
  job.report.simplified = true;
  job.report.slip_texels = coarse->max_slip_texels;
  job.report.turn_degrees = coarse->max_turn_degrees;
  job.record.finish({coarse->triangles_in, coarse->triangles_out, "triangles",
                     fmt::format("slip {:.3f} texels", coarse->max_slip_texels)});
  return coarse;
}

}  // namespace atlas
