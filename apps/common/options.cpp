#include "apps/common/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/common/program.h"
#include "libatlas/files/parse_number.h"

namespace atlas::app {
namespace {

// Returns how many letters must be added, left out, changed or swapped with the next one to turn
// one word into the other (Damerau's distance).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({last[j] + (a[i] != b[j]), last[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
        row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

// Returns whether a name that ends before this character goes on.
bool in_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
}

// Returns the command that was chosen, or the program if none was.
const CLI::App& command_of(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : *chosen.front();
}

// Returns the beginning of a text that users wrote, which may have any length.
std::string start_of(const std::string& text) {
  constexpr std::size_t kLongest = 120;
  if (text.size() <= kLongest) return text;
  std::size_t end = kLongest;
  while (end > 0 && continues_character(text[end])) --end;
  return text.substr(0, end) + "...";
}

// Returns the largest distance at which another word is taken for a misspelling of this one.
std::size_t near(std::string_view word) {
  return std::max<std::size_t>(1, word.size() / 5);
}

// Returns whether the program needs a command and none was given.
bool lacks_command(const CLI::App& app) {
  return app.get_require_subcommand_min() > 0 && app.get_subcommands().empty();
}

std::string about_command(const CLI::App& app, const std::string& word) {
  std::string names, meant;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string& name = command->get_name();
    names += (names.empty() ? "" : ", ") + name;
    if (distance(word, name) <= near(name)) meant = fmt::format(": is {} meant?", name);
  }
  return fmt::format("'{}' is none of the commands {}{}", start_of(word), names, meant);
}

// Returns the options that begin with this word: some programs let options be shortened.
std::string begun_by(const CLI::App& app, const std::string& word) {
  std::string names;
  if (word.size() < 4 || !word.starts_with("--")) return names;
  for (const CLI::Option* known : command_of(app).get_options())
    for (const std::string& other : known->get_lnames())
      if (other.starts_with(word.substr(2))) names += (names.empty() ? "--" : " or --") + other;
  return names;
}

// Returns a complaint about words that no option takes. It comes before others: --ouput is the
// reason why --output is missing.
std::string about_unknown(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining(true);
  if (words.empty()) return {};
  // A later word may be a command by chance, for example the name of a folder.
  const std::vector<std::string> own = app.remaining(false);
  if (app.get_require_subcommand_min() > 0 && !own.empty() && !own.front().starts_with("-"))
    return about_command(app, own.front());
  const auto option = std::find_if(words.begin(), words.end(),
                                   [](const std::string& w) { return w.starts_with("-"); });
  const std::string& word = option == words.end() ? words.front() : *option;
  const std::string name = word.substr(0, word.find('='));
  for (const CLI::Option* known : command_of(app).get_options())
    for (const std::string& other : known->get_lnames())
      if (name.size() > 4 && name.starts_with("--") &&
          distance(name.substr(2), other) <= near(name))
        return fmt::format("unknown option {}: is --{} meant?", start_of(word), other);
  if (const std::string meant = begun_by(app, name); !meant.empty())
    return fmt::format("unknown option {}: is {} meant?", start_of(word), meant);
  return "unknown option or one name too many: " + start_of(word);
}

// Returns a complaint about an option whose value is empty, like "$OUT" if that is not set.
std::string about_empty(const CLI::App& app) {
  for (const CLI::Option* option : command_of(app).get_options())
    for (const std::string& value : option->results())
      if (value.empty()) return fmt::format("{} is empty", option->get_name());
  return {};
}

std::string about_config(const CLI::App& app, const std::string& entry) {
  const CLI::Option* config = app.get_config_ptr();
  return fmt::format("{}: '{}' is no option and value (write one name=value a line)",
                     config ? config->as<std::string>() : "--config", start_of(entry));
}

std::string about_value(const CLI::App& app, const std::string& name, const std::string& value) {
  const CLI::Option* option = command_of(app).get_option_no_throw(name);
  const bool flag = option && option->get_expected_max() == 0;
  return fmt::format("{} {}: {}", name, value,
                     flag ? "is neither true nor false" : "not a number that it can be");
}

