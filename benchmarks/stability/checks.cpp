#include "benchmarks/stability/checks.h"

namespace atlas::bench {

void StressChecks::add(std::string quantity, double value, double bound, std::string note) const {
  list_.checks.push_back({group_, stress_, std::move(quantity), value, bound, std::move(note)});
}

const Context& StressChecks::context() const {
  return list_.context;
}

void all_checks(CheckList& list) {
#ifdef ATLAS_BENCH_VIEW
  check_shadow_maps(list);
#endif
  if (list.options.gpu) return;
  for (const auto& check : {check_degradation, check_scale_and_place, check_bad_triangles,
                            check_cones, check_closed_forms, check_conditioning, check_light,
                            check_downsizing, check_blend, check_grouping, check_packing})
    check(list);
}

}  // namespace atlas::bench
