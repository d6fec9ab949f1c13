#include "benchmarks/rivals/rivals.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "libatlas/core/clock.h"
#include "libatlas/pipeline/export_world.h"
#include "tests/support/atlas_measure.h"

namespace atlas::bench {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("atlas_rival_{}", ::getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

double children_cpu() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return double(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * double(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string filled_in(std::string command, const std::string& key, const fs::path& path) {
  for (std::size_t at; (at = command.find(key)) != std::string::npos;)
    command.replace(at, key.size(), quoted(path.string()));
  return command;
}

// Returns ": " and the last line of a program's error output, or "" if there is none.
std::string last_line(const fs::path& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string text; std::getline(file, text);)
    if (!text.empty()) last = ": " + text.substr(0, 120);
  return last;
}

// Returns how a rival failed, or "" if it did not. `timeout` reports 124, or 137 where it had to
// kill; programs may end so by themselves, and run out of memory, which only the time tells apart.
std::string failure_of(int status, double wall, const Rival& rival, const fs::path& complaints) {
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (code == 0) return "";
  if ((code == 124 || code == 137) && wall >= rival.timeout)
    return fmt::format("timed out after {} s", rival.timeout);
  if (code > 128)  // how a shell reports a signal
    return fmt::format("ended by signal {} ({}){}", code - 128, ::strsignal(code - 128),
                       last_line(complaints));
  return fmt::format("ended with code {}{}", code, last_line(complaints));
}

Row unwrap_row(const StageRun& run, const std::string& name) {
  Row row = run.staged.row("unwrap", name, true);
  row.unit = "triangles -> charts";
  return row;
}

struct PageSize {
  int width, height;
};

// Returns the size in a comment "# page WIDTH HEIGHT" before the first face of the file, or else a
// square.
PageSize page_of(const fs::path& path, int side) {
  std::ifstream file(path);
  for (std::string text; std::getline(file, text) && !text.starts_with("f ");) {
    PageSize page{};
    if (std::sscanf(text.c_str(), "# page %d %d", &page.width, &page.height) == 2 &&
        std::min(page.width, page.height) > 0)
      return page;
  }
  return {side, side};
}

// Measures the output. The row's error is L2 - 1; the seams, which trade against it, are added.
void judge(const fs::path& path, PageSize page, Row& row) {
  const Result<test::UvMesh> mesh = test::read_uv_obj(path);
  if (!mesh.ok()) {
    row.failure = mesh.status().message();
    return;
  }
  if (mesh->faces.empty()) {  // their stretch would be that of nothing
    row.failure = "wrote no uvs";
    return;
  }
  const test::AtlasMeasures m = test::measure_atlas(*mesh, page.width, page.height);
  row.size_out = m.charts;
  row.values = {{"l2_minus_1", m.stretch_l2 - 1},
                {"p999", m.stretch_999},
                {"seam", m.seam},
                {"util", m.utilization},
                {"overlap", double(m.overlap)},
                {"bleed", double(m.bleed)},
                {"flipped", double(m.flipped)},
                {"without_uv", double(m.faces_without_uv)}};
}

}  // namespace

Result<Rival> parse_rival(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || text.find("{in}") == std::string::npos ||
      text.find("{out}") == std::string::npos)
    return Status{ErrorCode::bad_option,
                  text + ": a rival is \"name=command {in} {out}\", with both files in it"};
  return Rival{text.substr(0, equals), text.substr(equals + 1)};
}

void bench_rival(const StageRun& run, const Rival& rival) {
  const Folder folder;
  const fs::path in = folder.path / "in.obj", out = folder.path / "out.obj";
  Row row = unwrap_row(run, rival.name);
  if (const Status s = write_plain_obj(run.staged.scene(), in, false); !s.ok()) {
    row.failure = s.message();
    return run.done(row);
  }
  const std::string command = filled_in(filled_in(rival.command, "{in}", in), "{out}", out);
  const double cpu = children_cpu(), wall = wall_seconds();
  const fs::path complaints = folder.path / "stderr.txt";
  const int code = std::system(fmt::format("timeout -k 2 {} sh -c {} >/dev/null 2>{} </dev/null",
                                           rival.timeout, quoted(command), quoted(complaints))
                                   .c_str());
  row.cpu_seconds = children_cpu() - cpu;
  row.wall_seconds = wall_seconds() - wall;
  row.failure = failure_of(code, row.wall_seconds, rival, complaints);
  if (!row.failure.empty())
    row.cpu_seconds = 0;  // of processes that were ended with their shell, nobody knows it
  else
    judge(out, page_of(out, rival.page), row);
  run.done(row);
}

void bench_ours(const StageRun& run, int page) {
  const Folder folder;
  const fs::path in = folder.path / "in.obj";
  Row row = unwrap_row(run, "libatlas");
  if (const Status s = write_plain_obj(run.staged.scene(), in, false); !s.ok()) {
    row.failure = s.message();
    return run.done(row);
  }
  ExportOptions options;
  options.target = folder.path / "out.obj";
  options.charts_only = true;
  options.atlas_size = page;
  in_own_process(row, run.done, [&](const TakeRow& take) {
    PageSize written{page, page};
    measure(run.repeats, row, [&]() -> Status {
      const Result<LoadedScene> scene = read_scene(in, {}, run.staged.context);
      if (!scene.ok()) return scene.status();
      const Result<ExportReport> report = export_world(*scene, options, {}, run.staged.context);
      if (report.ok() && !report->pages.empty())
        written = {report->pages[0].width, report->pages[0].height};
      return report.status();
    });
    if (row.failure.empty()) judge(options.target, written, row);
    take(row);
  });
}

}  // namespace atlas::bench
