// How far one picture is from another, for measuring shadow methods against the classic map.
#pragma once

#include "libatlas/core/image.h"

namespace atlas {

// Peak signal-to-noise ratio of 8-bit images of equal size and channels, dB; infinity if they are
// equal.
double psnr(const Image8& a, const Image8& b);

// Mean structural similarity of the first channels (Wang, Bovik, Sheikh and Simoncelli 2004), over
// all 8x8 windows, constants 0.01 and 0.03; 1 if they are equal.
double ssim(const Image8& a, const Image8& b);

// Visibilities as grey values (0 shadowed, 255 lit) compared pixel by pixel. The edge band is where
// the true value is strictly between 0 and 255: with 3x3 bilinear filtering, within 2 texels of a
// shadow's edge.
struct VisibilityError {
  double mean = 0;   // mean |difference|, 0 to 1
  double wrong = 0;  // share of pixels that differ by more than a half
  double mean_off_edges = 0, wrong_off_edges = 0;  // shares of all pixels, the edge band left out
  double edge_share = 0;                           // share of pixels in the edge band
};
VisibilityError visibility_error(const Image8& got, const Image8& truth);

}  // namespace atlas
