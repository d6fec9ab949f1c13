#include "libatlas/scene/building/lightmap_images.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "libatlas/core/srgb.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/files/decode_uri.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Limit on the texels of all pages, which are floats in memory: six gigabytes. A small file can
// hold a large image, and name it as many pages.
constexpr std::size_t kMostTexels = std::size_t{1} << 29;

// Returns `value_of` of each colour without alpha; grey becomes three equal channels.
template <class T, class Value>
ImageF three_channels(const Image<T>& image, const Value& value_of) {
  ImageF rgb(image.width, image.height, 3);
  const std::size_t texels = rgb.texels.size() / 3, n = std::size_t(image.channels);
  for (std::size_t i = 0; i < texels; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rgb.texels[3 * i + c] = value_of(image.texels[n * i + (n < 3 ? 0 : c)]);
  return rgb;
}

// Reads linear values, of which those that are no light become 0.
Result<ImageF> read_linear(const fs::path& path, SceneBuilder& builder) {
  auto image = read_image_float(path);
  if (!image.ok()) return image.status();
  for (float& value : image->texels) {
    if (std::fabs(value) <= kMostLight) continue;
    value = 0;
    builder.defects.add(DefectKind::illumination_not_finite, [&] { return path.string(); });
  }
  if (image->channels == 3) return image;
  return three_channels(*image, [](float value) { return value; });
}

Status too_large(const fs::path& path, int width, int height) {
  return {ErrorCode::unsupported,
          fmt::format("{}: its {} x {} texels and those of the pages before are more than {}",
                      path.string(), width, height, kMostTexels)};
}

// How a page is read: as an image of linear values if `white` is 0, and with no more than `room`
// texels.
struct PageWanted {
  float white;
  std::size_t room;
};

// Reads a page. Checks first whether the file exists, because asking the decoder for it would load
// a large library.
Result<ImageF> read_page(const fs::path& path, const PageWanted& wanted, SceneBuilder& builder) {
  if (!builder.may_read(path, builder.file)) return builder.refused;
  if (!builder.named_files.is_file(path))
    return Status(ErrorCode::not_found, path.string() + ": there is no such file");
  builder.files.push_back(path);
  if (wanted.white == 0) return read_linear(path, builder);
  const auto read = read_texture(path);
  if (!read.ok()) return read.status();
  // Its floats take up to twelve times as much memory as it does.
  const Image8& image = read->image;
  if (std::size_t(image.width) * std::size_t(image.height) > wanted.room)
    return too_large(path, image.width, image.height);
  return three_channels(image,
                        [&](std::uint8_t code) { return wanted.white * srgb_decode8(code); });
}

// Likewise, reads the pages that are used.
Result<std::vector<ImageF>> read_pages(const std::vector<std::string>& names, float white,
                                       const std::vector<bool>& used, SceneBuilder& builder,
                                       const Context& context) {
  std::vector<ImageF> pages(used.size());
  std::size_t texels = 0;
  for (std::size_t page = 0; page < used.size(); ++page) {
    if (!used[page]) continue;
    if (context.cancelled()) return Status::cancelled();
    if (page >= names.size() || names[page].empty())
      return Status(ErrorCode::not_found,
                    fmt::format("{}: names no image for page {}", builder.file, page));
    const fs::path path = lightmap_path(names[page], builder.file);
    auto image = read_page(path, {white, kMostTexels - texels}, builder);
    if (!image.ok()) return image.status();
    texels += image->texels.size() / 3;
    if (image->empty() || texels > kMostTexels) return too_large(path, image->width, image->height);
    pages[page] = std::move(*image);
  }
  return pages;
}

}  // namespace

fs::path lightmap_path(const std::string& name, const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::error_code error;  // a file that cannot be examined is not there
  const fs::path plain = folder / name, path = folder / decode_uri(name);
  return !fs::exists(path, error) && fs::exists(plain, error) ? plain : path;
}

void note_lightmap(const LightmapImages& named, SceneBuilder& builder) {
  for (const auto* names : {&named.images, &named.linear})
    for (const std::string& name : *names)
      if (!name.empty()) builder.other_files.push_back(lightmap_path(name, builder.file));
}

Result<std::vector<ImageF>> read_lightmap(const LightmapImages& named,
                                          const std::vector<bool>& used, SceneBuilder& builder,
                                          const Context& context) {
  const float white = named.white.value_or(1.0f);
  if (named.linear.empty()) return read_pages(named.images, white, used, builder, context);
  Result<std::vector<ImageF>> linear = read_pages(named.linear, 0, used, builder, context);
  if (linear.ok() || named.images.empty()) return linear;
  builder.defects.add(DefectKind::lightmap_clipped, [&] { return linear.status().message(); });
  return read_pages(named.images, white, used, builder, context);
}

}  // namespace atlas
