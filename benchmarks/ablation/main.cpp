// Unwraps a set of meshes and prints one line of JSON each. See ablation.py.
#include <fmt/format.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "benchmarks/ablation/measure.h"
#include "benchmarks/shapes/families.h"

namespace {

using namespace atlas;

struct Job {
  std::string_view family;
  std::uint32_t number, draw;
};

int usage() {
  std::fputs(
      "usage: atlas-ablation-measure FIRST STEP MEMBERS DRAWS\n"
      "Measures the members FIRST, FIRST + STEP, ... below MEMBERS of each family of meshes, with\n"
      "constants as LIBATLAS_TUNED says (\"name=value;name*factor\").\n",
      stderr);
  return 2;
}

std::string line(const Job& job, const bench::UnwrapFigures& f) {
  return fmt::format(
      "{{\"mesh\":\"{}-{}\",\"draw\":{},\"charts\":{},\"l2\":{:.6f},\"l999\":{:.4f},\"seam\":{:.5f}"
      ","
      "\"visible_smooth\":{:.5f},\"jag\":{:.5f},\"use\":{:.5f},\"chart_s\":{:.5f},\"page_s\":{:.5f}"
      ","
      "\"defects\":{}}}",
      job.family, job.number, job.draw, f.charts, f.stretch_l2, f.stretch_999, f.seams.seam,
      f.seams.visible_smooth, f.seams.jag, f.page_use, f.chart_seconds, f.page_seconds, f.defects);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) return usage();
  const int first = std::atoi(argv[1]), step = std::atoi(argv[2]), members = std::atoi(argv[3]),
            draws = std::atoi(argv[4]);
  if (first < 0 || step < 1 || members < 1 || draws < 1) return usage();
  std::vector<Job> jobs;
  for (int number = first; number < members; number += step)
    for (const std::string_view family : bench::families())
      for (int draw = 0; draw < draws; ++draw)
        jobs.push_back({family, std::uint32_t(number), std::uint32_t(draw)});
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> failed = false;
  std::mutex printing;
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      const auto shape = bench::make_member(jobs[i].family, jobs[i].number);
      const auto figures = bench::measure_unwrap(*shape, jobs[i].draw);
      const std::lock_guard lock(printing);
      if (!figures.ok()) {
        std::fprintf(stderr, "%s-%u: %s\n", std::string(jobs[i].family).c_str(), jobs[i].number,
                     figures.status().message().c_str());
        failed = true;
        continue;
      }
      std::puts(line(jobs[i], *figures).c_str());
    }
  };
  std::vector<std::thread> threads;
  for (unsigned k = 0; k < std::max(1u, std::thread::hardware_concurrency()); ++k)
    threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  return failed ? 1 : 0;
}
