#include "libatlas/charts/merging/merge.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <compare>
#include <numbers>
#include <queue>

#include "libatlas/charts/geometry/moments.h"
#include "libatlas/charts/merging/candidate.h"
#include "libatlas/charts/merging/coarse_chart.h"
#include "libatlas/charts/merging/cost_classes.h"
#include "libatlas/charts/merging/merge_budget.h"
#include "libatlas/charts/merging/runs.h"
#include "libatlas/core/glm_bridge.h"
#include "libatlas/core/parallel.h"

namespace atlas {
namespace {

// Under a cone limit charts are small and their outlines hardly matter; the number of charts does.
constexpr double kConeWeight = 1;
constexpr double kConeFill = 0.4;  // of both convex hull and rectangle

struct Border {
  std::uint32_t other;
  double length, weight;
  // Compares all members: weights would otherwise be added in any order where lengths are equal.
  auto operator<=>(const Border&) const = default;
};

// What the mergers of all pieces share.
struct MergeTask {
  const CoarseMesh& mesh;
  const MergeOptions& options;
  std::vector<std::uint32_t>& place;  // scratch, one per cell: its index in its piece's list
  MergeResult& result;
};

// Merges the cells of one piece of the mesh.
class Merger {
 public:
  Merger(const MergeTask& task, Trial& trial)
      : mesh_(task.mesh),
        options_(task.options),
        place_(task.place),
        result_(task.result),
        trial_(trial) {}

  void run(const std::vector<std::uint32_t>& cells, const Context& context) {
    charts_.resize(cells.size());
    for (std::uint32_t i = 0; i < cells.size(); ++i) place_[cells[i]] = i;
    std::size_t slots = 0;
    for (const std::uint32_t k : cells) {
      start(k);
      piece_area_ += mesh_.cells[k].area;
      slots += mesh_.cells[k].slot_count;
    }
    budget_ = MergeBudget(slots);
    for (const std::uint32_t k : cells) push_neighbours(k, true);
    empty_heap(context);
    relaxed_ = true;
    for (const std::uint32_t k : cells) {
      if (result_.chart_of_cell[k] == k) push_neighbours(k, true);
    }
    empty_heap(context);
  }

  // Tries the candidates in order of cost; once the budget makes it thrifty, lopsided ones last.
  void empty_heap(const Context& context) {
    std::vector<Candidate> later;
    for (bool postpone = true; !heap_.empty(); postpone = false) {
      while (!heap_.empty()) {
        if (context.cancelled()) return;
        const Candidate candidate = heap_.top();
        heap_.pop();
        const CoarseChart &p = chart(candidate.a), &q = chart(candidate.b);
        if (p.version != candidate.version_a || q.version != candidate.version_b) continue;
        const bool free = coplanar(p, q);
        if (!free && !budget_.affords(p.slots, q.slots)) continue;
        if (!free && postpone && budget_.postpones(p.slots, q.slots)) {
          later.push_back(candidate);
        } else {
          try_merge(candidate.a, candidate.b);
        }
      }
      for (const Candidate& candidate : later) heap_.push(candidate);
      later.clear();
    }
  }

  std::uint64_t work() const { return budget_.work(); }
  std::uint64_t trials = 0, rejections = 0;

 private:
  CoarseChart& chart(std::uint32_t name) { return charts_[place_[name]]; }
  const CoarseChart& chart(std::uint32_t name) const { return charts_[place_[name]]; }

  std::uint32_t chart_at(std::uint32_t arc, int side) const {
    const std::uint32_t cell = mesh_.arcs[arc].cell[side];
    return cell == kNoIndex ? kNoIndex : result_.chart_of_cell[cell];
  }

  void start(std::uint32_t k) {
    const CoarseCell& cell = mesh_.cells[k];
    CoarseChart& own = chart(k);
    own.cells = {k};
    own.moments = cell.moments;
    own.normal_sum = to_glm(cell.normal_sum);
    own.area = cell.area;
    own.slots = cell.slot_count;
    own.version = 1;
    own.flat = in_one_plane(own);
    if (options_.cone > 0) result_.chart_axis[k] = from_glm(glm::vec3(to_glm(cell.normal)));
    result_.chart_of_cell[k] = k;
    own.unrolls = cell.unrolls;
    if (cell.unrolls) {
      result_.uv.centre[k] = cell.flat_centre;
    } else {
      project_cell(mesh_, k, result_.uv);
    }
    for (std::uint32_t s = cell.first_slot; s < cell.first_slot + cell.slot_count; ++s) {
      own.arcs.push_back(mesh_.slot_arc[s]);
      own.perimeter += mesh_.arcs[mesh_.slot_arc[s]].length;
      if (cell.unrolls) result_.uv.slot[s] = mesh_.flat_slot[s];
    }
  }

