#include "libatlas/image/image_files.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <fstream>
#include <memory>
#include <new>
#include <string_view>
#include <type_traits>
#include <utility>

#include "libatlas/core/srgb.h"
#include "libatlas/files/write_error.h"
#include "libatlas/image/display_window.h"
#include "libatlas/image/file_kind.h"
#include "libatlas/image/image_claim.h"
#include "libatlas/image/webp_alpha.h"

namespace atlas {
namespace {

template <class T>
OIIO::TypeDesc type_of();
template <>
OIIO::TypeDesc type_of<std::uint8_t>() {
  return OIIO::TypeDesc::UINT8;
}
template <>
OIIO::TypeDesc type_of<float>() {
  return OIIO::TypeDesc::FLOAT;
}

// Returns the bytes per row. OpenImageIO advances by a stride from row to row, so that starting at
// the last row with a negative stride reverses the order of the rows.
template <class T>
OIIO::stride_t row_bytes(const Image<T>& image) {
  return OIIO::stride_t(sizeof(T)) * image.width * image.channels;
}

// Readers give several reasons, a line each, of which the first says what is wrong.
Status failure(const std::filesystem::path& path, const char* what, const std::string& why) {
  return {ErrorCode::io,
          fmt::format("{}: {}: {}", path.string(), what, why.substr(0, why.find('\n')))};
}

// An image that OpenImageIO reads, and its name for messages. `file` is null if OpenImageIO opens
// the file by itself.
struct Source {
  std::unique_ptr<OIIO::Filesystem::IOFile> file;
  std::unique_ptr<OIIO::ImageInput> input;  // reads `file`, so it is destroyed first
  std::uint64_t bytes = 0;                  // of the file
  std::string name;
};

ImageClaim spec_claim(const OIIO::ImageInput& input) {
  const OIIO::ImageSpec& spec = input.spec();
  const std::string_view format = input.format_name();
  const bool flat = format == "tiff" || format == "openexr" || format == "webp" ||
                    format == "heif" || format == "jpeg2000";
  return {spec.width, std::int64_t(spec.height) * spec.depth, spec.nchannels, 1,
          flat ? kFlatByte : kPackedByte};
}

// Refuses rows so long that OpenImageIO would take gigabytes: it takes memory for 256 rows at once,
// or for a strip of a TIFF, also where an image has two rows.
Status check_rows(const Source& source) {
  constexpr std::uint64_t kLongestRow = 4 << 20, kLargestStrip = 1 << 30;  // bytes
  const OIIO::ImageSpec& spec = source.input->spec();
  const std::uint64_t row = spec.scanline_bytes(true);
  const int strip = std::max(spec.get_int_attribute("tiff:RowsPerStrip", 1), 1);
  const bool small = strip <= spec.height || row <= kLargestStrip / std::uint64_t(strip);
  if (row <= kLongestRow && small) return {};
  return {
      ErrorCode::unsupported,
      fmt::format("{}: its rows are {} texels long, in strips of {}, which is too much to read: "
                  "make the image smaller, or its strips",
                  source.name, spec.width, strip)};
}

template <class T>
Result<Image<T>> read_pixels(const Source& source) {
  OIIO::ImageInput& input = *source.input;
  const OIIO::ImageSpec& spec = input.spec();
  ImageClaim claim = spec_claim(input);
  claim.channel_bytes = sizeof(T);
  if (Status s = check_claim(claim, source.bytes, source.name); !s.ok()) return s;
  if (Status s = check_rows(source); !s.ok()) return s;
  const bool other_part = stores_another_part(input);
  if (other_part) {
    claim.width = spec.full_width;
    claim.height = spec.full_height;
    if (Status s = check_claim(claim, source.bytes, source.name); !s.ok()) return s;
  }
  if (spec.depth > 1) {
    return Status(ErrorCode::unsupported,
                  source.name + ": is a volume of several slices: save one of them as an image");
  }
  Image<T> image(spec.width, spec.height, spec.nchannels);
  const OIIO::stride_t stride = row_bytes(image);
  T* top_row = image.texels.data() + std::size_t(spec.height - 1) * spec.width * spec.nchannels;
  const bool read =
      input.read_image(0, 0, 0, spec.nchannels, type_of<T>(), top_row, OIIO::AutoStride, -stride);
  // Some readers report success, and that something was missing.
  const std::string complaint = input.geterror();
  if (!read || !complaint.empty()) return failure(source.name, "image is damaged", complaint);
  if (other_part) return shown_part(image, spec);
  return image;
}

OIIO::ImageSpec input_settings() {
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;  // colours as stored, not multiplied by alpha
  return config;
}

// Calls `reader`, and returns an error if it throws. Some readers allocate memory before they can
// be asked how much, more than there is or even than a vector can have.
template <class Function>
auto within_memory(const std::string& name, const Function& reader) -> decltype(reader()) {
  try {
    return reader();
  } catch (const std::bad_alloc&) {
    return Status(ErrorCode::io, name + ": not enough memory to read it: make the image smaller");
  } catch (const std::exception& thrown) {
    return failure(name, "image is damaged", thrown.what());
  }
}

// Reads as much of a file as contains its size, whatever comments precede that: up to 16 MiB. For
// formats that take no memory to open, only the first 64 bytes are read.
std::vector<std::uint8_t> head_of(const std::filesystem::path& path, std::uint64_t bytes) {
  constexpr std::uint64_t kEnough = 1 << 24;
  std::vector<std::uint8_t> head(64);
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
  head.resize(std::size_t(file.gcount()));
  if (!takes_memory_to_open(head)) return head;
  head.resize(std::size_t(std::min(bytes, kEnough)));
  file.clear();  // of a file shorter than that
  file.seekg(0);
  file.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
  head.resize(std::size_t(file.gcount()));
  return head;
}

// Opens a WebP file in memory. `memory` must outlive the result.
std::unique_ptr<OIIO::ImageInput> open_webp(OIIO::Filesystem::IOMemReader& memory) {
  OIIO::Filesystem::IOProxy* proxy = &memory;
  OIIO::ImageSpec config = input_settings();
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  return OIIO::ImageInput::open("embedded.webp", &config, proxy);
}

// Returns whether a reader may have multiplied the colours by alpha though it was asked not to. Of
// the formats whose colours do not depend on alpha, this concerns WebP: its reader ignores the
// request in older releases of OpenImageIO, and obeys it without saying so in some newer ones.
bool may_be_multiplied(const OIIO::ImageInput& input) {
  return std::string_view(input.format_name()) == "webp" && input.spec().nchannels == 4 &&
         input.spec().get_int_attribute("oiio:UnassociatedAlpha") == 0;
}

// Returns whether the image's colours are multiplied by its last channel, alpha. TIFF files say it,
// and those of OpenEXR are so by definition. The readers of other formats do not all say it, or
// not truly (may_be_multiplied).
bool is_multiplied(const OIIO::ImageInput& input) {
  const OIIO::ImageSpec& spec = input.spec();
  const std::string_view format = input.format_name();
  return (format == "tiff" || format == "openexr") && spec.alpha_channel > 0 &&
         spec.alpha_channel == spec.nchannels - 1 &&
         spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
}

// Divides colours by alpha. Where alpha is 0, colours stay as they are: those of OpenEXR are light
// that a clear pixel adds, such as a glow.
template <class T>
void divide_by_alpha(Image<T>& image) {
  const auto alpha = std::size_t(image.channels - 1);
  constexpr float kOne = std::is_same_v<T, std::uint8_t> ? 255 : 1;
  for (std::size_t i = 0; i < image.texels.size(); i += alpha + 1) {
    const float share = float(image.texels[i + alpha]) / kOne;
    if (!(share > 0) || share >= 1) continue;
    for (std::size_t c = 0; c < alpha; ++c) {
      const float colour = float(image.texels[i + c]) / share;
      if constexpr (std::is_same_v<T, std::uint8_t>)
        image.texels[i + c] = T(std::min(kOne, std::round(colour)));
      else
        image.texels[i + c] = colour;
    }
  }
}

Image8 quantized(const ImageF& image) {
  Image8 bytes(image.width, image.height, image.channels);
  std::transform(image.texels.begin(), image.texels.end(), bytes.texels.begin(), quantize8);
  return bytes;
}

// Reads pixels with colours that are not multiplied by alpha. Floats are divided before they are
// rounded to 8 bits.
template <class T>
Result<Image<T>> read_colours(const Source& source) {
  const bool multiplied = is_multiplied(*source.input);
  if constexpr (std::is_same_v<T, std::uint8_t>) {
    if (multiplied && source.input->spec().format.is_floating_point()) {
      Result<ImageF> image = read_pixels<float>(source);
      if (!image.ok()) return image.status();
      divide_by_alpha(*image);
      return quantized(*image);
    }
  }
  Result<Image<T>> image = read_pixels<T>(source);
  if (image.ok() && multiplied) divide_by_alpha(*image);
  return image;
}

// Reads the colours of a WebP file again, from a copy without alpha. Dividing the multiplied ones
// by alpha would not do: they have been rounded, and nothing is left of them where alpha is 0.
template <class T>
Status restore_colors(std::span<const std::uint8_t> file, const Source& source, Image<T>& image) {
  const std::vector<std::uint8_t> opaque = without_webp_alpha(file);
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(opaque.data()), opaque.size());
  Source copy{nullptr, open_webp(memory), source.bytes, source.name};
  if (!copy.input) return failure(source.name, "cannot be read as an image", OIIO::geterror());
  Result<Image<T>> colors = read_pixels<T>(copy);
  if (!colors.ok()) return colors.status();
  if (colors->width != image.width || colors->height != image.height || colors->channels < 3)
    return failure(source.name, "image is damaged", "alpha and colours differ in size");
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) std::copy_n(colors->at(x, y), 3, image.at(x, y));
  return {};
}

