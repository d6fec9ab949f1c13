// Reads what the fuzzer makes up as a scene file of the format FUZZ_EXTENSION; the last byte also
// chooses options. The reader must return a sound scene or a clear error.
#include <cstdint>
#include <string>
#include <string_view>

#include "libatlas/scene/check_scene.h"
#include "libatlas/scene/reader.h"
#include "tests/fuzz/fuzz_files.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return -1;
  const unsigned choice = data[size - 1];
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  atlas::ReadOptions options;
  options.load_textures = choice & 1;
  options.encoded_textures = choice & 2;
  options.normals = choice & 4;
  options.rest = choice & 8;
  atlas::Context context;
  context.threads = 1;  // so that a finding repeats
  const auto loaded =
      atlas::read_scene(atlas::test::write_scene(bytes, FUZZ_EXTENSION), options, context);
  if (loaded.ok()) {
    const atlas::Status sound = atlas::check_scene(loaded->scene);
    atlas::test::require(sound.ok(), "an unsound scene: " + sound.message());
    atlas::test::require(loaded->scene.triangle_count() > 0, "a scene without a triangle");
  } else {
    const std::string& message = loaded.status().message();
    atlas::test::require(atlas::test::clear_error(message), "an unclear error: " + message);
  }
  return 0;
}
