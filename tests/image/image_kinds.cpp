#include "tests/image/image_kinds.h"

#include <fmt/format.h>
#include <png.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>

#include <jpeglib.h>

namespace atlas::test {
namespace {

struct PngKind {
  int width, height, type, bits;
  bool interlaced = false, transparent = false;
  std::function<void(png_structp, png_infop)> more = nullptr;  // chunks
};

int channels_of(int type) {
  if (type == PNG_COLOR_TYPE_RGB) return 3;
  if (type == PNG_COLOR_TYPE_RGB_ALPHA) return 4;
  return type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2 : 1;
}

void append(png_structp png, png_bytep bytes, std::size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))
      ->append(reinterpret_cast<const char*>(bytes), count);
}

// Names the first texel's colour as transparent, or gives every second palette entry an alpha.
void set_transparent(png_structp png, png_infop info, const PngKind& kind,
                     const std::vector<std::uint8_t>& texels) {
  std::vector<std::uint8_t> alphas(std::size_t{1} << std::min(kind.bits, 8), 255);
  for (std::size_t i = 0; i < alphas.size(); i += 2) alphas[i] = std::uint8_t(7 * i);
  if (kind.type == PNG_COLOR_TYPE_PALETTE)
    return png_set_tRNS(png, info, alphas.data(), int(alphas.size()), nullptr);
  const std::size_t wide = kind.bits == 16 ? 2 : 1;
  const auto value = [&](std::size_t c) {
    const std::uint8_t* at = texels.data() + c * wide;
    if (wide == 2) return png_uint_16(at[0] << 8 | at[1]);
    return png_uint_16(kind.bits < 8 ? at[0] >> (8 - kind.bits) : at[0]);
  };
  png_color_16 colour{};
  colour.gray = colour.red = value(0);
  if (kind.type == PNG_COLOR_TYPE_RGB) {
    colour.green = value(1);
    colour.blue = value(2);
  }
  png_set_tRNS(png, info, nullptr, 0, &colour);
}

// Writes these rows, whose bytes are `texels`.
std::string png_of(const PngKind& kind, std::vector<std::uint8_t> texels) {
  std::string file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &file, append, nullptr);
  png_set_IHDR(png, info, png_uint_32(kind.width), png_uint_32(kind.height), kind.bits, kind.type,
               kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
  std::vector<png_color> palette(std::size_t{1} << std::min(kind.bits, 8));
  for (std::size_t i = 0; i < palette.size(); ++i)
    palette[i] = {png_byte(3 * i), png_byte(200 - i), png_byte(5 * i + 9)};
  if (kind.type == PNG_COLOR_TYPE_PALETTE)
    png_set_PLTE(png, info, palette.data(), int(palette.size()));
  if (kind.transparent) set_transparent(png, info, kind, texels);
  if (kind.more) kind.more(png, info);
  png_write_info(png, info);
  std::vector<png_bytep> rows;
  for (int y = 0; y < kind.height; ++y)
    rows.push_back(texels.data() + std::size_t(y) * png_get_rowbytes(png, info));
  png_write_image(png, rows.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return file;
}

std::string png_of(const PngKind& kind) {
  std::mt19937 random(std::uint32_t(kind.type * 100 + kind.bits));
  const int row_bits = kind.width * channels_of(kind.type) * kind.bits;
  std::vector<std::uint8_t> texels(std::size_t(row_bits + 7) / 8 * std::size_t(kind.height));
  for (std::uint8_t& byte : texels) byte = std::uint8_t(random());
  return png_of(kind, texels);
}

std::string every_16_bit_value() {
  std::vector<std::uint8_t> texels;
  for (int value = 0; value < 65536; ++value) {
    texels.push_back(std::uint8_t(value >> 8));
    texels.push_back(std::uint8_t(value));
  }
  return png_of({256, 256, PNG_COLOR_TYPE_GRAY, 16}, texels);
}

// What files say beside their texels.
std::vector<ImageOfKind> annotated_pngs() {
  std::vector<ImageOfKind> files;
  const auto add = [&](const char* what, std::function<void(png_structp, png_infop)> more) {
    files.push_back(
        {what, png_of({9, 7, PNG_COLOR_TYPE_RGB_ALPHA, 8, false, false, std::move(more)})});
  };
  add("gAMA of 1", [](png_structp png, png_infop info) { png_set_gAMA(png, info, 1.0); });
  add("gAMA of 1/2.2", [](png_structp png, png_infop info) { png_set_gAMA(png, info, 0.45455); });
  add("sRGB", [](png_structp png, png_infop info) { png_set_sRGB(png, info, 0); });
  add("oFFs", [](png_structp png, png_infop info) { png_set_oFFs(png, info, 3, 2, 0); });
  add("sBIT", [](png_structp png, png_infop info) {
    const png_color_8 bits{5, 6, 5, 0, 4};
    png_set_sBIT(png, info, &bits);
  });
  add("bKGD", [](png_structp png, png_infop info) {
    const png_color_16 back{0, 200, 100, 50, 0};
    png_set_bKGD(png, info, &back);
  });
  return files;
}

struct JpegKind {
  int width, height;
  J_COLOR_SPACE given, stored;
  int sampling = 1;  // texels along a side for which there is one value of colour
  bool progressive = false;
  int restart = 0;  // blocks
  std::string exif = {};
};

int channels_of(J_COLOR_SPACE space) {
  if (space == JCS_CMYK) return 4;
  if (space == JCS_RGB) return 3;
  return space == JCS_UNKNOWN ? 2 : 1;
}

void write_rows(jpeg_compress_struct& info) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> row(info.image_width * std::size_t(info.input_components));
  for (JDIMENSION y = 0; y < info.image_height; ++y) {
    // Slopes with some noise, as in photographs; and both ends of the range.
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] =
          std::uint8_t(i % 11 == 0 ? 255 * (random() & 1) : 40 + 5 * i + 9 * y + random() % 30);
    JSAMPROW at = row.data();
    jpeg_write_scanlines(&info, &at, 1);
  }
}

