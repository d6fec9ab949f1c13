#include "apps/common/options.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "apps/common/program.h"

namespace atlas::app {
namespace {

// CLI11's words for what is wrong, where a user would not know what they mean.
std::string complaint(const CLI::ParseError& error) {
  const std::string text = error.what();
  constexpr std::string_view kConversion = "Could not convert: ";
  const auto equals = text.find(" = ");
  if (text.starts_with(kConversion) && equals != std::string::npos)
    return fmt::format("{} {}: not a number that it can be",
                       text.substr(kConversion.size(), equals - kConversion.size()),
                       text.substr(equals + 3));
  constexpr std::string_view kTwice = ": At Most 1 required";
  if (const auto at = text.find(kTwice); at != std::string::npos)
    return text.substr(0, at) + " is given more than once";
  constexpr std::string_view kUnknown = "The following argument";
  if (const auto at = text.find(": "); text.starts_with(kUnknown) && at != std::string::npos)
    return "unknown option or one name too many: " + text.substr(at + 2);
  if (text == "A subcommand is required") return "the name of a command is needed first";
  return text;
}

}  // namespace

CLI::Validator within(double low, double high, const std::string& text) {
  return CLI::Validator(
      [=](std::string& input) {
        char* end = nullptr;
        const double value = std::strtod(input.c_str(), &end);
        const bool number = end != input.c_str() && *end == 0 && std::isfinite(value);
        return number && value >= low && value <= high
                   ? std::string()
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

CLI::Option* add_off_flag(CLI::App& app, const std::string& name, bool& value,
                          const std::string& help) {
  return app.add_flag_callback(
      name, [&value] { value = false; }, help);
}

int parse(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", fmt::format("{} {}", app.get_name(), LIBATLAS_VERSION));
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    print(stderr, fmt::format("{}: error: {} (--help lists the options)\n", app.get_name(),
                              complaint(error)));
    return 2;
  }
  return -1;
}

}  // namespace atlas::app
