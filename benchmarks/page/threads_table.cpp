#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/page/tables.h"

namespace atlas::bench {
namespace {

struct ThreadTimes {
  double wall = 0, cpu = 0;
  std::string source;
};
using ByCount = std::map<int, ThreadTimes>;
using StageAndMesh = std::pair<std::string, std::string>;

// Returns the name under which a row's times are added up. With several threads, images are written
// while the next pages are baked, so that neither wall time means anything by itself.
std::string thread_stage(const Row& row) {
  const bool overlapped = row.stage == "export/baking" || row.stage == "export/images";
  return overlapped ? "export/baking + images" : row.stage;
}

// Fills in the times of each stage on each mesh, in the order of the rows.
std::vector<std::pair<StageAndMesh, ByCount>> times_by_threads(const Results& all) {
  std::vector<std::pair<StageAndMesh, ByCount>> table;
  for (const Row& row : all.rows) {
    if (row.threads == 0 || row.instructions > 0 || !row.failure.empty()) continue;
    if (row.setting != "standard" && row.stage != "baseline") continue;
    const StageAndMesh key(thread_stage(row), row.mesh);
    auto entry = std::find_if(table.begin(), table.end(),
                              [&](const auto& other) { return other.first == key; });
    if (entry == table.end()) entry = table.insert(table.end(), {key, {}});
    ThreadTimes& times = entry->second[row.threads];
    times.wall += row.wall_seconds;
    times.cpu += row.cpu_seconds;
    if (times.source.empty()) times.source = row.source;
  }
  return table;
}

}  // namespace

void threads_table(const Results& all, Document& page) {
  const auto table = times_by_threads(all);
  std::set<int> counts;
  for (const auto& [key, by_count] : table)
    for (const auto& [count, times] : by_count) counts.insert(count);
  if (counts.size() < 2) return;
  Cells header{"stage", "mesh"};
  for (const int n : counts) header.push_back(fmt::format("wall s, {}", n));
  for (const int n : counts) header.push_back(fmt::format("CPU s, {}", n));
  header.insert(header.end(), {"speed-up", "JSON"});
  std::vector<Cells> rows;
  for (const auto& [key, by_count] : table) {
    if (by_count.size() != counts.size()) continue;
    Cells cells{key.first, key.second};
    for (const auto& [n, times] : by_count) cells.push_back(fmt::format("{:.2f}", times.wall));
    for (const auto& [n, times] : by_count) cells.push_back(fmt::format("{:.2f}", times.cpu));
    const double first = by_count.begin()->second.wall, last = by_count.rbegin()->second.wall;
    cells.push_back(last > 0 ? fmt::format("{:.2f}", first / last) : "-");
    cells.push_back(by_count.begin()->second.source);
    rows.push_back(cells);
  }
  page.heading("Threads");
  page.paragraph(
      "The same work on one thread and on several; the results are the same bytes. Baking and "
      "images are one row, because images are written while the next pages are baked. Wall clocks "
      "mean what they say on a machine that does nothing else only.");
  page.table(header, rows);
}

}  // namespace atlas::bench
