// The folder of models, rooms and packing instances that LIBATLAS_DATA names; see docs/building.md.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atlas::test {

// Returns a part of that folder ("models", "room", "packing"). Returns nothing if the variable is
// unset or empty (as scripts leave it), or if the folder lacks that part; tests that need it skip
// then.
inline std::optional<std::filesystem::path> shared_data(const std::string& part) {
  const char* folder = std::getenv("LIBATLAS_DATA");
  if (!folder || !*folder) return std::nullopt;
  const std::filesystem::path path = std::filesystem::path(folder) / part;
  if (!std::filesystem::exists(path)) return std::nullopt;
  return path;
}

// Returns the reason why a test skips.
inline std::string lacks(const std::string& part) {
  return "LIBATLAS_DATA names no folder with " + part;
}

// Returns the folder's OBJ models, sorted by name.
inline std::vector<std::filesystem::path> shared_models() {
  std::vector<std::filesystem::path> paths;
  const auto folder = shared_data("models");
  if (!folder) return paths;
  for (const auto& entry : std::filesystem::directory_iterator(*folder))
    if (entry.path().extension() == ".obj") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace atlas::test
