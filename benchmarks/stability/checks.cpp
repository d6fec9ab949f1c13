#include "benchmarks/stability/checks.h"

namespace atlas::bench {

void all_checks(CheckList& list) {
  for (const auto& check : {check_degradation, check_scale_and_place, check_bad_triangles,
                            check_cones, check_closed_forms, check_conditioning, check_light,
                            check_downsizing, check_blend, check_grouping, check_packing})
    check(list);
#ifdef ATLAS_BENCH_VIEW
  check_shadow_maps(list);
#endif
}

}  // namespace atlas::bench
