#include "libatlas/charts/segment.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "libatlas/charts/cells/cells.h"
#include "libatlas/charts/cells/faces.h"
#include "libatlas/charts/cells/rows.h"
#include "libatlas/charts/piece_cuts.h"
#include "libatlas/charts/seams/refine.h"
#include "libatlas/charts/seams/slit_paths.h"
#include "libatlas/charts/seams/straighten.h"
#include "libatlas/core/clock.h"
#include "libatlas/core/degrees.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/portable_math.h"

namespace atlas {
namespace {

// Gives triangles their labels (beginning with `first_label`) and frames, and marks the seams of
// charts with themselves.
void spread_to_triangles(const Cut& cut, std::uint32_t first_label, Segmentation& result) {
  const auto& [topology, cells, coarse, merged, left_out] = cut;
  Partition& partition = result.partition;
  std::vector<std::uint32_t> frames(coarse.cells.size());
  for (std::uint32_t k = 0; k < frames.size(); ++k) {
    frames[k] = result.frames.add({coarse.cells[k].normal, cell_frame(coarse, merged.uv, k)});
  }
  for (std::uint32_t t = 0; t < topology.triangle_count(); ++t) {
    if (!cut.takes(t)) continue;
    const std::uint32_t k = cells.of_triangle[t];
    partition.chart[t] = first_label + merged.chart_of_cell[k];
    result.frames.share(t, frames[k]);
  }
  for (std::size_t i = 0; i < coarse.rim_half_edges.size(); ++i) {
    const std::uint32_t h = coarse.rim_half_edges[i], o = topology.opposite[h];
    if (o == kNoIndex || merged.joined[coarse.rim_arcs[i]] || !cut.takes(h / 3)) continue;
    const std::uint32_t a = h / 3, b = o / 3;
    if (partition.chart[a] != partition.chart[b]) continue;
    partition.seams[a] |= static_cast<std::uint8_t>(1u << (h % 3));
    partition.seams[b] |= static_cast<std::uint8_t>(1u << (o % 3));
  }
}

// Seams are straightened within bands of this share of a cell's width to each side, and at most so
// many rings of triangles. Wider bands make seams straighter, but more charts fail and are divided.
// ChartPreset::fast straightens once; otherwise two rounds in bands half as wide follow, in which
// borders adapt to those that end at them.
constexpr double kBandWidth = 2.0 / 3, kFastBandWidth = 0.25, kMostRings = 12;
constexpr int kRounds = 3;
// ChartPreset::fast has larger and therefore fewer cells: this takes a twelfth less time for a
// thirtieth more charts (77 meshes).
constexpr std::uint32_t kFastTrianglesPerCell = 250, kFastCellsOfSmallMesh = 60;

// Where faces cover kSomeFaces of a piece's area, it is cut a second time, with cells that faces
// bound; where they cover kAllFaces, only in that way. Boxes with holes came out in a third of the
// charts, but some parts with fillets in more (121 CAD parts and models: a twenty-fifth fewer
// charts, a sixth less seam, in the same time).
constexpr double kSomeFaces = 0.1, kAllFaces = 0.93;
constexpr std::size_t kFewCharts = 3;
// The cut by faces is taken if it has at most this share of the other cut's charts, or as many with
// shorter seams. Both are compared before they are flattened, and cells bound by faces merge less
// well after that: with 1, 171 CAD parts came out in 3 % more charts and 1 % longer seams, 11 parts
// in more charts and none in fewer. 0.85 saved 35 more charts, but 5 parts came out in more.
constexpr double kBetterByFaces = 0.92;

// Where the fans of a piece's cells err by more than kFanError of their area, its cells are grown
// again within rows of needles, if it has these, and are kept if their fans err by less than
// kBetterFans of that. Cells of most pieces err by 0.04 to 0.08. Six robots' parts with rows came
// out in 42 charts instead of 120, and 447 parts with some needles in 0.4 % fewer.
constexpr double kFanError = 0.06, kBetterFans = 0.5;

// Pieces of more than kManyTriangles are cut by their faces if, and only if, the fans of their
// cells err by more than kWrongFans: cells then hold several walls of teeth or holes. Otherwise
// cells are fine enough to find the creases. Faces saved hardly a chart there, and a cabin of a
// million triangles took three times as long. 33 printers' parts of that size err by 0.04 to 0.22,
// and came out in a ninth more charts by their faces.
constexpr std::size_t kManyTriangles = 20000;
constexpr double kWrongFans = 0.4;
// So are those with at least kFolded folds per triangle within their cells, if the borders of faces
// run through cells along at least kCrossed of their edges. The walls of involute teeth are low
// beside wide caps, so fans err little, but caps are joined to walls and cannot be flattened: gears
// of 30 000 to 120 000 triangles came out in 6 or 7 charts instead of 15 to 33. They have 0.21 to
// 0.47 folds per triangle and are crossed along 0.69 to 0.95; 33 printers' parts and 9 models of
// that size have at most 0.1, or no faces, and the parts are crossed along at most 0.52.
constexpr double kFolded = 0.15, kCrossed = 0.65;

// A piece that came out in more than kSomeCharts charts is cut again, with the cells that it would
// have alone, if these are kMuchFiner times as many. These charts are taken if they are at most
// kMuchBetter of the others: cells of few triangles make ragged charts, and in a truck of small
// parts a tie would be lost in later steps. A hundred cables of eight sides came out in 269 charts
// instead of 808, in three times the time, and 60 robots' parts in 4 % fewer, for 6 % more time.
// With kFewCharts in place of kSomeCharts, a cabin's many boxes took 60 % more time instead of
// 17 %, for 2 % fewer charts.
constexpr std::size_t kSomeCharts = 4;
constexpr std::uint32_t kMuchFiner = 2;
constexpr double kMuchBetter = 0.9;

// Which pieces are left out where cells ignore faces, and where faces bound them. The sides of a
// bent moulding are faces, too, so its cells may also lie within rows of needles.
struct Ways {
  std::vector<std::uint8_t> plain, walled;
  std::vector<std::uint8_t> by_rows;  // one per piece: of the plain cells only those within rows

