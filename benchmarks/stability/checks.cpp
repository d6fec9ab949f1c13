#include "benchmarks/stability/checks.h"

namespace atlas::bench {

std::vector<Check> all_checks(const StabilityOptions& options, const Context& context) {
  CheckList list(options, context);
  for (const auto& check :
       {check_scale_and_place, check_bad_triangles, check_cones, check_closed_forms, check_light,
        check_downsizing, check_blend, check_grouping, check_packing})
    check(list);
  return std::move(list.checks);
}

}  // namespace atlas::bench
