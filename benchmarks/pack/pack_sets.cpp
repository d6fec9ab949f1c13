// Runs pack_rects over instances ("W H n", then n lines "w h"; H = 0: a strip), checks every layout
// independently, and prints totals. With --strip, the area bound is used as the optimum.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "apps/common/options.h"
#include "benchmarks/pack/command_line.h"
#include "libatlas/core/clock.h"
#include "libatlas/pack/pack.h"

namespace {

struct Instance {
  std::string name;
  atlas::Extent page;
  std::vector<atlas::Extent> items;
};

atlas::Result<Instance> read_instance(const std::filesystem::path& path) {
  Instance in;
  in.name = path.stem().string();
  std::ifstream file(path);
  std::size_t n = 0;
  file >> in.page.width >> in.page.height >> n;
  for (atlas::Extent e; in.items.size() < n && file >> e.width >> e.height;) in.items.push_back(e);
  if (file && !in.items.empty()) return in;
  return atlas::Status(
      atlas::ErrorCode::bad_input,
      fmt::format("{}: is no instance (a line \"width height count\", then so many "
                  "of two numbers)",
                  path.string()));
}

// Checks that every item lies inside its page and that none overlap, by a sweep over x with the
// active items ordered by y.
bool valid(const Instance& in, const atlas::PackResult& result, bool rotate) {
  struct Box {
    std::uint32_t page;
    std::int64_t x0, y0, x1, y1;
  };
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < in.items.size(); ++i) {
    const auto& p = result.placements[i];
    if (!p.placed() || (p.rotated && !rotate)) return false;
    auto e = in.items[i];
    if (p.rotated) std::swap(e.width, e.height);
    if (p.x < 0 || p.y < 0 || p.x + e.width > result.pages[p.page].width ||
        p.y + e.height > result.pages[p.page].height)
      return false;
    boxes.push_back({p.page, p.x, p.y, p.x + e.width, p.y + e.height});
  }
  std::sort(boxes.begin(), boxes.end(), [](const Box& a, const Box& b) {
    return a.page != b.page ? a.page < b.page : a.x0 < b.x0;
  });
  std::vector<Box> active;
  std::uint32_t page = atlas::kNoPage;
  for (const Box& b : boxes) {
    if (b.page != page) active.clear();
    page = b.page;
    std::erase_if(active, [&](const Box& a) { return a.x1 <= b.x0; });
    for (const Box& a : active)
      if (a.y0 < b.y1 && b.y0 < a.y1) return false;
    active.push_back(b);
  }
  return true;
}

struct Arguments {
  atlas::PackOptions options;
  bool each = false, strip = false;
  std::vector<std::string> places;
};

// Returns the given files and the .txt files of given folders, sorted.
std::vector<std::filesystem::path> instances_in(const std::vector<std::string>& places) {
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path place : places) {
    if (!std::filesystem::is_directory(place)) {
      files.push_back(place);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(place))
      if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

struct Totals {
  double cpu = 0, gap = 0;
  std::uint64_t bins = 0;
  int strips = 0, invalid = 0;
};

// Prints what is filled of all pages, and of all but the last one if there are several: the last
// one holds what is left over.
void print_bins(const std::string& name, const atlas::PackResult& result, double spent) {
  fmt::print("{} bins {} bound {} fill {:.4f}", name, result.pages.size(), result.page_lower_bound,
             result.utilization);
  if (result.pages.size() > 1) fmt::print(" but-the-last {:.4f}", result.fill_without_last);
  fmt::print(" cpu {:.4f}\n", spent);
}

// Packs an instance, adds its figures to the totals, and prints them if each instance is wanted.
void run(Instance in, Arguments& arguments, Totals& totals) {
  if (arguments.strip) in.page.height = 0;
  arguments.options.page = in.page;
  atlas::Context context;
  context.threads = 1;
  const double start = atlas::cpu_seconds();
  auto result = atlas::pack_rects(in.items, arguments.options, context);
  const double spent = atlas::cpu_seconds() - start;
  totals.cpu += spent;
  if (!result.ok() || !valid(in, *result, arguments.options.allow_rotation)) {
    ++totals.invalid;
    std::printf("%s: INVALID %s\n", in.name.c_str(), result.status().message().c_str());
    return;
  }
  if (in.page.height == 0) {
    std::int64_t area = 0;
    for (const auto& e : in.items) area += e.area();
    const double optimum = double((area + in.page.width - 1) / in.page.width);
    const double gap = 100 * (result->pages[0].height - optimum) / optimum;
    totals.gap += gap;
    ++totals.strips;
    if (arguments.each) std::printf("%s gap %.2f cpu %.3f\n", in.name.c_str(), gap, spent);
  } else {
    totals.bins += result->pages.size();
    if (arguments.each) print_bins(in.name, *result, spent);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Packs sets of rectangles and checks every layout.", "atlas-bench-pack-sets");
  Arguments arguments;
  atlas::PackOptions& options = arguments.options;
  app.add_option("instances", arguments.places, "folders of .txt files, or files")
      ->required()
      ->check(CLI::ExistingPath);
  app.add_flag("--rotate", options.allow_rotation, "allow quarter turns");
  app.add_flag("--strip", arguments.strip, "open the pages upwards");
  app.add_flag(
      "--each", arguments.each,
      "a line an instance; fill: of all pages, but-the-last: of all pages but the last one");
  const std::map<std::string, atlas::PackEngine> engines{
      {"automatic", atlas::PackEngine::automatic},
      {"skyline-bl", atlas::PackEngine::skyline_bottom_left},
      {"skyline-mw", atlas::PackEngine::skyline_min_waste},
      {"max-rects", atlas::PackEngine::max_rects}};
  app.add_option("--engine", options.engine, "automatic, skyline-bl, skyline-mw or max-rects")
      ->transform(CLI::CheckedTransformer(engines).description(""))
      ->type_name("NAME")
      ->default_str("automatic");
  atlas::bench::add_effort_options(app, options);
  if (const int code = atlas::app::parse(app, argc, argv); code >= 0) return code;
  const auto files = instances_in(arguments.places);
  if (files.empty()) {
    fmt::print(stderr, "atlas-bench-pack-sets: no .txt file in {}\n", arguments.places.front());
    return 1;
  }
  Totals totals;
  for (const auto& file : files) {
    atlas::Result<Instance> instance = read_instance(file);
    if (!instance.ok()) {
      fmt::print(stderr, "atlas-bench-pack-sets: {}\n", instance.status().message());
      return 1;
    }
    run(std::move(*instance), arguments, totals);
  }
  fmt::print("{} instances, {} invalid, cpu {:.4f} s", files.size(), totals.invalid, totals.cpu);
  if (totals.strips) fmt::print(", mean gap {:.3f} %", totals.gap / totals.strips);
  if (totals.bins) fmt::print(", bins {}", totals.bins);
  fmt::print("\n");
  return totals.invalid > 0;
}
