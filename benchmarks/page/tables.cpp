#include "benchmarks/page/tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace atlas::bench {
namespace {

// Returns whether a row was measured normally, that is not in a thread series and without counted
// instructions.
bool ordinary(const Row& row) {
  return row.threads == 0 && row.instructions == 0;
}

const Row* find_row(const Results& all, const std::string& stage, const std::string& mesh,
                    const std::string& setting) {
  for (const Row& row : all.rows)
    if (ordinary(row) && row.failure.empty() && row.stage == stage && row.mesh == mesh &&
        row.setting == setting)
      return &row;
  return nullptr;
}

// Returns whether a value is the CPU seconds of a part instead of a quality. Parts have their own
// table.
bool is_part(const std::string& name) {
  return name.size() > 4 && name.compare(name.size() - 4, 4, "_cpu") == 0;
}

std::vector<std::string> value_names(const Results& all, const std::string& stage) {
  for (const Row& row : all.rows) {
    if (row.stage != stage || row.values.empty()) continue;
    std::vector<std::string> names;
    for (const auto& [name, v] : row.values)
      if (!is_part(name)) names.push_back(name);
    return names;
  }
  return {};
}

// Returns the value of that name, or "-" if the row has none or nothing that is a number: 0 would
// be the best there is.
std::string value_text(const Row& row, const std::string& name) {
  const double value = row.value(name, NAN);
  return std::isnan(value) ? "-" : figure(value);
}

std::string verdict(bool met) {
  return met ? "met" : "missed";
}

const Fit* find_fit(const Results& all, const std::string& stage, const std::string& work,
                    const std::string& quantity) {
  for (const Fit& f : all.fits)
    if (f.stage == stage && f.work == work && f.quantity == quantity) return &f;
  return nullptr;
}

// Returns the two largest cabins that were exported with standard settings, or null if there are
// fewer than two.
std::pair<const Row*, const Row*> largest_exports(const Results& all) {
  std::vector<const Row*> found;
  for (const Row& row : all.rows)
    if (ordinary(row) && row.stage == "export" && row.setting == "standard" &&
        row.failure.empty() && row.mesh.rfind("cabin:", 0) == 0)
      found.push_back(&row);
  if (found.size() < 2) return {nullptr, nullptr};
  std::sort(found.begin(), found.end(),
            [](const Row* a, const Row* b) { return a->triangles < b->triangles; });
  if (found.back()->triangles == found[found.size() - 2]->triangles) return {nullptr, nullptr};
  return {found[found.size() - 2], found.back()};
}

}  // namespace

std::string figure(double value) {
  if (std::isfinite(value) && std::abs(value) >= 1000 && std::abs(value) < 1e12)
    return fmt::format("{:.0f}", value);
  // Stretches begin at 1: what tells settings apart are the digits behind it.
  if (value > 1 && value < 2) return fmt::format("{:.4f}", value);
  return fmt::format("{:.4g}", value);
}