Result<std::vector<std::uint8_t>> whole_file(const Source& source) {
  std::vector<std::uint8_t> bytes(source.bytes);
  std::ifstream file(source.name, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size())))
    return failure(source.name, "cannot be read as an image", "it has changed while it was read");
  return bytes;
}

// Opens a file, unless it claims to be larger than it can be: OpenImageIO may run out of memory.
// OpenImageIO takes what follows a '?' in a name for options of its own. It then gets the open
// file, beside a name without '?', by which it picks a reader.
Result<Source> open_file(const std::filesystem::path& path) {
  std::error_code error;
  Source source{nullptr, nullptr, std::filesystem::file_size(path, error), path.string()};
  if (error) return failure(path, "cannot be read as an image", error.message());
  const std::vector<std::uint8_t> head = head_of(path, source.bytes);
  if (bmp_lacks_palette(head))
    return failure(path, "image is damaged", "it is compressed, but has no palette (save it anew)");
  if (exr_overclaims(head, source.bytes))
    return failure(path, "image is damaged", "its header claims more than it holds (save it anew)");
  if (const auto claim = claim_of(head)) {
    if (Status s = check_claim(*claim, source.bytes, source.name); !s.ok()) return s;
  }
  OIIO::ImageSpec config = input_settings();
  std::string name = source.name;
  OIIO::Filesystem::IOProxy* proxy = nullptr;
  if (name.find('?') != std::string::npos) {
    source.file = std::make_unique<OIIO::Filesystem::IOFile>(name, OIIO::Filesystem::IOProxy::Read);
    proxy = source.file.get();
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    std::replace(name.begin(), name.end(), '?', '_');
  }
  source.input = OIIO::ImageInput::open(name, &config, proxy);
  if (!source.input) return failure(path, "cannot be read as an image", OIIO::geterror());
  return source;
}

