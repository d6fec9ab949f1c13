// Image files, as they are read for textures and as sprites of atlas-pack.
#include <nlohmann/json.hpp>

#include "apps/atlas-pack/commands.h"
#include "libatlas/image/image_io.h"
#include "tests/fuzz/fuzz_files.h"

namespace atlas::test {
namespace {

namespace fs = std::filesystem;

// Messages about images give a reason of OpenImageIO's, which is sometimes all there is to say.
std::string fault_of(const Status& status, const std::string& name) {
  const std::string& message = status.message();
  const bool clear = message.starts_with(name + ": ") && message.find('\n') == message.npos &&
                     message.size() > name.size() + 2 && !message.ends_with(": ");
  return clear ? "" : "an unclear error: " + message;
}

template <class T>
std::string judge(const Result<Image<T>>& image, const std::string& name) {
  if (!image.ok()) return fault_of(image.status(), name);
  const bool sound = image->width > 0 && image->height > 0 && image->channels > 0 && image->whole();
  return sound ? "" : "an image of other texels than its sides say";
}

}  // namespace

FuzzResult fuzz_image(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  const fs::path path = folder.write_scene(bytes, extension);
  const std::string name = path.string();
  const Result<Image8> image = read_image8(path);
  const Result<ImageF> floats = read_image_float(path);
  std::string fault = judge(image, name);
  if (fault.empty()) fault = judge(floats, name);
  if (fault.empty()) fault = judge(decode_image8(bytes, "image 1"), "image 1");
  if (!fault.empty()) return {fault};
  const bool large = !floats.ok() && floats.status().message().find(": claims ") != name.npos;
  if (large) return {};  // floats take four times the memory
  if (image.ok() != floats.ok()) return {"read as bytes or as floats, but not as both"};
  if (!image.ok()) return {};
  if (image->width != floats->width || image->height != floats->height)
    return {"bytes and floats of different sizes", true};
  const Result<TextureImage> texture = read_texture(path);
  if (!texture.ok()) return {"an image, but no texture: " + texture.status().message(), true};
  return {texture->image.whole() ? "" : "a texture without its texels", true};
}

FuzzResult fuzz_sprites(FuzzBytes bytes, const std::string& extension) {
  const FuzzFolder folder;
  const unsigned choice = sum_of(bytes);
  app::PackCommand command;
  command.kind = app::PackCommand::Kind::images;
  command.input = folder.path() / "sprites";
  command.output = folder.path() / "atlas";
  command.options.page = {256, 256};
  command.options.max_pages = 2;
  command.options.effort = 20;
  command.options.allow_rotation = choice & 1;
  command.options.crop = choice & 2;
  command.trim = choice & 4;
  command.alias = choice & 8;
  command.extrude = choice & 16 ? 2 : 0;
  command.format = choice & 32 ? app::DataFormat::array : app::DataFormat::hash;
  command.threads = 1;
  fs::create_directory(command.input);
  const fs::path first = folder.write_scene(bytes, extension);
  fs::copy_file(first, command.input / ("a." + extension), fs::copy_options::overwrite_existing);
  fs::copy_file(first, command.input / ("b." + extension), fs::copy_options::overwrite_existing);
  const Result<app::PackedAtlas> packed = app::run_images(command, {});
  if (!packed.ok()) {
    const std::string& message = packed.status().message();
    const bool clear =
        message.starts_with(command.input.string()) && message.find('\n') == message.npos;
    return {clear ? "" : "an unclear error: " + message};
  }
  if (packed->items.size() != 2) return {"two sprites became another number", true};
  for (std::size_t p = 0; p < packed->pages.size(); ++p) {
    const Result<Image8> page = read_image8(folder.path() / packed->images[p]);
    if (!page.ok()) return {"a page cannot be read: " + page.status().message(), true};
    if (page->width != packed->pages[p].width || page->height != packed->pages[p].height)
      return {"a page of another size than its data say", true};
    std::ifstream data(folder.path() / app::data_of_page(packed->images[p]));
    if (!nlohmann::json::accept(data)) return {"the result is no JSON", true};
  }
  return {"", true};
}

}  // namespace atlas::test
