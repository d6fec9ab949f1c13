#include <sys/utsname.h>

#include <ctime>
#include <fstream>
#include <set>
#include <thread>
#include <tuple>

#include "benchmarks/support/results.h"

namespace atlas::bench {
namespace {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string text; std::getline(file, text);) {
    if (text.rfind("model name", 0) != 0) continue;
    const auto colon = text.find(": ");
    if (colon != std::string::npos) return text.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace

std::size_t machine_count(std::span<const Results> files) {
  std::set<std::tuple<std::string, int, std::string, std::string>> seen;
  for (const Results& r : files)
    seen.emplace(r.machine.processor, r.machine.cores, r.machine.compiler, r.machine.build);
  return seen.size();
}

Machine describe_machine(int argc, const char* const* argv) {
  Machine m;
  m.processor = processor_name();
  m.cores = int(std::thread::hardware_concurrency());
  utsname names{};
  if (uname(&names) == 0)
    m.system = std::string(names.sysname) + " " + names.release + " " + names.machine;
#if defined(__clang__)
  m.compiler = "clang " __clang_version__;
#elif defined(__GNUC__)
  m.compiler = "gcc " __VERSION__;
#endif
  m.build = ATLAS_BENCH_BUILD;
  char date[32];
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M UTC", std::gmtime(&now));
  m.date = date;
  for (int i = 0; i < argc; ++i) {
    std::string word = argv[i];
    if (i == 0) word = word.substr(word.rfind('/') + 1);
    if (word.find(' ') != std::string::npos) word = "\"" + word + "\"";
    m.command += (i ? " " : "") + word;
  }
  return m;
}

}  // namespace atlas::bench
