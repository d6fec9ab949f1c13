// Prints luminance and the display value of each tone operator, for the plot of tone_curves.gp.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

#include "apps/common/options.h"
#include "libatlas/texture/tone.h"

int main(int argc, char** argv) {
  using namespace atlas;
  CLI::App app("Prints luminance and the display value of each tone operator.", "atlas-bench-tone");
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  LuminanceStatistics interior;  // a lit room: most of it dim, with some lamps
  interior.lit_area = 1;
  interior.log_average = 0.3;
  interior.mean = 0.6;
  interior.mean_rgb = {0.6f, 0.6f, 0.6f};
  interior.minimum_log = std::log(0.005);
  interior.maximum_log = std::log(3);
  interior.middle = 0.3;
  interior.percentile98 = 2;
  interior.maximum = 30;
  std::vector<ToneMapping> curves;
  for (const ToneOperator op : {ToneOperator::linear, ToneOperator::reinhard, ToneOperator::drago,
                                ToneOperator::reinhard_devlin}) {
    ToneOptions options;
    options.op = op;
    const Result<ToneMapping> made = make_tone_mapping(options, interior);
    if (!made.ok()) {
      std::fprintf(stderr, "atlas-bench-tone: %s\n", made.status().message().c_str());
      return 1;
    }
    curves.push_back(*made);
  }
  for (int i = -25; i <= 17; ++i)
    for (int k = 0; k < 10; ++k) {
      const auto y = static_cast<float>(std::pow(10, (i + 0.1 * k) / 10));
      std::printf("%g", double(y));
      for (const ToneMapping& curve : curves)
        std::printf(" %.4f", double(curve.display({y, y, y}).x));
      std::printf("\n");
    }
  return 0;
}
