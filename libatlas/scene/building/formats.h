// Internal: one reader for each format. It fills a builder with the file's vertices and faces, and
// reports the share that is done under any name.
#pragma once

#include "libatlas/scene/building/scene_builder.h"

namespace atlas {

Status read_obj(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_ply(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_off(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_stl(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_gltf(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_vrml(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);

// Appends the materials of an MTL library and their textures.
Status read_mtl(const std::filesystem::path& path, SceneBuilder& builder);

// Replaces the builder's illumination with that of ReadOptions::illumination_file, which must have
// the same vertices.
Status read_illumination(const ReadOptions& options, SceneBuilder& builder, const Context& context);

// Returns whether the extension (in any case) names one of the formats above.
bool known_extension(const std::filesystem::path& path);

// Calls the reader that the extension names. Errors: unsupported if there is none; bad_input for an
// empty file or a directory, or if a file must not be read (SceneBuilder::may_read); those of the
// reader.
Status read_by_extension(const std::filesystem::path& path, SceneBuilder& builder,
                         const Context& context);

}  // namespace atlas
