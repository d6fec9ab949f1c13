// The options of atlas-pack.
#pragma once

#include <filesystem>
#include <optional>

#include "libatlas/pack/pack.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {

enum class DataFormat { hash, array };

struct PackCommand {
  enum class Kind { none, rects, images, mesh } kind = Kind::none;
  std::filesystem::path input, output, preview;
  PackOptions options;
  bool page_given = false;  // whether the page was given; if not, rects uses an instance's own
  DataFormat format = DataFormat::hash;
  bool json = false, quiet = false;
  int threads = 0;
  // images
  bool trim = true, alias = true;
  int extrude = 0, trim_threshold = 0;
  // images and mesh
  std::filesystem::path depfile;
  // mesh
  unsigned pages = 1, rotations = 16;
  int page_side = 2048;
  bool keep_density = false;
  std::optional<double> uv_aspect;  // nothing: what the mesh's file says of it
  ReadOptions read;                 // what users choose of it
};

// Fills in the command. Returns -1 to go on, or the exit code with which the program should end
// (after help, version, or an error that has been printed).
int parse_command_line(int argc, char** argv, PackCommand& command);

}  // namespace atlas::app
