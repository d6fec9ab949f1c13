#include "libatlas/scene/reader.h"

#include <fmt/format.h>

#include <cmath>
#include <new>

#include "libatlas/core/clock.h"
#include "libatlas/core/progress.h"
#include "libatlas/files/file_extension.h"
#include "libatlas/scene/building/formats.h"
#include "libatlas/scene/gltf/gltf_source.h"

namespace atlas {
namespace fs = std::filesystem;

namespace {

using Reader = Status (*)(const fs::path&, SceneBuilder&, const Context&);

Reader reader_for(const fs::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".obj") return read_obj;
  if (extension == ".wrl" || extension == ".wrz") return read_vrml;
  if (extension == ".gltf" || extension == ".glb") return read_gltf;
  if (extension == ".ply") return read_ply;
  if (extension == ".off") return read_off;
  if (extension == ".stl") return read_stl;
  return nullptr;
}

}  // namespace

bool known_extension(const fs::path& path) {
  return reader_for(path) != nullptr;
}

Status read_by_extension(const fs::path& path, SceneBuilder& builder, const Context& context) {
  std::error_code error;  // the reader reports what cannot be examined
  if (const Reader read = reader_for(path)) {
    // Otherwise the reader of each format would report something else as missing from an empty
    // file.
    if (fs::is_regular_file(path, error) && fs::is_empty(path, error))
      return {ErrorCode::bad_input,
              fmt::format("{}: is empty (was writing it cut short? export the scene again)",
                          path.string())};
    if (Status s = read(path, builder, context); !s.ok()) return s;
    return builder.refused;
  }
  if (fs::is_directory(path, error))
    return {ErrorCode::bad_input,
            fmt::format("{}: is a directory (name a file inside it)", path.string())};
  return {ErrorCode::unsupported,
          fmt::format("{}: no reader for {} (use .obj, .ply, .off, .stl, .gltf, .glb, or a .wrl "
                      "or .wrz written by this program)",
                      path.string(),
                      path.has_extension() ? fmt::format("'{}'", path.extension().string())
                                           : "a name without an ending")};
}

namespace {

Result<LoadedScene> read_whole(const fs::path& path, const ReadOptions& given,
                               const Context& context) {
  ReadOptions options = given;
  if (options.keep_scene) options.encoded_textures = options.normals = options.rest = true;
  if (!(options.metres_per_unit > 0) || !std::isfinite(options.metres_per_unit)) {
    return Status(ErrorCode::bad_option,
                  fmt::format("{} metres a unit: the unit's length must be positive",
                              options.metres_per_unit));
  }
  context.report("reading", 0);
  SceneBuilder builder(path);
  if (options.confine) builder.named_files.confine_to(path.parent_path());
  builder.limits = options.limits;
  builder.wants_textures = options.load_textures;
  builder.wants_normals = options.normals;
  builder.wants_rest = options.rest;
  builder.wants_told_uvs = options.told_uvs;
  builder.wants_polygons = options.polygons;
  // Shares of the stage: of the scene's file, then of that of the illumination.
  const bool other_light = !options.illumination_file.empty();
  builder.wants_lightmap = options.lightmap && !other_light;
  constexpr double kParsed = 0.8;
  const double own = other_light ? kParsed / 2 : kParsed;
  const auto part = [&](double from, double to) {
    return part_of_stage(context, "reading", from, to);
  };
  if (Status s = read_by_extension(path, builder, part(0, own)); !s.ok()) return s;
  if (other_light) {
    if (Status s = read_illumination(options, builder, part(own, kParsed)); !s.ok()) return s;
  }
  const std::shared_ptr<GltfSource> source = builder.source;
  auto result = builder.finish(options, part(kParsed, 1));
  if (result.ok()) result->files = std::move(builder.files);
  if (result.ok() && source) {
    source->image_texture = std::move(builder.texture_numbers);
    source->image_files = std::move(builder.image_files);
    source->other_light = other_light;
    source->positions_mark = positions_mark(result->scene);
  }
  return_freed_memory();  // half of the memory that reading took
  if (result.ok()) context.report("reading", 1);
  return result;
}

}  // namespace

Result<LoadedScene> read_scene(const fs::path& path, const ReadOptions& options,
                               const Context& context) {
  try {
    return read_whole(path, options, context);
  } catch (const std::bad_alloc&) {
    return Status(ErrorCode::unsupported,
                  fmt::format("{}: out of memory while it is read (split the scene, or free some "
                              "memory)",
                              path.string()));
  }
}

}  // namespace atlas
