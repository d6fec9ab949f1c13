// Internal: where the instances of a mesh lie on the pages, in a glTF file that has each mesh once.
// Includes nlohmann-json, so it is for .cpp files only.
#pragma once

#include <cstddef>
#include <vector>

#include "libatlas/exporters/gltf/gltf_document.h"
#include "libatlas/exporters/world.h"
#include "libatlas/scene/building/losses.h"

namespace atlas {

// Writes World::instances: as extras of the nodes that show a mesh (lightmapScale, lightmapOffset,
// and lightmapPage if there are several), or as attributes of their instances
// (EXT_mesh_gpu_instancing: _LIGHTMAP_SCALE, _LIGHTMAP_OFFSET, _LIGHTMAP_PAGE). `node_of_place`:
// one node of the document for each place of the source.
void name_instances(const World& world, const std::vector<std::size_t>& node_of_place,
                    GltfDocument& document, Losses& losses);

}  // namespace atlas
