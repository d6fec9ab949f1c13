// Internal: bakes the pages and measures each against the input. With more than one thread as many
// pages as there are threads are baked at once, and as many written beside that: each of the two up
// to 256 MiB of texels, one page at least.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/bake/fidelity.h"
#include "libatlas/core/atomic_file.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/pipeline/page_layout.h"
#include "libatlas/report/export_report.h"

namespace atlas {

struct BakedPages {
  std::vector<PageReport> pages;
  std::vector<std::filesystem::path> image_sources;  // 1 a page: where its image lies until commit
  Fidelity fidelity;                                 // zero without ExportOptions::measure_error
  std::uint64_t covered_texels = 0;
  double bake_cpu = 0, write_cpu = 0, measure_cpu = 0;  // seconds
  // Seconds; of writing what the others waited for it.
  double bake_wall = 0, write_wall = 0, measure_wall = 0;
};

// The file name of a page's image, the extension left out: world.wrl gives world_0, world_1, ...
std::string page_name(const std::filesystem::path& target, std::size_t page);

// The light, where its charts lie, and how to bake and write it. All of it outlives the call.
struct PagesToBake {
  const ChartLight& light;
  const PageLayout& layout;
  const ExportOptions& options;
};

// Images are named after the target (safe_file_name): world.wrl gives world_0.png, world_1.png, ...
// and, with ExportOptions::exr, world_0.exr, ...; their temporary names are collected in `files`.
Result<BakedPages> bake_pages(const PagesToBake& pages, AtomicFiles& files, const Context& context);

}  // namespace atlas
