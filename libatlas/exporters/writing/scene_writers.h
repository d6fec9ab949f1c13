// Internal: functions that write World::scene, one per format. The caller has called check_world().
#pragma once

#include "libatlas/exporters/world.h"

namespace atlas {

Result<WorldFile> write_gltf_scene(const World& world, const std::filesystem::path& path,
                                   AtomicFiles& files, const Context& context);
// Writes the glTF file that the scene was read from (Scene::source, not null), with the new uvs.
Result<WorldFile> write_gltf_file(const World& world, const std::filesystem::path& path,
                                  AtomicFiles& files, const Context& context);
// Returns what scene_texture_paths() does, of such a scene.
std::vector<std::filesystem::path> kept_image_paths(const Scene& scene,
                                                    const std::filesystem::path& target);
Result<WorldFile> write_obj_scene(const World& world, const std::filesystem::path& path,
                                  AtomicFiles& files, const Context& context);

}  // namespace atlas
