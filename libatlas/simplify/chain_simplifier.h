// Internal: removes border vertices, each from all charts that share it at once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libatlas/simplify/border_chains.h"
#include "libatlas/simplify/chart_simplifier.h"
#include "libatlas/simplify/simplify.h"

namespace atlas::simplify {

// Removes the vertices of border chains within the bounds of slip. The slip along a border is
// defined as follows. Each fine border vertex is matched with a point of the coarse border edge, in
// order. The slip is the distance between the two in space plus the distance between their uvs,
// both in texels, in the chart where this sum is largest. Between matched points both borders are
// linear, so the slip is nowhere larger.
class ChainSimplifier {
 public:
  ChainSimplifier(const Geometry& geometry, std::vector<std::unique_ptr<ChartSimplifier>>& charts,
                  BorderChains chains, std::span<const double> texels_per_unit);

  // Sets the bounds of slip in texels. Open borders have a bound of their own.
  void set_limits(double slip, double open_slip) {
    slip_ = slip;
    open_slip_ = open_slip;
  }
  void run(double limit, const Context& context);
  double next_cost() const;
  void wake(std::uint32_t chart, const std::vector<std::uint32_t>& vertices);
  double worst_slip() const;  // upper bound of the slip over all coarse border edges, texels

 private:
  struct Entry {
    float cost;
    std::uint32_t slot;
  };
  struct Home {
    std::uint32_t chart, vertex, slot;
  };
  struct Candidate {
    std::uint32_t target = kNoIndex;
    double cost = 0, step = 0;
    bool possible = false;
  };
  const BorderChain& chain_of(std::uint32_t slot) const {
    return chains_.chains[chains_.slot_chain[slot]];
  }
  std::uint32_t uv_of(const BorderChain& chain, std::uint32_t slot, std::uint32_t side) const;
  double deviation(const BorderChain& chain, const std::uint32_t (&ends)[2], std::uint32_t slot,
                   double& t) const;
  double measure(const BorderChain& chain, std::uint32_t from, std::uint32_t to) const;
  double bound(const BorderChain& chain) const;
  bool may_go(const BorderChain& chain, std::uint32_t slot) const;
  Candidate judge(std::uint32_t slot, std::uint32_t target, double step);
  bool apart(const BorderChain& chain) const;
  bool attempt(std::uint32_t slot, const Candidate& candidate);
  void process(std::uint32_t slot);
  void push(std::uint32_t slot, float cost);

  const Geometry& geometry_;
  std::vector<std::unique_ptr<ChartSimplifier>>& charts_;
  BorderChains chains_;
  std::span<const double> texels_per_unit_;
  double slip_ = 0, open_slip_ = 0;
  std::vector<std::uint32_t> next_, previous_;  // remaining neighbours along the chain, or kNoIndex
  std::vector<float> edge_slip_;                // slip bound of the coarse edge to next_, texels
  std::vector<std::uint8_t> alive_;
  std::vector<float> key_;
  std::vector<Entry> heap_;
  std::vector<Home> homes_;      // the slot of each local vertex, sorted by chart and vertex
  std::vector<Collapse> sides_;  // one collapse a side, of the current attempt
  std::vector<Ring> rings_;
};

}  // namespace atlas::simplify
