// atlas-bench: error against run time, stage by stage, on meshes of any size.
//   atlas-bench --work cabin:100000 scan:1000000 --out results.json
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

#include "apps/common/options.h"
#include "benchmarks/rivals/rivals.h"
#include "benchmarks/support/callgrind.h"
#include "benchmarks/support/staged.h"

namespace {

using namespace atlas;
using namespace atlas::bench;

struct Arguments {
  std::vector<std::string> work{"cabin:20000", "sphere:20000"}, stages, rivals;
  std::string out;
  std::vector<int> threads;  // empty: as many as there are cores
  int repeats = 1, page = 2048;
  std::uint32_t pages = 8;
  double timeout = 60, texel = 0;
  bool standard_only = false, instructions = false;
  std::uint64_t fit_from = 10000;
};

struct StageEntry {
  const char* name;
  void (*run)(const StageRun&);
  bool needs_light;
};
constexpr StageEntry kStages[] = {
    {"baseline", bench_baseline, false},    {"charts", bench_charts, false},
    {"downsizing", bench_downsizing, true}, {"grouping", bench_grouping, true},
    {"packing", bench_packing, true},       {"baking", bench_baking, true},
    {"simplify", bench_simplify, false},    {"export", bench_export, true},
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option(
      "--work,-w", a.work,
      std::string("what to measure on: KIND:TRIANGLES or file:PATH; kinds: cabin, ") + kShapeKinds);
  std::vector<std::string> names{"unwrap"};
  for (const StageEntry& s : kStages) names.push_back(s.name);
  app.add_option("--stages,-s", a.stages, "which (default: all; unwrap with rivals only)")
      ->check(CLI::IsMember(names));
  app.add_option("--rival", a.rivals, "\"name=command {in} {out}\": a program that unwraps an OBJ");
  app.add_option("--timeout", a.timeout, "of a rival, wall seconds a mesh")
      ->check(app::positive())
      ->capture_default_str();
  app.add_option("--out,-o", a.out, "JSON file to write");
  app.add_option("--repeats,-r", a.repeats, "the least CPU time counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  CLI::Option* threads =
      app.add_option("--threads", a.threads, "one run for each number (default: all cores)")
          ->check(CLI::Range(1, 1024));
  app.add_flag("--instructions", a.instructions, "count them with callgrind, on one thread")
      ->excludes(threads);
  app.add_option("--atlases", a.pages, "pages of the budget")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  app.add_option("--atlas-size", a.page, "their largest side, texels, a power of two")
      ->check(app::within(64, 16384))
      ->capture_default_str();
  app.add_option("--texel", a.texel, "scene units; 0: as fine as the budget")
      ->check(app::not_negative())
      ->capture_default_str();
  app.add_flag("--standard", a.standard_only, "presets' standard settings only: no sweeps");
  app.add_option("--fit-from", a.fit_from, "exponents are fitted to meshes of at least this many")
      ->check(app::not_negative())
      ->capture_default_str();
}

bool wanted(const Arguments& a, const std::string& stage) {
  return a.stages.empty() || std::find(a.stages.begin(), a.stages.end(), stage) != a.stages.end();
}

// Returns whether a stage is run. Without light, those that need it are only if they are named, and
// then fail.
bool runs(const Arguments& a, const StageEntry& stage, const Staged& staged) {
  if (!wanted(a, stage.name)) return false;
  if (!stage.needs_light || staged.scene().lit() || !a.stages.empty()) return true;
  fmt::print("{:<11} {:<18} left out: the mesh has no light\n", stage.name, staged.name);
  return false;
}

// Each stage begins with the mesh alone, without what other stages made from it.
void run_stages(const Arguments& a, const StageRun& run, const std::vector<Rival>& rivals) {
  for (const StageEntry& stage : kStages) {
    if (!runs(a, stage, run.staged)) continue;
    in_own_process(run.staged.row(stage.name, "standard", true), run.done,
                   [&](const TakeRow& take) {
                     stage.run({run.staged, run.repeats, run.sweep, take});
                   });
  }
  const bool named = !a.stages.empty() && wanted(a, "unwrap");
  if (!named && (rivals.empty() || !a.stages.empty())) return;
  bench_ours(run, a.page);
  for (const Rival& rival : rivals) bench_rival(run, rival);
}

int fail(const Status& status) {
  fmt::print(stderr, "atlas-bench: {}\n", status.message());
  return 1;
}

Result<std::vector<Rival>> parse_rivals(const Arguments& a) {
  std::vector<Rival> rivals;
  for (const std::string& text : a.rivals) {
    Result<Rival> rival = parse_rival(text);
    if (!rival.ok()) return rival.status();
    rival->timeout = a.timeout;
    rival->page = a.page;
    rivals.push_back(*rival);
  }
  return rivals;
}

// Runs one mesh through all wanted stages, once for each number of threads.
Status run_work(const Arguments& a, const std::string& work, const std::vector<Rival>& rivals,
                Results& results) {
  Result<LoadedScene> scene = make_work(work, {});
  if (!scene.ok()) return scene.status();
  const std::vector<int> counts = a.threads.empty() ? std::vector{0} : a.threads;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    Context context;
    context.threads = counts[i];
    LoadedScene loaded = i + 1 < counts.size() ? *scene : std::move(*scene);
    Staged staged(work, std::move(loaded), context);
    staged.threads = counts[i];
    staged.settings.pages = a.pages;
    staged.settings.page_size = a.page;
    staged.settings.texel = a.texel;
    const auto done = [&](Row row) {
      fmt::print("{}\n", line(row));
      std::fflush(stdout);
      results.rows.push_back(std::move(row));
    };
    run_stages(a, {staged, a.repeats, !a.standard_only, done}, rivals);
  }
  return {};
}

int run_instructions(const Arguments& a, int argc, char** argv) {
  std::vector<std::string> arguments;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--out" || word == "-o")
      ++i;
    else if (word != "--instructions" && !word.starts_with("--out=") && !word.starts_with("-o"))
      arguments.push_back(word);
  }
  arguments.insert(arguments.end(), {"--threads", "1"});
  Result<Results> counted = count_instructions(arguments);
  if (!counted.ok()) return fail(counted.status());
  counted->machine = describe_machine(argc, argv);
  for (const Row& row : counted->rows)
    fmt::print("{} {:.4g} instructions\n", row.key(), row.instructions);
  if (a.out.empty()) return 0;
  const Status s = save(*counted, a.out);
  return s.ok() ? 0 : fail(s);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures quality and cost of every stage of libatlas.", "atlas-bench");
  Arguments a;
  describe(app, a);
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  if (const Status s = check_target(a.out); !s.ok()) return fail(s);
  if (a.instructions) return run_instructions(a, argc, argv);
  const Result<std::vector<Rival>> rivals = parse_rivals(a);
  if (!rivals.ok()) return fail(rivals.status());
  Results results;
  results.machine = describe_machine(argc, argv);
  for (const std::string& work : a.work) {
    if (const Status s = run_work(a, work, *rivals, results); !s.ok()) return fail(s);
    // Saved after every mesh, so that an interrupted run leaves something.
    if (a.out.empty()) continue;
    results.fits = fit_exponents(results.rows, a.fit_from);
    if (const Status s = save(results, a.out); !s.ok()) return fail(s);
  }
  for (const Fit& f : fit_exponents(results.rows, a.fit_from))
    fmt::print("{:<11} {:<28} {} ~ triangles^{:.2f}\n", f.stage, f.work, f.quantity, f.exponent);
  for (const Row& row : results.rows)
    if (!row.failure.empty() && row.stage != "unwrap") return 1;
  return 0;
}