  // Finds the charts that share arcs with `a`, ordered by id.
  void find_borders(std::uint32_t a) {
    borders_.clear();
    for (const std::uint32_t arc : chart(a).arcs) {
      const std::uint32_t c0 = chart_at(arc, 0), c1 = chart_at(arc, 1);
      const std::uint32_t other = c0 == a ? c1 : c0;
      if (other == kNoIndex || other == a) continue;
      borders_.push_back({other, mesh_.arcs[arc].length, mesh_.arcs[arc].weight});
    }
    std::sort(borders_.begin(), borders_.end());
    std::size_t kept = 0;
    for (std::size_t i = 0; i < borders_.size(); ++i) {
      if (kept > 0 && borders_[kept - 1].other == borders_[i].other) {
        borders_[kept - 1].length += borders_[i].length;
        borders_[kept - 1].weight += borders_[i].weight;
      } else {
        borders_[kept++] = borders_[i];
      }
    }
    borders_.resize(kept);
  }

  void push_neighbours(std::uint32_t a, bool once) {
    find_borders(a);
    budget_.count_borders(chart(a).arcs.size());
    for (const Border& border : borders_) {
      if (once && border.other < a) continue;
      if (relaxed_ &&
          std::min(chart(a).area, chart(border.other).area) > options_.small_share * piece_area_) {
        continue;
      }
      const std::uint32_t low = std::min(a, border.other), high = std::max(a, border.other);
      heap_.push(
          {cost_classes_(cost(a, border)), low, high, chart(low).version, chart(high).version});
    }
  }

  double cost(std::uint32_t a, const Border& border) const {
    const CoarseChart &p = chart(a), &q = chart(border.other);
    const double area = p.area + q.area;
    Moments m;
    for (int i = 0; i < 6; ++i) m[i] = (p.moments[i] + q.moments[i]) / area;
    m = about(m, from_glm((p.normal_sum + q.normal_sum) / area));
    // Under a cone limit the cost is how much of the cone is used up.
    const double spread = options_.cone > 0 ? kConeWeight * (m[0] + m[3] + m[5])
                                            : std::max(0.0, smallest_eigenvalue(m));
    const double perimeter = p.perimeter + q.perimeter - 2 * border.length;
    const double compact = perimeter / std::sqrt(4 * std::numbers::pi * area);
    return spread + options_.compactness_weight * compact +
           (border.length > 0 ? options_.crease_weight * (1 - border.weight / border.length) : 0);
  }

  // Whether all normals lie in one cone within the limit. Stores its axis in axis_.
  bool within_cone(std::uint32_t a, std::uint32_t b) {
    if (options_.cone <= 0) return true;
    normals_.clear();
    for (const std::uint32_t name : {a, b}) {
      for (const std::uint32_t k : chart(name).cells) {
        const std::span<const Vec3f> extreme = options_.cell_normals->of(k);
        normals_.insert(normals_.end(), extreme.begin(), extreme.end());
      }
    }
    const NormalCone cone = normal_cone(normals_);
    axis_ = cone.axis;
    return cone.angle <= options_.cone;
  }

  void try_merge(std::uint32_t a, std::uint32_t b) {
    const bool within = within_cone(a, b);
    if (chart(a).cells.size() < chart(b).cells.size()) std::swap(a, b);
    if (!within || !join(a, b)) {
      ++rejections;
      return;
    }
    trial_.commit();
    absorb(a, b);
    push_neighbours(a, false);
  }

  bool join(std::uint32_t a, std::uint32_t b) {
    glue_.clear();
    for (const std::uint32_t arc : chart(b).arcs) {
      const std::uint32_t c0 = chart_at(arc, 0), c1 = chart_at(arc, 1);
      if ((c0 == a && c1 == b) || (c0 == b && c1 == a)) glue_.push_back(arc);
    }
    std::sort(glue_.begin(), glue_.end());
    // Without a trial, whatever the outline: nothing is stretched, and an oriented surface in a
    // plane does not overlap itself.
    if (coplanar(chart(a), chart(b))) {
      energy_ = high_area_ = 0;
      euler_ = trial_.euler(chart(a).euler, chart(b).euler, glue_);
      unrolls_ = chart(a).unrolls && chart(b).unrolls;
      trial_.join_flat({chart(a).cells, chart(b).cells, glue_}, result_.joined);
      return true;
    }
    const TrialOutcome outcome = attempt(a, b);
    return outcome.accepted ||
           ((outcome.euler < 1 || glue_is_sharp()) &&
            keep_longest_run(mesh_, seam_ends(a, b), glue_) && attempt(a, b).accepted);
  }

