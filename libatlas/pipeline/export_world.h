// The whole method in one call: turns a lit scene into a walkable world with atlases.
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

// Runs the stages of the scene's plan (make_plan), and writes options.target with its images beside
// it. All files appear together at the end, or none does. Scenes without illumination, and
// ExportOptions::charts_only, give plain uvs. The report lacks the path of the scene and what
// reading it took, which the caller adds. A scene that a program has built itself is passed as
// `LoadedScene{.scene = std::move(scene)}` after complete_scene() (scene/check_scene.h).
// The world begins with `loaded.view`, unless there is none or it looks straight up or down: then
// choose_viewpoint() decides.
// `stage_done` (may be empty) is called after each stage.
// Errors: bad_option (the message names the option), bad_input, no_solution, io, cancelled.
Result<ExportReport> export_world(const LoadedScene& loaded, const ExportOptions& options,
                                  const std::function<void(const StageReport&)>& stage_done,
                                  const Context& context);

// Returns the message that tells users of plain uvs about their pages (there must be at least one).
// The uvs run from 0 to 1 along both sides of each page.
std::string plain_pages_text(std::span<const Extent> pages, bool udim);

}  // namespace atlas
