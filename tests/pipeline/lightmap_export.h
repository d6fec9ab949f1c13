// The options of exports whose lightmap tests look at.
#pragma once

#include <filesystem>

#include "libatlas/pipeline/export_options.h"

namespace atlas::test {

inline ExportOptions lightmap_options(const std::filesystem::path& target) {
  ExportOptions options;
  options.packing = PackPreset::fast;
  options.target = target;
  options.atlas_size = 512;
  options.keep_scene = true;
  options.exr = true;
  options.threshold = 0;
  return options;
}

}  // namespace atlas::test
