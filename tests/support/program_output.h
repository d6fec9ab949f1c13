// The output of programs, for tests that run them.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

namespace atlas::test {

// Returns the standard output of a shell command, or an empty string if it fails.
inline std::string output_of(const std::string& command) {
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) return output;
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe)) output += buffer;
  return pclose(pipe) == 0 ? output : std::string();
}

// Returns the number in field `name` of a flat JSON object.
inline double json_field(const std::string& text, const std::string& name) {
  const std::size_t at = text.find("\"" + name + "\":");
  EXPECT_NE(at, std::string::npos) << name << " in " << text;
  return at == std::string::npos ? 0 : std::atof(text.c_str() + at + name.size() + 3);
}

}  // namespace atlas::test
