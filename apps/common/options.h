// What the command lines have in common: the checks of numbers and names, and the answers to wrong
// command lines.
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libatlas/scene/reader.h"

namespace atlas::app {

// Accept finite numbers within [low, high]; `text` describes them in the help and in complaints.
CLI::Validator within(double low, double high, const std::string& text);
CLI::Validator within(int low, int high);
CLI::Validator not_negative();
CLI::Validator positive();

// Accepts one of `names`, in any case, and replaces it by its number.
CLI::Validator one_of(const std::map<std::string, int>& names);

template <class T>
CLI::Validator choices(const std::map<std::string, T>& names) {
  std::map<std::string, int> numbers;
  for (const auto& [name, value] : names) numbers[name] = static_cast<int>(value);
  return one_of(numbers);
}

// A flag whose presence makes `value` false.
CLI::Option* add_off_flag(CLI::App& app, const std::string& name, bool& value,
                          const std::string& help);

// Adds --budget, the seconds that packing may take where `preset` is best.
void add_budget(CLI::App& app, const std::string& preset, double& seconds);

// Adds what a program that reads scenes lets users choose for those of strangers.
void add_trust_options(CLI::App& app, ReadOptions& read);

// An option's field, as the library's messages name it, and its flag.
using FlagName = std::pair<std::string_view, std::string_view>;

// Those of add_trust_options().
inline constexpr FlagName kTrustFlags[] = {{"ReadOptions::confine", "--confine"},
                                           {"ReadOptions::limits", "--no-limits"}};

// Returns a message of the library with the flags in place of the fields, for the program's users.
std::string with_flags(std::string_view text, std::span<const FlagName> names);

// Ends the help with examples: what each does, and the command without the program's name.
void add_examples(CLI::App& app, std::span<const std::pair<const char*, const char*>> examples);

// Parses the command line, after adding --version. Returns -1 to go on, or the exit code with which
// the program should end: 0 after the help or the version, 2 after one line about what is wrong.
int parse(CLI::App& app, int argc, char** argv);

// Returns the options that were given, with their values as in the command line, and the others
// that have a default; flags are "true".
std::vector<std::pair<std::string, std::string>> option_values(const CLI::App& app, int argc,
                                                               const char* const* argv);

// While it lives, options that are added appear under the heading `name` of --help.
class OptionGroup {
 public:
  OptionGroup(CLI::App& app, const char* name) : app_(app) { app_.option_defaults()->group(name); }
  ~OptionGroup() { app_.option_defaults()->group("Options"); }
  OptionGroup(const OptionGroup&) = delete;
  OptionGroup& operator=(const OptionGroup&) = delete;

 private:
  CLI::App& app_;
};

}  // namespace atlas::app
