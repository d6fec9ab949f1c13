// What tests of playing, loading and measuring share.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "libatlas/view/renderer.h"
#include "tests/support/temp_folder.h"

namespace atlas::testing {

// A test with a folder of its own, which is removed at its end.
class Folder : public ::testing::Test {
 private:
  const test::TempFolder folder_;

 protected:
  const std::filesystem::path path_ = folder_.path();
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