  // Whether curvature is concentrated at an end of an arc that is glued.
  bool glue_is_sharp() const {
    return std::any_of(glue_.begin(), glue_.end(), [&](std::uint32_t arc) {
      const auto& slot = mesh_.arcs[arc].slot;
      return mesh_.slot_sharp[slot[0]] || mesh_.slot_sharp[slot[1]];
    });
  }

  TrialOutcome attempt(std::uint32_t a, std::uint32_t b) {
    ++trials;
    const TrialLimits limits = limits_for(a, b);
    const CoarseChart &p = chart(a), &q = chart(b);
    const double area = p.area + q.area;
    const double spare = area * (limits.stretch_l2 * limits.stretch_l2 - 1) - p.energy - q.energy;
    const double spare_area = limits.high_area - p.high_area - q.high_area;
    if (refused(a, b, spare, spare_area) || refused(b, a, spare, spare_area)) {
      return {.euler = trial_.euler(p.euler, q.euler, glue_)};
    }
    budget_.count_trial(p.slots + q.slots);
    const TrialOutcome outcome = trial_.run({p.cells, q.cells, glue_}, result_.joined, limits);
    unrolls_ = outcome.unrolled;
    high_area_ = outcome.high_area;
    euler_ = outcome.euler;
    if (outcome.accepted) {
      energy_ = area * (outcome.stretch_l2 * outcome.stretch_l2 - 1);
    } else if (outcome.energy > 0 || outcome.high_area > 0 || budget_.thrifty()) {
      chart(a).refusals.push_back({b, outcome.energy - p.energy - q.energy,
                                   outcome.high_area - p.high_area - q.high_area, outcome.settled,
                                   outcome.entangled, glue_, p.slots, q.slots});
    }
    return outcome;
  }

  // Returns what the two charts may be as one that is joined along glue_. The merger may cost as
  // much stretch as the seam that it saves is worth.
  TrialLimits limits_for(std::uint32_t a, std::uint32_t b) {
    double seam = 0;
    for (const std::uint32_t arc : glue_) seam += mesh_.arcs[arc].weight;
    if (relaxed_) seam += options_.chart_worth * std::sqrt(piece_area_);
    const CoarseChart &p = chart(a), &q = chart(b);
    const double worth = options_.seam_worth * seam * std::sqrt(piece_area_);
    const double stretch = std::sqrt(1 + (p.energy + q.energy + worth) / (p.area + q.area));
    TrialLimits limits = options_.limits;
    limits.stretch_l2 = std::min(limits.stretch_l2, stretch);
    limits.high_area =
        p.high_area + q.high_area + options_.tail_worth * seam * std::sqrt(piece_area_);
    if (relaxed_) {
      limits.solidity = options_.small_solidity;
      limits.fill = options_.small_fill;
    }
    if (options_.cone > 0) limits.solidity = limits.fill = kConeFill;
    limits.unrolls = p.unrolls && q.unrolls;
    for (CoarseChart* half : {&chart(a), &chart(b)}) {
      if (half->box == 0) half->box = trial_.box(half->cells);
      limits.box += half->box;
    }
    return limits;
  }

  // Whether an earlier trial of parts of the two charts shows that joining them would fail, or cost
  // more than the given energy or area; with little budget left, also that it probably would.
  bool refused(std::uint32_t a, std::uint32_t b, double energy, double high_area) {
    const CoarseChart &p = chart(a), &q = chart(b);
    budget_.count_refusals(p.refusals.size());
    for (const Refusal& r : p.refusals) {
      if (result_.chart_of_cell[r.cell] != b) continue;
      if (fails_again(r, glue_, energy, high_area)) return true;
      if (budget_.thrifty() && p.slots < 2 * r.own_slots && q.slots < 2 * r.other_slots)
        return true;
    }
    return false;
  }

