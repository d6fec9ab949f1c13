// Internal: the other parts of a glTF file that is written again. Includes tinygltf, so it is for
// .cpp files only.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>

#include "libatlas/exporters/gltf_kept/gltf_data.h"
#include "libatlas/scene/building/losses.h"

namespace atlas {

// Returns the asset to write: what the source says of its author and licence, its title (if it has
// none, the new one), and the information of both. If the source is an earlier export, its
// information is replaced, except the pages of its uv sets. What the source says of the pages of
// `new_sets` is left out in any case: these hold other uvs now.
nlohmann::json merge_assets(const nlohmann::json& source, const nlohmann::json& own,
                            const std::set<std::int64_t>& new_sets);

// Counts the images that an asset names of an earlier export's lightmap, and that are not there for
// `file`.
void count_absent_images(const nlohmann::json& asset, const std::filesystem::path& file,
                         Losses& losses);

// Returns the uv set of the lightmap that an earlier export has named in the source, or -1.
std::int64_t lightmap_set(const nlohmann::json& source);

// Removes the page of such a lightmap from a primitive (see name_lightmap_page()).
void drop_lightmap_page(nlohmann::json& primitive);

// Removes from a part of the document the extensions that refer to data by number, except
// EXT_mesh_gpu_instancing. Data gets new numbers, and only such an extension knows where its own
// are.
void drop_data_extensions(nlohmann::json& part, Losses& losses);

// Handles skins, animations, instances of nodes that are not shown, extensions, and the lists of
// extensions that are used. Must be called last.
void keep_rest(const GltfSource& source, GltfData& data, nlohmann::json& document, Losses& losses);

}  // namespace atlas
