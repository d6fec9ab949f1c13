// Prints F(A) around the bisection's answer and the steps taken, for a plot:
//   grouping_curve [items] [groups] > curve.txt
//   gnuplot -e "plot 'curve.txt' i 0 w steps t 'F(A)', '' i 1 w p t 'evaluated'"
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "libatlas/pack/grouping.h"

int main(int argc, char** argv) {
  const int items = argc > 1 ? std::atoi(argv[1]) : 60, groups = argc > 2 ? std::atoi(argv[2]) : 8;
  std::mt19937 random(20240601);
  std::vector<std::uint64_t> sizes(static_cast<std::size_t>(items));
  for (auto& s : sizes) {
    double normal = -6;
    for (int k = 0; k < 12; ++k) normal += random() * 0x1p-32;
    s = static_cast<std::uint64_t>(600 * std::exp(normal));
  }
  atlas::GroupingOptions options;
  options.groups = static_cast<std::uint32_t>(groups);
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
