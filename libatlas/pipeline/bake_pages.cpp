#include "libatlas/pipeline/bake_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <mutex>
#include <optional>
#include <utility>

#include "libatlas/core/background.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/exporters/html/light_page.h"
#include "libatlas/exporters/world.h"
#include "libatlas/files/write_error.h"
#include "libatlas/image/image_io.h"
#include "libatlas/image/webp.h"

namespace atlas {
namespace {

// Adds the time between its construction and its destruction to a sum.
class BookedTime {
 public:
  BookedTime(double (*clock)(), double& sum) : clock_(clock), sum_(sum), start_(clock()) {}
  ~BookedTime() { sum_ += clock_() - start_; }

 private:
  double (*clock_)();
  double& sum_;
  double start_;
};

std::vector<std::vector<ChartPlacement>> placements_by_page(const PageLayout& layout) {
  std::vector<std::vector<ChartPlacement>> pages(layout.pages.size());
  for (const ChartPlacement& p : layout.placements) pages[std::size_t(p.page)].push_back(p);
  return pages;
}

// Returns decibels over all channels; of equal images, those of an error below half a step in one
// texel.
double psnr_of(const Image8& a, const Image8& b) {
  double sum = 0.25;
  for (std::size_t i = 0; i < a.texels.size(); ++i) {
    const double d = double(a.texels[i]) - double(b.texels[i]);
    sum += d * d;
  }
  return 10 * std::log10(255.0 * 255.0 * double(a.texels.size()) / sum);
}

// The pages that are baked at once take at most this many bytes together, and so do those that wait
// to be written. A single page may take more.
constexpr std::size_t kBytesAtOnce = std::size_t{256} << 20;

constexpr int kErrorCell = 32;  // texels

class PageBaker {
 public:
  PageBaker(const PagesToBake& pages, AtomicFiles& files, const Context& context,
            const Context& images)
      : light_(pages.light),
        layout_(pages.layout),
        options_(pages.options),
        mip_levels_(pages.mip_levels),
        files_(files),
        context_(context),
        images_(images),
        pages_(placements_by_page(layout_)),
        write_cpu_(layout_.pages.size(), 0),
        fraction_(layout_.pages.size(), 0) {}

  Result<BakedPages> run() {
    const double cpu = own_cpu_seconds();
    if (Status s = draw_samples(); !s.ok()) return s;
    const std::size_t at_once = pages_at_once();
    Background writing(writes_itself() ? 0 : at_once);
    for (std::size_t p = 0; p < pages_.size(); p += at_once) {
      if (Status s = add_pages(p, std::min(at_once, pages_.size() - p), writing); !s.ok()) return s;
    }
    {
      const BookedTime watch(wall_seconds, result_.write_wall);
      if (Status s = writing.finish(); !s.ok()) return s;
    }
    images_.report("images", 1);
    for (std::size_t p = 0; p < pages_.size(); ++p) {
      std::error_code error;
      const auto bytes = std::filesystem::file_size(result_.image_sources[p], error);
      result_.pages[p].image_bytes = error ? 0 : bytes;
      result_.write_cpu += write_cpu_[p];
    }
    result_.bake_cpu = own_cpu_seconds() - cpu - result_.measure_cpu - result_.write_cpu;
    if (meter_) result_.fidelity = meter_->result();
    return std::move(result_);
  }

 private:
  // A page, and its file if that is WebP. A lossy one shows what its file does.
  struct FinishedPage {
    BakedPage page = {};
    std::vector<std::uint8_t> webp = {};
    std::optional<double> psnr = {};
  };

  Status draw_samples() {
    if (!options_.measure_error) return {};
    const BookedTime cpu_watch(own_cpu_seconds, result_.measure_cpu);
    const BookedTime wall_watch(wall_seconds, result_.measure_wall);
    Result<FidelityMeter> meter = FidelityMeter::make(light_, layout_.placements, {}, context_);
    if (!meter.ok()) return meter.status();
    meter_.emplace(std::move(*meter));
    return {};
  }

  bool floats() const { return options_.exr || options_.linear; }

  // Returns whether the caller's thread writes images, instead of threads in the background.
  bool writes_itself() const { return pages_.size() < 2 || context_.threads == 1; }

  // Returns how many pages are baked at once, while as many others are written. This is the number
  // of threads if memory allows, because a page may hold a single chart, which occupies one thread.
  std::size_t pages_at_once() const {
    if (writes_itself()) return 1;
    const std::size_t texel = floats() ? 3 + 3 * sizeof(float) : 3;
    std::size_t largest = 1;  // texels of a page
    for (const auto& page : layout_.pages)
      largest = std::max(largest, std::size_t(page.width) * std::size_t(page.height));
    return std::clamp<std::size_t>(kBytesAtOnce / (texel * largest), 1, thread_count(context_));
  }

  Status add_pages(std::size_t first, std::size_t count, Background& writing) {
    std::vector<std::optional<Result<FinishedPage>>> baked(count);
    {
      const BookedTime watch(wall_seconds, result_.bake_wall);
      parallel_for(context_, count, 1,
                   [&](std::size_t i, std::size_t) { baked[i].emplace(finish(first + i)); });
    }
    if (context_.cancelled()) return Status::cancelled();
    for (std::size_t i = 0; i < count; ++i) {
      if (!baked[i]->ok()) return baked[i]->status();
      if (Status s = add_page(first + i, std::move(baked[i]->value()), writing); !s.ok()) return s;
    }
    return {};
  }

