#include "benchmarks/page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "benchmarks/page/plots.h"

namespace atlas::bench {
namespace {

// A document that comes out as Markdown and as HTML.
class Document {
 public:
  explicit Document(const std::string& title) {
    markdown = "# " + title + "\n";
    html =
        "<!doctype html><meta charset=utf-8><title>" + title +
        "</title><style>body{font:15px sans-serif;max-width:76em;margin:2em auto;padding:0 1em}"
        "table{border-collapse:collapse;margin:1em 0}td,th{border:1px solid #ccc;padding:.2em .6em;"
        "text-align:right}td:first-child,th:first-child{text-align:left}.bad{background:#fcc}"
        "img{max-width:100%}</style><h1>" +
        title + "</h1>\n";
  }
  void heading(const std::string& text) {
    markdown += "\n## " + text + "\n\n";
    html += "<h2>" + escaped(text) + "</h2>\n";
  }
  void paragraph(const std::string& text) {
    markdown += "\n" + text + "\n";
    html += "<p>" + escaped(text) + "</p>\n";
  }
  void image(const std::string& file, const std::string& text) {
    markdown += fmt::format("\n![{}](plots/{})\n", text, file);
    html += fmt::format("<p><img src=\"plots/{}\" alt=\"{}\"></p>\n", file, escaped(text));
  }
  void table(const std::vector<std::string>& header,
             const std::vector<std::vector<std::string>>& rows) {
    std::string rule = "|";
    for (std::size_t i = 0; i < header.size(); ++i) rule += i ? "---:|" : "---|";
    markdown += "\n" + row_markdown(header) + rule + "\n";
    html += "<table>" + row_html(header, "th");
    for (const auto& row : rows) {
      markdown += row_markdown(row);
      html += row_html(row, "td");
    }
    html += "</table>\n";
  }

  std::string markdown, html;

 private:
  static std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text)
      result += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return result;
  }
  static std::string row_markdown(const std::vector<std::string>& cells) {
    std::string text = "|";
    for (std::string cell : cells) {
      std::replace(cell.begin(), cell.end(), '|', '/');
      text += " " + cell + " |";
    }
    return text + "\n";
  }
  static std::string row_html(const std::vector<std::string>& cells, const char* tag) {
    const bool bad = !cells.empty() && cells.back() == "EXCEEDED";
    std::string text = bad ? "<tr class=bad>" : "<tr>";
    for (const std::string& cell : cells) text += fmt::format("<{0}>{1}</{0}>", tag, escaped(cell));
    return text + "</tr>\n";
  }
};

Results joined(const PageInput& input) {
  Results all;
  for (const Results& r : input.files) {
    all.rows.insert(all.rows.end(), r.rows.begin(), r.rows.end());
    all.fits.insert(all.fits.end(), r.fits.begin(), r.fits.end());
    all.checks.insert(all.checks.end(), r.checks.begin(), r.checks.end());
  }
  return all;
}

void machines(const PageInput& input, Document& page) {
  page.heading("Machine and commands");
  std::vector<std::vector<std::string>> rows;
  double noise = 0;
  for (const Results& r : input.files) {
    const Machine& m = r.machine;
    rows.push_back({m.command, m.date, fmt::format("{}, {} cores", m.processor, m.cores), m.system,
                    m.compiler + ", " + m.build});
    for (const Row& row : r.rows)
      if (row.cpu_seconds > 0.05) noise = std::max(noise, row.cpu_spread);
  }
  page.table({"command", "date", "processor", "system", "compiler"}, rows);
  page.paragraph(fmt::format(
      "Times are CPU seconds (user and system, all threads), the least of the repeats; the largest "
      "spread between repeats of any row above 50 ms is {:.0f} %. Memory is the largest resident "
      "set "
      "while the stage ran, the mesh included. Every figure is a line of the JSON files that the "
      "commands above wrote.",
      100 * noise));
}

