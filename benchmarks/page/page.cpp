#include "benchmarks/page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "benchmarks/page/gnuplot.h"
#include "benchmarks/page/plots.h"
#include "benchmarks/page/tables.h"

namespace atlas::bench {
namespace {

// Files with checks belong to the stability page with all their rows, the others to that of
// performance. Names cannot tell them apart, since groups of checks are called after stages.
PageInput files_of(const PageInput& input, bool with_checks) {
  PageInput chosen;
  for (const Results& r : input.files)
    if (r.checks.empty() != with_checks) chosen.files.push_back(r);
  return chosen;
}

Results joined(const PageInput& input) {
  Results all;
  for (const Results& r : input.files) {
    all.rows.insert(all.rows.end(), r.rows.begin(), r.rows.end());
    all.fits.insert(all.fits.end(), r.fits.begin(), r.fits.end());
    all.checks.insert(all.checks.end(), r.checks.begin(), r.checks.end());
  }
  return all;
}

std::string file_of(const Results& results) {
  std::string source;
  if (!results.rows.empty()) source = results.rows.front().source;
  if (!results.checks.empty()) source = results.checks.front().source;
  return source.substr(0, source.find(':'));
}

void machines(const PageInput& input, Document& page) {
  page.heading("Machine and commands");
  std::vector<Cells> rows;
  for (const Results& r : input.files)
    rows.push_back({file_of(r), r.machine.command, r.machine.date});
  page.table({"JSON", "command", "date"}, rows);
  rows.clear();
  for (const Results& r : input.files) {
    const Machine& m = r.machine;
    const Cells cells{fmt::format("{}, {} cores", m.processor, m.cores), m.system,
                      m.compiler + ", " + m.build};
    if (std::find(rows.begin(), rows.end(), cells) == rows.end()) rows.push_back(cells);
  }
  page.table({"processor", "system", "compiler"}, rows);
  if (const std::size_t count = machine_count(input.files); count > 1)
    page.paragraph(
        fmt::format("These results are of {} different machines or builds: times must be compared "
                    "within one JSON file only.",
                    count));
}

void noise(const Results& all, Document& page) {
  std::vector<double> spreads;
  for (const Row& row : all.rows)
    if (row.cpu_spread > 0 && row.cpu_seconds > 0.05) spreads.push_back(row.cpu_spread);
  std::string text =
      "Times are CPU seconds (user and system, all threads), the least of the repeats. Memory is "
      "the largest resident set of a process that runs this stage with this setting only (light "
      "leak and shadows: one process for all settings); of it, "
      "input is what it held before: the program, the mesh and what the stage is given. Every "
      "figure is a value in the line of the JSON file that its row names (results/FILE:LINE).";
  if (!spreads.empty()) {
    std::sort(spreads.begin(), spreads.end());
    text += fmt::format(
        " Noise of the CPU times, as the spread between repeats of the {} rows above 50 ms: median "
        "{:.0f} %, largest {:.0f} %; between whole runs it is more, see docs/performance.md. "
        "Quality figures have no noise: reruns give the same digits.",
        spreads.size(), 100 * spreads[spreads.size() / 2], 100 * spreads.back());
  }
  page.paragraph(text);
}

class Pictures {
 public:
  Pictures(const Results& all, const std::filesystem::path& folder)
      : folder_(folder), plots_(make_plots(all)) {
    for (const Plot& plot : plots_)
      if (const Status s = draw(plot, folder); !s.ok()) undrawn_[plot.file] = s.message();
  }
  void show(const std::string& file, Document& page) const {
    for (const Plot& plot : plots_) {
      if (plot.file != file) continue;
      const auto reason = undrawn_.find(file);
      if (reason == undrawn_.end())
        page.image(file, plot.title);
      else
        page.paragraph("No plot: " + reason->second);
    }
  }

  // Shows a picture that another program drew into the folder, if it exists.
  void show_drawn(const std::string& file, const std::string& title, Document& page) const {
    if (std::filesystem::exists(folder_ / file)) page.image(file, title);
  }

