// Runs pack_rects over a folder of instances ("W H n", then n lines "w h"; H = 0: a strip), checks
// every layout independently, and prints totals:
//   pack_sets FOLDER_OR_FILE... [--rotate] [--preset fast|default|best] [--budget S] [--effort
//   LAYOUTS] [--each]
//   [--strip]
//   [--engine skyline-bl|skyline-mw|max-rects]
// --strip ignores H and opens the page upwards; the optimum is taken to be the area bound.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libatlas/core/clock.h"
#include "libatlas/pack/pack.h"

namespace {

struct Instance {
  std::string name;
  atlas::Extent page;
  std::vector<atlas::Extent> items;
};

Instance read_instance(const std::filesystem::path& path) {
  Instance in;
  in.name = path.stem().string();
  std::ifstream file(path);
  int n = 0;
  file >> in.page.width >> in.page.height >> n;
  in.items.resize(static_cast<std::size_t>(n));
  for (auto& e : in.items) file >> e.width >> e.height;
  if (!file) {
    std::fprintf(stderr, "%s: malformed instance\n", path.c_str());
    std::exit(1);
  }
  return in;
}

// Every item inside its page, none overlapping: a sweep over x with the active items by y.
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
  std::vector<std::filesystem::path> files;  // sorted
};

Arguments read_arguments(int argc, char** argv) {
  Arguments read;
  atlas::PackOptions& options = read.options;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const auto value = [&] { return std::string(i + 1 < argc ? argv[++i] : ""); };
    if (a == "--rotate") {
      options.allow_rotation = true;
    } else if (a == "--strip") {
      read.strip = true;
    } else if (a == "--each") {
      read.each = true;
    } else if (a == "--preset") {
      const std::string p = value();
      options.preset = p == "fast"   ? atlas::PackPreset::fast
                       : p == "best" ? atlas::PackPreset::best
                                     : atlas::PackPreset::standard;
    } else if (a == "--engine") {
      const std::string e = value();
      options.engine = e == "skyline-bl"   ? atlas::PackEngine::skyline_bottom_left
                       : e == "skyline-mw" ? atlas::PackEngine::skyline_min_waste
                                           : atlas::PackEngine::max_rects;
    } else if (a == "--effort") {
      options.effort = std::strtoull(value().c_str(), nullptr, 10);
    } else if (a == "--budget") {
      options.time_budget = std::atof(value().c_str());
    } else if (std::filesystem::is_directory(a)) {
      for (const auto& e : std::filesystem::directory_iterator(a))
        if (e.path().extension() == ".txt") read.files.push_back(e.path());
    } else {
      read.files.push_back(a);
    }
  }
  std::sort(read.files.begin(), read.files.end());
  return read;
}

struct Totals {
  double cpu = 0, gap = 0;
  std::uint64_t bins = 0;
  int strips = 0, invalid = 0;
};

// Packs an instance, adds its figures to the totals and prints them if each is wanted.
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
    if (arguments.each)
      std::printf("%s bins %zu bound %u fill %.4f cpu %.4f\n", in.name.c_str(),
                  result->pages.size(), result->page_lower_bound, result->fill_without_last, spent);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments = read_arguments(argc, argv);
  Totals totals;
  for (const auto& file : arguments.files) run(read_instance(file), arguments, totals);
  std::printf("%zu instances, %d invalid, cpu %.4f s", arguments.files.size(), totals.invalid,
              totals.cpu);
  if (totals.strips) std::printf(", mean gap %.3f %%", totals.gap / totals.strips);
  if (totals.bins) std::printf(", bins %llu", static_cast<unsigned long long>(totals.bins));
  std::printf("\n");
  return totals.invalid > 0;
}
