// What the fuzzers of files share: a folder of their own, and how they stop at a fault.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace atlas::test {

// Ends the program, so that the fuzzer keeps the input.
inline void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

// The folder of this process among the temporary files.
inline const std::filesystem::path& fuzz_folder() {
  static const std::filesystem::path folder = [] {
    auto made = std::filesystem::temp_directory_path() / ("fuzz." + std::to_string(::getpid()));
    std::filesystem::create_directories(made);
    return made;
  }();
  return folder;
}

// Writes scene.EXTENSION, and returns its path. What follows a line `%%` is a second file,
// second.mtl and second.bin, which the scene may name.
inline std::filesystem::path write_scene(std::string_view bytes, const std::string& extension) {
  const auto write = [](const std::filesystem::path& path, std::string_view content) {
    std::ofstream(path, std::ios::binary).write(content.data(), std::streamsize(content.size()));
  };
  const std::size_t cut = bytes.find("\n%%\n");
  if (cut != bytes.npos) {
    write(fuzz_folder() / "second.mtl", bytes.substr(cut + 4));
    write(fuzz_folder() / "second.bin", bytes.substr(cut + 4));
  }
  const std::filesystem::path file = fuzz_folder() / ("scene." + extension);
  write(file, bytes.substr(0, cut));
  return file;
}

// Whether the message is what a user can use: one line that names a file of the folder and, in
// brackets, a remedy.
inline bool clear_error(const std::string& message) {
  return message.find('\n') == message.npos && message.find('(') != message.npos &&
         message.find(fuzz_folder().string()) != message.npos;
}

}  // namespace atlas::test
