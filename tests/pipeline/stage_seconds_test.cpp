// The seconds that the report states for stages.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "libatlas/core/clock.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/pipeline/lit_scene.h"
#include "tests/support/temp_folder.h"

namespace atlas::test {
namespace {

// The seconds of an export are those of the call, whatever else the process does meanwhile. With
// one thread they are those that the system counts for the calling thread.
TEST(Export, SecondsAreThoseOfTheCall) {
  const TempFolder folder;
  std::atomic<bool> done{false};
  std::thread other([&] {
    volatile double sum = 0;
    while (!done) sum = sum + 1;
  });
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    ExportOptions options;
    options.target = folder / "world.obj";
    options.atlases = 6;
    options.atlas_size = 256;
    options.simplify = false;
    const double begun = thread_cpu_seconds();
    const auto report = export_world(lit_room(40), options, {}, context);
    const double spent = thread_cpu_seconds() - begun;
    ASSERT_TRUE(report.ok());
    double stages = 0;
    for (const StageReport& stage : report->stages) stages += stage.cpu_seconds;
    EXPECT_LE(stages, 1.01 * report->cpu_seconds) << threads;
    EXPECT_GE(stages, 0.5 * report->cpu_seconds) << threads;
    if (threads > 1) continue;
    EXPECT_LE(report->cpu_seconds, spent);
    EXPECT_GE(report->cpu_seconds, 0.8 * spent);
  }
  done = true;
  other.join();
}

}  // namespace
}  // namespace atlas::test
