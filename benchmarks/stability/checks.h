// Checks every stage under stress. Each figure has a bound that the tests enforce. References are
// closed forms, exact integers or the same computation without the stress.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "benchmarks/support/results.h"
#include "libatlas/core/context.h"
#include "tests/support/shapes.h"

namespace atlas::bench {

struct StabilityOptions {
  bool full = false;  // also large cases (10^5 fans, 10^6 items); the tests run the small ones
  bool gpu = false;   // only the shadow maps, as a GPU draws them, not the software renderer
  std::vector<std::filesystem::path> models;  // meshes for scale, offset and rotation, if any
};

class CheckList;

// One stress of a group, to which measured figures are added.
class StressChecks {
 public:
  StressChecks(CheckList& list, std::string group, std::string stress)
      : list_(list), group_(std::move(group)), stress_(std::move(stress)) {}
  void add(std::string quantity, double value, double bound, std::string note = "") const;
  const Context& context() const;

 private:
  CheckList& list_;
  std::string group_, stress_;
};

// The list of checks that every function below extends.
class CheckList {
 public:
  CheckList(const StabilityOptions& o, const Context& c) : options(o), context(c) {}
  StressChecks at(std::string group, std::string stress) {
    return {*this, std::move(group), std::move(stress)};
  }
  const StabilityOptions& options;
  const Context& context;
  std::vector<Check> checks;
  std::vector<Row> rows;  // figures without a bound, of the stage with the group's name
};

// Runs all groups below.
void all_checks(CheckList& list);

void check_degradation(CheckList& list);      // the stress from which methods degrade
void check_scale_and_place(CheckList& list);  // units, offsets, rotations
void check_bad_triangles(CheckList& list);    // needles, fans, coincident vertices
void check_cones(CheckList& list);            // cone limits, 1/cos, cosines at the limit
void check_closed_forms(CheckList& list);     // cylinder, cone, Milnor's cap
void check_conditioning(CheckList& list);     // linear systems, flips, fallbacks and their cost
void check_light(CheckList& list);            // luminance extremes, tone curves, outputs
void check_downsizing(CheckList& list);       // thresholds 0, tiny, huge
void check_blend(CheckList& list);            // SLERP weights from 1e-18 to pi
#ifdef ATLAS_BENCH_VIEW
void check_shadow_maps(CheckList& list);  // grazing light, bits of depth, tiny and huge scenes
#endif
void check_grouping(CheckList& list);  // ties, 2^62, anomalies, bounded bisection
void check_packing(CheckList& list);   // page = item, ones by the million, 10^9

}  // namespace atlas::bench
