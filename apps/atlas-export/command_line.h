// atlas-export's command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/reader.h"

namespace atlas::app {

struct ExportCommand {
  std::filesystem::path scene;
  std::filesystem::path like, seams;           // of ExportOptions; empty if not given
  std::vector<std::filesystem::path> reports;  // a .html is a page, others are JSON
  std::filesystem::path depfile;               // empty if not asked for
  ReportRequest request;                       // the command line, and every option with its value
  ReadOptions read;
  ExportOptions options;
  std::optional<double> uv_aspect;  // nothing: what the scene's file says of it
  bool plan_only = false, quiet = false;
  int threads = 0;
};

// Whether a report of this name is a page to read.
bool is_page(const std::filesystem::path& report);

// Parses argv. Returns nothing if the program should end with exit_code: help was asked for, or an
// option is wrong; the user has been told of either.
std::optional<ExportCommand> parse_export_command(int argc, char** argv, int& exit_code);

}  // namespace atlas::app
