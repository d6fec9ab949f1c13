// Internal: bakes the pages and measures each against the input. With several threads, as many
// pages as there are threads are baked at once, while as many others are written. Each of these two
// groups has at most 256 MiB of texels, or a single page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/bake/fidelity.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

struct BakedPages {
  std::vector<PageReport> pages;
  // One per page: where its image lies until the files are committed.
  std::vector<std::filesystem::path> image_sources;
  Fidelity fidelity;  // zero without ExportOptions::measure_error
  // One per page: where on it the error lies, in cells of 32 texels. Empty without measure_error.
  std::vector<FidelityMeter::Cells> error;
  std::uint64_t covered_texels = 0;
  double bake_cpu = 0, write_cpu = 0, measure_cpu = 0;  // seconds
  // Seconds. write_wall is only the time for which the other work waited for writing.
  double bake_wall = 0, write_wall = 0, measure_wall = 0;
};

// The light, where its charts lie, and how to bake and write it. All of it must outlive the call.
struct PagesToBake {
  const ChartLight& light;
  const PageLayout& layout;
  const ExportOptions& options;
  int mip_levels = 0;  // for which the pages were laid out
};

// Bakes the pages and writes their images, which are named after the target (safe_file_name):
// world.wrl gives world_0.png, world_1.png, ... (.webp, if asked for; with ExportOptions::linear,
// pages of light, see write_light_page()) and, with ExportOptions::exr, world_0.exr, ... Their
// temporary names are collected in `files`. `images` gets the progress of the images that are still
// to be written when all pages are baked.
Result<BakedPages> bake_pages(const PagesToBake& pages, AtomicFiles& files, const Context& context,
                              const Context& images);

}  // namespace atlas
