// Reads what the fuzzer makes up as a scene file of the format FUZZ_EXTENSION, exports it, and
// reads the result again; the last byte also chooses options. All triangles must come back.
#include <cstdint>
#include <string>
#include <string_view>

#include "libatlas/pipeline/export_world.h"
#include "tests/fuzz/fuzz_files.h"

namespace {

constexpr const char* kTargets[] = {"world.gltf", "world.glb", "world.obj", "world.wrl"};

atlas::ExportOptions options_of(unsigned choice) {
  atlas::ExportOptions options;
  options.target = atlas::test::fuzz_folder() / kTargets[choice & 3];
  options.charts_only = choice & 4;
  options.keep_scene = options.charts_only && (choice & 3) != 3;
  options.simplify = choice & 8;
  if (choice & 16) options.charts.cone_degrees = 50;
  options.atlases = choice & 32 ? 1 : 3;
  options.atlas_size = 64;
  return options;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using atlas::test::require;
  if (size == 0) return -1;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const atlas::ExportOptions options = options_of(data[size - 1]);
  atlas::ReadOptions read;
  read.keep_scene = options.keep_scene;
  atlas::Context context;
  context.threads = 1;  // so that a finding repeats
  const auto loaded =
      atlas::read_scene(atlas::test::write_scene(bytes, FUZZ_EXTENSION), read, context);
  if (!loaded.ok()) return -1;
  const auto report = atlas::export_world(*loaded, options, {}, context);
  if (!report.ok()) {
    const std::string& message = report.status().message();
    require(message.find('\n') == message.npos && message.find('(') != message.npos,
            "an unclear error: " + message);
    return 0;
  }
  const auto again = atlas::read_scene(options.target, {}, context);
  require(again.ok(), "the export cannot be read: " + again.status().message());
  if (options.keep_scene || options.charts_only || !options.simplify)
    require(again->scene.triangle_count() == loaded->scene.triangle_count(),
            "triangles: " + std::to_string(loaded->scene.triangle_count()) + " became " +
                std::to_string(again->scene.triangle_count()));
  return 0;
}
