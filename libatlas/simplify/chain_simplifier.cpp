#include "libatlas/simplify/chain_simplifier.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <tuple>

#include "libatlas/core/glm_bridge.h"

namespace atlas::simplify {
namespace {

constexpr float kIdleVertex = std::numeric_limits<float>::infinity();

struct Later {
  template <class Entry>
  bool operator()(const Entry& a, const Entry& b) const {
    return a.cost != b.cost ? a.cost > b.cost : a.slot > b.slot;
  }
};

}  // namespace

ChainSimplifier::ChainSimplifier(const Geometry& geometry,
                                 std::vector<std::unique_ptr<ChartSimplifier>>& charts,
                                 BorderChains chains, std::span<const double> texels_per_unit)
    : geometry_(geometry),
      charts_(charts),
      chains_(std::move(chains)),
      texels_per_unit_(texels_per_unit) {
  const std::size_t n = chains_.slot_chain.size();
  next_.assign(n, kNoIndex);
  previous_.assign(n, kNoIndex);
  edge_slip_.assign(n, 0.0F);
  alive_.assign(n, 1);
  key_.assign(n, kIdleVertex);
  for (const BorderChain& chain : chains_.chains) {
    const std::uint32_t first = chain.first_slot, last = first + chain.slot_count - 1;
    for (std::uint32_t s = first; s <= last; ++s) {
      if (s != first) previous_[s] = s - 1;
      if (s != last) next_[s] = s + 1;
    }
    if (chain.closed) {
      previous_[first] = last;
      next_[last] = first;
    }
    for (std::uint32_t s = first; s <= last; ++s) {
      if (previous_[s] == kNoIndex || next_[s] == kNoIndex) continue;
      for (std::uint32_t k = 0; k < chain.side_count; ++k) {
        homes_.push_back(
            {chains_.side_chart[chain.first_side + k], chains_.vertex(chain, s, k), s});
      }
      push(s, 0.0F);
    }
  }
  std::sort(homes_.begin(), homes_.end(), [](const Home& a, const Home& b) {
    return std::tie(a.chart, a.vertex) < std::tie(b.chart, b.vertex);
  });
}

void ChainSimplifier::push(std::uint32_t slot, float cost) {
  key_[slot] = cost;
  heap_.push_back({cost, slot});
  std::push_heap(heap_.begin(), heap_.end(), Later());
}

double ChainSimplifier::next_cost() const {
  return heap_.empty() ? kIdleVertex : heap_.front().cost;
}

void ChainSimplifier::wake(std::uint32_t chart, const std::vector<std::uint32_t>& vertices) {
  for (const std::uint32_t v : vertices) {
    const auto at = std::lower_bound(
        homes_.begin(), homes_.end(), std::pair(chart, v),
        [](const Home& h, const auto& key) { return std::pair(h.chart, h.vertex) < key; });
    if (at == homes_.end() || at->chart != chart || at->vertex != v) continue;
    if (alive_[at->slot] && key_[at->slot] == kIdleVertex) push(at->slot, 0.0F);
  }
}

double ChainSimplifier::worst_slip() const {
  double worst = 0;
  for (std::size_t s = 0; s < alive_.size(); ++s) {
    if (alive_[s] && next_[s] != kNoIndex) worst = std::max<double>(worst, edge_slip_[s]);
  }
  return worst;
}

std::uint32_t ChainSimplifier::uv_of(const BorderChain& chain, std::uint32_t slot,
                                     std::uint32_t side) const {
  const ChartSimplifier& chart = *charts_[chains_.side_chart[chain.first_side + side]];
  return chart.fine().vertex_uv[chains_.vertex(chain, slot, side)];
}

double ChainSimplifier::bound(const BorderChain& chain) const {
  return chain.side_count == 1 ? open_slip_ : slip_;
}

// Returns the slip of the fine vertex at `slot` against the straight edge between the slots `ends`.
// t is set to the position on the edge that is matched with the vertex. It never moves back behind
// the value given, so that matched points keep their order.
double ChainSimplifier::deviation(const BorderChain& chain, const std::uint32_t (&ends)[2],
                                  std::uint32_t slot, double& t) const {
  const auto position = [&](std::uint32_t s) {
    return to_dvec(geometry_.position(uv_of(chain, s, 0)));
  };
  const glm::dvec3 a = position(ends[0]), along = position(ends[1]) - a, x = position(slot) - a;
  t = std::clamp(glm::dot(x, along) / glm::dot(along, along), t, 1.0);
  const double distance = glm::length(x - t * along);
  double worst = 0;
  for (std::uint32_t k = 0; k < chain.side_count; ++k) {
    const std::uint32_t chart = chains_.side_chart[chain.first_side + k];
    const glm::dvec2 p = to_glm(geometry_.uv(uv_of(chain, ends[0], k))),
                     q = to_glm(geometry_.uv(uv_of(chain, ends[1], k))),
                     u = to_glm(geometry_.uv(uv_of(chain, slot, k)));
    const double shift = glm::length(p + t * (q - p) - u) * texels_per_unit_[chart];
    worst = std::max(worst, distance / charts_[chart]->texel() + shift);
  }
  return worst;
}

// Returns the largest slip over all fine vertices between two slots. It stops as soon as the bound
// is exceeded.
double ChainSimplifier::measure(const BorderChain& chain, std::uint32_t from,
                                std::uint32_t to) const {
  const std::uint32_t ends[2] = {from, to};
  double t = 0, worst = 0;
  const std::uint32_t end = chain.first_slot + chain.slot_count;
  for (std::uint32_t s = from;;) {
    s = s + 1 == end ? chain.first_slot : s + 1;
    if (s == to) break;
    worst = std::max(worst, deviation(chain, ends, s, t));
    if (worst > bound(chain)) break;
  }
  return worst;
}

bool ChainSimplifier::may_go(const BorderChain& chain, std::uint32_t slot) const {
  const std::uint32_t a = previous_[slot], b = next_[slot];
  if (a == kNoIndex || b == kNoIndex || a == b || next_[b] == a)
    return false;  // keeps three vertices
  return !(geometry_.position(uv_of(chain, a, 0)) == geometry_.position(uv_of(chain, b, 0)));
}

ChainSimplifier::Candidate ChainSimplifier::judge(std::uint32_t slot, std::uint32_t target,
                                                  double step) {
  const BorderChain& chain = chain_of(slot);
  Candidate candidate{target, 0, step, true};
  Estimate estimate;
  for (std::uint32_t k = 0; k < chain.side_count && candidate.possible; ++k) {
    ChartSimplifier& chart = *charts_[chains_.side_chart[chain.first_side + k]];
    candidate.possible =
        chart.judge(chains_.vertex(chain, slot, k), chains_.vertex(chain, target, k), estimate);
    candidate.cost = std::max(candidate.cost, estimate.cost);
  }
  const double relative = step / bound(chain);
  candidate.cost += relative * relative;
  return candidate;
}

// Returns whether the sides can be collapsed independently. Two sides in one chart are collapsed
// one after the other. Their surroundings must not overlap, because the first collapse would
// otherwise change what was decided about the second.
bool ChainSimplifier::apart(const BorderChain& chain) const {
  for (std::uint32_t i = 0; i < chain.side_count; ++i) {
    for (std::uint32_t j = 0; j < i; ++j) {
      if (chains_.side_chart[chain.first_side + i] != chains_.side_chart[chain.first_side + j]) {
        continue;
      }
      for (const std::uint32_t a : rings_[i].vertices) {
        if (a == sides_[j].v) return false;
        const bool common = a == sides_[i].w && a == sides_[j].w;
        const auto& other = rings_[j].vertices;
        if (!common && std::find(other.begin(), other.end(), a) != other.end()) return false;
      }
    }
  }
  return true;
}

bool ChainSimplifier::attempt(std::uint32_t slot, const Candidate& candidate) {
  const BorderChain& chain = chain_of(slot);
  const std::uint32_t a = previous_[slot], b = next_[slot];
  const double before = std::max(edge_slip_[a], edge_slip_[slot]);
  double after = before + candidate.step;
  if (after > bound(chain)) after = measure(chain, a, b);
  if (after > bound(chain)) return false;
  const std::uint32_t k_end = chain.side_count;
  sides_.resize(std::max<std::size_t>(sides_.size(), k_end));
  rings_.resize(std::max<std::size_t>(rings_.size(), k_end));
  for (std::uint32_t k = 0; k < k_end; ++k) {
    ChartSimplifier& chart = *charts_[chains_.side_chart[chain.first_side + k]];
    const std::uint32_t v = chains_.vertex(chain, slot, k),
                        w = chains_.vertex(chain, candidate.target, k);
    chart.ring(v, rings_[k]);
    if (!chart.judge(v, w, sides_[k]) || !chart.check({before, candidate.step}, sides_[k])) {
      return false;
    }
  }
  if (!apart(chain)) return false;
  for (std::uint32_t k = 0; k < k_end; ++k) {
    charts_[chains_.side_chart[chain.first_side + k]]->apply(sides_[k]);
  }
  next_[a] = b;
  previous_[b] = a;
  alive_[slot] = 0;
  edge_slip_[a] = static_cast<float>(after * (1 + 1e-6));
  return true;
}

void ChainSimplifier::process(std::uint32_t slot) {
  const BorderChain& chain = chain_of(slot);
  if (!may_go(chain, slot)) return;
  const std::uint32_t ends[2] = {previous_[slot], next_[slot]};
  double t = 0;
  const double step = deviation(chain, ends, slot, t);
  if (step > bound(chain)) return;
  Candidate candidates[2] = {judge(slot, ends[0], step), judge(slot, ends[1], step)};
  if (candidates[1].possible &&
      (!candidates[0].possible || candidates[1].cost < candidates[0].cost)) {
    std::swap(candidates[0], candidates[1]);
  }
  if (!candidates[0].possible) return;
  for (const Candidate& candidate : candidates) {
    if (!candidate.possible || !attempt(slot, candidate)) continue;
    for (const std::uint32_t s : ends) {
      if (key_[s] == kIdleVertex) push(s, static_cast<float>(candidate.cost));
    }
    return;
  }
}

void ChainSimplifier::run(double limit, const Context& context) {
  for (std::size_t steps = 0; !heap_.empty() && heap_.front().cost <= limit; ++steps) {
    if (steps % 256 == 0 && context.cancelled()) return;
    const Entry top = heap_.front();
    std::pop_heap(heap_.begin(), heap_.end(), Later());
    heap_.pop_back();
    if (key_[top.slot] != top.cost || !alive_[top.slot]) continue;
    key_[top.slot] = kIdleVertex;
    process(top.slot);
  }
}

}  // namespace atlas::simplify
