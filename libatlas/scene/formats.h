// Internal: one function a format. Each fills a builder with the file's vertices and faces.
#pragma once

#include "libatlas/scene/scene_builder.h"

namespace atlas {

Status read_obj(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_ply(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_off(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_stl(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_gltf(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);
Status read_vrml(const std::filesystem::path& path, SceneBuilder& builder, const Context& context);

// Appends the materials of an MTL library, and their textures.
Status read_mtl(const std::filesystem::path& path, SceneBuilder& builder);

// Replaces the builder's illumination by that of a file with the same vertices.
Status read_illumination(const std::filesystem::path& path, SceneBuilder& builder,
                         const Context& context);

// Whether the extension (in any case) names one of the formats above.
bool known_extension(const std::filesystem::path& path);

// Calls the reader that the extension names; unsupported where there is none.
Status read_by_extension(const std::filesystem::path& path, SceneBuilder& builder,
                         const Context& context);

}  // namespace atlas
