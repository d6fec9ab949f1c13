#include "tests/support/shared_data.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "LIBATLAS_DATA";

std::optional<std::string> given() {
  const char* value = std::getenv(kName);
  return value ? std::optional<std::string>(value) : std::nullopt;
}

TEST(SharedData, IsWhatIsThere) {
  const TempFolder folder;
  fs::create_directories(folder / "models");
  const std::optional<std::string> before = given();
  ::setenv(kName, folder.path().c_str(), 1);
  EXPECT_EQ(shared_data("models"), folder / "models");
  EXPECT_FALSE(shared_data("room"));
  EXPECT_TRUE(shared_models().empty());
  ::setenv(kName, "", 1);
  EXPECT_FALSE(shared_data("models"));
  ::unsetenv(kName);
  EXPECT_FALSE(shared_data("models"));
  if (before) ::setenv(kName, before->c_str(), 1);
}

// If the name was misspelt, all tests that need the data would skip unnoticed.
TEST(SharedData, TheFolderThatIsNamedExists) {
  if (!given() || given()->empty()) GTEST_SKIP() << kName << " is not set";
  EXPECT_TRUE(fs::is_directory(*given())) << kName << " is " << *given();
}

}  // namespace
}  // namespace atlas::test
