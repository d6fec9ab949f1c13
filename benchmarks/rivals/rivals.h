// Compares libatlas with other programs: each turns an OBJ into an OBJ with uvs, which the
// project's evaluator measures.
#pragma once

#include <string>

#include "benchmarks/support/staged.h"

namespace atlas::bench {

// `command` contains {in} and {out}, which stand for the paths of the OBJ files. It is run by `sh
// -c`.
struct Rival {
  std::string name, command;
  double timeout = 60;  // wall seconds
  int page = 2048;      // side of its pages in texels, if its OBJ has no "# page WIDTH HEIGHT"
};

// Parses "name=command {in} {out}". Errors: bad_option.
Result<Rival> parse_rival(const std::string& text);

// Measures one row of stage "unwrap". CPU seconds are those of the child processes. Beyond the
// timeout, the row states that and has no figures.
void bench_rival(const StageRun& run, const Rival& rival);

// Measures libatlas under the same conditions: reading, charts, packing and writing an OBJ.
void bench_ours(const StageRun& run, int page);

}  // namespace atlas::bench
