// Runs work in a separate process.
#pragma once

#include <functional>

#include "benchmarks/support/results.h"

namespace atlas::bench {

using TakeRow = std::function<void(Row)>;

// Forks this process, runs `work` in the child and passes each row from there to `done` in this
// process as soon as it arrives. A child begins with the memory that is in use here, without freed
// memory; what it allocates, loads or starts ends with it. If a child dies or cannot be started,
// the row is `otherwise` with a failure that states the reason. Children may nest. TBB's threads
// are ended first, so call it outside of parallel loops, from the only remaining thread. Under
// valgrind, where memory is not measured and a single process counts, the work runs in this
// process.
void in_own_process(const Row& otherwise, const TakeRow& done,
                    const std::function<void(const TakeRow& done)>& work);

}  // namespace atlas::bench
