#include "benchmarks/support/results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace atlas::bench {

std::string Row::key() const {
  std::string text = fmt::format("{} | {} | {}", stage, mesh, setting);
  if (threads > 0) text += fmt::format(" | threads {}", threads);
  return text;
}

double Row::value(const std::string& name, double missing) const {
  for (const auto& [key, v] : values)
    if (key == name) return v;
  return missing;
}

std::string line(const Row& row) {
  const std::string head = fmt::format("{:<11} {:<18} {:<22}", row.stage, row.mesh, row.setting);
  if (!row.failure.empty()) return head + "  " + row.failure;
  std::string text = head + fmt::format(" {:>9} {:>9} {:<21}", row.size_in, row.size_out, row.unit);
  for (const auto& [name, v] : row.values) text += fmt::format(" {} {:.4g}", name, v);
  return text + fmt::format("  {:.1f} ms  {:.0f} MiB", 1e3 * row.cpu_seconds, row.memory_mib);
}

namespace {

struct Point {
  double x, y;
};

Fit fitted(const std::vector<Point>& points) {
  double mx = 0, my = 0, xx = 0, xy = 0;
  for (const Point& p : points) {
    mx += p.x / double(points.size());
    my += p.y / double(points.size());
  }
  for (const Point& p : points) {
    xx += (p.x - mx) * (p.x - mx);
    xy += (p.x - mx) * (p.y - my);
  }
  Fit fit;
  fit.exponent = xx > 0 ? xy / xx : 0;
  fit.factor = std::exp(my - fit.exponent * mx);
  fit.points = std::uint32_t(points.size());
  return fit;
}

}  // namespace

std::vector<Fit> fit_exponents(const std::vector<Row>& rows, std::uint64_t smallest) {
  std::map<std::string, std::vector<const Row*>> series;
  for (const Row& row : rows) {
    const auto colon = row.mesh.find(':');
    if (!row.preset || !row.failure.empty() || colon == std::string::npos) continue;
    if (row.mesh.rfind("file:", 0) == 0) continue;  // these are different shapes, not sizes of one
    if (row.triangles < smallest || row.cpu_seconds <= 0 || row.memory_mib <= 0) continue;
    series[row.stage + "|" + row.mesh.substr(0, colon) + "|" + row.setting + "|" +
           std::to_string(row.threads)]
        .push_back(&row);
  }
  std::vector<Fit> fits;
  for (const auto& [key, members] : series) {
    std::vector<Point> time, memory;
    std::uint64_t low = ~0ull, high = 0;
    for (const Row* row : members) {
      const double x = std::log(double(row->triangles));
      time.push_back({x, std::log(row->cpu_seconds)});
      memory.push_back({x, std::log(row->memory_mib)});
      low = std::min(low, row->triangles);
      high = std::max(high, row->triangles);
    }
    if (low == high) continue;
    const Row& first = *members.front();
    for (const bool of_time : {true, false}) {
      Fit fit = fitted(of_time ? time : memory);
      fit.stage = first.stage;
      fit.work = first.mesh.substr(0, first.mesh.find(':')) + ", " + first.setting;
      fit.quantity = of_time ? "cpu_seconds" : "memory_mib";
      fit.smallest = low;
      fit.largest = high;
      fits.push_back(fit);
    }
  }
  return fits;
}

}  // namespace atlas::bench