  // Returns where seams of either chart with itself end, and sharp points.
  std::vector<Vec3d> seam_ends(std::uint32_t a, std::uint32_t b) const {
    std::vector<Vec3d> ends;
    for (const std::uint32_t name : {a, b}) {
      for (const std::uint32_t arc : chart(name).arcs) {
        const bool seam = chart_at(arc, 0) == chart_at(arc, 1);
        for (const std::uint32_t slot : mesh_.arcs[arc].slot) {
          if (slot != kNoIndex && (seam || mesh_.slot_sharp[slot])) {
            ends.push_back(mesh_.slot_position[slot]);
          }
        }
      }
    }
    return ends;
  }

  void absorb(std::uint32_t a, std::uint32_t b) {
    CoarseChart &p = chart(a), &q = chart(b);
    for (const std::uint32_t k : q.cells) result_.chart_of_cell[k] = a;
    p.cells.insert(p.cells.end(), q.cells.begin(), q.cells.end());
    p.arcs.insert(p.arcs.end(), q.arcs.begin(), q.arcs.end());
    std::erase_if(p.arcs, [&](std::uint32_t arc) { return result_.joined[arc] != 0; });
    for (const std::uint32_t arc : glue_) p.perimeter -= 2 * mesh_.arcs[arc].length;
    p.perimeter += q.perimeter;
    p.flat = coplanar(p, q);
    p.energy = energy_;
    p.high_area = high_area_;
    p.euler = euler_;
    p.box = 0;
    p.unrolls = unrolls_;
    if (options_.cone > 0) result_.chart_axis[a] = axis_;
    std::move(q.refusals.begin(), q.refusals.end(), std::back_inserter(p.refusals));
    std::erase_if(p.refusals, [&](const Refusal& r) { return result_.chart_of_cell[r.cell] == a; });
    p.area += q.area;
    p.slots += q.slots;
    p.normal_sum += q.normal_sum;
    for (int i = 0; i < 6; ++i) p.moments[i] += q.moments[i];
    ++p.version;
    q = CoarseChart{};
    q.version = kNoIndex;
  }

  const CoarseMesh& mesh_;
  const MergeOptions& options_;
  std::vector<std::uint32_t>& place_;
  std::vector<CoarseChart> charts_;  // one per cell of the piece
  MergeResult& result_;
  Trial& trial_;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> heap_;
  CostClasses cost_classes_;
  MergeBudget budget_;
  std::vector<Border> borders_;
  std::vector<std::uint32_t> glue_;
  std::vector<Vec3f> normals_;  // of the candidate, under a cone limit
  Vec3f axis_;                  // axis of their cone
  double piece_area_ = 0;
  bool relaxed_ = false;
  double energy_ = 0, high_area_ = 0;  // of the last accepted trial
  int euler_ = 1;
  bool unrolls_ = false;
};

}  // namespace

MergeResult merge_cells(const CoarseMesh& mesh, const std::vector<std::uint32_t>& piece,
                        const MergeOptions& options, const Context& context) {
  const std::size_t n = mesh.cells.size();
  MergeResult result;
  result.chart_of_cell.assign(n, kNoIndex);
  result.joined.assign(mesh.arcs.size(), 0);
  if (options.cone > 0) result.chart_axis.resize(n);
  result.uv.centre.resize(n);
  result.uv.slot.resize(mesh.slot_position.size());
  std::vector<std::uint32_t> place(n, kNoIndex);
  std::vector<std::vector<std::uint32_t>> pieces;
  for (std::uint32_t k = 0; k < n; ++k) {
    if (piece[k] == kNoIndex) continue;
    if (piece[k] >= pieces.size()) pieces.resize(piece[k] + 1);
    pieces[piece[k]].push_back(k);
  }
  const Fans fans(mesh);
  TrialScratch scratch(mesh);
  std::atomic<std::uint64_t> trials{0}, rejections{0}, work{0};
  const std::size_t grain = std::max<std::size_t>(1, pieces.size() / 64);
  parallel_for(context, pieces.size(), grain, [&](std::size_t begin, std::size_t end) {
    Trial trial(mesh, fans, scratch, result.uv);
    for (std::size_t i = begin; i < end; ++i) {
      Merger merger({mesh, options, place, result}, trial);
      merger.run(pieces[i], context);
      trials += merger.trials;
      work += merger.work();
      rejections += merger.rejections;
    }
  });
  result.trials = trials;
  result.rejections = rejections;
  result.work = work;
  return result;
}

}  // namespace atlas
