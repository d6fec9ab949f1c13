#include "libatlas/image/png_file.h"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libatlas/files/write_error.h"
#include "libatlas/image/image_claim.h"

namespace atlas {
namespace {

// What libpng's functions get of a reader or writer. libpng leaves by longjmp, so the functions
// that it jumps to have no objects of their own.
struct Png {
  std::FILE* file;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string complaint = {};  // the first
};

void fail(png_structp png, png_const_charp complaint) {
  auto* const to = static_cast<Png*>(png_get_error_ptr(png));
  if (to->complaint.empty()) to->complaint = complaint;
  png_longjmp(png, 1);
}

void ignore(png_structp, png_const_charp) {}

struct PngReader : Png {
  explicit PngReader(std::FILE* from) : Png{from} {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, static_cast<Png*>(this), fail, ignore);
    info = png ? png_create_info_struct(png) : nullptr;
    if (!info) complaint = "not enough memory";
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
};

struct PngWriter : Png {
  explicit PngWriter(std::FILE* to) : Png{to} {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, static_cast<Png*>(this), fail, ignore);
    info = png ? png_create_info_struct(png) : nullptr;
    if (!info) complaint = "not enough memory";
  }
  ~PngWriter() { png_destroy_write_struct(&png, &info); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
};

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto* const from = static_cast<Png*>(png_get_io_ptr(png));
  if (std::fread(to, 1, count, from->file) != count) png_error(png, "it ends too early");
}

void write_bytes(png_structp png, png_bytep bytes, std::size_t count) {
  auto* const to = static_cast<Png*>(png_get_io_ptr(png));
  if (std::fwrite(bytes, 1, count, to->file) == count) return;
  to->complaint = write_error(errno);
  png_error(png, "");
}

void flush_nothing(png_structp) {}

// Reads up to the texels, and asks for at least 8 bits, at most `bits`, and alpha as a channel.
// Chunks that do not change texels are skipped: unpacked texts and profiles could fill the memory.
bool read_header(PngReader& reader, int bits) {
  if (!reader.info || setjmp(png_jmpbuf(reader.png))) return false;
  png_set_read_fn(reader.png, static_cast<Png*>(&reader), read_bytes);
  png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);
  if (bits == 8) png_set_scale_16(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(PngReader& reader, std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_image(reader.png, rows.data());
  return true;
}

// Returns the rows from the last one in memory on, which is the top row.
std::vector<png_bytep> top_down(std::uint8_t* texels, int height, std::size_t row_bytes) {
  std::vector<png_bytep> rows(std::size_t(height), nullptr);
  for (std::size_t y = 0; y < rows.size(); ++y)
    rows[y] = texels + (rows.size() - 1 - y) * row_bytes;
  return rows;
}

Status failure(const std::string& name, const char* what, const std::string& why) {
  return {ErrorCode::io, fmt::format("{}: {}: {}", name, what, why)};
}

// Values of one or two bytes, the higher one first.
struct PngValues {
  Image8 image = {};  // of as many channels as bytes a texel
  int value_bytes = 1;
};

// Reads values of at most `bits` bits, 8 or 16, which will take `value_bytes` each in memory.
Result<PngValues> read_values(const EncodedImage& source, int bits, std::size_t value_bytes) {
  PngReader reader(source.file);
  if (!read_header(reader, bits)) return failure(source.name, "image is damaged", reader.complaint);
  const ImageClaim claim{
      png_get_image_width(reader.png, reader.info), png_get_image_height(reader.png, reader.info),
      png_get_channels(reader.png, reader.info), double(value_bytes), kPackedByte};
  if (Status s = check_claim(claim, source.bytes, source.name); !s.ok()) return s;
  PngValues values{{}, png_get_bit_depth(reader.png, reader.info) / 8};
  values.image =
      Image8(int(claim.width), int(claim.height), int(claim.channels) * values.value_bytes);
  std::vector<png_bytep> rows = top_down(values.image.texels.data(), values.image.height,
                                         png_get_rowbytes(reader.png, reader.info));
  if (!read_rows(reader, rows)) return failure(source.name, "image is damaged", reader.complaint);
  return values;
}

int colour_type(int channels) {
  constexpr int kTypes[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                            PNG_COLOR_TYPE_RGB_ALPHA};
  return kTypes[channels - 1];
}

bool write_image(PngWriter& writer, const Image8& image, const PngOptions& options,
                 std::vector<png_bytep>& rows) {
  if (!writer.info || setjmp(png_jmpbuf(writer.png))) return false;
  png_set_write_fn(writer.png, static_cast<Png*>(&writer), write_bytes, flush_nothing);
  png_set_IHDR(writer.png, writer.info, png_uint_32(image.width), png_uint_32(image.height), 8,
               colour_type(image.channels), PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const bool runs = options.smooth && options.compression >= 1 && options.compression <= 5;
  png_set_compression_level(writer.png, options.compression);
  png_set_compression_strategy(writer.png, runs ? Z_RLE : Z_DEFAULT_STRATEGY);
  png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, runs ? PNG_FILTER_PAETH : PNG_NO_FILTERS);
  png_write_info(writer.png, writer.info);
  png_write_image(writer.png, rows.data());
  png_write_end(writer.png, writer.info);
  return true;
}

}  // namespace

Result<Image8> read_png8(const EncodedImage& source) {
  Result<PngValues> values = read_values(source, 8, sizeof(std::uint8_t));
  if (!values.ok()) return values.status();
  return std::move(values->image);
}

Result<ImageF> read_png_float(const EncodedImage& source) {
  const Result<PngValues> values = read_values(source, 16, sizeof(float));
  if (!values.ok()) return values.status();
  const Image8& bytes = values->image;
  const int wide = values->value_bytes;
  ImageF image(bytes.width, bytes.height, bytes.channels / wide);
  for (std::size_t i = 0; i < image.texels.size(); ++i) {
    const std::uint8_t* value = bytes.texels.data() + i * std::size_t(wide);
    image.texels[i] =
        wide == 1 ? float(*value) * (1.0f / 255) : float(value[0] << 8 | value[1]) * (1.0f / 65535);
  }
  return image;
}

Status encode_png(std::FILE* file, const std::string& name, const Image8& image,
                  const PngOptions& options) {
  PngWriter writer(file);
  auto* const texels = const_cast<std::uint8_t*>(image.texels.data());  // which libpng only reads
  std::vector<png_bytep> rows =
      top_down(texels, image.height, std::size_t(image.width) * std::size_t(image.channels));
  if (write_image(writer, image, options, rows)) return {};
  return failure(name, "writing failed", writer.complaint);
}

}  // namespace atlas
