// Returns invented results, and folders to write them to.
#pragma once

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/benchmarks/rows.h"

namespace atlas::bench {

namespace fs = std::filesystem;

struct TempFolder {
  fs::path path = fs::temp_directory_path() / ("bench_test_" + std::to_string(::getpid()));
  TempFolder() { fs::create_directories(path); }
  ~TempFolder() { fs::remove_all(path); }
};

inline Results some_results() {
  const char* argv[] = {"/usr/bin/atlas-bench", "--work", "sphere:10 000"};
  Results results;
  results.machine = describe_machine(3, argv);
  for (const double n : {1e4, 1e5, 1e6})
    results.rows.push_back(row(std::uint64_t(n), 2e-5 * std::pow(n, 1.07), 5));
  results.fits = fit_exponents(results.rows, 10000);
  results.checks.push_back({"scale", "x 2", "drift", 0.1, 1, "note"});
  return results;
}

}  // namespace atlas::bench
