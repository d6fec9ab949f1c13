// atlas-bench: error against run time, stage by stage, on meshes of any size.
//   atlas-bench --work cabin:100000 scan:1000000 --out results.json
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "benchmarks/rivals/rivals.h"
#include "benchmarks/support/staged.h"

namespace {

using namespace atlas;
using namespace atlas::bench;

struct Arguments {
  std::vector<std::string> work{"cabin:20000", "sphere:20000"}, stages, rivals;
  std::string out;
  int repeats = 1, threads = 0, page = 2048;
  std::uint32_t pages = 8;
  double timeout = 60, texel = 0;
  bool standard_only = false;
  std::uint64_t fit_from = 10000;
};

struct StageEntry {
  const char* name;
  void (*run)(const StageRun&);
};
constexpr StageEntry kStages[] = {
    {"baseline", bench_baseline}, {"charts", bench_charts},   {"downsizing", bench_downsizing},
    {"grouping", bench_grouping}, {"packing", bench_packing}, {"baking", bench_baking},
    {"simplify", bench_simplify}, {"export", bench_export},
};

void describe(CLI::App& app, Arguments& a) {
  app.add_option(
      "--work,-w", a.work,
      std::string("what to measure on: KIND:TRIANGLES or file:PATH; kinds: ") + kWorkKinds);
  std::vector<std::string> names{"unwrap"};
  for (const StageEntry& s : kStages) names.push_back(s.name);
  app.add_option("--stages,-s", a.stages, "which (default: all; unwrap with rivals only)")
      ->check(CLI::IsMember(names));
  app.add_option("--rival", a.rivals, "\"name=command {in} {out}\": a program that unwraps an OBJ");
  app.add_option("--timeout", a.timeout, "of a rival, wall seconds a mesh")->capture_default_str();
  app.add_option("--out,-o", a.out, "JSON file to write");
  app.add_option("--repeats,-r", a.repeats, "the least CPU time counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  app.add_option("--threads", a.threads, "0: as many as there are cores")->capture_default_str();
  app.add_option("--atlases", a.pages, "pages of the budget")->capture_default_str();
  app.add_option("--atlas-size", a.page, "their largest side, texels")->capture_default_str();
  app.add_option("--texel", a.texel, "scene units; 0: as fine as the budget")
      ->capture_default_str();
  app.add_flag("--standard", a.standard_only, "presets' standard settings only: no sweeps");
  app.add_option("--fit-from", a.fit_from, "exponents are fitted to meshes of at least this many")
      ->capture_default_str();
}

bool wanted(const Arguments& a, const std::string& stage) {
  return a.stages.empty() || std::find(a.stages.begin(), a.stages.end(), stage) != a.stages.end();
}

void run_stages(const Arguments& a, const StageRun& run, const std::vector<Rival>& rivals) {
  for (const StageEntry& stage : kStages)
    if (wanted(a, stage.name)) stage.run(run);
  const bool named = !a.stages.empty() && wanted(a, "unwrap");
  if (!named && (rivals.empty() || !a.stages.empty())) return;
  bench_ours(run, a.page);
  for (const Rival& rival : rivals) bench_rival(run, rival);
}

int fail(const Status& status) {
  fmt::print(stderr, "atlas-bench: {}\n", status.message());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures quality and cost of every stage of libatlas.");
  Arguments a;
  describe(app, a);
  CLI11_PARSE(app, argc, argv);
  std::vector<Rival> rivals;
  for (const std::string& text : a.rivals) {
    Result<Rival> rival = parse_rival(text);
    if (!rival.ok()) return fail(rival.status());
    rival->timeout = a.timeout;
    rival->page = a.page;
    rivals.push_back(*rival);
  }
  Context context;
  context.threads = a.threads;
  Results results;
  results.machine = describe_machine(argc, argv);
  int failures = 0;
  for (const std::string& work : a.work) {
    Result<LoadedScene> scene = make_work(work, context);
    if (!scene.ok()) return fail(scene.status());
    Staged staged(work, std::move(*scene), context);
    staged.settings.pages = a.pages;
    staged.settings.page_size = a.page;
    staged.settings.texel = a.texel;
    const auto done = [&](Row row) {
      fmt::print("{}\n", line(row));
      std::fflush(stdout);
      failures += !row.failure.empty() && row.stage != "unwrap";
      results.rows.push_back(std::move(row));
    };
    run_stages(a, {staged, a.repeats, !a.standard_only, done}, rivals);
    if (a.out.empty()) continue;  // after every mesh, so that an interrupted run leaves something
    results.fits = fit_exponents(results.rows, a.fit_from);
    if (const Status s = save(results, a.out); !s.ok()) return fail(s);
  }
  for (const Fit& f : fit_exponents(results.rows, a.fit_from))
    fmt::print("{:<11} {:<28} {} ~ triangles^{:.2f}\n", f.stage, f.work, f.quantity, f.exponent);
  return failures ? 1 : 0;
}
