// atlas-bench-compare BASE.json HEAD.json: exits with 0 if nothing got worse, 1 if something did, 2
// on errors.
#include "benchmarks/support/compare.h"

#include <cstdio>

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "apps/common/options.h"

int main(int argc, char** argv) {
  using namespace atlas::bench;
  CLI::App app("Compares two result files of atlas-bench; fails on a regression.",
               "atlas-bench-compare");
  std::string base_path, head_path;
  CompareOptions o;
  app.add_option("base", base_path, "the older file")->required();
  app.add_option("head", head_path, "the newer one")->required();
  app.add_option("--quality", o.quality_relative,
                 "relative growth of an error that counts; of stretches, of what exceeds 1")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--quality-least", o.quality_absolute, "and the absolute one")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--time", o.time_relative, "of CPU time")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--time-least", o.time_absolute, "seconds")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--instructions", o.instructions_relative, "of counted instructions")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--instructions-least", o.instructions_absolute, "and the absolute one")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--memory", o.memory_relative, "of memory")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  app.add_option("--memory-least", o.memory_absolute, "MiB")
      ->check(atlas::app::not_negative())
      ->capture_default_str();
  if (const int code = atlas::app::parse(app, argc, argv); code >= 0) return code;
  const auto base = load(base_path), head = load(head_path);
  for (const auto* file : {&base, &head}) {
    if (file->ok()) continue;
    fmt::print(stderr, "atlas-bench-compare: {}\n", file->status().message());
    return 2;
  }
  if (machine_count(std::vector{*base, *head}) > 1)
    fmt::print("The files are of different machines or builds: their times are not compared.\n");
  const auto found = compare(*base, *head, o);
  constexpr const char* kNames[] = {"quality",      "missing", "failed",
                                    "instructions", "time",    "memory"};
  for (const Regression& r : found) fmt::print("{:<12} {}\n", kNames[r.kind], r.what);
  fmt::print("{} rows and {} checks compared, {} regressions\n", base->rows.size(),
             base->checks.size(), found.size());
  return found.empty() ? 0 : 1;
}
