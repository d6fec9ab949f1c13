// Tests which image module a program loads.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "libatlas/image/image_io.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

// Returns what the probe says about an image, with its newline.
std::string said_by(const fs::path& probe, const fs::path& image) {
  std::FILE* pipe = ::popen((probe.string() + " " + image.string()).c_str(), "r");
  std::string said;
  for (int c; pipe && (c = std::fgetc(pipe)) != EOF;) said += char(c);
  if (pipe) ::pclose(pipe);
  return said;
}

fs::path image_in(const TempFolder& folder) {
  EXPECT_TRUE(write_exr(folder / "a.exr", ImageF(2, 2, 3, 77)).ok());
  return folder / "a.exr";
}

TEST(ImageModule, IsFoundInTheTreeItWasBuiltIn) {
  const TempFolder folder;
  EXPECT_EQ(said_by(LIBATLAS_TEST_PROBE, image_in(folder)), "read\n");
}

// A program that has left the build's tree must not load the module that lies there.
TEST(ImageModule, OfTheBuildIsNotLoadedFromElsewhere) {
  const fs::path module = LIBATLAS_TEST_OTHER_MODULE;
  if (fs::exists(fs::path(LIBATLAS_TEST_INSTALL_FOLDER) / module.filename()))
    GTEST_SKIP() << "libatlas is installed on this machine";
  const TempFolder folder;
  fs::copy_file(LIBATLAS_TEST_PROBE, folder / "probe");
  const std::string said = said_by(folder / "probe", image_in(folder));
  EXPECT_NE(said.find("belongs beside the program"), std::string::npos) << said;
}

// PNG and JPEG are read and written without it.
TEST(ImageModule, IsNotLoadedForPng) {
  const TempFolder folder;
  fs::copy_file(LIBATLAS_TEST_PROBE, folder / "probe");
  fs::copy_file(LIBATLAS_TEST_OTHER_MODULE,
                folder / fs::path(LIBATLAS_TEST_OTHER_MODULE).filename().string());
  ASSERT_TRUE(write_png(folder / "a.png", Image8(2, 2, 3, 77), {}).ok());
  EXPECT_EQ(said_by(folder / "probe", folder / "a.png"), "read\n");
}

TEST(ImageModule, OfAnotherBuildIsRefused) {
  const fs::path module = LIBATLAS_TEST_OTHER_MODULE;
  const TempFolder folder;
  fs::copy_file(LIBATLAS_TEST_PROBE, folder / "probe");
  fs::copy_file(module, folder / module.filename().string());
  const std::string said = said_by(folder / "probe", image_in(folder));
  EXPECT_NE(said.find((folder / module.filename().string()).string()), std::string::npos) << said;
  EXPECT_NE(said.find("of another build"), std::string::npos) << said;
}

}  // namespace
}  // namespace atlas
