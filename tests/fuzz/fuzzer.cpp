// A program for libFuzzer, of the target FUZZ_TARGET(bytes).
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const atlas::test::FuzzBytes bytes(data, size);
  const std::string fault = FUZZ_TARGET.fault;
  if (fault.empty()) return 0;
  std::fprintf(stderr, "%s\n", fault.c_str());
  std::abort();  // so that the fuzzer keeps the input
}
