// Work in a process of its own.
#pragma once

#include <functional>

#include "benchmarks/support/results.h"

namespace atlas::bench {

using TakeRow = std::function<void(Row)>;

// Forks this process, runs `work` in the child and hands here, to `done`, each row that it gave, as
// soon as it comes. A child begins with what is alive here and nothing that was freed; what it
// allocates, loads or starts ends with it. `otherwise` is the row, with a failure that says why,
// for a child that dies or cannot be started. Children may nest.
// TBB's threads are ended first: call it outside of parallel loops, from the only thread left.
// Under valgrind, where memory is not measured and one process counts, the work runs in place.
void in_own_process(const Row& otherwise, const TakeRow& done,
                    const std::function<void(const TakeRow& done)>& work);

}  // namespace atlas::bench
