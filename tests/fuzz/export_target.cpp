#include "libatlas/pipeline/export_world.h"
#include "tests/fuzz/fuzz_files.h"

namespace atlas::test {
namespace {

constexpr const char* kTargets[] = {"world.gltf", "world.glb", "world.obj", "world.wrl"};
constexpr const char* kPacked = "world.wrz";

ExportOptions options_of(unsigned choice, const FuzzFolder& folder) {
  ExportOptions options;
  options.target = folder.path() / kTargets[choice & 3];
  options.charts_only = choice & 4;
  options.keep_scene = options.charts_only && (choice & 3) != 3;
  options.simplify = choice & 8;
  if (choice & 16) options.charts.cone_degrees = 50;
  options.atlases = choice & 32 ? 1 : 3;
  options.atlas_size = 64;
  if ((choice & 3) == 3 && choice & 64) options.target = folder.path() / kPacked;
  options.plain_pages = choice & 128 ? 3 : 1;
  options.square_plain_page = choice & 256;
  options.charts.keep_uv_charts = choice & 512;
  options.charts.split_at_materials = choice & 1024;
  options.exr = choice & 2048;
  return options;
}

}  // namespace

FuzzResult fuzz_export(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  const ExportOptions options = options_of(sum_of(bytes), folder);
  ReadOptions read;
  read.keep_scene = options.keep_scene;
  Context context;
  context.threads = 1;
  const Result<LoadedScene> loaded =
      read_scene(folder.write_scene(bytes, extension), read, context);
  if (!loaded.ok()) return {};
  const Result<ExportReport> report = export_world(*loaded, options, {}, context);
  if (!report.ok()) {
    const std::string& message = report.status().message();
    return {clear_error(message) ? "" : "an unclear error: " + message};
  }
  const Result<LoadedScene> again = read_scene(options.target, {}, context);
  if (!again.ok()) return {"the export cannot be read: " + again.status().message(), true};
  const std::size_t before = loaded->scene.triangle_count(), now = again->scene.triangle_count();
  const bool simplified = options.simplify && !options.charts_only && loaded->scene.lit();
  const bool kept = now == before || (simplified && now < before);
  return {kept ? "" : std::to_string(before) + " triangles became " + std::to_string(now), true};
}

}  // namespace atlas::test
