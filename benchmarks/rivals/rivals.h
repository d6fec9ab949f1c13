// Other programs beside ours: an OBJ in, an OBJ with UVs out, all judged by the project's
// evaluator.
#pragma once

#include <string>

#include "benchmarks/support/staged.h"

namespace atlas::bench {

// command holds {in} and {out}, paths of the OBJ files; it is run by `sh -c`.
struct Rival {
  std::string name, command;
  double timeout = 60;  // wall seconds
  int page = 2048;  // side of its pages, texels, where its OBJ does not say "# page WIDTH HEIGHT"
};

// "name=command {in} {out}". Errors: bad_option.
Result<Rival> parse_rival(const std::string& text);

// One row of stage "unwrap"; CPU seconds are those of the child processes. Beyond the timeout the
// row says so and has no figures.
void bench_rival(const StageRun& run, const Rival& rival);

// libatlas itself under the same conditions: reading, charts, packing and writing an OBJ.
void bench_ours(const StageRun& run, int page);

}  // namespace atlas::bench