template <class T>
Result<Image<T>> read(const std::filesystem::path& path) {
  return within_memory(path.string(), [&]() -> Result<Image<T>> {
    const Result<Source> source = open_file(path);
    if (!source.ok()) return source.status();
    Result<Image<T>> image = read_colours<T>(*source);
    if (!image.ok() || !may_be_multiplied(*source->input)) return image;
    const Result<std::vector<std::uint8_t>> file = whole_file(*source);
    if (!file.ok()) return file.status();
    if (Status s = restore_colors<T>(*file, *source, *image); !s.ok()) return s;
    return image;
  });
}

// A file that remembers the reason of its first failure. OpenImageIO reports neither that a disk is
// full nor why a write failed, and later calls overwrite errno.
class RememberingFile : public OIIO::Filesystem::IOFile {
 public:
  using IOFile::IOFile;

  size_t write(const void* bytes, size_t size) override {
    errno = 0;
    const size_t written = IOFile::write(bytes, size);
    if (written != size) remember();
    return written;
  }
  bool seek(int64_t offset) override {  // flushes the buffer
    errno = 0;
    const bool done = IOFile::seek(offset);
    if (!done) remember();
    return done;
  }

  int reason() const { return reason_; }  // an errno, or 0

 private:
  void remember() {
    if (reason_ == 0) reason_ = errno;
  }
  int reason_ = 0;
};

