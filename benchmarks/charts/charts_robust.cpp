#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "benchmarks/charts/charts_bench.h"
#include "libatlas/charts/charts.h"

namespace atlas::bench {
namespace {

using Positions = std::vector<Vec3f>;

Result<ChartSet> charts_of(const Positions& positions, const Scene& scene, int threads,
                           const Context& context) {
  Context own = context;
  if (threads > 0) own.threads = threads;
  MeshView view;
  view.positions = positions;
  view.indices = scene.indices;
  return make_charts(view, {}, own);
}

struct Range {
  std::size_t least = SIZE_MAX, most = 0;
  double change = 0;  // largest relative change of the L2 stretch
  void add(const ChartSet& set, const ChartSet& reference) {
    least = std::min(least, set.charts.size());
    most = std::max(most, set.charts.size());
    change =
        std::max(change, std::abs(set.distortion.stretch_l2 / reference.distortion.stretch_l2 - 1));
  }
  std::string text() const {
    return fmt::format("{} ({:.2f} %)",
                       least == most ? fmt::format("{}", least) : fmt::format("{}-{}", least, most),
                       100 * change);
  }
};

Positions scaled(const Positions& positions, double factor) {
  Positions result;
  for (const Vec3f& p : positions)
    result.push_back({float(factor * p.x), float(factor * p.y), float(factor * p.z)});
  return result;
}

// Applies a random unit quaternion (Shoemake 1992) in double.
Positions turned(const Positions& positions, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
  const double u = uniform(), a = 2 * std::numbers::pi * uniform(),
               b = 2 * std::numbers::pi * uniform(), r = std::sqrt(1 - u), s = std::sqrt(u);
  const double x = r * std::sin(a), y = r * std::cos(a), z = s * std::sin(b), w = s * std::cos(b);
  Positions result;
  for (const Vec3f& p : positions)
    result.push_back({float((1 - 2 * (y * y + z * z)) * p.x + 2 * (x * y - w * z) * p.y +
                            2 * (x * z + w * y) * p.z),
                      float(2 * (x * y + w * z) * p.x + (1 - 2 * (x * x + z * z)) * p.y +
                            2 * (y * z - w * x) * p.z),
                      float(2 * (x * z - w * y) * p.x + 2 * (y * z + w * x) * p.y +
                            (1 - 2 * (x * x + y * y)) * p.z)});
  return result;
}

// Writes the moved mesh with all digits of a double and reads it back.
Result<LoadedScene> moved(const Scene& scene, double offset, const Context& context) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("atlas_robust_{}.obj", ::getpid());
  {
    std::ofstream file(path);
    for (const Vec3f& p : scene.positions)
      file << fmt::format("v {} {} {}\n", p.x + offset, p.y - 0.7 * offset, p.z + 0.31 * offset);
    for (std::size_t i = 0; i < scene.indices.size(); i += 3)
      file << fmt::format("f {} {} {}\n", scene.indices[i] + 1, scene.indices[i + 1] + 1,
                          scene.indices[i + 2] + 1);
  }
  Result<LoadedScene> read = read_scene(path, {}, context);
  std::filesystem::remove(path);
  return read;
}

// Counts the cases that keep the number of charts within 3 %, and the numbers of the other cases.
struct Kept {
  std::size_t reference;
  int cases = 0, kept = 0;
  std::map<std::size_t, int> others = {};
  void add(const ChartSet& set) {
    const double change = std::abs(double(set.charts.size()) / double(reference) - 1);
    ++cases;
    change <= 0.03 ? void(++kept) : void(++others[set.charts.size()]);
  }
  std::string text() const {
    std::string text = fmt::format("{} of {}", kept, cases);
    for (const auto& [charts, times] : others) text += fmt::format(", {} x {}", times, charts);
    return text;
  }
};

bool same(const ChartSet& set, const ChartSet& reference, double factor) {
  if (set.triangle_chart != reference.triangle_chart || set.triangle_uv != reference.triangle_uv ||
      set.uvs.size() != reference.uvs.size())
    return false;
  for (std::size_t i = 0; i < set.uvs.size(); ++i)
    if (set.uvs[i].x != factor * reference.uvs[i].x || set.uvs[i].y != factor * reference.uvs[i].y)
      return false;
  return true;
}

}  // namespace

