// atlas-export's command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {

struct ExportCommand {
  std::filesystem::path scene;
  std::filesystem::path report, depfile;  // empty if not asked for
  ReadOptions read;
  ExportOptions options;
  std::optional<double> uv_aspect;  // nothing: what the scene's file says of it
  bool report_charts = false, plan_only = false, quiet = false;
  int threads = 0;
  // For the report: the words of the command line, and every option with its value.
  std::vector<std::string> words;
  std::vector<std::pair<std::string, std::string>> values;
};

// Parses argv. Returns nothing if the program should end with exit_code: help was asked for, or an
// option is wrong; the user has been told of either.
std::optional<ExportCommand> parse_export_command(int argc, char** argv, int& exit_code);

}  // namespace atlas::app