void goals_table(const Results& all, Document& page) {
  std::vector<Cells> rows;
  for (const auto& [quantity, name, bound] :
       {std::tuple{"cpu_seconds", "exponent of CPU time against triangles", 1.1},
        std::tuple{"memory_mib", "exponent of memory against triangles", 1.05}}) {
    const Fit* fit = find_fit(all, "export", "cabin, standard", quantity);
    if (!fit) continue;
    rows.push_back({fmt::format("whole export, cabin, {} to {}", fit->smallest, fit->largest), name,
                    fmt::format("{:.3f}", fit->exponent), fmt::format("{}", bound),
                    verdict(fit->exponent <= bound)});
  }
  // The fit hides the last increase, because pages of a fixed size cost the same for small meshes.
  const auto [smaller, larger] = largest_exports(all);
  if (larger && smaller->cpu_seconds > 0) {
    const double size = std::log(double(larger->triangles) / double(smaller->triangles));
    const double time = std::log(larger->cpu_seconds / smaller->cpu_seconds) / size;
    const double memory = std::log(larger->memory_mib / smaller->memory_mib) / size;
    const std::string what = smaller->mesh + " to " + larger->mesh + " alone";
    rows.push_back(
        {what, "exponent of CPU time", fmt::format("{:.3f}", time), "1.1", verdict(time <= 1.1)});
    rows.push_back({what, "exponent of memory", fmt::format("{:.3f}", memory), "1.05",
                    verdict(memory <= 1.05)});
  }
  for (const Row& row : all.rows) {
    if (!ordinary(row) || row.stage != "charts" || row.setting != "standard") continue;
    if (row.triangles < 900000 || row.triangles > 1200000) continue;
    const Row* limit = find_row(all, "baseline", row.mesh, "parse + normals");
    if (!limit || !row.failure.empty()) continue;
    const double times = row.cpu_seconds / limit->cpu_seconds;
    rows.push_back({"charts + parameterisation, " + row.mesh, "times \"parse + normals\"",
                    fmt::format("{:.1f}", times), "12", verdict(times <= 12)});
  }
  if (rows.empty()) return;
  page.heading("Goals");
  page.table({"what", "figure", "value", "goal", ""}, rows);
}

void fits_table(const Results& all, Document& page) {
  std::vector<Cells> rows;
  for (const Fit& f : all.fits)
    rows.push_back({f.stage, f.work, f.quantity == "cpu_seconds" ? "CPU time" : "memory",
                    fmt::format("{:.2f}", f.exponent),
                    fmt::format("{} .. {}", f.smallest, f.largest), fmt::format("{}", f.points)});
  if (!rows.empty())
    page.table({"stage", "work", "quantity", "exponent", "triangles", "meshes"}, rows);
}

void limit_table(const Results& all, Document& page) {
  std::vector<Cells> rows;
  for (const Row& row : all.rows) {
    if (!ordinary(row) || row.stage != "baseline" || row.cpu_seconds <= 0) continue;
    const Row* charts = find_row(all, "charts", row.mesh, "standard");
    const Row* whole = find_row(all, "export", row.mesh, "standard");
    const auto times = [&](double seconds) {
      return fmt::format("{:.1f}", seconds / row.cpu_seconds);
    };
    Cells cells{row.mesh, fmt::format("{:.3f}", row.cpu_seconds)};
    if (charts) {
      const double param = charts->value("param_cpu");
      cells.insert(cells.end(),
                   {times(charts->cpu_seconds - param), times(param), times(charts->cpu_seconds)});
    }
    cells.resize(5, "");
    cells.push_back(whole ? times(whole->cpu_seconds) : "");
    cells.push_back(row.source);
    rows.push_back(cells);
  }
  if (rows.empty()) return;
  page.paragraph(
      "The distance from the physical limit: CPU time in multiples of \"parse the OBJ and compute "
      "its normals\". Charts = segmentation + parameterisation; their parts stand below.");
  page.table({"mesh", "parse + normals, s", "segmentation", "parameterisation", "charts",
              "whole export", "JSON"},
             rows);
}

namespace {

struct Part {
  const char *name, *what;
};
// The parts of make_charts, as Row::values names them, with what each does and why it takes time.
constexpr Part kParts[] = {
    {"topology_cpu", "welding, edge links and pieces: every triangle once, by counting sorts"},
    {"noise_cpu", "normals without scan noise"},
    {"cells_cpu", "micro-cells: Dijkstra's algorithm over all triangles, three times"},
    {"coarse_cpu", "the cells' coarse mesh, on which candidates are tried"},
    {"merging_cpu",
     "merging: every candidate pair is flattened on trial, and each chart that grows makes new "
     "candidates"},
    {"borders_cpu", "shortening the borders"},
    {"cuts_cpu", "charts cut open, or divided where the bound does not hold"},
    {"solve_cpu",
     "isometric descent: sparse systems of every chart's vertices, several a chart, and more for "
     "the charts beyond the bound"},
    {"flips_cpu", "flips turned"},
    {"overlaps_cpu", "overlaps found and drawn apart, exactly"},
    {"absorb_cpu", "fragments joined again: each is tried with its neighbours"},
    {"limbs_cpu", "limbs cut"}};

// Returns the parts that take most of a charts row, as "merging 40 %, isometric descent 22 %".
std::string dearest_parts(const Row& row) {
  std::vector<std::pair<double, const Part*>> order;
  for (const Part& part : kParts) order.emplace_back(row.value(part.name), &part);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{}{:.0f} % {}", i ? "; " : "", 100 * order[i].first / row.cpu_seconds,
                        order[i].second->what);
  return text;
}

}  // namespace