  Status add_page(std::size_t p, FinishedPage baked, Background& writing) {
    result_.covered_texels += baked.page.covered_texels;
    if (meter_) {
      const BookedTime cpu_watch(own_cpu_seconds, result_.measure_cpu);
      const BookedTime wall_watch(wall_seconds, result_.measure_wall);
      const auto page = std::int32_t(p);
      options_.linear ? meter_->add_light_page(page, baked.page.linear)
                      : meter_->add_page(page, baked.page.display);
      const Extent& size = layout_.pages[p];
      result_.error.push_back(meter_->cells(page, size.width, size.height, kErrorCell));
    }
    const std::string name = page_name(options_.target, p) +
                             (options_.linear ? ".light" : page_extension(options_.texture_format));
    std::filesystem::path target = options_.target.parent_path() / name;
    const std::filesystem::path image = files_.path_for(target);
    const std::filesystem::path exr =
        options_.exr ? files_.path_for(target.replace_extension(".exr")) : "";
    result_.image_sources.push_back(image);
    result_.pages.push_back({name, layout_.pages[p].width, layout_.pages[p].height,
                             std::uint32_t(pages_[p].size()), 0, baked.psnr});
    const BookedTime watch(wall_seconds, result_.write_wall);
    if (p + 1 == pages_.size()) only_images_are_left();
    return writing.add([this, p, image, exr, baked = std::move(baked)]() -> Status {
      const BookedTime own_watch(own_cpu_seconds, write_cpu_[p]);
      if (Status s = write_image(baked, image); !s.ok()) return s;
      if (Status s = exr.empty() ? Status() : write_exr(exr, baked.page.linear); !s.ok()) return s;
      const std::lock_guard lock(reporting_);
      ++written_;
      if (baked_) report_images();
      return {};
    });
  }

  // Ends the progress of baking and begins that of images, which were written beside it.
  void only_images_are_left() {
    const std::lock_guard lock(reporting_);
    baked_ = true;
    context_.report("baking", 1);
    report_images();
  }

  void report_images() const { images_.report("images", double(written_) / double(pages_.size())); }

  Result<FinishedPage> finish(std::size_t p) {
    Result<BakedPage> baked = bake(p);
    if (!baked.ok()) return baked.status();
    FinishedPage finished{std::move(*baked)};
    if (options_.linear || options_.texture_format != TextureFormat::webp) return finished;
    Image8& display = finished.page.display;
    auto webp = encode_webp(display, {options_.webp_quality});
    if (!webp.ok()) return webp.status();
    finished.webp = std::move(*webp);
    if (options_.webp_quality == 0) return finished;
    Result<Image8> shown = decode_webp(finished.webp, page_name(options_.target, p));
    if (!shown.ok()) return shown.status();
    finished.psnr = psnr_of(display, *shown);
    display = std::move(*shown);
    return finished;
  }

  Status write_image(const FinishedPage& baked, const std::filesystem::path& path) const {
    if (options_.linear) return write_light_page(path, baked.page.linear);
    if (options_.texture_format == TextureFormat::png)
      return write_png(path, baked.page.display, {options_.png_compression, true});
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(baked.webp.data()),
               std::streamsize(baked.webp.size()));
    file.close();
    if (file) return {};
    return {ErrorCode::io, fmt::format("{}: {}", path.string(), write_error(errno))};
  }

  Result<BakedPage> bake(std::size_t p) {
    Context context = context_;
    context.progress = [&](std::string_view, double fraction) {
      const std::lock_guard lock(reporting_);
      fractions_ += fraction - std::exchange(fraction_[p], fraction);
      context_.report("baking", std::min(1.0, fractions_ / double(pages_.size())));
    };
    if (context_.warn) {
      context.warn = [&, p](std::string_view line) {
        const std::lock_guard lock(reporting_);
        context_.say(fmt::format("page {}: {}", p, line));
      };
    }
    BakeOptions bake;
    bake.page_width = layout_.pages[p].width;
    bake.page_height = layout_.pages[p].height;
    bake.shifts = options_.shifts;
    bake.mip_levels = mip_levels_;
    bake.method = options_.bake_method;
    bake.linear = floats();
    return bake_page(light_, pages_[p], bake, context);
  }

  const ChartLight& light_;
  const PageLayout& layout_;
  const ExportOptions& options_;
  const int mip_levels_;
  AtomicFiles& files_;
  const Context& context_;
  const Context& images_;
  std::vector<std::vector<ChartPlacement>> pages_;
  std::optional<FidelityMeter> meter_;
  std::vector<double> write_cpu_;  // one per page; each writer adds to its own
  std::mutex reporting_;
  std::vector<double> fraction_;  // one per page: how much is done
  double fractions_ = 0;          // their sum
  std::size_t written_ = 0;       // pages
  bool baked_ = false;            // all pages are
  BakedPages result_;
};

}  // namespace

Result<BakedPages> bake_pages(const PagesToBake& pages, AtomicFiles& files, const Context& context,
                              const Context& images) {
  return PageBaker(pages, files, context, images).run();
}

}  // namespace atlas