// Returns a complaint about an option that has too few or too many values. `text` begins with its
// name.
std::string about_count(const CLI::App& app, const std::string& text) {
  const std::string name = text.substr(0, text.find(": "));
  const CLI::Option* option = command_of(app).get_option_no_throw(name);
  if (!option) return text;
  const int got = static_cast<int>(option->results().size());
  const int least = option->get_items_expected_min(), most = option->get_items_expected_max();
  // The values so far are as many as there should be, but the option is given again without one.
  if (got == 0 || (got >= least && got <= most)) return name + " needs a value after it";
  if (most <= 1) return name + " is given more than once";
  return fmt::format("{} takes {} values with commas between them, not {}", name,
                     got < least ? least : most, got);
}

template <class Kind>
bool is(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

// Returns a complaint about a parse error. Where a user would not understand CLI11's words, others
// replace them. Errors tell the name of an option by their text only.
std::string complaint(const CLI::App& app, const CLI::ParseError& error) {
  const std::string text = error.what();
  constexpr std::string_view kConfig = "INI was not able to parse ";
  if (is<CLI::ConfigError>(error) && text.starts_with(kConfig))
    return about_config(app, text.substr(kConfig.size()));
  if (std::string unknown = about_unknown(app); !unknown.empty()) return unknown;
  if (is<CLI::ArgumentMismatch>(error)) return about_count(app, text);
  // "...: NAME = VALUE"
  const auto colon = text.find(": "), equals = text.find(" = ");
  if (is<CLI::ConversionError>(error) && equals != std::string::npos && colon < equals)
    return about_value(app, text.substr(colon + 2, equals - colon - 2), text.substr(equals + 3));
  if (is<CLI::RequiredError>(error) && lacks_command(app))
    return "the name of a command is needed first";
  return text;
}

// Parses "1s", "500ms", "2m" or a number of seconds. Returns a complaint, empty if there is none.
std::string parse_seconds(const std::string& text, double& seconds) {
  double value = 0;
  const char* end = parse_number(text.data(), text.data() + text.size(), value);
  const std::string unit = end ? end : "";
  const std::map<std::string, double> units{
      {"", 1}, {"s", 1}, {"ms", 1e-3}, {"m", 60}, {"min", 60}};
  if (end == nullptr || !units.count(unit) || !(value >= 0 && value < 1e9))
    return "'" + text + "' must be a duration such as 1s, 500ms or 2m (without a unit: seconds)";
  seconds = value * units.at(unit);
  return {};
}

}  // namespace

CLI::Validator within(double low, double high, const std::string& text) {
  return CLI::Validator(
      [=](std::string& input) {
        char* end = nullptr;
        const double value = std::strtod(input.c_str(), &end);
        const bool number = end != input.c_str() && *end == 0 && std::isfinite(value);
        if (number && value >= low && value <= high) return std::string();
        const bool huge = number && value > high && text.find("..") == std::string::npos &&
                          text.find("at most") == std::string::npos;
        return huge ? fmt::format("'{}' must be {}, and at most {}", input, text, high)
                    : fmt::format("'{}' must be {}", input, text);
      },
      text);
}

CLI::Validator within(int low, int high) {
  return within(low, high, fmt::format("{}..{}", low, high));
}

CLI::Validator not_negative() {
  return within(0, 1e30, "0 or more");
}

CLI::Validator positive() {
  return within(1e-30, 1e30, "above 0");
}

CLI::Validator one_of(const std::map<std::string, int>& names) {
  std::string all;
  for (const auto& [name, value] : names) all += (all.empty() ? "" : ", ") + name;
  return CLI::Validator(
      [=](std::string& input) {
        const auto at = names.find(CLI::detail::to_lower(input));
        if (at == names.end()) return fmt::format("'{}' must be one of {}", input, all);
        input = std::to_string(at->second);
        return std::string();
      },
      "");
}

