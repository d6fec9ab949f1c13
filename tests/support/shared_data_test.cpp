#include "tests/support/shared_data.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace atlas::test {
namespace {

TEST(SharedData, AnEmptyVariableIsAsNone) {
  constexpr const char* kName = "LIBATLAS_DATA";
  const char* given = std::getenv(kName);
  const std::optional<std::string> before =
      given ? std::optional<std::string>(given) : std::nullopt;
  ::setenv(kName, "/some/folder", 1);
  EXPECT_EQ(shared_data(), std::filesystem::path("/some/folder"));
  ::setenv(kName, "", 1);
  EXPECT_FALSE(shared_data());
  ::unsetenv(kName);
  EXPECT_FALSE(shared_data());
  if (before) ::setenv(kName, before->c_str(), 1);
}

}  // namespace
}  // namespace atlas::test