void parts_table(const Results& all, Document& page) {
  Cells header{"mesh", "charts, s"};
  for (const Part& part : kParts)
    header.push_back(std::string(part.name).substr(0, std::string(part.name).size() - 4));
  header.insert(header.end(), {"the rest", "JSON"});
  std::vector<Cells> rows;
  std::vector<std::string> reasons;
  for (const Row& row : all.rows) {
    if (!ordinary(row) || row.stage != "charts" || row.setting != "standard") continue;
    const Row* limit = find_row(all, "baseline", row.mesh, "parse + normals");
    if (!limit || !row.failure.empty() || std::isnan(row.value("merging_cpu", NAN))) continue;
    if (row.mesh.rfind("file:", 0) == 0) continue;
    Cells cells{row.mesh, fmt::format("{:.2f}", row.cpu_seconds)};
    double rest = row.cpu_seconds;
    for (const Part& part : kParts) {
      rest -= row.value(part.name);
      cells.push_back(fmt::format("{:.1f}", row.value(part.name) / limit->cpu_seconds));
    }
    cells.insert(cells.end(), {fmt::format("{:.1f}", rest / limit->cpu_seconds), row.source});
    rows.push_back(cells);
    if (row.triangles > 900000 && row.cpu_seconds > 12 * limit->cpu_seconds)
      reasons.push_back(fmt::format("{}, {:.1f} times: {}.", row.mesh,
                                    row.cpu_seconds / limit->cpu_seconds, dearest_parts(row)));
  }
  if (rows.empty()) return;
  page.heading("Where charts + parameterisation spend it");
  page.paragraph(
      "In multiples of \"parse the OBJ and compute its normals\", as above; CPU time of all "
      "threads. Up to borders the parts are segmentation's, from cuts on parameterisation's.");
  page.table(header, rows);
  if (reasons.empty()) return;
  page.paragraph("Beyond twelve times, and what takes most of it there:");
  for (const std::string& reason : reasons) page.paragraph(reason);
}

void export_table(const Results& all, Document& page) {
  std::vector<std::string> stages;
  std::vector<const Row*> meshes;  // the first row of each
  std::map<std::string, std::map<std::string, const Row*>> table;
  for (const Row& row : all.rows) {
    if (!ordinary(row) || row.stage.rfind("export/", 0) != 0) continue;
    const std::string stage = row.stage.substr(7);
    if (std::find(stages.begin(), stages.end(), stage) == stages.end()) stages.push_back(stage);
    if (!table.count(row.mesh)) meshes.push_back(&row);
    table[row.mesh].emplace(stage, &row);
  }
  if (meshes.empty()) return;
  Cells header{"mesh"};
  header.insert(header.end(), stages.begin(), stages.end());
  header.push_back("JSON");
  std::vector<Cells> rows;
  for (const Row* first : meshes) {
    const std::map<std::string, const Row*>& of_mesh = table[first->mesh];
    Cells cells{first->mesh};
    for (const std::string& stage : stages) {
      const auto found = of_mesh.find(stage);
      cells.push_back(found == of_mesh.end() ? "-"
                                             : fmt::format("{:.2f}", found->second->cpu_seconds));
    }
    cells.push_back(first->source);
    rows.push_back(cells);
  }
  page.heading("Where the whole export spends its CPU seconds");
  page.paragraph("Standard settings; the JSON column names the first line of each mesh's stages.");
  page.table(header, rows);
}

