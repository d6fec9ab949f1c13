#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "libatlas/view/bench.h"
#include "libatlas/view/image_error.h"

namespace atlas {
namespace {

Image8 noise(int width, int height, unsigned seed) {
  std::mt19937 rng(seed);
  Image8 image(width, height, 3);
  for (auto& v : image.texels) v = std::uint8_t(rng() & 255);
  return image;
}

// Computes it window by window, directly from the paper's formula.
double slow_ssim(const Image8& a, const Image8& b) {
  double total = 0;
  int windows = 0;
  for (int y = 0; y + 8 <= a.height; ++y)
    for (int x = 0; x + 8 <= a.width; ++x, ++windows) {
      double ma = 0, mb = 0, va = 0, vb = 0, c = 0;
      for (int j = 0; j < 64; ++j) {
        ma += *a.at(x + j % 8, y + j / 8) / 64.0;
        mb += *b.at(x + j % 8, y + j / 8) / 64.0;
      }
      for (int j = 0; j < 64; ++j) {
        const double p = *a.at(x + j % 8, y + j / 8) - ma, q = *b.at(x + j % 8, y + j / 8) - mb;
        va += p * p / 64;
        vb += q * q / 64;
        c += p * q / 64;
      }
      const double c1 = 6.5025, c2 = 58.5225;
      total += (2 * ma * mb + c1) * (2 * c + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
    }
  return total / windows;
}

TEST(ImageError, SsimIsTheFormula) {
  const Image8 a = noise(23, 17, 1);
  Image8 b = a;
  for (std::size_t i = 0; i < b.texels.size(); i += 5) b.texels[i] = std::uint8_t(b.texels[i] / 2);
  EXPECT_NEAR(ssim(a, b), slow_ssim(a, b), 1e-9);
  EXPECT_NEAR(ssim(a, noise(23, 17, 2)), slow_ssim(a, noise(23, 17, 2)), 1e-9);
  EXPECT_NEAR(ssim(a, a), 1, 1e-12);
  EXPECT_LT(ssim(a, b), 1);
}

TEST(ImageError, SsimOfTheSmallestImages) {
  for (const auto& [width, height] : {std::pair{8, 8}, {8, 9}, {9, 8}}) {
    const Image8 a = noise(width, height, 3), b = noise(width, height, 4);
    EXPECT_NEAR(ssim(a, b), slow_ssim(a, b), 1e-9);
  }
  for (const auto& [width, height] : {std::pair{7, 8}, {8, 7}, {1, 1}}) {
    const Image8 a = noise(width, height, 3), b = noise(width, height, 4);
    EXPECT_EQ(ssim(a, a), 1);
    EXPECT_EQ(ssim(a, b), 0);
  }
}

TEST(ImageError, PsnrOfKnownDifferences) {
  Image8 a(4, 4, 1, 100), b(4, 4, 1, 110);
  EXPECT_NEAR(psnr(a, b), 20 * std::log10(25.5), 1e-9);
  EXPECT_TRUE(std::isinf(psnr(a, a)));
}

TEST(ImageError, VisibilityCountsAndSetsEdgesApart) {
  Image8 truth(10, 1, 1, 0), got(10, 1, 1, 0);
  for (int x = 5; x < 10; ++x) *truth.at(x, 0) = *got.at(x, 0) = 255;
  *truth.at(4, 0) = 128;  // an edge pixel
  *got.at(4, 0) = 0;
  *got.at(0, 0) = 255;  // wrong
  *got.at(9, 0) = 204;  // differs by a fifth
  const VisibilityError e = visibility_error(got, truth);
  EXPECT_NEAR(e.mean, (128.0 / 255 + 1 + 0.2) / 10, 1e-9);
  EXPECT_NEAR(e.wrong, 0.2, 1e-9);
  EXPECT_NEAR(e.mean_off_edges, 0.12, 1e-9);
  EXPECT_NEAR(e.wrong_off_edges, 0.1, 1e-9);
  EXPECT_NEAR(e.edge_share, 0.1, 1e-9);
}

TEST(ImageError, VisibilityIsTheFirstChannelOfEither) {
  Image8 truth(4, 2, 1, 0), got(4, 2, 3, 99);
  for (int i = 0; i < 8; ++i) {
    truth.texels[std::size_t(i)] = i < 3 ? 255 : 0;
    got.texels[std::size_t(3 * i)] = truth.texels[std::size_t(i)];
  }
  EXPECT_EQ(visibility_error(got, truth).mean, 0);
  got.texels[3 * 5] = 255;
  EXPECT_EQ(visibility_error(got, truth).wrong, 1.0 / 8);
  EXPECT_EQ(visibility_error(truth, got).wrong, 1.0 / 8);
}

TEST(ImageError, SpreadTakesNearestRanks) {
  std::vector<double> v;
  for (int i = 1; i <= 1000; ++i) v.push_back(i);
  const Spread s = spread_of(v);
  EXPECT_EQ(s.p50, 500);
  EXPECT_EQ(s.p95, 950);
  EXPECT_EQ(s.p99, 990);
  EXPECT_EQ(s.p999, 999);
  EXPECT_EQ(s.worst, 1000);
  EXPECT_NEAR(s.mean, 500.5, 1e-9);
  EXPECT_EQ(spread_of({}).worst, 0);
  EXPECT_EQ(spread_of({7}).p50, 7);
  EXPECT_EQ(spread_of({3, 1, 2}).p50, 2);
  EXPECT_EQ(spread_of({4, 1, 3, 2}).p50, 2);
  EXPECT_EQ(spread_of({4, 1, 3, 2}).p95, 4);
}

}  // namespace
}  // namespace atlas
