#include "libatlas/exporters/html/light_page.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "libatlas/core/luma.h"
#include "libatlas/exporters/html/mesh_columns.h"
#include "libatlas/exporters/writing/text_output.h"

namespace atlas {
namespace {

constexpr int kStepsAnOctave = 256, kMostCode = 65535;

struct Codes {
  float top = 0;
  std::vector<std::uint16_t> luma;
  std::vector<std::uint8_t> red, blue;  // shares
};

float positive(float v) {
  return v > 0 ? v : 0.0f;
}

Codes codes_of(const ImageF& light) {
  const std::size_t count = std::size_t(light.width) * std::size_t(light.height);
  Codes codes{0, std::vector<std::uint16_t>(count), std::vector<std::uint8_t>(count, 85),
              std::vector<std::uint8_t>(count, 85)};
  std::vector<float> lumas(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* c = &light.texels[3 * i];
    const float r = positive(c[0]), g = positive(c[1]), b = positive(c[2]);
    lumas[i] = luma(r, g, b);
    if (!(lumas[i] > 0)) continue;
    const auto share = [&](float v) {
      return static_cast<std::uint8_t>(std::lround(255.0 * v / (double{r} + g + b)));
    };
    codes.red[i] = share(r);
    codes.blue[i] = share(b);
  }
  const float most = lumas.empty() ? 0 : *std::max_element(lumas.begin(), lumas.end());
  if (most > 0) codes.top = std::log2(most);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(lumas[i] > 0)) continue;
    const double below = kStepsAnOctave * (double{codes.top} - std::log2(double{lumas[i]}));
    codes.luma[i] =
        static_cast<std::uint16_t>(std::clamp<long>(kMostCode - std::lround(below), 1, kMostCode));
  }
  return codes;
}

int paeth(int left, int lower, int corner) {
  const int p = left + lower - corner;
  const int a = std::abs(p - left), b = std::abs(p - lower), c = std::abs(p - corner);
  return a <= b && a <= c ? left : b <= c ? lower : corner;
}

// Calls `put` with each value minus its prediction.
template <class T, class Put>
void predict(const std::vector<T>& values, int width, const Put& put) {
  const auto row = static_cast<std::size_t>(width);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool first = i % row == 0, lowest = i < row;
    const int left = first ? 0 : values[i - 1], lower = lowest ? 0 : values[i - row];
    put(i, values[i] - paeth(left, lower, first || lowest ? 0 : values[i - row - 1]));
  }
}

}  // namespace

Status write_light_page(const std::filesystem::path& path, const ImageF& light) {
  if (light.channels != 3 || !light.whole())
    return {ErrorCode::bad_input, path.string() + ": a page of light has three channels"};
  const Codes codes = codes_of(light);
  const std::size_t count = codes.luma.size();
  const std::uint32_t head[3] = {std::uint32_t(light.width), std::uint32_t(light.height),
                                 std::bit_cast<std::uint32_t>(codes.top)};
  std::string bytes(sizeof head + 4 * count, '\0');
  for (std::size_t k = 0; k < sizeof head; ++k)
    bytes[k] = static_cast<char>(head[k / 4] >> (8 * (k % 4)));
  char* const low = bytes.data() + sizeof head;
  predict(codes.luma, light.width, [&](std::size_t i, int d) {
    const auto difference = static_cast<std::int16_t>(d);
    const auto folded = static_cast<std::uint16_t>((difference << 1) ^ (difference >> 15));
    low[i] = static_cast<char>(folded & 255);
    low[count + i] = static_cast<char>(folded >> 8);
  });
  predict(codes.red, light.width,
          [&](std::size_t i, int d) { low[2 * count + i] = static_cast<char>(d); });
  predict(codes.blue, light.width,
          [&](std::size_t i, int d) { low[3 * count + i] = static_cast<char>(d); });
  Result<std::string> packed = deflated(bytes);
  if (!packed.ok()) return packed.status();
  TextFile file(path, path, false);
  file.write(*packed);
  return file.finish();
}

}  // namespace atlas
