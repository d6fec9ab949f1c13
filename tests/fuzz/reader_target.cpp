#include "libatlas/image/image_io.h"
#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/fuzz/effort.h"
#include "tests/fuzz/fuzz_files.h"

namespace atlas::test {

FuzzResult fuzz_reader(FuzzBytes bytes, const std::string& extension) {
  const unsigned choice = sum_of(bytes);
  ReadOptions options;
  options.load_textures = choice & 1;
  options.encoded_textures = choice & 2;
  options.normals = choice & 4;
  options.rest = choice & 8;
  options.lightmap = choice & 16;
  options.confine = choice & 32;
  Context context;
  context.threads = 1;
  const FuzzFolder folder;
  const std::filesystem::path path = folder.write_scene(bytes, extension);
  if (options.load_textures)
    static_cast<void>(check_image_module(extension));  // takes its time once
  const Effort effort;
  const Result<LoadedScene> loaded = read_scene(path, options, context);
  if (std::string much = effort.fault(loaded.ok() ? loaded->scene.triangle_count() : 0);
      !much.empty())
    return {much, loaded.ok()};
  if (!loaded.ok()) {
    const std::string& message = loaded.status().message();
    const bool named = message.find(folder.path().string()) != message.npos;
    return {named && clear_error(message) ? "" : "an unclear error: " + message};
  }
  if (const Status sound = check_scene(loaded->scene); !sound.ok())
    return {"an unsound scene: " + sound.message(), true};
  return {loaded->scene.triangle_count() > 0 ? "" : "a scene without a triangle", true};
}

FuzzResult fuzz_illumination(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  ReadOptions options;
  options.illumination_file = folder.write_scene(bytes, extension);
  Context context;
  context.threads = 1;
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n";
  const Result<LoadedScene> loaded = read_scene(folder.write("mesh.obj", mesh), options, context);
  if (!loaded.ok()) {
    const std::string& message = loaded.status().message();
    const bool named = message.find(options.illumination_file.string()) != message.npos;
    return {named && clear_error(message) ? "" : "an unclear error: " + message};
  }
  const Status sound = check_scene(loaded->scene);
  return {sound.ok() ? "" : "an unsound scene: " + sound.message(), true};
}

}  // namespace atlas::test
