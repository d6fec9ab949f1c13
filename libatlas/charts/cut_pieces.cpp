#include "libatlas/charts/cut_pieces.h"

#include <algorithm>
#include <compare>
#include <iterator>
#include <mutex>

#include "libatlas/charts/mesh/border_weight.h"
#include "libatlas/charts/mesh/pieces.h"
#include "libatlas/charts/segment.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/sort_total.h"

namespace atlas {
namespace {

constexpr std::size_t kTrianglesAtATime = 50000;

// How many segmentations ChartPreset::best tries, each from other cells.
constexpr int kBestAttempts = 4;

// Seams along the sides of polygons are longer than those along the edges of their triangles, by a
// tenth on grids of squares (4 / pi instead of 1.16 times the way across, averaged over all
// directions) and by a sixth on hexagons. Which cells seams follow makes as much of a difference,
// so meshes of polygons up to this size are cut in several ways, too: ten meshes of quads then have
// 1 % shorter seams than their triangles in one way, instead of 8 % longer ones.
constexpr std::size_t kPolygonTriangles = 200000;

int attempts_for(const FlattenInput& mesh) {
  if (mesh.options.preset == ChartPreset::best) return kBestAttempts;
  const bool polygons = !mesh.topology.polygon.empty() &&
                        mesh.options.preset != ChartPreset::fast &&
                        mesh.topology.triangle_count() <= kPolygonTriangles;
  return polygons ? kBestAttempts : 1;
}

// The cost of a piece's charts; less is better.
struct Cost {
  std::size_t charts = 0;
  double seams = 0;  // border_weight
  auto operator<=>(const Cost&) const = default;
};

std::vector<Cost> costs(const FlattenInput& mesh, const Partition& partition,
                        std::span<const FlatChart> charts) {
  const Topology& topology = mesh.topology;
  const double crease_angle = radians(mesh.options.crease_degrees);
  std::vector<Cost> costs(topology.component_count);
  for (const FlatChart& chart : charts) ++costs[chart.piece(topology)].charts;
  for (std::uint32_t h = 0; h < topology.opposite.size(); ++h) {
    const std::uint32_t o = topology.opposite[h];
    if (o == kNoIndex || partition.chart[h / 3] == kNoIndex) continue;
    if (partition.chart[h / 3] == partition.chart[o / 3] && !partition.seam(h)) continue;
    costs[topology.component[h / 3]].seams += 0.5 * border_weight(topology, h, crease_angle);
  }
  return costs;
}

// The best charts of each piece in several attempts.
class BestCharts {
 public:
  explicit BestCharts(const FlattenInput& mesh) : mesh_(mesh) {}

  void take(const Partition& partition, FlattenResult flat) {
    const std::vector<Cost> made = costs(mesh_, partition, flat.charts);
    const bool first = least_.empty();
    least_.resize(made.size());
    best_.splits.resize(made.size());
    std::vector<bool> better(made.size());
    for (std::size_t piece = 0; piece < made.size(); ++piece) {
      better[piece] = first || made[piece] < least_[piece];
      if (!better[piece]) continue;
      least_[piece] = made[piece];
      best_.splits[piece] = flat.splits[piece];
    }
    const auto changes = [&](const FlatChart& chart) {
      return better[chart.piece(mesh_.topology)];
    };
    std::erase_if(best_.charts, changes);
    std::copy_if(std::move_iterator(flat.charts.begin()), std::move_iterator(flat.charts.end()),
                 std::back_inserter(best_.charts), changes);
  }

  // The charts are not in order.
  FlattenResult result() && { return std::move(best_); }

