// Internal: derives the layout options of pages from an export's options.
#pragma once

#include <cstdint>
#include <string>

#include "libatlas/charts/charts.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/unwrap/page_layout.h"

namespace atlas {

// Returns the layout options. With `bake`, pages get images, so their padding and alignment follow
// from the mip levels, and min_side limits how small charts become. Without it, they are for plain
// uvs; a single page then grows with the number of charts if that is requested
// (ExportOptions::larger_plain_page).
LayoutOptions layout_options(const ChartSet& charts, const ExportOptions& options, bool bake);

// Returns the texels kept free around charts of plain uvs.
std::int32_t plain_padding(const ExportOptions& options);

// Returns what gives charts more room, for messages: more pages (unless the file can only have one,
// see holds_pages()), or larger ones, or `other`, if not empty.
std::string more_room(const ExportOptions& options, bool bake, const std::string& other = "");

}  // namespace atlas
