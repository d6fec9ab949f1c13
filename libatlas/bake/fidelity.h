// Measures how far the finished atlases are from the light that they were made from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libatlas/bake/bake.h"
#include "libatlas/core/context.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"
#include "libatlas/core/vec.h"
#include "libatlas/uvs/placement.h"

namespace atlas {

struct FidelityOptions {
  std::uint32_t samples = 100000;  // distributed uniformly over the area of the whole surface
  std::uint64_t seed = 1;
};

// The PSNR of samples without any error, dB.
inline constexpr double kPerfectDecibels = 999;

// A sample that is shown badly. Colours are display values, 0..1.
struct WorstPlace {
  std::int32_t page = -1;
  Vec2f texel = {};  // position on the page
  Vec3f wanted = {}, shown = {};
  float error = 0;  // absolute, in the worst channel
};

inline constexpr std::size_t kWorstPlaces = 8;
inline constexpr float kWorstDistance = 32;

// The error of the lit samples, unless said otherwise.
struct Fidelity {
  // Samples that have a channel above 0, and those that do not. Channels below 0 count as 0.
  std::uint64_t lit = 0, unlit = 0;
  std::uint64_t clipped = 0;   // lit samples at or above display white in a channel
  std::uint64_t unplaced = 0;  // samples on charts without a placement or page; they are left out
  // The root mean square error of luma after decoding, scene units. It is measured only where the
  // tone curve can be inverted, that is with `linear` tone mapping and for samples that are not
  // clipped; else it is 0.
  double rmse = 0;
  double psnr = 0;  // of display values (sRGB-encoded, peak 1) over all three channels, dB
  double psnr_channel[3] = {0, 0, 0};
  double psnr_all = 0;      // as psnr, but with unlit samples included
  double rmse_display = 0;  // root mean square error of display values over channels
  // The 95th and 99.9th percentile and the maximum of the absolute display error in a sample's
  // worst channel.
  double p95 = 0, p999 = 0, maximum = 0;
  // The worst samples, the worst first: at most kWorstPlaces, at least kWorstDistance texels apart.
  std::vector<WorstPlace> worst = {};
};

// Measures the error of pages that are given one by one, in any order, so that they need not be in
// memory together.
class FidelityMeter {
 public:
  // Draws the samples, which are the same for every thread count. `placements` are those of all
  // pages. The arguments are no longer used after the call. Errors: bad_input (a placement names a
  // chart that does not exist or is not finite, or a triangle a chart or uv that does not exist;
  // see check_scene_of()); cancelled.
  static Result<FidelityMeter> make(const ChartLight& light,
                                    std::span<const ChartPlacement> placements,
                                    const FidelityOptions& options, const Context& context);
  FidelityMeter(FidelityMeter&&) noexcept;
  FidelityMeter& operator=(FidelityMeter&&) noexcept;
  ~FidelityMeter();

  // Looks up this page's samples bilinearly in the 8-bit image, as a viewer does. `display` is the
  // image from bake_page, or one of the same size. If the image is empty, not whole, or has fewer
  // than three channels, its samples count as if the charts had no page.
  void add_page(std::int32_t page, const Image8& display);
  // The same for a page of light, which a viewer interpolates before the tone curve.
  void add_light_page(std::int32_t page, const ImageF& light);

  // The error on a page that was given, where its samples lie.
  struct Cells {
    std::size_t columns = 0;
    // Root mean square error of display values (0..1) over the channels, in rows from the bottom;
    // -1 where there is no sample.
    std::vector<float> rms = {};
  };
  // Divides a page of width x height texels into cells of `side` texels (> 0).
  Cells cells(std::int32_t page, int width, int height, int side) const;

  Fidelity result() const;

 private:
  struct State;
  explicit FidelityMeter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace atlas
