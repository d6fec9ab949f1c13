// atlas-bench-stability: the stress cases of stability/checks.h. Fails if a bound does not hold.
#include <fmt/format.h>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "apps/common/options.h"
#include "benchmarks/stability/checks.h"

int main(int argc, char** argv) {
  using namespace atlas;
  using namespace atlas::bench;
  CLI::App app("Checks every stage on stiff and extreme cases.", "atlas-bench-stability");
  StabilityOptions options;
  std::string out;
  bool failures_only = false;
  app.add_flag("--full", options.full, "the large cases too");
  app.add_flag("--gpu", options.gpu, "only the shadow maps, drawn by a GPU");
  app.add_option("--models", options.models, "meshes for scale, offset and rotation")
      ->check(CLI::ExistingFile);
  app.add_option("--out,-o", out, "JSON file to write");
  app.add_flag("--failures", failures_only, "print only what does not hold");
  if (const int code = app::parse(app, argc, argv); code >= 0) return code;
  const auto fail = [](const Status& status) {
    fmt::print(stderr, "atlas-bench-stability: {}\n", status.message());
    return 2;
  };
  if (const Status s = check_target(out); !s.ok()) return fail(s);
  Results results;
  results.machine = describe_machine(argc, argv);
  Context context;
  context.warn = [](std::string_view text) { fmt::print(stderr, "{}\n", text); };
  CheckList list(options, context);
  all_checks(list);
  results.checks = std::move(list.checks);
  results.rows = std::move(list.rows);
  int failures = 0;
  for (const Check& c : results.checks) {
    failures += !c.holds();
    if (failures_only && c.holds()) continue;
    fmt::print("{} {:<13} {:<46} {:<46} {:>11.4g} <= {:<9.4g} {}\n", c.holds() ? "   " : "BAD",
               c.group, c.stress, c.quantity, c.value, c.bound, c.note);
  }
  for (const Row& row : results.rows)
    if (!failures_only) fmt::print("{}\n", line(row));
  fmt::print("{} checks, {} bounds exceeded\n", results.checks.size(), failures);
  if (!out.empty())
    if (const Status s = save(results, out); !s.ok()) return fail(s);
  return failures ? 1 : 0;
}