void add_trust_options(CLI::App& app, ReadOptions& read) {
  app.add_flag("--confine", read.confine,
               "Refuse a scene that names files outside of its folder, also by links");
  add_off_flag(app, "--no-limits", read.limits,
               "Read also what is much larger than its file: text that unpacks, nodes that repeat");
}

std::string with_flags(std::string_view text, std::span<const FlagName> names) {
  std::string out(text);
  for (const auto& [field, flag] : names) {
    std::size_t at = 0;
    while ((at = out.find(field, at)) != std::string::npos) {
      const std::size_t end = at + field.size();
      if (end < out.size() && in_name(out[end])) {
        at = end;  // a longer name
      } else {
        out.replace(at, field.size(), flag);
        at += flag.size();
      }
    }
  }
  return out;
}

CLI::Option* add_off_flag(CLI::App& app, const std::string& name, bool& value,
                          const std::string& help) {
  return app.add_flag_callback(
      name, [&value] { value = false; }, help);
}

void add_budget(CLI::App& app, const std::string& preset, double& seconds) {
  app.add_option_function<std::string>("--budget",
                                       [&seconds](const std::string& text) {
                                         if (std::string e = parse_seconds(text, seconds);
                                             !e.empty())
                                           throw CLI::ValidationError("--budget", e);
                                       })
      ->type_name("TIME")
      ->description("Time for " + preset + " best, e.g. 1s or 500ms, without a unit seconds");
}

void add_examples(CLI::App& app, std::span<const std::pair<const char*, const char*>> examples) {
  std::string name = app.get_name();
  if (app.get_parent()) name = app.get_parent()->get_name() + " " + name;
  std::string text = "\nExamples:\n";
  for (const auto& [what, command] : examples)
    text += fmt::format("  {} {}\n      {}\n", name, command, what);
  app.footer(text);
}

int parse(CLI::App& app, int argc, char** argv) {
  const auto refuse = [&](const std::string& why) {
    const std::string command =
        app.get_subcommands().empty() ? "" : command_of(app).get_name() + " ";
    print_error(app.get_name(), fmt::format("{} ({}--help lists the {})", why, command,
                                            lacks_command(app) ? "commands" : "options"));
    return 2;
  };
  app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), LIBATLAS_VERSION));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    std::ostringstream help;
    const int code = app.exit(done, help, help);
    print(stdout, help.str());
    return code;
  } catch (const CLI::ParseError& error) {
    return refuse(complaint(app, error));
  }
  const std::string empty = about_empty(app);
  return empty.empty() ? -1 : refuse(empty);
}

namespace {

// Returns the word that the command line gives for an option. CLI11 keeps what it becomes, such as
// the number of an enumerator.
std::string given_word(const CLI::Option& option, int argc, const char* const* argv) {
  for (int i = argc - 1; i > 0; --i) {
    const std::string word = argv[i];
    const std::size_t equals = word.find('=');
    if (!word.starts_with('-') || !option.check_name(word.substr(0, equals))) continue;
    if (equals != std::string::npos) return word.substr(equals + 1);
    if (i + 1 < argc) return argv[i + 1];
  }
  return CLI::detail::join(option.results(), " ");  // in a form of its own, such as -ofile
}

std::string value_of(const CLI::Option& option, int argc, const char* const* argv) {
  if (option.get_expected_min() == 0) return "true";
  const bool one = option.results().size() == 1 && !option.get_positional();
  return one ? given_word(option, argc, argv) : CLI::detail::join(option.results(), " ");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> option_values(const CLI::App& app, int argc,
                                                               const char* const* argv) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const CLI::Option* option : app.get_options()) {
    std::string value = option->get_default_str();
    if (option->count() > 0) value = value_of(*option, argc, argv);
    if (!value.empty()) values.emplace_back(option->get_name(), value);
  }
  return values;
}

}  // namespace atlas::app
