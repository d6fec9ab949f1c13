// The folder of models, rooms and packing instances that LIBATLAS_DATA names.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>

namespace atlas::test {

// None where the variable is unset or empty, as scripts leave it: tests that need the data skip.
inline std::optional<std::filesystem::path> shared_data() {
  const char* folder = std::getenv("LIBATLAS_DATA");
  if (!folder || !*folder) return std::nullopt;
  return folder;
}

}  // namespace atlas::test