void stage_tables(const Results& all, Document& page, const std::vector<Plot>& plots,
                  const std::map<std::string, std::string>& undrawn) {
  std::vector<std::string> stages;
  for (const Row& row : all.rows)
    if (std::find(stages.begin(), stages.end(), row.stage) == stages.end())
      stages.push_back(row.stage);
  for (const std::string& stage : stages) {
    page.heading(stage);
    std::vector<std::string> header{"mesh", "setting", "in", "out", "CPU s", "MiB"};
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> names;
    for (const Row& row : all.rows)
      if (row.stage == stage && names.empty())
        for (const auto& [name, v] : row.values) names.push_back(name);
    header.insert(header.end(), names.begin(), names.end());
    for (const Row& row : all.rows) {
      if (row.stage != stage) continue;
      std::vector<std::string> cells{row.mesh, row.setting + (row.preset ? " *" : "")};
      if (!row.failure.empty()) {
        cells.push_back(row.failure);
        cells.resize(header.size());
        rows.push_back(cells);
        continue;
      }
      cells.push_back(fmt::format("{}", row.size_in));
      cells.push_back(fmt::format("{}", row.size_out));
      cells.push_back(fmt::format("{:.3g}", row.cpu_seconds));
      cells.push_back(fmt::format("{:.0f}", row.memory_mib));
      for (const std::string& name : names) cells.push_back(fmt::format("{:.4g}", row.value(name)));
      rows.push_back(cells);
    }
    page.table(header, rows);
    for (const Plot& plot : plots) {
      if (plot.file != "error_" + stage + ".svg" && plot.file != stage + ".svg") continue;
      const auto reason = undrawn.find(plot.file);
      if (reason == undrawn.end())
        page.image(plot.file, plot.title);
      else
        page.paragraph("No plot: " + reason->second);
    }
  }
}

void fit_table(const Results& all, Document& page) {
  page.heading("Cost against size");
  std::vector<std::vector<std::string>> rows;
  for (const Fit& f : all.fits)
    rows.push_back({f.stage, f.work, f.quantity == "cpu_seconds" ? "CPU time" : "memory",
                    fmt::format("{:.2f}", f.exponent),
                    fmt::format("{} .. {}", f.smallest, f.largest), fmt::format("{}", f.points)});
  page.table({"stage", "work", "quantity", "exponent", "triangles", "meshes"}, rows);
  rows.clear();
  for (const Row& row : all.rows) {
    if (row.stage != "baseline" || row.cpu_seconds <= 0) continue;
    for (const Row& other : all.rows)
      if (other.mesh == row.mesh && other.setting == "standard" && other.cpu_seconds > 0 &&
          (other.stage == "charts" || other.stage == "export"))
        rows.push_back(
            {row.mesh, other.stage, fmt::format("{:.1f}", other.cpu_seconds / row.cpu_seconds)});
  }
  page.paragraph(
      "Distance from the physical limit, in times \"parse the file and compute normals\":");
  page.table({"mesh", "stage", "times"}, rows);
}

void stability(const Results& all, Document& page) {
  std::size_t bad = 0;
  for (const Check& c : all.checks) bad += !c.holds();
  page.paragraph(fmt::format("{} figures, {} beyond their bound.", all.checks.size(), bad));
  std::vector<std::string> groups;
  for (const Check& c : all.checks)
    if (std::find(groups.begin(), groups.end(), c.group) == groups.end()) groups.push_back(c.group);
  for (const std::string& group : groups) {
    page.heading(group);
    std::vector<std::vector<std::string>> rows;
    for (const Check& c : all.checks)
      if (c.group == group)
        rows.push_back({c.stress, c.quantity, fmt::format("{:.4g}", c.value),
                        fmt::format("{:.4g}", c.bound), c.note, c.holds() ? "holds" : "EXCEEDED"});
    page.table({"stress", "quantity", "value", "bound", "reference or limit", ""}, rows);
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
  const Results all = joined(input);
  const std::vector<Plot> plots = make_plots(all);
  std::map<std::string, std::string> undrawn;
  for (const Plot& plot : plots)
    if (const Status s = draw(plot, folder / "plots"); !s.ok()) undrawn[plot.file] = s.message();

  Document performance("Performance");
  performance.paragraph(
      "Written by scripts/bench.sh, not by hand. One point a setting: its error (the first figure "
      "after the memory; smaller is better) against its CPU time. Settings with a star are "
      "presets.");
  machines(input, performance);
  fit_table(all, performance);
  for (const char* file : {"time_against_size.svg", "memory_against_size.svg"})
    for (const Plot& plot : plots)
      if (plot.file == file && !undrawn.count(file)) performance.image(file, plot.title);
  stage_tables(all, performance, plots, undrawn);
  Document stable("Stability");
  stable.paragraph(
      "Written by scripts/bench.sh, not by hand. Every figure has a bound; the small cases of this "
      "page run in the tests, which fail where a bound is exceeded.");
  machines(input, stable);
  stability(all, stable);
  const std::pair<const char*, const std::string&> files[] = {
      {"index.html", performance.html},
      {"performance.md", performance.markdown},
      {"stability.html", stable.html},
      {"stability.md", stable.markdown}};
  for (const auto& [name, text] : files)
    if (const Status s = write(folder / name, text); !s.ok()) return s;
  return {};
}

}  // namespace atlas::bench
