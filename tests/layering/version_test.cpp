// The version stands in CMakeLists.txt; files that cannot read it there repeat it.
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "tests/layering/source_tree.h"

namespace {

std::string found(const char* file, const char* pattern) {
  const std::string text = read(kRoot / file);
  std::smatch match;
  return std::regex_search(text, match, std::regex(pattern)) ? match[1].str() : "";
}

TEST(Version, IsTheSameInEveryFile) {
  const std::string version =
      found("CMakeLists.txt", R"(project\(libatlas VERSION (\d+\.\d+\.\d+))");
  ASSERT_NE(version, "");
  EXPECT_EQ(found("CITATION.cff", R"(\nversion: (\S+))"), version);
  EXPECT_EQ(found("bindings/js/package.json", R"re("version": "([^"]+)")re"), version);
  const char* const header = "libatlas/c/atlas.h";
  EXPECT_EQ(found(header, R"(LIBATLAS_VERSION_MAJOR (\d+))") + "." +
                found(header, R"(LIBATLAS_VERSION_MINOR (\d+))") + "." +
                found(header, R"(LIBATLAS_VERSION_PATCH (\d+))"),
            version);
  EXPECT_NE(found("CHANGELOG.md", ("\n## (" + version + ")").c_str()), "");
}

}  // namespace
