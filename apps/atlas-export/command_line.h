// atlas-export's command line.
#pragma once

#include <filesystem>
#include <optional>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {

struct ExportCommand {
  std::filesystem::path scene, report;  // report: empty if not asked for
  ReadOptions read;
  ExportOptions options;
  bool plan_only = false, quiet = false;
  int threads = 0;
};

// Parses argv. Nothing: the program ends with exit_code (help was asked for, or an option is
// wrong; both have been told to the user).
std::optional<ExportCommand> parse_export_command(int argc, char** argv, int& exit_code);

}  // namespace atlas::app
