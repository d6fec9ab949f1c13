// Instruction counts: the same program run again under valgrind's callgrind.
#pragma once

#include <string>
#include <vector>

#include "benchmarks/support/results.h"

namespace atlas::bench {

// Brackets one piece of work: under callgrind its instructions are counted and dumped as `key`;
// elsewhere nothing happens.
class CountedWork {
 public:
  explicit CountedWork(std::string key);
  ~CountedWork();

 private:
  std::string key_;
};

// Whether this process runs under valgrind, where times mean nothing.
bool under_valgrind();

// Runs `arguments` (a program that measures with CountedWork and writes results to `--out FILE`,
// which is added) under callgrind and returns its results with Row::instructions filled in.
// Errors: unsupported (no valgrind, or built without its header); io; those of load().
Result<Results> count_instructions(const std::vector<std::string>& arguments);

}  // namespace atlas::bench
