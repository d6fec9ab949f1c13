// Names of files that every viewer can load.
#include "libatlas/files/safe_file_name.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace atlas {
namespace {

const std::string kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";

TEST(SafeFileName, KeepsPlainCharactersAndReplacesAllOthers) {
  std::set<std::string> names;
  for (int c = 0; c < 256; ++c) {
    const std::string text = {'a', char(c), 'b'}, name = safe_file_name(text);
    if (kPlain.find(char(c)) != std::string::npos) {
      EXPECT_EQ(name, text);
    } else {
      EXPECT_EQ(name.substr(0, 4), "a_b-") << c;
      EXPECT_EQ(name.size(), 8u) << c;  // four hexadecimal digits tell the texts apart
    }
    EXPECT_EQ(name.find_first_not_of(kPlain), std::string::npos) << c;
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 256u);
}

TEST(SafeFileName, HidesNoFile) {
  EXPECT_EQ(safe_file_name(".a.b").substr(0, 5), "_a.b-");
  EXPECT_EQ(safe_file_name("a..").substr(0, 5), "a..");
  EXPECT_EQ(safe_file_name(""), "world");
}

TEST(SafeFileName, BesideAPathReplacesItsExtension) {
  EXPECT_EQ(safely_beside("some folder/name.obj", ".mtl"), "some folder/name.mtl");
  EXPECT_EQ(safely_beside("name", ".mtl"), "name.mtl");
  const std::string blank = safely_beside("x y/n m.obj", ".mtl").string();
  EXPECT_EQ(blank, "x y/" + safe_file_name("n m") + ".mtl");
}

}  // namespace
}  // namespace atlas
