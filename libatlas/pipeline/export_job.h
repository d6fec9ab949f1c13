// Internal: what every stage of an export is given, and the values that stages hand each other.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/vec.h"
#include "libatlas/files/atomic_file.h"
#include "libatlas/pipeline/earlier_scene.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/pipeline/stage_recorder.h"
#include "libatlas/report/export_plan.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/reader.h"
#include "libatlas/scene/scene.h"
#include "libatlas/texture/luminance.h"
#include "libatlas/texture/tone.h"
#include "libatlas/unwrap/page_layout.h"
#include "libatlas/uvs/page_uvs.h"

namespace atlas {

// The scene, what is to be done with it, and where that is reported. A stage fills its part of the
// report and finishes its record, or returns an error. All references must outlive the job.
struct ExportJob {
  ExportJob(const LoadedScene& loaded, const ExportOptions& asked,
            const std::function<void(const StageReport&)>& stage_done, const Context& context);

  const Scene& scene;
  const std::optional<FileView> view;          // where a viewer of the scene's own file begins
  const std::vector<FileView>& further_views;  // of the scene's own file
  const ExportOptions options;                 // those that hold for the scene (planned_options)
  const Context& context;
  const ExportPlan plan;
  AtomicFiles files;
  ExportReport report;
  StageRecorder record;
  // The scene with the uvs of ExportOptions::like, where some of these stay.
  std::optional<LikeScene> like = {};
};

// The scene's triangles as charts are made of them.
MeshView view_of(const Scene& scene);

// The light of a scene, and the curve that shows it.
struct SceneLight {
  LuminanceSampler sampler;
  ToneMapping tone;
};

// Charts and where they lie. Without light they have no full densities.
struct PackedCharts {
  ChartSet charts;
  std::vector<Vec2d> full_densities;
  PageLayout layout;

  PlacedCharts placed() const {
    return {charts, layout.placements, layout.pages, layout.kept_texels};
  }
};

// Reports the charts. Must be called again whenever charts were cut.
void report_charts(const ChartSet& charts, ExportReport& report);

// Reports how they were made, once.
void report_making(const ChartSet& charts, ExportReport& report);

// Reports the page and the density of each chart.
void report_placements(std::span<const ChartPlacement> placements, ExportReport& report);

// Reports pages without images, and how many charts lie on each.
void report_plain_pages(std::span<const Extent> pages, std::span<const ChartPlacement> placements,
                        ExportReport& report);

}  // namespace atlas