struct Target {
  std::filesystem::path path;
  RememberingFile file;
  // The writer may still write when it is destroyed, so it is declared last and destroyed before
  // the file.
  std::unique_ptr<OIIO::ImageOutput> writer;
};

Status encode(Target& to, const ImageF& image, const OIIO::ImageSpec& spec) {
  const float* top_row =
      image.texels.data() + std::size_t(image.height - 1) * image.width * image.channels;
  if (!to.writer->set_ioproxy(&to.file) || !to.writer->open(to.path.string(), spec) ||
      !to.writer->write_image(type_of<float>(), top_row, OIIO::AutoStride, -row_bytes(image)) ||
      !to.writer->close()) {
    return failure(to.path, "writing failed", to.writer->geterror());
  }
  return {};
}

// Writes an OpenEXR file, whatever the extension of its name is.
Status write(const std::filesystem::path& path, const ImageF& image, const OIIO::ImageSpec& spec) {
  auto writer = OIIO::ImageOutput::create("openexr");
  if (!writer) return failure(path, "no writer for this kind of image", OIIO::geterror());
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return failure(path, "cannot be written", std::strerror(errno));
  Status status;
  int reason = 0;
  {
    Target to{path, {file, OIIO::Filesystem::IOProxy::Write}, std::move(writer)};
    status = encode(to, image, spec);
    to.writer.reset();
    reason = to.file.reason();
  }
  errno = 0;
  const bool stored = std::fflush(file) == 0 && !std::ferror(file);
  if (reason == 0) reason = errno ? errno : EIO;
  if (std::fclose(file) != 0 || !stored)
    return failure(path, "writing failed", write_error(reason));
  return status;
}

Result<Image8> read_8_bits(const std::filesystem::path& path) {
  return read<std::uint8_t>(path);
}

Result<Image8> decode_webp(std::span<const std::uint8_t> bytes, const std::string& name) {
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(bytes.data()), bytes.size());
  return within_memory(name, [&]() -> Result<Image8> {
    Source source{nullptr, open_webp(memory), bytes.size(), name};
    if (!source.input) return failure(name, "cannot be read as an image", OIIO::geterror());
    Result<Image8> image = read_pixels<std::uint8_t>(source);
    if (!image.ok() || !may_be_multiplied(*source.input)) return image;
    if (Status s = restore_colors<std::uint8_t>(bytes, source, *image); !s.ok()) return s;
    return image;
  });
}

Result<ImageF> read_floats(const std::filesystem::path& path) {
  return read<float>(path);
}

bool has_floats(const std::filesystem::path& path) {
  const Result<bool> floats = within_memory(path.string(), [&]() -> Result<bool> {
    const Result<Source> source = open_file(path);
    if (!source.ok()) return source.status();
    return source->input->spec().format.is_floating_point();
  });
  return floats.ok() && *floats;
}

// Returns whether half floats represent an image with at least ten bits for all values down to a
// hundredth of its brightest one. Sunlight does not fit: 100 000 lux would become infinite.
bool fits_halves(const ImageF& image) {
  constexpr float kLargest = 65504, kSmallestNormal = 0x1p-14f;
  float largest = 0;
  for (const float v : image.texels) largest = std::max(largest, std::fabs(v));
  return largest <= kLargest && (largest == 0 || largest >= 100 * kSmallestNormal);
}

Status write_floats(const std::filesystem::path& path, const ImageF& image) {
  const OIIO::TypeDesc type = fits_halves(image) ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT;
  OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
  spec["compression"] = "zip";
  // Without this, it would be the time of writing; the same input must give the same bytes.
  spec["DateTime"] = "1970:01:01 00:00:00";
  return write(path, image, spec);
}

constexpr ImageFiles functions = {image_files_mark(), read_8_bits, decode_webp,
                                  read_floats,        has_floats,  write_floats};

}  // namespace
}  // namespace atlas

extern "C" const atlas::ImageFiles* libatlas_image_files() {
  return &atlas::functions;
}
