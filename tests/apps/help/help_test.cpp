// Checks that docs/programs.md lists exactly the options that --help prints.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

using Names = std::set<std::string>;

// Returns the options in the first group of `names` in the lines that it matches.
Names options_in(const std::string& text, const std::regex& names) {
  Names found;
  const std::regex option("--[a-z0-9-]+");
  std::istringstream lines(text);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (!std::regex_search(line, match, names)) continue;
    const std::string column = match[1];
    for (std::sregex_iterator i(column.begin(), column.end(), option), none; i != none; ++i)
      found.insert(i->str());
  }
  found.erase("--help");
  found.erase("--version");
  return found;
}

std::string help_of(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen((command + " --help").c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
  EXPECT_EQ(::pclose(pipe), 0);
  return text;
}

Names of_help(const std::string& command) {
  const std::string text = help_of(command);
  // Names begin the line, with commas between them. Versions of CLI11 indent them differently.
  return options_in(text, std::regex("^ +((?:--?[A-Za-z0-9-]+(?:, *)?)+)"));
}

Names of_page(const std::string& program) {
  std::ifstream file(PROGRAMS_PAGE);
  const std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t begin = page.find("\n## " + program + "\n");
  if (begin == std::string::npos) return {};
  return options_in(page.substr(begin, page.find("\n## ", begin + 1) - begin),
                    std::regex("^\\| (`-[^|]*)"));
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

// Each is a command, and below it what it does.
TEST(Help, EndsWithThreeExamplesOfItsOwnOptions) {
  const std::string pack = ATLAS_PACK;
  for (const std::string& command : {std::string(ATLAS_EXPORT), std::string(ATLAS_PLAY), pack,
                                     pack + " rects", pack + " images", pack + " mesh"}) {
    SCOPED_TRACE(command);
    const std::string help = help_of(command);
    const std::size_t begin = help.find("\nExamples:\n");
    ASSERT_NE(begin, std::string::npos);
    const std::string examples = help.substr(begin);
    const std::regex line("\n  (atlas-[^\n]+)\n      [A-Z][^\n]+");
    const std::sregex_iterator first(examples.begin(), examples.end(), line), none;
    EXPECT_EQ(std::distance(first, none), 3);
    if (command == pack) continue;  // whose commands have the options
    const Names known =
        options_in(help.substr(0, begin), std::regex("^ +((?:--?[A-Za-z0-9-]+(?:, *)?)+)"));
    for (auto i = first; i != none; ++i)
      for (const std::string& option : options_in((*i)[1], std::regex("(.*)")))
        EXPECT_TRUE(known.count(option)) << option;
  }
}

}  // namespace
