// The charts stage in three views: a table of figures, error against time, and the effects of
// units, orientation and position.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/scene/reader.h"

namespace atlas::bench {

// Returns a mesh of shapes/figures.h or support/work.h by name, or reads a file if the name has an
// extension. Errors: bad_option; those of read_scene.
Result<LoadedScene> charts_work(const std::string& name, const Context& context);

// Returns one line of Markdown for a mesh. It is exported to an OBJ with default options, and the
// measures are taken from the file, as for any other program. CPU seconds are those of charts and
// parameterisation. Errors: those of export_world; io.
Result<std::string> charts_table_row(const std::string& name, const LoadedScene& loaded,
                                     const Context& context);
std::string charts_table_head();

// Draws the meshes' charts side by side, from OBJs written with default options (charts_picture.h).
// Errors: those of export_world; io.
Status draw_charts(const std::vector<LoadedScene>& meshes, const std::filesystem::path& png,
                   const Context& context);

// One setting on one mesh.
struct ChartsPoint {
  std::string mesh, setting;
  bool preset = false;
  double cpu_seconds = 0;           // least of the repeats
  double stretch_l2 = 1, seam = 0;  // seam is length / sqrt(area)
  double stretch_999 = 1;
  std::size_t charts = 0;
};

// Measures the presets at their default bound and the bounds 1.05 to 2. Errors: those of
// make_charts.
Result<std::vector<ChartsPoint>> charts_sweep(const std::string& name, const LoadedScene& loaded,
                                              int repeats, const Context& context);
std::string line(const ChartsPoint& point);

// Writes two plots to `target`, which has no extension: -stretch.svg with L2 - 1 against CPU time,
// and -seams.svg. Each has one panel per mesh with its Pareto front. Errors: io (gnuplot is missing
// or fails).
Status draw_sweep(const std::vector<ChartsPoint>& points, const std::filesystem::path& target);

// Returns one line of Markdown: the number of charts and the L2 stretch of the mesh as it is; their
// ranges over seven units from 10^-6 to 10^6, over `turns` random rotations and over three offsets
// up to 10^6 of its size (through a written OBJ); and whether every bit is the same for powers of
// two and for other numbers of threads. Errors: those of make_charts and read_scene.
Result<std::string> charts_robust_row(const std::string& name, const LoadedScene& loaded, int turns,
                                      const Context& context);
std::string charts_robust_head();

// Returns one line of Markdown: in how many of `cases` random rotations, units from 10^-6 to 10^6
// and offsets up to 10^6 of its size the mesh keeps its number of charts within 3 %, and the
// numbers of charts in the other cases. Errors: those of make_charts and read_scene.
Result<std::string> charts_cases_row(const std::string& name, const LoadedScene& loaded, int cases,
                                     const Context& context);
std::string charts_cases_head();

}  // namespace atlas::bench
