#include "libatlas/pipeline/bake_pages.h"

#include <fmt/format.h>

#include <optional>

#include "libatlas/core/clock.h"
#include "libatlas/exporters/world.h"
#include "libatlas/image/image_io.h"

namespace atlas {
namespace {

// Adds the time since its construction to two sums.
class BookedTime {
 public:
  BookedTime(double& cpu, double& wall) : cpu_(cpu), wall_(wall) {}
  ~BookedTime() {
    cpu_ += cpu_seconds() - cpu_start_;
    wall_ += wall_seconds() - wall_start_;
  }

 private:
  double &cpu_, &wall_;
  double cpu_start_ = cpu_seconds(), wall_start_ = wall_seconds();
};

std::vector<std::vector<ChartPlacement>> placements_by_page(const PageLayout& layout) {
  std::vector<std::vector<ChartPlacement>> pages(layout.pages.size());
  for (const ChartPlacement& p : layout.placements) pages[std::size_t(p.page)].push_back(p);
  return pages;
}

// Gives back the image's temporary path.
Result<std::filesystem::path> write_page(const std::filesystem::path& target,
                                         const BakedPage& baked, const ExportOptions& options,
                                         AtomicFiles& files) {
  const std::filesystem::path png = files.path_for(target);
  if (Status s = write_png(png, baked.display, {options.png_compression}); !s.ok()) return s;
  if (options.exr) {
    std::filesystem::path exr = target;
    exr.replace_extension(".exr");
    if (Status s = write_exr(files.path_for(exr), baked.linear); !s.ok()) return s;
  }
  return png;
}

}  // namespace

Result<BakedPages> bake_pages(const ChartLight& light, const PageLayout& layout,
                              const ExportOptions& options, AtomicFiles& files,
                              const Context& context) {
  BakedPages result;
  const auto pages = placements_by_page(layout);
  std::optional<FidelityMeter> meter;
  if (options.measure_error) {
    const BookedTime watch(result.measure_cpu, result.measure_wall);
    meter.emplace(light, layout.placements, FidelityOptions{});
  }
  Context page_context = context;
  for (std::size_t p = 0; p < pages.size(); ++p) {
    page_context.progress = [&](std::string_view, double fraction) {
      context.report("baking", (double(p) + fraction) / double(pages.size()));
    };
    BakeOptions bake;
    bake.page_width = layout.pages[p].width;
    bake.page_height = layout.pages[p].height;
    bake.shifts = options.shifts;
    bake.mip_levels = options.mip_levels;
    bake.method = options.bake_method;
    bake.linear = options.exr;
    Result<BakedPage> baked = [&] {
      const BookedTime watch(result.bake_cpu, result.bake_wall);
      return bake_page(light, pages[p], bake, page_context);
    }();
    if (!baked.ok()) return baked.status();
    result.covered_texels += baked->covered_texels;
    if (meter) {
      const BookedTime watch(result.measure_cpu, result.measure_wall);
      meter->add_page(std::int32_t(p), baked->display);
    }
    const BookedTime watch(result.write_cpu, result.write_wall);
    const std::string name =
        fmt::format("{}_{}.png", safe_file_name(options.target.stem().string()), p);
    const auto image = write_page(options.target.parent_path() / name, *baked, options, files);
    if (!image.ok()) return image.status();
    result.image_sources.push_back(*image);
    result.pages.push_back({name, bake.page_width, bake.page_height, std::uint32_t(pages[p].size()),
                            std::filesystem::file_size(*image)});
  }
  if (meter) result.fidelity = meter->result();
  return result;
}

}  // namespace atlas
