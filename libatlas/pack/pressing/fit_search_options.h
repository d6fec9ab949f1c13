// Internal: how much a search for layouts of outlines may do, and what a caller that tries several
// ways to fit charts tells it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "libatlas/core/clock.h"
#include "libatlas/core/portable_math.h"
#include "libatlas/pack/fit.h"

namespace atlas::pack {

struct FitSearchOptions : FitOptions {
  // A single page that is filled less than this share is of no use to the caller, so ways to fill
  // it that seldom reach the share are left out. Several pages are no longer pressed once they are
  // unlikely to become so full. 0: the search is as long as usual.
  double wanted_fill = 0;
  // The share of round_work() that the first round takes, above 0. Callers that compare several
  // ways ask for little.
  double first_round = 1;
  // The wall_seconds() at which `best` ends; set by search_fit().
  double deadline = std::numeric_limits<double>::infinity();
};

// Returns when a search that begins now ends, at its deadline at the latest.
inline double ending(const FitSearchOptions& options) {
  const bool timed = options.preset == PackPreset::best && options.effort == 0;
  return timed ? std::min(options.deadline, wall_seconds() + options.time_budget)
               : options.deadline;
}

// Work is counted in words that are examined while charts overlap, about 2 ns each. Placing charts
// examines words of tables, each of which takes kWordsOfPlacing times as long.
inline constexpr double kWordsOfPlacing = 4;
// FitOptions::effort counts so many words as one, about a millisecond.
inline constexpr double kWordsOfEffort = 500'000;

// Returns the work of a round of a search for layouts of so many charts on a page. One chart gets
// 50 ms, a hundred get 0.23 s, most of which a single page does not use.
inline double round_work(std::size_t charts) {
  constexpr double kOfOneChart = 25e6;
  return kOfOneChart * portable::pow(double(std::max<std::size_t>(1, charts)), 1 / 3.0);
}

// The rounds of a search for layouts. `standard` makes one. `best` goes on with longer rounds as
// long as its effort or time allows. A round does not depend on how much is allowed, so more of it
// never gives less. A share is relative to round_work().
class SearchRounds {
 public:
  SearchRounds(const FitSearchOptions& options, std::size_t charts)
      : options_(options), all_(double(options.effort) * kWordsOfEffort / round_work(charts)) {}

  // Begins a round. Returns false if there is no further one.
  bool next() {
    const double share = options_.first_round * double(1u << std::min(begun_, kMost));
    if (begun_ > 0 && !(options_.preset == PackPreset::best && allows(share))) return false;
    ++begun_;
    share_ = share;
    planned_ += share;
    return true;
  }
  std::uint32_t number() const { return begun_ - 1; }
  double share() const { return share_; }

 private:
  static constexpr std::uint32_t kMost = 3;  // doublings

  bool allows(double share) const {
    return options_.effort > 0 ? planned_ + share <= all_ : wall_seconds() < options_.deadline;
  }

  const FitSearchOptions& options_;
  double all_;  // shares that the effort is
  double planned_ = 0, share_ = 0;
  std::uint32_t begun_ = 0;
};

// Returns how many of `most` layouts a round of this share works on.
inline std::size_t layouts_of_round(std::size_t most, double share) {
  return static_cast<std::size_t>(std::ceil(double(most) * std::min(1.0, share)));
}

}  // namespace atlas::pack
