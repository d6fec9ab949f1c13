// Internal: measures the stages of an export and writes them into its report.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "libatlas/core/context.h"
#include "libatlas/report/export_report.h"

namespace atlas {

// What went into a stage and came out, and the phrase of quality that its line shows.
struct StageOutcome {
  std::uint64_t in = 0, out = 0;
  std::string unit;  // of `out`
  std::string quality;
};

// All references must outlive the recorder. `stage_done` may be empty.
class StageRecorder {
 public:
  StageRecorder(ExportReport& report, const std::function<void(const StageReport&)>& stage_done,
                const Context& context);

  // Starts a stage's clocks. finish() stops them and appends the stage to the report. The CPU time
  // is that of this thread, its loops and its background tasks, not that of the process. What the
  // stage calls with the returned context reports its progress under the stage's name.
  const Context& begin(std::string name);
  void finish(StageOutcome outcome);

  // Appends a stage that was measured, and has reported its progress, elsewhere.
  void add(std::string name, double cpu_seconds, double wall_seconds, StageOutcome outcome);

 private:
  ExportReport& report_;
  const std::function<void(const StageReport&)>& stage_done_;
  const Context& context_;
  Context stage_context_;
  std::string name_;
  double cpu_ = 0, wall_ = 0;  // at begin()
};

}  // namespace atlas
