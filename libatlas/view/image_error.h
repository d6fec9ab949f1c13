// Measures how far one picture is from another, to compare shadow methods with the classic map.
#pragma once

#include "libatlas/core/image.h"

namespace atlas {

// Returns the peak signal-to-noise ratio in dB of 8-bit images of equal size and channels; infinity
// if they are equal.
double psnr(const Image8& a, const Image8& b);

// Returns the mean structural similarity of the first channels (Wang, Bovik, Sheikh and Simoncelli
// 2004), over all 8x8 windows, with the constants 0.01 and 0.03; 1 if they are equal. Smaller
// images give 1 if they are equal, else 0.
double ssim(const Image8& a, const Image8& b);

// Visibilities as grey values (0 shadowed, 255 lit), compared pixel by pixel. The edge band
// consists of the pixels whose true value is strictly between 0 and 255: with 3x3 bilinear
// filtering, those within 2 texels of a shadow's edge.
struct VisibilityError {
  double mean = 0;   // mean of |difference|, 0 to 1
  double wrong = 0;  // share of pixels that differ by more than a half
  // Sums over the pixels outside the edge band, as shares of all pixels.
  double mean_off_edges = 0, wrong_off_edges = 0;
  double edge_share = 0;  // share of pixels in the edge band
};
VisibilityError visibility_error(const Image8& got, const Image8& truth);

}  // namespace atlas