std::string jpeg_of(const JpegKind& kind) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  jpeg_mem_dest(&info, &bytes, &count);
  info.image_width = JDIMENSION(kind.width);
  info.image_height = JDIMENSION(kind.height);
  info.input_components = channels_of(kind.given);
  info.in_color_space = kind.given;
  jpeg_set_defaults(&info);
  jpeg_set_colorspace(&info, kind.stored);
  info.comp_info[0].h_samp_factor = info.comp_info[0].v_samp_factor = kind.sampling;
  if (kind.stored == JCS_YCCK)  // black is as fine as luminance
    info.comp_info[3].h_samp_factor = info.comp_info[3].v_samp_factor = kind.sampling;
  if (kind.progressive) jpeg_simple_progression(&info);
  info.restart_interval = unsigned(kind.restart);
  jpeg_start_compress(&info, TRUE);
  if (!kind.exif.empty())
    jpeg_write_marker(&info, JPEG_APP0 + 1, reinterpret_cast<const JOCTET*>(kind.exif.data()),
                      unsigned(kind.exif.size()));
  write_rows(info);
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const std::string file(reinterpret_cast<const char*>(bytes), count);
  std::free(bytes);
  return file;
}

}  // namespace

std::vector<ImageOfKind> png_kinds() {
  std::vector<ImageOfKind> files = annotated_pngs();
  files.push_back({"every 16-bit value", every_16_bit_value()});
  for (const int type : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_PALETTE, PNG_COLOR_TYPE_RGB,
                         PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB_ALPHA})
    for (const int bits : {1, 2, 4, 8, 16})
      for (const bool interlaced : {false, true})
        for (const bool transparent : {false, true})
          for (const int width : {1, 37}) {
            const bool packed = type == PNG_COLOR_TYPE_GRAY || type == PNG_COLOR_TYPE_PALETTE;
            if (bits < 8 && !packed) continue;
            if (bits == 16 && type == PNG_COLOR_TYPE_PALETTE) continue;
            if (transparent && (type & PNG_COLOR_MASK_ALPHA)) continue;
            files.push_back(
                {fmt::format("type {}, {} bits, interlaced {}, transparent {}, {} wide", type, bits,
                             interlaced, transparent, width),
                 png_of({width, width == 1 ? 1 : 6, type, bits, interlaced, transparent})});
          }
  return files;
}

std::vector<ImageOfKind> jpeg_kinds() {
  std::vector<ImageOfKind> files;
  for (const auto& [given, stored, what] : {std::tuple{JCS_GRAYSCALE, JCS_GRAYSCALE, "grey"},
                                            {JCS_RGB, JCS_YCbCr, "YCbCr"},
                                            {JCS_RGB, JCS_RGB, "RGB"},
                                            {JCS_CMYK, JCS_CMYK, "CMYK"},
                                            {JCS_CMYK, JCS_YCCK, "YCCK"},
                                            {JCS_UNKNOWN, JCS_UNKNOWN, "two channels"}})
    for (const bool progressive : {false, true})
      for (const int width : {1, 37})
        for (const int sampling : {1, 2}) {
          const bool halved = stored == JCS_YCbCr || stored == JCS_YCCK;
          if (sampling == 2 && !halved) continue;
          files.push_back(
              {fmt::format("{}, progressive {}, {} wide, sampling {}", what, progressive, width,
                           sampling),
               jpeg_of({width, width == 1 ? 1 : 21, given, stored, sampling, progressive})});
        }
  files.push_back({"restarts", jpeg_of({37, 21, JCS_RGB, JCS_YCbCr, 2, false, 1})});
  // Orientation (0x0112), a short, once, 6: to be turned to the right.
  const std::string exif("Exif\0\0MM\0*\0\0\0\10\0\1\1\22\0\3\0\0\0\1\0\6\0\0\0\0\0\0", 32);
  files.push_back({"turned", jpeg_of({37, 21, JCS_RGB, JCS_YCbCr, 1, false, 0, exif})});
  return files;
}

std::string jpeg_of_scans(int scans) {
  const std::string file = jpeg_of({16, 16, JCS_GRAYSCALE, JCS_GRAYSCALE, 1, true});
  const std::size_t last = file.rfind("\xff\xda"), end = file.size() - 2;
  std::string many = file.substr(0, last);
  for (int i = 0; i < scans; ++i) many += file.substr(last, end - last);
  return many + file.substr(end);
}

}  // namespace atlas::test
