#include "libatlas/image/image_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "libatlas/core/srgb.h"
#include "libatlas/files/write_error.h"
#include "libatlas/image/encoded_image.h"
#include "libatlas/image/file_kind.h"
#include "libatlas/image/image_module.h"
#include "libatlas/image/jpeg_file.h"
#include "libatlas/image/png_file.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;

// The formats that are read here, by the first bytes of their files. The module reads all others.
struct Reader {
  std::string_view signature;
  Result<Image8> (*read8)(const EncodedImage&);
  Result<ImageF> (*read_float)(const EncodedImage&);
};
constexpr Reader kReaders[] = {{"\x89PNG", read_png8, read_png_float},
                               {"\xff\xd8", read_jpeg8, read_jpeg_float}};

const Reader* reader_of(std::span<const std::uint8_t> head) {
  for (const Reader& reader : kReaders)
    if (begins_with(head, reader.signature)) return &reader;
  return nullptr;
}

struct Closer {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Closer>;

// A file to read, and what reads it: null if that is the module.
struct Source {
  File file = {};
  const Reader* reader = nullptr;
  std::uint64_t bytes = 0;
};

Result<Source> open_image(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return error ? Status(ErrorCode::io, fmt::format("{}: {}", path.string(), error.message()))
                 : Status(ErrorCode::not_found, fmt::format("{}: no such image", path.string()));
  }
  const auto failure = [&](const std::string& why) {
    return Status(ErrorCode::io,
                  fmt::format("{}: cannot be read as an image: {}", path.string(), why));
  };
  Source source;
  source.bytes = fs::file_size(path, error);  // of regular files only: others could keep us waiting
  if (error) return failure(error.message());
  source.file.reset(std::fopen(path.c_str(), "rb"));
  if (!source.file) return failure(std::strerror(errno));
  std::uint8_t head[8];
  const std::size_t read = std::fread(head, 1, sizeof head, source.file.get());
  source.reader = reader_of({head, read});
  std::rewind(source.file.get());
  return source;
}

template <class T>
Result<Image<T>> read_with(const Reader& reader, const EncodedImage& source) {
  try {
    if constexpr (std::is_same_v<T, float>)
      return reader.read_float(source);
    else
      return reader.read8(source);
  } catch (const std::bad_alloc&) {
    return Status(ErrorCode::io,
                  source.name + ": not enough memory to read it: make the image smaller");
  }
}

// Calls the module's function, or returns the reason why there is no module.
template <class Function, class... Arguments>
auto call(Function ImageFiles::*function, const std::string& name, Arguments&&... arguments)
    -> decltype((std::declval<ImageFiles>().*function)(arguments...)) {
  const ImageModule& files = image_module();
  if (!files.functions) {
    return Status(ErrorCode::unsupported, fmt::format("{}: {}", name, files.why_not));
  }
  return (files.functions->*function)(std::forward<Arguments>(arguments)...);
}

template <class T>
Result<Image<T>> read(const fs::path& path,
                      Result<Image<T>> (*ImageFiles::*by_module)(const fs::path&)) {
  const Result<Source> source = open_image(path);
  if (!source.ok()) return source.status();
  if (!source->reader) return call(by_module, path.string(), path);
  return read_with<T>(*source->reader, {source->file.get(), source->bytes, path.string()});
}

// Refuses an image whose sides or channels are out of range, or whose texels are not as many as
// these say: a writer would read past the end of a shorter one.
template <class T>
Status check_image(const fs::path& path, const Image<T>& image, int most_channels) {
  const std::string sizes = fmt::format("{}: the image is {} x {} with {} channels", path.string(),
                                        image.width, image.height, image.channels);
  if (image.width < 1 || image.height < 1 || image.channels < 1 || image.channels > most_channels)
    return {ErrorCode::bad_input,
            fmt::format("{} (sides of at least 1, 1 to {} channels)", sizes, most_channels)};
  if (!image.whole())
    return {ErrorCode::bad_input,
            fmt::format("{}, but holds {} values", sizes, image.texels.size())};
  return {};
}

