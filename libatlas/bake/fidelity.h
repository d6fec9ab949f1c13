// How far the finished atlases are from the light they were made of.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "libatlas/bake/bake.h"
#include "libatlas/bake/placement.h"
#include "libatlas/core/context.h"
#include "libatlas/core/image.h"
#include "libatlas/core/status.h"

namespace atlas {

struct FidelityOptions {
  std::uint32_t samples = 100000;  // area-uniform over the whole surface
  std::uint64_t seed = 1;
};

// The PSNR of samples without any error.
inline constexpr double kPerfectDecibels = 999;

// Of the lit samples, unless said otherwise.
struct Fidelity {
  std::uint64_t lit = 0, unlit = 0;  // samples: luminance not exactly zero / exactly zero
  std::uint64_t clipped = 0;         // lit samples above display white in a channel
  std::uint64_t unplaced = 0;        // samples on charts without a placement or page: left out
  double rmse = 0;  // of luma, scene units, after decoding; only where the curve inverts:
                    // `linear` tone mapping and samples not clipped; else 0
  double psnr = 0;  // dB, of display values (sRGB-encoded, peak 1), all three channels
  double psnr_channel[3] = {0, 0, 0};
  double psnr_all = 0;                    // the same with unlit samples counted in
  double rmse_display = 0;                // root mean square of the display error over channels
  double p95 = 0, p999 = 0, maximum = 0;  // of the largest channel's absolute display error
};

// Takes the pages one by one, in any order, so that they need not be in memory together.
class FidelityMeter {
 public:
  // Draws the samples, the same for every thread count. `placements` of all pages; what is given
  // here is not looked at any more once the call is over. Errors: bad_input (a placement names a
  // chart that is not there); cancelled.
  static Result<FidelityMeter> make(const ChartLight& light,
                                    std::span<const ChartPlacement> placements,
                                    const FidelityOptions& options, const Context& context);
  FidelityMeter(FidelityMeter&&) noexcept;
  FidelityMeter& operator=(FidelityMeter&&) noexcept;
  ~FidelityMeter();

  // Looks up this page's samples bilinearly in the 8-bit image, as a viewer does. `display` is what
  // bake_page gave, or of the same size. Samples of an image that is empty, not whole, or of fewer
  // than three channels count as if the page had none.
  void add_page(std::int32_t page, const Image8& display);

  Fidelity result() const;

 private:
  struct State;
  explicit FidelityMeter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace atlas
