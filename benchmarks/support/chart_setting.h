// Settings of the charts stage that benchmarks compare.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "libatlas/charts/charts.h"

namespace atlas::bench {

struct ChartSetting {
  std::string name;
  bool preset = false;  // otherwise one option of the standard preset was changed
  ChartOptions options;
};

// Returns fast, standard and best.
inline std::vector<ChartSetting> chart_presets() {
  std::vector<ChartSetting> list{{"fast", true, {}}, {"standard", true, {}}, {"best", true, {}}};
  list[0].options.preset = ChartPreset::fast;
  list[2].options.preset = ChartPreset::best;
  return list;
}

// Returns a setting that is named by the prefix and the number.
inline ChartSetting with_stretch(double max_stretch, const std::string& prefix = "") {
  ChartSetting setting{fmt::format("{}{}", prefix, max_stretch), false, {}};
  setting.options.max_stretch = max_stretch;
  return setting;
}

}  // namespace atlas::bench
