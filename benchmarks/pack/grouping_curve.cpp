// Prints F(A) around the result of the bisection and its steps, for the plot of grouping_curve.gp.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <random>

#include "apps/common/options.h"
#include "libatlas/pack/grouping.h"

int main(int argc, char** argv) {
  std::size_t items = 60;
  atlas::GroupingOptions options;
  options.groups = 8;
  CLI::App app("Prints F(A), the groups that a capacity A needs, of random sizes.",
               "atlas-bench-grouping");
  app.add_option("items", items, "how many")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("groups", options.groups, "wanted")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  if (const int code = atlas::app::parse(app, argc, argv); code >= 0) return code;
  std::mt19937 random(20240601);
  std::vector<std::uint64_t> sizes(items);
  for (auto& s : sizes) {
    double normal = -6;
    for (int k = 0; k < 12; ++k) normal += random() * 0x1p-32;
    s = static_cast<std::uint64_t>(600 * std::exp(normal));
  }
  const auto result = atlas::group_sizes(sizes, options, {});
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.status().message().c_str());
    return 1;
  }
  const std::uint64_t low = result->lower_bound - result->lower_bound / 20,
                      high = result->upper_bound;
  for (std::uint64_t a = low; a <= high; a += 1 + (high - low) / 4000)
    std::printf("%llu %u\n", static_cast<unsigned long long>(a),
                atlas::count_groups(sizes, a, options.groups + 4));
  std::printf("\n\n");
  for (const atlas::GroupingStep& s : result->trace)
    std::printf("%llu %u\n", static_cast<unsigned long long>(s.capacity), s.groups);
  return 0;
}
