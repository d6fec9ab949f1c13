// Exports a lit mesh in memory as a world with its textures in one call, with progress and with
// cancellation from another thread (or a signal). The mesh is a floor with a spot of light.
//   export world.wrl          or .wrz, .gltf, .glb, .obj
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <string_view>
#include <utility>

#include "libatlas/pipeline/export_world.h"
#include "libatlas/scene/check_scene.h"

namespace {

std::atomic<bool> stop = false;

atlas::Scene floor_with_spot() {
  constexpr unsigned kSide = 200;
  atlas::Scene scene;
  for (unsigned j = 0; j <= kSide; ++j)
    for (unsigned i = 0; i <= kSide; ++i) {
      const float x = 4.0f * float(i) / kSide - 2, z = 4.0f * float(j) / kSide - 2;
      const float lux = 50 + 900 * std::exp(-4 * (x * x + z * z));
      scene.positions.push_back({x, 0, z});  // metres
      scene.illumination.push_back({lux, 0.9f * lux, 0.7f * lux});
      if (i == kSide || j == kSide) continue;
      const unsigned p = j * (kSide + 1) + i, q = p + kSide + 1;
      for (unsigned v : {p, q, q + 1, p, q + 1, p + 1}) scene.indices.push_back(v);
    }
  scene.materials.resize(1);
  scene.materials[0].diffuse = {0.6f, 0.5f, 0.4f};
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::puts("usage: export world.wrl"), 2;
  std::signal(SIGINT, [](int) { stop = true; });
  atlas::Context context;
  context.cancel = &stop;
  context.progress = [](std::string_view stage, double fraction) {
    std::fprintf(stderr, "\r%-20.*s %3.0f %%", int(stage.size()), stage.data(), 100 * fraction);
  };

  atlas::LoadedScene loaded;
  loaded.scene = floor_with_spot();
  atlas::ExportOptions options;
  options.target = argv[1];
  options.atlases = 1;
  options.atlas_size = 512;
  atlas::Status status = atlas::complete_scene(loaded.scene);
  if (status.ok()) {
    const auto report = atlas::export_world(loaded, options, {}, context);
    status = report.status();
    if (report.ok())
      std::printf("\n%llu triangles -> %llu, %zu page, %.1f dB\n",
                  static_cast<unsigned long long>(report->triangles),
                  static_cast<unsigned long long>(report->triangles_out), report->pages.size(),
                  report->fidelity.psnr);
  }
  if (!status.ok()) std::fprintf(stderr, "\n%s\n", status.message().c_str());
  return status.ok() ? 0 : 1;
}
