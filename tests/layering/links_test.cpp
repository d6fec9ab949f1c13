// Every link of a document leads to a file, and its anchor to a heading there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/layering/source_tree.h"

namespace {

namespace fs = std::filesystem;

// The text without code, in which brackets and parentheses are no links, and `#` no headings.
std::string prose(const fs::path& page) {
  std::istringstream lines(read(page));
  std::string text;
  bool code = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```"))
      code = !code;
    else if (!code)
      text += line + '\n';
  }
  return text;
}

// The name that GitHub gives to a heading: small letters, digits, hyphens for blanks.
std::string anchor_of(std::string heading) {
  heading = std::regex_replace(heading, std::regex(R"(\[([^\]]*)\]\([^)]*\))"), "$1");
  std::string name;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 128)
      name += byte < 128 ? static_cast<char>(std::tolower(byte)) : c;
    else if (c == ' ')
      name += '-';
  }
  return name;
}

std::set<std::string> anchors(const fs::path& page) {
  std::set<std::string> names;
  std::istringstream lines(prose(page));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with('#'))
      names.insert(anchor_of(line.substr(std::min(line.size(), line.find(' ') + 1))));
  return names;
}

// What npm installs for comparisons.
bool is_of_others(const fs::path& path) {
  return path.string().find("/node_modules/") != std::string::npos;
}

TEST(Links, LeadToFilesAndHeadings) {
  std::vector<fs::path> pages;
  for (const auto& entry : fs::directory_iterator(kRoot))
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  for (const char* folder : {"docs", "examples", "benchmarks"})
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder))
      if (entry.path().extension() == ".md" && !is_of_others(entry.path()))
        pages.push_back(entry.path());
  const std::regex link(R"(\]\(([^)\s]+)\))");
  int checked = 0;
  for (const fs::path& page : pages) {
    const std::string text = prose(page);
    for (std::sregex_iterator i(text.begin(), text.end(), link), end; i != end; ++i) {
      const std::string target = (*i)[1];
      if (target.find("://") != std::string::npos) continue;
      const std::size_t hash = std::min(target.size(), target.find('#'));
      const fs::path file = hash == 0 ? page : page.parent_path() / target.substr(0, hash);
      EXPECT_TRUE(fs::exists(file)) << page << ": " << target;
      if (hash < target.size() && file.extension() == ".md") {
        EXPECT_TRUE(anchors(file).contains(target.substr(hash + 1))) << page << ": " << target;
      }
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
}

}  // namespace
