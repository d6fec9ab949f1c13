// Internal: what else of a glTF file goes into one that is written again. Includes tinygltf, so it
// is for .cpp files only.
#pragma once

#include "libatlas/exporters/gltf_data.h"
#include "libatlas/scene/losses.h"

namespace atlas {

// The asset that is written: what the source says of its author and licence, its title if it has
// one, and the information of both; that of an earlier export is replaced.
nlohmann::json merge_assets(const nlohmann::json& source, nlohmann::json own);

// Takes extensions out of a part of the document that name data by number, and do so where only
// they know: data gets new numbers.
void drop_data_extensions(nlohmann::json& part, Losses& losses);

// Skins, animations, instances of nodes that are not shown, extensions, and the lists of those that
// are used. To be called last.
void keep_rest(const GltfSource& source, GltfData& data, nlohmann::json& document, Losses& losses);

}  // namespace atlas
