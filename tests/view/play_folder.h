// What tests of playing, loading and measuring share.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "libatlas/view/renderer.h"

namespace atlas::testing {

// A test with a folder of its own, which is removed at its end.
class Folder : public ::testing::Test {
 protected:
  Folder() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() / (std::string("atlas-view-") + info->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~Folder() override { std::filesystem::remove_all(path_); }
  std::filesystem::path path_;
};

// Returns options for pictures that are quickly drawn.
inline RenderOptions small() {
  RenderOptions o;
  o.width = 48;
  o.height = 32;
  o.map_resolution = 128;
  return o;
}

}  // namespace atlas::testing
