// Returns an invented row of results.
#pragma once

#include <cstdint>
#include <string>

#include "benchmarks/support/results.h"

namespace atlas::bench {

inline Row row(std::uint64_t triangles, double cpu, double error) {
  Row r;
  r.stage = "charts";
  r.mesh = "sphere:" + std::to_string(triangles);
  r.setting = "standard";
  r.preset = true;
  r.triangles = r.size_in = triangles;
  r.unit = "triangles -> charts";
  r.values = {{"seam", error}, {"l2", 1.01}};
  r.cpu_seconds = cpu;
  r.memory_mib = 100;
  return r;
}

}  // namespace atlas::bench