  Ways(const CellPlan& plan, const Regions& faces, const Regions& rows, ChartPreset preset) {
    const double least = preset == ChartPreset::fast ? kAllFaces : kSomeFaces;
    for (std::size_t k = 0; k < faces.share.size(); ++k) {
      const bool neither = plan.cells[k] == 0;
      const bool all_faces = faces.share[k] >= kAllFaces;
      plain.push_back(neither || (all_faces && rows.share[k] == 0));
      by_rows.push_back(all_faces);
      walled.push_back(neither || faces.share[k] < least);
    }
  }

  // Leaves out pieces with few charts from the second way.
  void spare(const std::vector<PieceCost>& costs) {
    for (std::size_t k = 0; k < costs.size(); ++k) {
      if (costs[k].charts > 0 && costs[k].charts <= kFewCharts) walled[k] = 1;
    }
  }
};

std::vector<std::uint8_t> large_pieces(const CellPlan& plan) {
  std::vector<std::uint8_t> large;
  for (std::uint32_t k = 0; k < plan.pieces.count(); ++k) {
    large.push_back(plan.pieces.of(k).size() > kManyTriangles);
  }
  return large;
}

class Segmenter {
 public:
  Segmenter(const Topology& topology, const ChartOptions& options, double first_seed,
            const Context& context)
      : topology_(topology),
        options_(options),
        first_seed_(first_seed),
        context_(context),
        cone_(radians(options.cone_degrees)) {}

  Segmentation run() {
    const std::size_t n = topology_.triangle_count();
    result_.partition.chart.assign(n, kNoIndex);
    result_.partition.seams.assign(n, 0);
    result_.frames.resize(n);
    cut_into_labels();
    if (context_.cancelled()) return {};
    Stopwatch watch(own_cpu_seconds);
    const BorderRules rules{options_.crease_degrees, {axes_, portable::cos(cone_ - 1e-5)}};
    Slits slits(topology_, {rules, rings_}, result_.partition, result_.frames);
    slits.close();
    smooth_borders(topology_, rules, result_.partition, result_.frames);
    straighten(rules);
    slits.reopen();
    slits.straighten();
    result_.timing.borders_cpu = watch.lap();
    return std::move(result_);
  }

 private:
  void straighten(const BorderRules& rules) {
    std::vector<std::uint8_t> rings = rings_;
    const int rounds = options_.preset == ChartPreset::fast ? 1 : kRounds;
    for (int i = 0; i < rounds && !context_.cancelled(); ++i) {
      const std::vector<std::uint32_t> moved =
          straighten_borders(topology_, {rules, rings}, result_.partition, context_);
      carry_frames(topology_, moved, result_.frames);
      smooth_borders(topology_, rules, result_.partition, result_.frames);
      if (i == 0)
        for (std::uint8_t& width : rings) width = static_cast<std::uint8_t>((width + 1) / 2);
    }
  }

  void cut_into_labels() {
    Stopwatch watch(own_cpu_seconds);
    const CellOptions options = cell_options();
    const CellPlan plan = plan_cells(topology_, options);
    result_.timing.cells_cpu += watch.lap();
    std::vector<Cut> cuts;
    cut_in_both_ways(plan, cuts);
    if (options_.preset != ChartPreset::fast && !(cone_ > 0)) cut_finer(plan, cuts);
    if (context_.cancelled()) return;
    for (const Cut& made : cuts) take(made);
  }

