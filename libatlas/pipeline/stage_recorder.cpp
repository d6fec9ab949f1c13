#include "libatlas/pipeline/stage_recorder.h"

#include <utility>

#include "libatlas/core/clock.h"
#include "libatlas/core/parallel.h"
#include "libatlas/core/progress.h"

namespace atlas {

StageRecorder::StageRecorder(ExportReport& report,
                             const std::function<void(const StageReport&)>& stage_done,
                             const Context& context)
    : report_(report), stage_done_(stage_done), context_(context) {}

const Context& StageRecorder::begin(std::string name) {
  name_ = std::move(name);
  stage_context_ = part_of_stage(context_, name_);
  cpu_ = own_cpu_seconds();
  wall_ = wall_seconds();
  stage_context_.report(name_, 0);
  return stage_context_;
}

void StageRecorder::finish(StageOutcome outcome) {
  context_.report(name_, 1);
  add(name_, own_cpu_seconds() - cpu_, wall_seconds() - wall_, std::move(outcome));
}

void StageRecorder::add(std::string name, double cpu_seconds, double wall_seconds,
                        StageOutcome outcome) {
  StageReport stage;
  stage.stage = std::move(name);
  stage.cpu_seconds = cpu_seconds;
  stage.wall_seconds = wall_seconds;
  stage.peak_memory = peak_memory();
  stage.size_in = outcome.in;
  stage.size_out = outcome.out;
  stage.unit = std::move(outcome.unit);
  stage.quality = std::move(outcome.quality);
  report_.stages.push_back(stage);
  if (stage_done_) stage_done_(stage);
}

}  // namespace atlas
