// Internal: the last stage of an export, which makes the world and writes it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "libatlas/bake/fidelity.h"
#include "libatlas/charts/charted_mesh.h"
#include "libatlas/core/atomic_file.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/pipeline/stage_recorder.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/reader.h"
#include "libatlas/scene/scene.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// The results of the stages before. All of them must outlive the call.
struct ExportToWrite {
  const Scene& scene;
  const ExportOptions& options;
  const ChartSet& charts;
  const PageLayout& layout;
  WorldMesh mesh;                           // the triangles to write
  std::vector<Vec2f> uvs;                   // one per uv of the charts: 0..1 over its page
  bool baked = false;                       // the pages hold light
  const LuminanceSampler* light = nullptr;  // that light; not null if baked
  // One per page with an image: where it lies until the files are committed.
  std::span<const std::filesystem::path> image_sources = {};
  std::span<const FidelityMeter::Cells> error = {};  // one per page, or none
  std::optional<FileView> view = {};  // where a viewer of the scene's own file begins
  std::span<const FileView> further_views = {};
};

// Writes the world and commits `files`, which hold the pages' images. Adds to the report what was
// written, what the format had no room for, and advice on a place too far from zero and on meshes
// without new uvs. Errors: bad_input, io, cancelled.
Result<StageOutcome> write_export(ExportToWrite made, AtomicFiles& files, ExportReport& report,
                                  const Context& context);

}  // namespace atlas
