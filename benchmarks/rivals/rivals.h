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

// Measures one row of stage "unwrap". CPU seconds are those of the child processes. A rival that
// exceeds the timeout, ends with a code other than 0 or by a signal has a row that says which, with
// wall seconds only.
void bench_rival(const StageRun& run, const Rival& rival);

// Measures libatlas doing the same work: reading, charts, packing and writing an OBJ. It is called
// as a library, in a process that has started already, and without a timeout.
void bench_ours(const StageRun& run, int page);

}  // namespace atlas::bench