 private:
  const FlattenInput& mesh_;
  FlattenResult best_;
  std::vector<Cost> least_;  // one per piece
};

// Cuts the whole mesh at once.
CutCharts cut_mesh(const FlattenInput& mesh, const Context& context) {
  const int attempts = attempts_for(mesh);
  CutCharts out;
  FlattenResult chosen;
  BestCharts best(mesh);
  for (int i = 0; i < attempts; ++i) {
    const double start = own_cpu_seconds();
    Segmentation segmentation = segment(mesh.topology, mesh.options, double(i) / attempts, context);
    if (context.cancelled()) return out;
    if (mesh.topology.triangle_count() > kTrianglesAtATime) return_freed_memory();
    out.timing.segmentation_cpu += own_cpu_seconds() - start;
    context.report("charts", (i + 0.5) / attempts);
    FlattenResult flat =
        flatten_charts({mesh.topology, mesh.density, mesh.options, segmentation.frames},
                       segmentation.partition, context);
    add_parts(segmentation.timing, out.timing);
    add_parts(flat.timing, out.timing);
    if (context.cancelled()) return out;
    if (attempts == 1) {
      chosen = std::move(flat);
    } else {
      best.take(segmentation.partition, std::move(flat));
    }
  }
  if (attempts > 1) {
    chosen = std::move(best).result();
    sort_by_triangle(chosen.charts);
  }
  out.split_charts = chosen.split_charts();
  out.charts = std::move(chosen.charts);
  return out;
}

// Cuts pieces of a mesh in batches of about kTrianglesAtATime triangles.
class Batches {
 public:
  Batches(const FlattenInput& mesh, std::span<const std::uint32_t> pieces, const Context& context)
      : mesh_(mesh), pieces_(pieces), context_(context), cutter_(mesh.topology) {
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
      if (count == 0) first_.push_back(i);
      all_ += cutter_.triangle_count(pieces[i]);
      count += cutter_.triangle_count(pieces[i]);
      if (count >= kTrianglesAtATime) count = 0;
    }
    first_.push_back(static_cast<std::uint32_t>(pieces.size()));
    inner_ = context;
    if (first_.size() > 2) inner_.progress = nullptr;
  }

  CutCharts run() {
    std::vector<CutCharts> made(first_.size() - 1);
    parallel_for(context_, made.size(), 1, [&](std::size_t begin, std::size_t) {
      made[begin] = cut(pieces_.subspan(first_[begin], first_[begin + 1] - first_[begin]));
    });
    CutCharts out;
    for (CutCharts& batch : made) append(std::move(batch), out);
    sort_by_triangle(out.charts);
    return out;
  }

 private:
  CutCharts cut(std::span<const std::uint32_t> pieces) {
    const double start = own_cpu_seconds();
    PieceMesh part;
    {
      const std::lock_guard lock(mutex_);  // the cutter's scratch memory covers the whole mesh
      part = cutter_.cut(pieces);
    }
    std::vector<float> density;
    if (!mesh_.density.empty()) {
      for (const std::uint32_t t : part.triangles) density.push_back(mesh_.density[t]);
    }
    Frames none;
    const double cutting = own_cpu_seconds() - start;
    CutCharts made = cut_mesh({part.topology, density, mesh_.options, none}, inner_);
    made.timing.segmentation_cpu += cutting;
    for (FlatChart& chart : made.charts) {
      for (std::uint32_t& t : chart.triangles) t = part.triangles[t];
      for (std::uint32_t& v : chart.vertex) v = part.topology.source_vertex[v];
    }
    if (!inner_.progress) report(part.triangles.size());
    return made;
  }

  void report(std::size_t triangles) {
    const std::lock_guard lock(mutex_);
    done_ += triangles;
    context_.report("charts", double(done_) / double(all_));
  }

  const FlattenInput& mesh_;
  std::span<const std::uint32_t> pieces_;
  const Context& context_;
  Context inner_;  // of a batch
  std::mutex mutex_;
  PieceCutter cutter_;
  std::vector<std::uint32_t> first_;  // one per batch, and the end: index into pieces_
  std::size_t all_ = 0, done_ = 0;    // triangles
};

}  // namespace

void append(CutCharts part, CutCharts& whole) {
  std::move(part.charts.begin(), part.charts.end(), std::back_inserter(whole.charts));
  whole.split_charts += part.split_charts;
  whole.copied_pieces += part.copied_pieces;
  whole.timing.segmentation_cpu += part.timing.segmentation_cpu;
  add_parts(part.timing, whole.timing);
}

void sort_by_triangle(std::vector<FlatChart>& charts) {
  sort_total(charts.begin(), charts.end(), [](const FlatChart& a, const FlatChart& b) {
    return a.triangles.front() < b.triangles.front();
  });
}

CutCharts cut_pieces(const FlattenInput& mesh, std::span<const std::uint32_t> pieces,
                     const Context& context) {
  const std::size_t n = mesh.topology.triangle_count();
  // A large piece with little beside it gains nothing from batches, and would be in memory twice.
  if (pieces.size() == mesh.topology.component_count &&
      (n <= kTrianglesAtATime || n / kTrianglesAtATime >= pieces.size())) {
    return cut_mesh(mesh, context);
  }
  return Batches(mesh, pieces, context).run();
}

}  // namespace atlas
