// Options that say where seams run and which uvs stay.
#include <sstream>
#include <utility>

#include "tests/apps/atlas_export/export_flags.h"

namespace atlas::test {
namespace {

TEST_F(ExportFlags, SeamsAreCut) {
  std::istringstream lines(slurp(dir_ / "box.obj"));
  std::string seams;
  int faces = 0;
  for (std::string line; std::getline(lines, line);) {
    int a = 0, b = 0, c = 0, d = 0;
    if (line.starts_with("v ")) seams += line + "\n";
    if (std::sscanf(line.c_str(), "f %d %d %d %d", &a, &b, &c, &d) != 4) continue;
    seams += fmt::format("l {} {} {} {} {}\n", a, b, c, d, a);
    ++faces;
  }
  write("seams.obj", seams);
  const auto charts = [&](const std::string& options) {
    return report("{0}/box.obj -o {0}/w.obj --charts-only " + options)["charts"]["count"]
        .get<int>();
  };
  EXPECT_LT(charts(""), 10);
  EXPECT_EQ(charts("--seams {0}/seams.obj"), faces);
  const RunResult none =
      run(fmt::format("{0}/box.obj -o {0}/v.obj --seams {0}/box.obj", dir_.string()));
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_TRUE(holds(none.output, "no polyline")) << none.output;
}

TEST_F(ExportFlags, LikeKeepsAnEarlierExport) {
  done("{0}/box.obj -o {0}/old.obj --charts-only");
  const auto again = report("{0}/box.obj -o {0}/new.obj --charts-only --like {0}/old.obj");
  EXPECT_EQ(again["charts"]["like"]["made"], 0);
  EXPECT_EQ(again["charts"]["like"]["kept"], again["charts"]["count"]);
  const auto uvs = [&](const char* file) {
    const std::string text = slurp(dir_ / file);
    return text.substr(text.find("\nvt "));
  };
  EXPECT_EQ(uvs("old.obj"), uvs("new.obj"));
  // The scene's own file has none.
  EXPECT_TRUE(holds(done("{0}/box.obj -o {0}/v.obj --charts-only --like {0}/box.obj"),
                    "nothing of the earlier uvs stays"));
  const RunResult lit =
      run(fmt::format("{0}/box.obj -o {0}/l.obj --like {0}/old.obj", dir_.string()));
  EXPECT_EQ(lit.exit_code, 2);
  EXPECT_TRUE(holds(lit.output, "--like: this scene carries light")) << lit.output;
}

TEST_F(ExportFlags, LikeFindsTheTilesAndPagesOfItsFile) {
  for (const char* pages : {"--atlases 3 --atlas-size 64", "--atlases 3 --atlas-size 64 --udim"}) {
    const std::string options = std::string(" --charts-only ") + pages;
    const auto first = report("{0}/box.obj -o {0}/old.obj" + options);
    ASSERT_GT(first["packing"]["pages"].size(), 1u) << pages;
    const auto again = report("{0}/box.obj -o {0}/new.obj --like {0}/old.obj" + options);
    EXPECT_EQ(again["charts"]["like"]["kept"], first["charts"]["count"]) << pages;
  }
}

TEST_F(ExportFlags, WithoutMinFillNoChartIsCutForThePage) {
  // A cross of long arms: flat, so one chart, of which the page would stay mostly empty.
  std::string cross;
  for (const double arm : {0.0, 1.0})
    for (const double end : {-10.0, 10.0}) {
      const auto vertex = [&](double along, double across) {
        cross += arm == 0 ? fmt::format("v {} {} 0\n", along, across)
                          : fmt::format("v {} {} 0\n", across, along);
      };
      const double near = end < 0 ? -0.5 : 0.5;
      vertex(near, -0.5), vertex(end, -0.5), vertex(end, 0.5), vertex(near, 0.5);
    }
  cross += "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\nf 13 14 15 16\nf 1 5 8 4\n";
  write("cross.obj", cross);
  const auto charts = [&](const std::string& options) {
    return report("{0}/cross.obj -o {0}/w.obj --charts-only --square " + options)["charts"]["count"]
        .get<int>();
  };
  EXPECT_GT(charts(""), 1);
  EXPECT_EQ(charts("--min-fill 0"), 1);
}

}  // namespace
}  // namespace atlas::test
