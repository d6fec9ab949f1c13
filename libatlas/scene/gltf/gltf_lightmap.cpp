#include "libatlas/scene/gltf/gltf_lightmap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libatlas/core/is_finite.h"
#include "libatlas/core/srgb.h"
#include "libatlas/image/image_io.h"
#include "libatlas/scene/files/decode_uri.h"
#include "libatlas/scene/gltf/gltf_pose.h"

namespace atlas {
namespace fs = std::filesystem;
namespace {

// Limit on the texels of all pages, which are floats in memory: six gigabytes. A small file can
// hold a large image, and name it as many pages.
constexpr std::size_t kMostTexels = std::size_t{1} << 29;

// Returns the file names of a list, or an empty one if the value is anything else.
std::vector<std::string> names(const tinygltf::Value& value) {
  std::vector<std::string> result;
  if (!value.IsArray()) return result;
  for (const tinygltf::Value& name : value.Get<tinygltf::Value::Array>())
    result.push_back(name.IsString() ? name.Get<std::string>() : std::string());
  return result;
}

bool is_light(const tinygltf::Value& value) {
  return value.IsNumber() && value.GetNumberAsDouble() > 0 &&
         value.GetNumberAsDouble() <= double(kMostLight);
}

// Returns how many values an accessor announces; 0 if there is none of that number.
std::size_t count_of(const tinygltf::Model& model, int accessor) {
  const bool exists = accessor >= 0 && std::size_t(accessor) < model.accessors.size();
  return exists ? model.accessors[std::size_t(accessor)].count : 0;
}

ImageF decoded(const Image8& image, float white) {
  ImageF rgb(image.width, image.height, 3);
  const std::size_t texels = rgb.texels.size() / 3, n = std::size_t(image.channels);
  for (std::size_t i = 0; i < texels; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rgb.texels[3 * i + c] = white * srgb_decode8(image.texels[n * i + (n < 3 ? 0 : c)]);
  return rgb;
}

// Returns the colours without alpha; grey becomes three equal channels.
ImageF three_channels(ImageF image) {
  if (image.channels == 3) return image;
  ImageF rgb(image.width, image.height, 3);
  const std::size_t texels = rgb.texels.size() / 3, n = std::size_t(image.channels);
  for (std::size_t i = 0; i < texels; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rgb.texels[3 * i + c] = image.texels[n * i + (n < 3 ? 0 : c)];
  return rgb;
}

}  // namespace

GltfLightmap::GltfLightmap(const tinygltf::Model& model, SceneBuilder& builder)
    : model_(model), builder_(builder) {
  const tinygltf::Value& extras = model.asset.extras;
  if (!builder.wants_lightmap || !extras.IsObject() || !extras.Has("lightmap")) return;
  const std::string wrong = name_from(extras.Get("lightmap"));
  if (wrong.empty()) return;
  named_.reset();
  builder_.defects.add(DefectKind::lightmap_unusable, [&] {
    return fmt::format("{}: asset.extras.lightmap {}", builder_.file, wrong);
  });
}

std::string GltfLightmap::name_from(const tinygltf::Value& map) {
  if (!map.IsObject()) return "is no object";
  named_.emplace();
  named_->images = names(map.Get("images"));
  named_->linear = names(map.Get("linear"));
  if (named_->images.empty() && named_->linear.empty()) return "names no images";
  const tinygltf::Value& set = map.Get("texCoord");
  if (!set.IsInt() || set.GetNumberAsInt() < 0)
    return "has a texCoord that is no whole number from 0 on";
  named_->set = set.GetNumberAsInt();
  if (map.Has("white")) {
    const tinygltf::Value& white = map.Get("white");
    if (!is_light(white))
      return fmt::format("has a white that is no number above 0 and up to {:g}", kMostLight);
    named_->white = float(white.GetNumberAsDouble());
  }
  used_.resize(std::max(named_->images.size(), named_->linear.size()));
  return {};
}

// Reads the texture coordinates. Returns what is wrong with them, or an empty string.
std::string GltfLightmap::coordinates_of(const tinygltf::Primitive& primitive,
                                         const std::string& name, Part& part) {
  const std::string attribute = fmt::format("TEXCOORD_{}", named_->set);
  const int accessor = gltf_attribute(primitive.attributes, attribute);
  if (accessor < 0) return "has no " + attribute;
  // This also keeps a small file from announcing more coordinates than it shows vertices.
  if (count_of(model_, accessor) !=
      count_of(model_, gltf_attribute(primitive.attributes, "POSITION")))
    return "has another number of " + attribute + " than of positions";
  const auto [at, is_new] = parts_.try_emplace(accessor);
  if (is_new) {
    const auto uvs = gltf_floats(model_, accessor, 2);
    if (!uvs.ok()) {
      parts_.erase(at);
      return fmt::format("{}: {}", attribute, uvs.status().message());
    }
    at->second = {texcoords_.size(), uvs->size() / 2, 0};
    for (std::size_t i = 0; i + 1 < uvs->size(); i += 2) {
      Vec2f uv{(*uvs)[i], 1 - (*uvs)[i + 1]};
      if (!is_finite(uv)) {
        uv = {};
        builder_.defects.add(DefectKind::texcoord_not_finite, [&] {
          return fmt::format("{}: {}: {} of vertex {}", builder_.file, name, attribute, i / 2);
        });
      }
      texcoords_.push_back(uv);
    }
  }
  part = at->second;
  return {};
}

GltfLightmap::Part GltfLightmap::part_of(const tinygltf::Primitive& primitive, bool unlit,
                                         const std::string& name) {
  Part part;
  if (!named_ || unlit) return part;
  std::int64_t page = 0;
  if (primitive.extras.IsObject() && primitive.extras.Has("lightmap")) {
    const tinygltf::Value& value = primitive.extras.Get("lightmap");
    page = value.IsInt() ? value.GetNumberAsInt() : -1;
  }
  std::string wrong;
  if (page < 0 || std::size_t(page) >= used_.size())
    wrong = fmt::format("its extras.lightmap is no page from 0 to {}", used_.size() - 1);
  else
    wrong = coordinates_of(primitive, name, part);
  if (!wrong.empty()) {
    absent_.push_back(fmt::format("{}: {}", name, wrong));
    return {};
  }
  part.page = std::int32_t(page);
  used_[std::size_t(page)] = true;
  return part;
}

// Returns the file. Names are encoded like other uris, or as the file system has them.
fs::path GltfLightmap::path_of(const std::string& uri) const {
  const fs::path folder = fs::path(builder_.file).parent_path();
  std::error_code error;  // a file that cannot be examined is not there
  const fs::path plain = folder / uri, path = folder / decode_uri(uri);
  return !fs::exists(path, error) && fs::exists(plain, error) ? plain : path;
}

// Checks first whether the file exists, because asking the decoder for it would load a large
// library.
Result<ImageF> GltfLightmap::read_page(const std::string& uri, bool linear) {
  const fs::path path = path_of(uri);
  std::error_code error;
  if (uri.empty() || !fs::is_regular_file(path, error))
    return Status(ErrorCode::not_found, path.string() + ": there is no such file");
  builder_.files.push_back(path);
  if (!linear) {
    const auto image = read_texture(path);
    if (!image.ok()) return image.status();
    return decoded(image->image, named_->white);
  }
  auto image = read_image_float(path);
  if (!image.ok()) return image.status();
  for (float& value : image->texels) {
    if (std::fabs(value) <= kMostLight) continue;
    value = 0;
    builder_.defects.add(DefectKind::illumination_not_finite, [&] { return path.string(); });
  }
  return three_channels(std::move(*image));
}

Status GltfLightmap::read_pages(bool linear, const std::vector<bool>& used,
                                const Context& context) {
  const std::vector<std::string>& uris = linear ? named_->linear : named_->images;
  map_ = std::make_shared<SceneLightmap>();
  map_->pages.resize(used.size());
  std::size_t texels = 0;
  for (std::size_t page = 0; page < used.size(); ++page) {
    if (!used[page]) continue;
    if (context.cancelled()) return Status::cancelled();
    if (page >= uris.size())
      return {ErrorCode::not_found, fmt::format("{}: asset.extras.lightmap names no image for "
                                                "page {}",
                                                builder_.file, page)};
    auto image = read_page(uris[page], linear);
    if (!image.ok()) return image.status();
    texels += image->texels.size() / 3;
    if (image->empty() || texels > kMostTexels)
      return {ErrorCode::unsupported,
              fmt::format("{}: its {} x {} texels and those of the pages before are more than {}",
                          path_of(uris[page]).string(), image->width, image->height, kMostTexels)};
    map_->pages[page] = std::move(*image);
  }
  return {};
}

// Notes all images. Those that are read, too, are listed as such only.
void GltfLightmap::note_files() {
  for (const auto* uris : {&named_->images, &named_->linear})
    for (const std::string& uri : *uris)
      if (!uri.empty()) builder_.other_files.push_back(path_of(uri));
}

void GltfLightmap::load(const Context& context) {
  if (!named_) return;
  note_files();
  Status read(ErrorCode::not_found, fmt::format("{}: no triangle has TEXCOORD_{} and a page",
                                                builder_.file, named_->set));
  if (std::find(used_.begin(), used_.end(), true) != used_.end()) {
    const bool linear = !named_->linear.empty();
    read = read_pages(linear, used_, context);
    if (!read.ok() && linear && !named_->images.empty()) {
      builder_.defects.add(DefectKind::lightmap_clipped, [&] { return read.message(); });
      read = read_pages(false, used_, context);
    }
  }
  if (!read.ok()) {
    map_.reset();
    builder_.defects.add(DefectKind::lightmap_unusable, [&] { return read.message(); });
    return;
  }
  for (const std::string& primitive : absent_)
    builder_.defects.add(DefectKind::lightmap_absent,
                         [&] { return fmt::format("{}: {}", builder_.file, primitive); });
  map_->texcoords = std::move(texcoords_);
}

void GltfLightmap::add_triangle(const Part& part, const std::array<std::uint32_t, 3>& corners) {
  if (!map_) return;
  const bool given = part.page >= 0 && std::all_of(corners.begin(), corners.end(),
                                                   [&](auto c) { return c < part.count; });
  for (const std::uint32_t corner : corners)
    map_->texcoord_indices.push_back(given ? std::uint32_t(part.first) + corner
                                           : Scene::kNoTexcoord);
  map_->triangle_page.push_back(given ? std::uint32_t(part.page) : 0);
}

void GltfLightmap::finish() {
  builder_.lightmap = std::move(map_);
}

}  // namespace atlas
