// Loads a scene file that must be readable.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <utility>

#include "libatlas/scene/reader.h"

namespace atlas::test {

inline LoadedScene load(const std::filesystem::path& path, const ReadOptions& options = {}) {
  auto loaded = read_scene(path, options, {});
  EXPECT_TRUE(loaded.ok()) << loaded.status().message();
  return loaded.ok() ? std::move(*loaded) : LoadedScene{};
}

}  // namespace atlas::test