std::string charts_robust_head() {
  return "| mesh | charts | L2 | units 10^-6..10^6 | rotations | offsets to 10^6 | 2^-40..2^40 | "
         "1, 2, 8 threads |\n|---|---|---|---|---|---|---|---|";
}

Result<std::string> charts_robust_row(const std::string& name, const LoadedScene& loaded, int turns,
                                      const Context& context) {
  const Scene& scene = loaded.scene;
  const Result<ChartSet> reference = charts_of(scene.positions, scene, 1, context);
  if (!reference.ok()) return reference.status();
  Range units, rotations, offsets;
  bool bits = true, threads = true;
  const auto each = [&](const Positions& positions, int count, auto&& body) -> Status {
    const Result<ChartSet> set = charts_of(positions, scene, count, context);
    if (set.ok()) body(*set);
    return set.status();
  };
  for (const double factor : {1e-6, 1e-3, 0.0254, 0.3048, 10.0, 1e3, 1e6})
    if (const Status s = each(scaled(scene.positions, factor), 0,
                              [&](const ChartSet& set) { units.add(set, *reference); });
        !s.ok())
      return s;
  for (int i = 1; i <= turns; ++i)
    if (const Status s = each(turned(scene.positions, std::uint64_t(i)), 0,
                              [&](const ChartSet& set) { rotations.add(set, *reference); });
        !s.ok())
      return s;
  for (const double times : {1e2, 1e4, 1e6}) {
    const Result<LoadedScene> far =
        moved(scene, times * std::sqrt(reference->surface_area), context);
    if (!far.ok()) return far.status();
    const Result<ChartSet> set = charts_of(far->scene.positions, far->scene, 0, context);
    if (!set.ok()) return set.status();
    offsets.add(*set, *reference);
  }
  for (const int exponent : {-40, 40}) {
    const double factor = std::ldexp(1, exponent);
    if (const Status s = each(scaled(scene.positions, factor), 0,
                              [&](const ChartSet& set) { bits &= same(set, *reference, factor); });
        !s.ok())
      return s;
  }
  for (const int count : {2, 8})
    if (const Status s = each(scene.positions, count,
                              [&](const ChartSet& set) { threads &= same(set, *reference, 1); });
        !s.ok())
      return s;
  return fmt::format("| {} | {} | {:.4f} | {} | {} | {} | {} | {} |", name,
                     reference->charts.size(), reference->distortion.stretch_l2, units.text(),
                     rotations.text(), offsets.text(), bits ? "same bits" : "DIFFER",
                     threads ? "same bits" : "DIFFER");
}

std::string charts_cases_head() {
  return "| mesh | charts | rotations kept within 3 % | units | offsets |\n|---|---|---|---|---|";
}

Result<std::string> charts_cases_row(const std::string& name, const LoadedScene& loaded, int cases,
                                     const Context& context) {
  const Scene& scene = loaded.scene;
  const Result<ChartSet> reference = charts_of(scene.positions, scene, 0, context);
  if (!reference.ok()) return reference.status();
  Kept rotations{reference->charts.size()}, units = rotations, offsets = rotations;
  std::mt19937_64 random(1);
  const auto power = [&](double from, double to) {  // a random power of ten
    return std::pow(10, from + (to - from) * double(random() >> 11) * 0x1p-53);
  };
  for (int i = 1; i <= cases; ++i) {
    const Result<ChartSet> rotated =
        charts_of(turned(scene.positions, 1000 + std::uint64_t(i)), scene, 0, context);
    if (!rotated.ok()) return rotated.status();
    rotations.add(*rotated);
    const Result<ChartSet> unit =
        charts_of(scaled(scene.positions, power(-6, 6)), scene, 0, context);
    if (!unit.ok()) return unit.status();
    units.add(*unit);
    const Result<LoadedScene> far =
        moved(scene, power(0, 6) * std::sqrt(reference->surface_area), context);
    if (!far.ok()) return far.status();
    const Result<ChartSet> offset = charts_of(far->scene.positions, far->scene, 0, context);
    if (!offset.ok()) return offset.status();
    offsets.add(*offset);
  }
  return fmt::format("| {} | {} | {} | {} | {} |", name, reference->charts.size(), rotations.text(),
                     units.text(), offsets.text());
}

}  // namespace atlas::bench
