// Instruction counts, found by running the same program again under valgrind's callgrind.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// Encloses one piece of work. Under callgrind its instructions are counted and dumped as `key`;
// otherwise nothing happens.
class CountedWork {
 public:
  explicit CountedWork(std::string key);
  ~CountedWork();

 private:
  std::string key_;
};

// Returns whether this process runs under valgrind, where times have no meaning.
bool under_valgrind();

// Runs `arguments` under callgrind and returns the results with Row::instructions filled in. They
// name a program that measures with CountedWork and writes results to `--out FILE`, which is added.
// Errors: unsupported (no valgrind, or built without its header); io; those of load().
Result<Results> count_instructions(const std::vector<std::string>& arguments);

}  // namespace atlas::bench
