// The lightmap that an export writes beside a scene that is kept and carries light.
#pragma once

#include <string>

#include "libatlas/exporters/world.h"
#include "libatlas/pipeline/export_options.h"
#include "libatlas/report/export_report.h"
#include "libatlas/scene/scene.h"

namespace atlas {

// Returns whether an export with these options writes one, for a scene that is lit or is not.
bool has_lightmap(bool lit, const ExportOptions& options);

// Returns whether the light of a glTF file that is kept is COLOR_0 within 0 to 1, which nothing
// says to be light (ExportOptions::colours_are_light).
bool keeps_paint(const Scene& scene, const ExportOptions& options);

// Returns the line that says for what COLOR_0 of a glTF file that is kept is taken by an export
// with these options, which are not those of planned_options(); empty if it has none, or no light
// is wanted.
std::string colours_text(const Scene& scene, const ExportOptions& options);

// Returns whether the file can have several pages, with light (`bake`) or without. A scene that is
// kept has its own materials, so only what glTF says of the pages of a lightmap can tell its
// triangles apart, or UDIM tiles.
bool holds_pages(const ExportOptions& options, bool bake);

// Returns the images of the lightmap and the light that is white on them, after an export with
// these options.
Lightmap lightmap_of(const ExportReport& report, const ExportOptions& options);

// Returns the message that tells users of it.
std::string lightmap_text(const Lightmap& lightmap);

}  // namespace atlas
