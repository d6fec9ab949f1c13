// The whole method, one call: a lit scene in, a walkable world with atlases out.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pack/pack.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/pipeline/plan.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/reader.h"

namespace atlas {

// Runs the stages that `plan` keeps and writes options.target with its images beside it: all files
// appear together at the end, or none does. Scenes without illumination, and
// ExportOptions::charts_only, give plain uvs. The report's scene path, wall_seconds and so on are
// filled except for reading, which the caller adds. A scene that a program has built by itself is
// passed as `LoadedScene{.scene = std::move(scene)}` after complete_scene() (scene/check_scene.h).
// `stage_done` (may be empty) is called after each stage.
// Errors: bad_option (named), bad_input, no_solution, io, cancelled.
Result<ExportReport> export_world(const LoadedScene& loaded, const ExportOptions& options,
                                  const std::function<void(const StageReport&)>& stage_done,
                                  const Context& context);

// What whoever uses plain uvs has to know of their pages (one at least): uvs run from 0 to 1 along
// both sides of each.
std::string plain_pages_text(std::span<const Extent> pages);

}  // namespace atlas
