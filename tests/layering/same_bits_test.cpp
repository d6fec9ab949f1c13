// What gives charts and uvs has the same bits with every compiler, standard library and processor.
// Its sources therefore leave out what these implement differently.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <regex>
#include <string>
#include <vector>

#include "tests/layering/source_tree.h"

namespace {

namespace fs = std::filesystem;

constexpr std::array kFolders{"core", "param", "charts", "raster", "pack", "uvs", "unwrap"};

struct Source {
  std::string name;  // below libatlas/
  std::string text;  // without comments
};

std::string without_comments(const std::string& text) {
  return std::regex_replace(text, std::regex("//[^\n]*"), "");
}

std::vector<Source> sources() {
  std::vector<Source> result;
  for (const char* folder : kFolders) {
    const fs::path root = kRoot / "libatlas" / folder;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      const fs::path& path = entry.path();
      if (path.extension() != ".h" && path.extension() != ".cpp") continue;
      result.push_back(
          {fs::relative(path, kRoot / "libatlas").string(), without_comments(read(path))});
    }
  }
  std::sort(result.begin(), result.end(),
            [](const Source& a, const Source& b) { return a.name < b.name; });
  return result;
}

// Returns the lines and matches of a pattern.
std::string found(const Source& source, const std::regex& pattern) {
  std::string all;
  for (std::sregex_iterator at(source.text.begin(), source.text.end(), pattern), end; at != end;
       ++at) {
    const auto line = std::count(source.text.begin(), source.text.begin() + at->position(), '\n');
    all += source.name + ":" + std::to_string(line + 1) + ": " + at->str() + "\n";
  }
  return all;
}

// Returns how many arguments a call has, given the place of its opening bracket.
std::size_t arguments(const std::string& text, std::size_t open) {
  std::size_t depth = 0, count = 1;
  for (std::size_t i = open; i < text.size(); ++i) {
    if (std::string("([{").find(text[i]) != std::string::npos) ++depth;
    if (std::string(")]}").find(text[i]) != std::string::npos && --depth == 0) break;
    count += text[i] == ',' && depth == 1;
  }
  return count;
}

TEST(SameBits, TheFoldersAreThere) {
  EXPECT_GT(sources().size(), 300u);
}

// C libraries round the last place differently.
TEST(SameBits, ElementaryFunctionsAreOurOwn) {
  const std::regex theirs(
      R"(\b(std|glm)::(a?(sin|cos|tan)h?|atan2|exp2?|expm1|log(2|10|1p|b)?|pow|cbrt|hypot|fma|[lt]gamma|erfc?|slerp)[fl]?\()");
  for (const Source& source : sources())
    EXPECT_EQ(found(source, theirs), "") << "(use core/portable_math.h)";
}

// The standard gives the engines' numbers, but not what distributions and std::shuffle() make of
// them.
TEST(SameBits, RandomNumbersAreOurOwn) {
  const std::regex theirs(
      R"(\bstd::(\w+_distribution|shuffle|sample|random_device|default_random_engine|rand)\b)");
  for (const Source& source : sources())
    EXPECT_EQ(found(source, theirs), "") << "(use core/random.h)";
}

// Libraries leave elements of which neither is less in different orders. Without an order of one's
// own, elements are compared by all that they consist of.
TEST(SameBits, OrdersAreTotal) {
  struct Sort {
    std::string name;
    std::size_t arguments;  // with an order
  };
  const std::vector<Sort> sorts{{"sort", 3},         {"partial_sort", 4}, {"nth_element", 4},
                                {"make_heap", 3},    {"push_heap", 3},    {"pop_heap", 3},
                                {"ranges::sort", 2}, {"sort_heap", 3}};
  for (const Source& source : sources()) {
    if (source.name == "core/sort_total.h") continue;
    for (const Sort& sort : sorts) {
      const std::string call = "std::" + sort.name + "(";
      for (std::size_t at = 0; (at = source.text.find(call, at)) != std::string::npos; ++at)
        EXPECT_LT(arguments(source.text, at + call.size() - 1), sort.arguments)
            << source.name << ": " << call << " with an order (use core/sort_total.h)";
    }
  }
}

// Hashes of the standard library decide the order in unordered containers.
TEST(SameBits, NothingGoesThroughHashTablesInOrder) {
  const std::regex declared(R"(std::unordered_\w+<[^;{}()]*>[&*\s]+(\w+))");
  for (const Source& source : sources()) {
    for (std::sregex_iterator at(source.text.begin(), source.text.end(), declared), end; at != end;
         ++at) {
      const std::string name = (*at)[1];
      const std::regex visited("for \\([^;)]*: " + name + R"(\)|\b)" + name + R"(\.c?begin\()");
      EXPECT_EQ(found(source, visited), "") << "(sort what " << name << " holds)";
    }
  }
}

// Sums in an order that the library chooses.
TEST(SameBits, SumsHaveAnOrder) {
  const std::regex theirs(R"(\bstd::(reduce|transform_reduce|execution)\b|parallel_reduce\b)");
  for (const Source& source : sources()) EXPECT_EQ(found(source, theirs), "");
}

}  // namespace
