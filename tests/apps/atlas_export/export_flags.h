// Runs atlas-export on a lit box, to see what an option does.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/apps/atlas_export/run_export.h"

namespace atlas::test {

inline bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class ExportFlags : public AtlasExport {
 protected:
  void SetUp() override {
    AtlasExport::SetUp();
    write("box.obj", lit_box(4));
  }

  // Runs with {0} for the folder in the arguments.
  std::string done(const std::string& arguments) const {
    const RunResult r = run(fmt::format(fmt::runtime(arguments), dir_.string()));
    EXPECT_EQ(r.exit_code, 0) << arguments << "\n" << r.output;
    return r.output;
  }
  std::string plan(const std::string& options) const {
    return done("{0}/box.obj -o {0}/w.wrl --plan " + options);
  }
  nlohmann::json report(const std::string& arguments) const {
    done(arguments + " --report {0}/r.json");
    return nlohmann::json::parse(slurp(dir_ / "r.json"));
  }
};

}  // namespace atlas::test
