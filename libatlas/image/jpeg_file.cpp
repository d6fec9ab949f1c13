#include "libatlas/image/jpeg_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <cstdio>  // which jpeglib.h needs
#include <vector>

#include <jpeglib.h>

#include <jerror.h>

#include "libatlas/core/srgb.h"
#include "libatlas/image/image_claim.h"

namespace atlas {
namespace {

// A scan takes ten bytes of a file, and time as for the whole image. No encoder writes so many.
constexpr int kMostScans = 500;

// libjpeg leaves by longjmp, so the functions that it jumps to have no objects of their own.
struct JpegReader {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  std::jmp_buf out;
  char complaint[JMSG_LENGTH_MAX] = "";
  bool cut_short = false;

  JpegReader() = default;
  ~JpegReader() { jpeg_destroy_decompress(&info); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
};

JpegReader& reader_of(j_common_ptr info) {
  return *static_cast<JpegReader*>(info->client_data);
}

[[noreturn]] void fail(j_common_ptr info) {
  JpegReader& reader = reader_of(info);
  if (!*reader.complaint) info->err->format_message(info, reader.complaint);
  std::longjmp(reader.out, 1);
}

// Of the warnings all but one are harmless: libjpeg invents texels where data are missing.
void hear(j_common_ptr info, int) {
  if (info->err->msg_code == JWRN_HIT_MARKER) reader_of(info).cut_short = true;
}

void count_scans(j_common_ptr info) {
  if (reinterpret_cast<j_decompress_ptr>(info)->input_scan_number <= kMostScans) return;
  std::snprintf(reader_of(info).complaint, JMSG_LENGTH_MAX, "it has more than %d scans",
                kMostScans);
  fail(info);
}

bool read_header(JpegReader& reader, std::FILE* file) {
  reader.info.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = fail;
  reader.errors.emit_message = hear;
  reader.info.client_data = &reader;
  if (setjmp(reader.out)) return false;
  jpeg_create_decompress(&reader.info);
  reader.progress.progress_monitor = count_scans;
  reader.info.progress = &reader.progress;
  jpeg_stdio_src(&reader.info, file);
  jpeg_read_header(&reader.info, TRUE);
  return true;
}

// Reads texels of `image`, from its top row on, which is the last one in memory. `inks` holds a row
// of CMYK texels, or is empty.
bool read_rows(JpegReader& reader, Image8& image, std::vector<std::uint8_t>& inks) {
  if (setjmp(reader.out)) return false;
  jpeg_start_decompress(&reader.info);
  for (int y = image.height - 1; y >= 0; --y) {
    JSAMPROW row = inks.empty() ? image.at(0, y) : inks.data();
    jpeg_read_scanlines(&reader.info, &row, 1);
    // Files hold what remains of the light, not the amount of ink.
    for (std::size_t x = 0; 4 * x < inks.size(); ++x)
      for (std::size_t c = 0; c < 3; ++c)
        image.at(int(x), y)[c] = quantize8(float(inks[4 * x + c]) * (1.0f / 255) *
                                           (float(inks[4 * x + 3]) * (1.0f / 255)));
  }
  return true;
}

Status failure(const JpegReader& reader, const std::string& name) {
  if (reader.errors.msg_code == JERR_OUT_OF_MEMORY)
    return {ErrorCode::io, name + ": not enough memory to read it: make the image smaller"};
  return {ErrorCode::io, fmt::format("{}: image is damaged: {}", name, reader.complaint)};
}

Result<Image8> read(const EncodedImage& source, std::size_t value_bytes) {
  JpegReader reader;
  if (!read_header(reader, source.file)) return failure(reader, source.name);
  const bool cmyk = reader.info.out_color_space == JCS_CMYK;
  const ImageClaim claim{reader.info.image_width, reader.info.image_height,
                         cmyk ? 3 : reader.info.num_components, double(value_bytes), kPackedByte};
  if (Status s = check_claim(claim, source.bytes, source.name); !s.ok()) return s;
  Image8 image(int(claim.width), int(claim.height), int(claim.channels));
  std::vector<std::uint8_t> inks(cmyk ? 4 * std::size_t(claim.width) : 0);
  if (!read_rows(reader, image, inks)) return failure(reader, source.name);
  if (reader.cut_short)
    return Status(ErrorCode::io, source.name + ": image is damaged: it is cut short");
  return image;
}

}  // namespace

Result<Image8> read_jpeg8(const EncodedImage& source) {
  return read(source, sizeof(std::uint8_t));
}

Result<ImageF> read_jpeg_float(const EncodedImage& source) {
  const Result<Image8> bytes = read(source, sizeof(float));
  if (!bytes.ok()) return bytes.status();
  ImageF image(bytes->width, bytes->height, bytes->channels);
  std::transform(bytes->texels.begin(), bytes->texels.end(), image.texels.begin(),
                 [](std::uint8_t value) { return float(value) * (1.0f / 255); });
  return image;
}

}  // namespace atlas
