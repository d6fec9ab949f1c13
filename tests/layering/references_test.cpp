// Whatever the code and the documents cite as "Author Year" is listed in docs/references.bib.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "tests/layering/source_tree.h"

namespace {

namespace fs = std::filesystem;

struct Entry {
  std::string authors, year;
};

std::vector<Entry> bibliography() {
  const std::string text = read(kRoot / "docs/references.bib");
  const std::regex pattern(R"(author = \{(.*)\},\n[^@]*?year = \{(\d{4})\})");
  std::vector<Entry> entries;
  for (std::sregex_iterator i(text.begin(), text.end(), pattern), end; i != end; ++i) {
    std::string authors = (*i)[1];  // accents are in TeX notation: {\'e} and so on
    authors = std::regex_replace(authors, std::regex(R"(\{\\.(\{\w\}|\w)\})"), "?");
    entries.push_back({authors, (*i)[2]});
  }
  return entries;
}

// Joins the lines of comments and replaces letters beyond ASCII by '?': "Lévy et al. 2002" becomes
// "L?vy et al. 2002".
std::string plain(std::string text) {
  text = std::regex_replace(text, std::regex(R"(\n\s*(//)?\s*)"), " ");
  return std::regex_replace(text, std::regex("[\xC3\xC4\xC5][\x80-\xBF]"), "?");
}

bool cited(const fs::path& path) {
  const std::string e = path.extension().string();
  return e == ".h" || e == ".cpp" || e == ".md";
}

TEST(References, EveryCitationStandsInTheBibliography) {
  const std::vector<Entry> entries = bibliography();
  ASSERT_GE(entries.size(), 40u);
  const std::regex citation(
      R"(\b([A-Z][A-Za-z?]+(?:-[A-Z][a-z]+)?)(?:'s)?(?: et al\.,?| and [A-Z][A-Za-z?]+)? \(?((?:19|20)\d{2})\b)");
  // Phrases that look like citations but are not: standards, dates, names of programs with a year.
  const std::regex other(
      "January|February|March|April|May|June|July|August|September|October|November|December|ISO|"
      "Debian|The|In|At|Every|From|With|About|OBJ|CLASS|Copyright");
  int found = 0;
  for (const char* folder : {"libatlas", "apps", "examples", "benchmarks", "docs", "tests"}) {
    for (const auto& item : fs::recursive_directory_iterator(kRoot / folder)) {
      if (item.path().string().find("/node_modules/") != std::string::npos) continue;
      if (!item.is_regular_file() || !cited(item.path())) continue;
      const std::string text = plain(read(item.path()));
      for (std::sregex_iterator i(text.begin(), text.end(), citation), end; i != end; ++i) {
        const std::string author = (*i)[1], year = (*i)[2];
        if (std::regex_match(author, other)) continue;
        ++found;
        bool known = false;
        for (const Entry& e : entries) {
          known |= e.year == year && e.authors.find(author) != std::string::npos;
        }
        EXPECT_TRUE(known) << fs::relative(item.path(), kRoot).string() << ": " << i->str()
                           << " is not in docs/references.bib";
      }
    }
  }
  EXPECT_GT(found, 40);
}

}  // namespace
