// atlas-bench-page RESULT.json... -o FOLDER: draws the page.
#include <fmt/format.h>
#include <cstdio>

#include <CLI/CLI.hpp>

#include "apps/common/options.h"
#include "benchmarks/page/page.h"

int main(int argc, char** argv) {
  using namespace atlas::bench;
  CLI::App app("Draws the benchmark page from result files.", "atlas-bench-page");
  std::vector<std::string> files;
  std::string folder = "out/bench";
  app.add_option("files", files, "of atlas-bench, atlas-bench-leak, atlas-bench-stability")
      ->required();
  app.add_option("-o,--out", folder, "folder to write into")->capture_default_str();
  if (const int code = atlas::app::parse(app, argc, argv); code >= 0) return code;
  PageInput input;
  for (const std::string& file : files) {
    auto results = load(file);
    if (!results.ok()) {
      fmt::print(stderr, "atlas-bench-page: {}\n", results.status().message());
      return 1;
    }
    input.files.push_back(std::move(*results));
  }
  if (const atlas::Status s = write_page(input, folder); !s.ok()) {
    fmt::print(stderr, "atlas-bench-page: {}\n", s.message());
    return 1;
  }
  if (machine_count(input.files) > 1)
    fmt::print(stderr,
               "atlas-bench-page: the results are of different machines or builds; run the whole "
               "bench on one to compare times\n");
  fmt::print("{}/index.html\n", folder);
  return 0;
}
