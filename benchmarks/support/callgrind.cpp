#include "benchmarks/support/callgrind.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#define ATLAS_HAS_CALLGRIND 1
#else
#define ATLAS_HAS_CALLGRIND 0
#endif

namespace atlas::bench {

#if ATLAS_HAS_CALLGRIND
bool under_valgrind() {
  return RUNNING_ON_VALGRIND != 0;
}
CountedWork::CountedWork(std::string key) : key_(std::move(key)) {
  CALLGRIND_ZERO_STATS;
  CALLGRIND_START_INSTRUMENTATION;
}
CountedWork::~CountedWork() {
  CALLGRIND_DUMP_STATS_AT(key_.c_str());
  CALLGRIND_STOP_INSTRUMENTATION;
}
#else
bool under_valgrind() {
  return false;
}
CountedWork::CountedWork(std::string key) : key_(std::move(key)) {}
CountedWork::~CountedWork() = default;
#endif

namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("atlas_callgrind_{}", ::getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

// Reads a dump, which names its trigger and ends with the sum of all costs.
void read_dump(const fs::path& path, std::map<std::string, double>& counts) {
  const std::string trigger = "desc: Trigger: Client Request: ", totals = "totals: ";
  std::ifstream file(path);
  std::string key;
  for (std::string text; std::getline(file, text);) {
    if (text.rfind(trigger, 0) == 0) key = text.substr(trigger.size());
    if (text.rfind(totals, 0) == 0 && !key.empty())
      counts[key] = std::strtod(text.c_str() + totals.size(), nullptr);
  }
}

}  // namespace

Result<Results> count_instructions(const std::vector<std::string>& arguments) {
  if (!ATLAS_HAS_CALLGRIND || std::system("valgrind --version >/dev/null 2>&1") != 0)
    return Status{ErrorCode::unsupported,
                  "instructions are counted by valgrind (package valgrind)"};
  const Folder folder;
  const fs::path out = folder.path / "rows.json";
  std::string command =
      "valgrind --quiet --tool=callgrind --instr-atstart=no --callgrind-out-file=" +
      quoted((folder.path / "dump").string());
  for (const std::string& argument : arguments) command += ' ' + quoted(argument);
  command += " --out " + quoted(out.string());
  if (std::system(command.c_str()) != 0)
    return Status{ErrorCode::io, command + ": failed (see its messages above)"};
  Result<Results> results = load(out);
  if (!results.ok()) return results;
  std::map<std::string, double> counts;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path))
    if (entry.path().extension() != ".json") read_dump(entry.path(), counts);
  for (Row& row : results->rows) {
    const auto found = counts.find(row.key());
    if (found != counts.end()) row.instructions = found->second;
    row.cpu_seconds = row.cpu_spread = row.wall_seconds = row.memory_mib = 0;
  }
  results->fits.clear();
  return results;
}

}  // namespace atlas::bench
