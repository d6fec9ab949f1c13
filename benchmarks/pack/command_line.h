// Command-line options that the packing benchmarks share.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "libatlas/pack/pack.h"

namespace atlas::bench {

// Adds --preset, --budget and --effort, for options that have all three.
template <class Options>
void add_effort_options(CLI::App& app, Options& options) {
  const std::map<std::string, PackPreset> presets{
      {"fast", PackPreset::fast}, {"default", PackPreset::standard}, {"best", PackPreset::best}};
  app.add_option("--preset", options.preset, "fast, default or best")
      ->transform(CLI::CheckedTransformer(presets).description(""))
      ->type_name("NAME")
      ->default_str("default");
  app.add_option("--budget", options.time_budget, "of best: seconds")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--effort", options.effort, "of best: layouts at most; 0: no limit")
      ->capture_default_str();
}

}  // namespace atlas::bench
