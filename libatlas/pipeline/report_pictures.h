// Internal: the pictures for a report's page.
#pragma once

#include <filesystem>
#include <span>

#include "libatlas/charts/charts.h"
#include "libatlas/core/context.h"
#include "libatlas/core/status.h"
#include "libatlas/report/export_report.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// What the pictures show. All of it must outlive the call.
struct PagesToShow {
  const ChartSet& charts;
  const PageLayout& layout;
  // One per page with an image: where it lies. Empty without baked light.
  std::span<const std::filesystem::path> images = {};
  const std::vector<WorstPlace>& worst;
};

// Errors: those of decode_image8(); cancelled.
Result<ReportPictures> report_pictures(const PagesToShow& pages, const Context& context);

}  // namespace atlas