 private:
  std::filesystem::path folder_;
  std::vector<Plot> plots_;
  std::map<std::string, std::string> undrawn_;
};

void performance(const PageInput& input, const Results& all, const Pictures& pictures,
                 Document& page) {
  machines(input, page);
  noise(all, page);
  goals_table(all, page);
  page.heading("Cost against size");
  fits_table(all, page);
  pictures.show("time_against_size.svg", page);
  pictures.show("memory_against_size.svg", page);
  limit_table(all, page);
  parts_table(all, page);
  export_table(all, page);
  threads_table(all, page);
  instructions_table(all, page);
  rivals_table(all, page);
  pictures.show("error_unwrap.svg", page);
  for (const std::string& stage : stages_of(all)) {
    page.heading("Stage: " + stage);
    pictures.show("error_" + stage + ".svg", page);
    pictures.show(stage + ".svg", page);
    if (stage == "light_leak")
      pictures.show_drawn(
          "light_leak.png",
          "A patch of the door across the shadow's edge: the light as the mesh holds it, then "
          "as the pages show it, in the order of the rows below",
          page);
    stage_table(all, stage, page);
  }
}

void stability(const PageInput& input, const Results& all, Document& page) {
  std::size_t bad = 0;
  for (const Check& c : all.checks) bad += !c.holds();
  page.paragraph(fmt::format("{} figures, {} beyond their bound.", all.checks.size(), bad));
  machines(input, page);
  std::vector<std::string> groups;
  for (const Check& c : all.checks)
    if (std::find(groups.begin(), groups.end(), c.group) == groups.end()) groups.push_back(c.group);
  const std::vector<std::string> stages = stages_of(all);
  for (const std::string& group : groups) {
    page.heading(group);
    std::vector<Cells> rows;
    for (const Check& c : all.checks)
      if (c.group == group)
        rows.push_back({c.stress, c.quantity, fmt::format("{:.4g}", c.value),
                        fmt::format("{:.4g}", c.bound), c.note, c.source,
                        c.holds() ? "holds" : "EXCEEDED"});
    page.table({"stress", "quantity", "value", "bound", "reference or limit", "JSON", ""}, rows);
    if (std::find(stages.begin(), stages.end(), group) != stages.end())
      stage_table(all, group, page);
  }
  for (const std::string& stage : stages) {
    if (std::find(groups.begin(), groups.end(), stage) != groups.end()) continue;
    page.heading("Stage: " + stage);
    stage_table(all, stage, page);
  }
}

Status write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.flush();
  if (file) return {};
  return {ErrorCode::io, path.string() + ": cannot be written"};
}

}  // namespace

Status write_page(const PageInput& input, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / "plots", error);
  if (error) return {ErrorCode::io, folder.string() + ": " + error.message()};
  const PageInput measured = files_of(input, false), checked = files_of(input, true);
  const Results speed = joined(measured);
  const Pictures pictures(speed, folder / "plots");
  Document fast("Performance: results");
  fast.paragraph(
      "Written by scripts/bench.sh; do not edit. What is measured and how to read it: "
      "docs/performance.md. One point of a plot is one setting: its error (the first figure after "
      "the memory; smaller is better) against its CPU time. The lowest tick of an axis says with "
      "\"≤\" where smaller errors are drawn. Settings with a star are presets.");
  performance(measured, speed, pictures, fast);
  Document stable("Stability: results");
  stable.paragraph(
      "Written by scripts/bench.sh; do not edit. Every figure has a bound; the small cases of this "
      "page run in the tests (tests/benchmarks/stability_test.cpp), which fail where a bound is "
      "exceeded. What the groups mean: docs/stability.md.");
  stability(checked, joined(checked), stable);
  const std::pair<const char*, std::string> files[] = {
      {"index.html", fast.html + "<p><a href=\"stability.html\">Stability</a></p></body></html>\n"},
      {"performance.md", fast.markdown},
      {"stability.html",
       stable.html + "<p><a href=\"index.html\">Performance</a></p></body></html>\n"},
      {"stability.md", stable.markdown}};
  for (const auto& [name, text] : files)
    if (const Status s = write(folder / name, text); !s.ok()) return s;
  return {};
}

}  // namespace atlas::bench