// Returns whether clipping changes a linear value by more than a step of eight bits.
bool clips(float linear) {
  constexpr float kStep = 1 / 255.0f;
  return !(linear >= -kStep / 12.92f && linear <= 1 + kStep);
}

TextureImage encoded(const ImageF& linear) {
  TextureImage texture{Image8(linear.width, linear.height, linear.channels)};
  const int n = linear.channels, colours = n == 2 || n == 4 ? n - 1 : n;
  for (std::size_t i = 0; i < linear.texels.size(); ++i) {
    const float value = linear.texels[i];
    const bool alpha = int(i % std::size_t(n)) >= colours;
    texture.image.texels[i] = alpha ? quantize8(value) : srgb_encode8(value);
    texture.clipped |= !alpha && clips(value);
  }
  return texture;
}

bool holds_floats(const fs::path& path) {
  const Result<Source> source = open_image(path);
  if (!source.ok() || source->reader) return false;
  const ImageModule& files = image_module();
  return files.functions && files.functions->holds_floats(path);
}

}  // namespace

Status check_image_module(const std::string& name) {
  const ImageModule& files = image_module();
  if (files.functions) return {};
  return {ErrorCode::unsupported, fmt::format("{}: {}", name, files.why_not)};
}

Result<Image8> read_image8(const fs::path& path) {
  return read(path, &ImageFiles::read_image8);
}

Result<Image8> decode_image8(std::span<const std::uint8_t> bytes, const std::string& name) {
  const auto failure = [&](const char* why) {
    return Status(ErrorCode::io, fmt::format("{}: cannot be read as an image: {}", name, why));
  };
  if (begins_with(bytes, "RIFF")) return call(&ImageFiles::decode_webp8, name, bytes, name);
  const Reader* const reader = reader_of(bytes);
  if (!reader) return failure("not PNG, JPEG or WebP");
  auto* const memory = const_cast<std::uint8_t*>(bytes.data());  // which is only read
  const File file(::fmemopen(memory, bytes.size(), "rb"));
  if (!file) return failure(std::strerror(errno));
  return read_with<std::uint8_t>(*reader, {file.get(), bytes.size(), name});
}

Result<ImageF> read_image_float(const fs::path& path) {
  return read(path, &ImageFiles::read_image_float);
}

Result<TextureImage> read_texture(const fs::path& path) {
  if (holds_floats(path)) {
    const Result<ImageF> linear = read_image_float(path);
    if (!linear.ok()) return linear.status();
    return encoded(*linear);
  }
  Result<Image8> image = read_image8(path);
  if (!image.ok()) return image.status();
  return TextureImage{std::move(*image)};
}

Status write_png(const fs::path& path, const Image8& image, const PngOptions& options) {
  if (options.compression < 0 || options.compression > 9)
    return {ErrorCode::bad_option, fmt::format("{}: compression {} is not a zlib level, 0 to 9",
                                               path.string(), options.compression)};
  if (Status s = check_image(path, image, 4); !s.ok()) return s;
  File file(std::fopen(path.c_str(), "wb"));
  if (!file)
    return {ErrorCode::io,
            fmt::format("{}: cannot be written: {}", path.string(), std::strerror(errno))};
  if (Status s = encode_png(file.get(), path.string(), image, options); !s.ok()) return s;
  if (std::fclose(file.release()) != 0)
    return {ErrorCode::io,
            fmt::format("{}: writing failed: {}", path.string(), write_error(errno))};
  return {};
}

Status write_exr(const fs::path& path, const ImageF& image) {
  if (Status s = check_image(path, image, 1024); !s.ok()) return s;
  return call(&ImageFiles::write_exr, path.string(), path, image);
}

}  // namespace atlas