  // Cuts pieces with many charts again, with the cells that each would have if it were the whole
  // mesh, and keeps the better charts. A mesh of many thin tubes has cells that wrap around them.
  void cut_finer(const CellPlan& plan, std::vector<Cut>& cuts) {
    if (topology_.component_count == 1 && topology_.whole_triangles <= topology_.triangle_count())
      return;
    Stopwatch watch(own_cpu_seconds);
    const std::vector<PieceCost> costs = chosen_costs(cuts);
    const auto many = [](const PieceCost& cost) { return cost.charts > kSomeCharts; };
    if (std::none_of(costs.begin(), costs.end(), many)) return;
    CellOptions alone = cell_options();
    alone.each_piece_alone = true;
    CellPlan finer = plan_cells(topology_, alone);
    for (std::size_t k = 0; k < costs.size(); ++k) {
      if (many(costs[k]) && finer.cells[k] >= kMuchFiner * plan.cells[k]) continue;
      finer.cells[k] = 0;
    }
    result_.timing.cells_cpu += watch.lap();
    const std::size_t coarse = cuts.size();
    cut_in_both_ways(finer, cuts);
    if (context_.cancelled()) return;
    for (std::size_t i = 0; i < coarse; ++i) {
      for (std::size_t j = coarse; j < cuts.size(); ++j)
        choose(cuts[i], cuts[j], kMuchBetter, false);
    }
  }

  // Adds up to two cuts with that number of cells, each of which leaves out the pieces that the
  // other one takes.
  void cut_in_both_ways(const CellPlan& plan, std::vector<Cut>& cuts) {
    Stopwatch watch(own_cpu_seconds);
    const Regions faces = find_faces(topology_, plan, large_pieces(plan));
    const Regions rows = find_rows(topology_, plan);
    Ways ways(plan, faces, rows, options_.preset);
    result_.timing.cells_cpu += watch.lap();
    const std::size_t first = cuts.size();
    if (takes_any(ways.plain)) cut_plainly({topology_, plan, &rows, ways.plain}, ways, cuts);
    if (context_.cancelled()) return;
    if (cuts.size() > first) ways.spare(chosen_costs(std::span(cuts).subspan(first)));
    if (!takes_any(ways.walled)) return;
    const std::size_t walled = cuts.size();
    cuts.push_back(grow({topology_, plan, &faces, ways.walled}));
    merge(cuts.back());
    if (context_.cancelled()) return;
    for (std::size_t i = first; i < walled; ++i)
      choose(cuts[i], cuts[walled], kBetterByFaces, true);
  }

  // Adds a cut with cells that nothing bounds, and one with cells that rows of needles bound. Each
  // leaves out the pieces that the other one takes.
  void cut_plainly(const CellInput& input, const Ways& ways, std::vector<Cut>& cuts) {
    CellInput freely = input;
    freely.regions = nullptr;
    std::vector<Cut> made;
    made.push_back(grow(freely));
    if (context_.cancelled()) return;
    bound_by_rows(input, made);
    for (std::size_t k = 0; k < ways.by_rows.size(); ++k) made[0].left_out[k] |= ways.by_rows[k];
    bound_by_faces(input.plan, ways.walled, made);
    for (Cut& cut : made) {
      if (context_.cancelled()) return;
      if (!takes_any(cut.left_out)) continue;
      merge(cut);
      cuts.push_back(std::move(cut));
    }
  }

  // Grows the cells of those pieces again, bounded by rows, whose fans err with the cells grown
  // freely, and keeps the better ones.
  void bound_by_rows(const CellInput& input, std::vector<Cut>& made) {
    const std::vector<double>& share = input.regions->share;
    if (std::all_of(share.begin(), share.end(), [](double s) { return s == 0; })) return;
    const std::vector<double> free_error = fan_errors(made[0]);
    std::vector<std::uint8_t> left_out = made[0].left_out;
    for (std::size_t k = 0; k < share.size(); ++k) {
      if (share[k] == 0 || free_error[k] < kFanError) left_out[k] = 1;
    }
    if (!takes_any(left_out)) return;
    made.push_back(grow({topology_, input.plan, input.regions, left_out}));
    if (context_.cancelled()) return;
    const std::vector<double> error = fan_errors(made[1]);
    for (std::size_t k = 0; k < share.size(); ++k) {
      if (!left_out[k]) made[error[k] < kBetterFans * free_error[k] ? 0 : 1].left_out[k] = 1;
    }
  }

