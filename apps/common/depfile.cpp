#include "apps/common/depfile.h"

#include <fmt/format.h>

#include <set>
#include <string_view>

namespace atlas::app {
namespace {

namespace fs = std::filesystem;

// Returns whether ninja takes this character for the end of a name, with or without a backslash.
bool ends_names(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < ' ' || byte == 0x7f || std::string_view("*;<>|^`").find(c) != std::string::npos;
}

// Appends the name to `rule`. A backslash before a character that is escaped, or at the end, means
// one thing to make and another to ninja. Returns false if there is one, or any other character
// that cannot be written.
bool append(const std::string& name, std::string& rule) {
  char before = 0;
  for (const char c : name) {
    const bool escaped = c == ' ' || c == '#' || c == ':';
    if (ends_names(c) || (before == '\\' && (escaped || c == '$'))) return false;
    if (escaped) rule += '\\';
    if (c == '$') rule += '$';
    rule += c;
    before = c;
  }
  return before != '\\' && before != ':';
}

}  // namespace

Result<std::string> dependency_rule(const fs::path& target, std::span<const fs::path> inputs) {
  const auto refused = [](const fs::path& name) {
    return Status(ErrorCode::bad_option,
                  fmt::format("{}: no dependency file can hold this name: make and ninja read no "
                              "control characters, none of * ; < > | ^ ` and no backslash before a "
                              "space, #, $, : or the end (rename it)",
                              name.string()));
  };
  std::string rule;
  if (!append(target.string(), rule)) return refused(target);
  rule += ':';
  std::set<fs::path> seen;
  for (const fs::path& input : inputs) {
    if (input.empty() || !seen.insert(input.lexically_normal()).second) continue;
    rule += " \\\n  ";
    if (!append(input.string(), rule)) return refused(input);
  }
  return rule + '\n';
}

}  // namespace atlas::app
