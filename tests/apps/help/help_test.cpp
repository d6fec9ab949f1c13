// Checks that docs/programs.md lists exactly the options that --help prints.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace {

using Names = std::set<std::string>;

// Returns the options in the first column of lines that begin with `start`. The column ends at the
// first character that is in `ends`.
Names options_in(const std::string& text, const std::string& start, const std::string& ends) {
  Names names;
  const std::regex option("--[a-z0-9-]+");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string line = text.substr(at, end - at);
    at = end + 1;
    if (!line.starts_with(start)) continue;
    const std::string column =
        line.substr(0, line.find_first_of(ends, line.find('-', start.size() - 1)));
    for (std::sregex_iterator i(column.begin(), column.end(), option), none; i != none; ++i)
      names.insert(i->str());
  }
  names.erase("--help");
  names.erase("--version");
  return names;
}

Names of_help(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen((command + " --help").c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  EXPECT_EQ(::pclose(pipe), 0);
  return options_in(text, "  -", " :=");
}

Names of_page(const std::string& program) {
  std::ifstream file(PROGRAMS_PAGE);
  const std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t begin = page.find("\n## " + program + "\n");
  if (begin == std::string::npos) return {};
  return options_in(page.substr(begin, page.find("\n## ", begin + 1) - begin), "| `-", "|");
}

TEST(Help, ThePageOfProgramsNamesEveryOption) {
  EXPECT_EQ(of_page("atlas-export"), of_help(ATLAS_EXPORT));
  EXPECT_EQ(of_page("atlas-play"), of_help(ATLAS_PLAY));
  EXPECT_EQ(of_page("atlas-make-cabin"), of_help(ATLAS_MAKE_CABIN));
  Names pack;
  for (const char* command : {" rects", " images", " mesh"})
    pack.merge(of_help(ATLAS_PACK + std::string(command)));
  EXPECT_EQ(of_page("atlas-pack"), pack);
  EXPECT_GT(pack.size(), 20u);
}

}  // namespace