void instructions_table(const Results& all, Document& page) {
  std::vector<Cells> rows;
  for (const Row& row : all.rows)
    if (row.instructions > 0)
      rows.push_back({row.stage, row.setting, row.mesh,
                      fmt::format("{:.2f}", row.instructions * 1e-6),
                      fmt::format("{:.0f}", row.instructions / double(row.triangles)), row.source});
  if (rows.empty()) return;
  page.heading("Instructions");
  page.paragraph(
      "Counted by callgrind on one thread: free of the machine's noise, which is what "
      "atlas-bench-compare wants.");
  page.table({"stage", "setting", "mesh", "million", "a triangle", "JSON"}, rows);
}

void rivals_table(const Results& all, Document& page) {
  const std::vector<std::string> names = value_names(all, "unwrap");
  Cells header{"mesh", "program", "triangles", "charts", "CPU s", "wall s"};
  header.insert(header.end(), names.begin(), names.end());
  header.push_back("JSON");
  std::vector<Cells> rows;
  for (const Row& row : all.rows) {
    if (!ordinary(row) || row.stage != "unwrap") continue;
    Cells cells{row.mesh, row.setting, fmt::format("{}", row.triangles)};
    if (row.failure.empty()) {
      cells.push_back(fmt::format("{}", row.size_out));
      cells.push_back(fmt::format("{:.2f}", row.cpu_seconds));
      cells.push_back(fmt::format("{:.2f}", row.wall_seconds));
      for (const std::string& name : names) cells.push_back(value_text(row, name));
    } else {
      // The CPU time of processes that a timeout ended is not known.
      cells.insert(cells.end(), {row.failure, "", fmt::format("{:.2f}", row.wall_seconds)});
    }
    cells.resize(header.size() - 1);
    cells.push_back(row.source);
    rows.push_back(cells);
  }
  if (rows.empty()) return;
  page.heading("Beside other programs");
  page.paragraph(
      "The same OBJ file for every program, everything judged by the same evaluator "
      "(tests/support/atlas_measure) on pages of the size that its program made. Reading and "
      "writing files is part of the time. The others are programs that are started, and stopped at "
      "a "
      "timeout; libatlas is called as a library. See benchmarks/rivals/README.md for how each is "
      "called.");
  page.table(header, rows);
}

void stage_table(const Results& all, const std::string& stage, Document& page) {
  const std::vector<std::string> names = value_names(all, stage);
  Cells header{"mesh", "setting", "in", "out", "CPU s", "MiB", "of it input"};
  header.insert(header.end(), names.begin(), names.end());
  header.push_back("JSON");
  std::vector<Cells> rows;
  for (const Row& row : all.rows) {
    if (row.stage != stage || !ordinary(row)) continue;
    Cells cells{row.mesh, row.setting + (row.preset ? " *" : "")};
    if (row.failure.empty()) {
      cells.insert(cells.end(),
                   {fmt::format("{}", row.size_in), fmt::format("{}", row.size_out),
                    fmt::format("{:.3g}", row.cpu_seconds), fmt::format("{:.0f}", row.memory_mib),
                    row.input_mib > 0 ? fmt::format("{:.0f}", row.input_mib) : "-"});
      for (const std::string& name : names) cells.push_back(value_text(row, name));
    } else {
      cells.push_back(row.failure);
    }
    cells.resize(header.size() - 1);
    cells.push_back(row.source);
    rows.push_back(cells);
  }
  page.table(header, rows);
}

std::vector<std::string> stages_of(const Results& all) {
  std::vector<std::string> stages;
  for (const Row& row : all.rows)
    if (ordinary(row) && row.stage != "unwrap" && row.stage.rfind("export/", 0) != 0 &&
        std::find(stages.begin(), stages.end(), row.stage) == stages.end())
      stages.push_back(row.stage);
  return stages;
}

}  // namespace atlas::bench