  // Grows the cells of those pieces again, bounded by faces, whose fans are far from the cells
  // grown freely, or which have many folds within these. `unwalled` are the pieces that are not cut
  // by faces anyway.
  void bound_by_faces(const CellPlan& plan, std::span<const std::uint8_t> unwalled,
                      std::vector<Cut>& made) {
    if (!takes_any(made[0].left_out)) return;
    const std::vector<std::uint8_t> large = large_pieces(plan);
    const std::vector<double> error = fan_errors(made[0]);
    std::vector<double> folds(error.size(), 0);
    if (std::find(large.begin(), large.end(), 1) != large.end()) folds = folds_in_cells(made[0]);
    std::vector<std::uint8_t> left_out;
    for (std::size_t k = 0; k < error.size(); ++k) {
      const bool folded = large[k] && folds[k] >= kFolded;
      left_out.push_back(!unwalled[k] || (error[k] < kWrongFans && !folded));
    }
    if (!takes_any(left_out)) return;
    const Regions faces = find_faces(topology_, plan, left_out);
    const std::vector<double> crossed = crossed_borders(made[0], faces);
    for (std::size_t k = 0; k < error.size(); ++k) {
      const bool wrong = error[k] >= kWrongFans || crossed[k] >= kCrossed;
      left_out[k] |= faces.share[k] == 0 || !wrong;
    }
    if (!takes_any(left_out)) return;
    made.push_back(grow({topology_, plan, &faces, left_out}));
    for (std::size_t k = 0; k < error.size(); ++k) made[0].left_out[k] |= !left_out[k];
  }

  void take(const Cut& made) {
    spread_to_triangles(made, labels_, result_);
    add_rings(made.cells, made.merged);
    labels_ += static_cast<std::uint32_t>(made.coarse.cells.size());
    const std::vector<Vec3f>& axes = made.merged.chart_axis;
    axes_.insert(axes_.end(), axes.begin(), axes.end());
  }

  CellOptions cell_options() const {
    CellOptions options;
    options.mesh_triangles = std::max(topology_.whole_triangles, topology_.triangle_count());
    options.first_seed = first_seed_;
    if (options_.preset == ChartPreset::fast) {
      options.triangles_per_cell = kFastTrianglesPerCell;
      options.cells_of_small_mesh = kFastCellsOfSmallMesh;
    }
    return options;
  }

  // Returns a cut with cells that are not merged yet. It is incomplete if the context is cancelled.
  Cut grow(const CellInput& input) {
    Stopwatch watch(own_cpu_seconds);
    Cut made{topology_, {}, {}, {}, {input.left_out.begin(), input.left_out.end()}};
    made.cells = grow_cells(input, cell_options(), context_);
    if (context_.cancelled()) return made;
    if (cone_ > 0) split_by_cone(topology_, cone_, made.cells);
    result_.timing.cells_cpu += watch.lap();
    made.coarse = build_coarse(topology_, options_.crease_degrees, made.cells);
    result_.timing.coarse_cpu += watch.lap();
    return made;
  }

  void merge(Cut& made) {
    if (context_.cancelled()) return;
    Stopwatch watch(own_cpu_seconds);
    MergeOptions merge = merge_options(options_.max_stretch);
    ExtremeNormals normals;
    if (cone_ > 0) {
      // Keeps clear of the limit, since the final cone is measured with other rounding.
      normals = extreme_normals(topology_, made.cells);
      merge.cone = std::max(1e-9, cone_ - 2e-5);
      merge.cell_normals = &normals;
    }
    made.merged = merge_cells(made.coarse, pieces_of(made), merge, context_);
    result_.timing.merging_cpu += watch.lap();
  }

  void add_rings(const Cells& cells, const MergeResult& merged) {
    std::vector<std::uint32_t> triangles(cells.count, 0), cell_count(cells.count, 0);
    for (const std::uint32_t chart : merged.chart_of_cell) {
      if (chart != kNoIndex) ++cell_count[chart];  // a cell may have lost all its triangles
    }
    for (const std::uint32_t k : cells.of_triangle) {
      if (k != kNoIndex && merged.chart_of_cell[k] != kNoIndex)
        ++triangles[merged.chart_of_cell[k]];
    }
    const double share = options_.preset == ChartPreset::fast ? kFastBandWidth : kBandWidth;
    for (std::uint32_t k = 0; k < cells.count; ++k) {
      const double width = std::sqrt(double(triangles[k]) / std::max(cell_count[k], 1u));
      rings_.push_back(static_cast<std::uint8_t>(std::min(share * width, kMostRings)));
    }
  }

  const Topology& topology_;
  const ChartOptions& options_;
  double first_seed_;
  const Context& context_;
  double cone_;  // radians
  Segmentation result_;
  std::vector<std::uint8_t> rings_;  // by label: the width of the band that its borders move in
  std::uint32_t labels_ = 0;         // number of labels given so far
  std::vector<Vec3f> axes_;          // by label; only with a cone limit
};

}  // namespace

Segmentation segment(const Topology& topology, const ChartOptions& options, double first_seed,
                     const Context& context) {
  return Segmenter(topology, options, first_seed, context).run();
}

}  // namespace atlas
