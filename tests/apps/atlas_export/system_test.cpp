// atlas-export under adverse conditions of the system: closed or full streams, too long names, no
// memory, signals.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>

#include "tests/support/program_output.h"
#include "tests/support/temp_folder.h"

namespace atlas {
namespace {

namespace fs = std::filesystem;
using test::TempFolder;

struct RunResult {
  int exit_code = -1;
  std::string output;
};

RunResult shell(const std::string& command) {
  RunResult result;
  FILE* pipe = ::popen(command.c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe))
    result.output.append(buffer, n);
  const int status = ::pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

// `arguments` may redirect streams. Returns what is still written to stderr.
RunResult run(const std::string& arguments) {
  return shell(fmt::format("{} {}", ATLAS_EXPORT, arguments));
}

constexpr const char* kTriangle = "v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 2 1 1\nf 1 2 3\n";

class System : public testing::Test {
 protected:
  void SetUp() override { scene_ = folder_.write("tri.obj", kTriangle).string(); }

  std::string to(const std::string& name) const { return (folder_ / name).string(); }

  TempFolder folder_;
  std::string scene_;
};

TEST_F(System, OutputThatNobodyTakes) {
  const std::string command = fmt::format("{} -o {} ", scene_, to("w.glb"));
  const RunResult full = run(command + "2>&1 >/dev/full");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_EQ(full.output, "atlas-export: error: standard output: No space left on device\n");
  EXPECT_EQ(run("nosuch.obj -o w.glb 2>/dev/full").exit_code, 1);
  // If the reader of its output ends at once, the program still completes the world.
  fs::remove(folder_ / "w.glb");
  (void)run(command + "| true");
  for (int i = 0; i < 200 && !fs::exists(folder_ / "w.glb"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_TRUE(fs::exists(folder_ / "w.glb"));
}

// As with `--help | head -1`.
TEST_F(System, HelpThatNobodyReadsToItsEnd) {
  const RunResult r = shell(fmt::format(
      "{{ {{ sleep 0.2; {} --help 2>&3; echo $? >&3; }} | true; }} 3>&1", ATLAS_EXPORT));
  EXPECT_EQ(r.output, "0\n");
  EXPECT_EQ(run("--help >/dev/full 2>&1").exit_code, 1);
}

// The system sends a signal in this case. By default it would end the program and leave incomplete
// files.
TEST_F(System, FilesThatMayNotGrow) {
  for (const char* name : {"w.wrl", "w.glb"}) {
    const RunResult r =
        shell(fmt::format("ulimit -f 1 && {} {} -q -o {} 2>&1", ATLAS_EXPORT, scene_, to(name)));
    EXPECT_EQ(r.exit_code, 1) << name;
    EXPECT_NE(r.output.find("File too large"), std::string::npos) << r.output;
    for (const auto& entry : fs::directory_iterator(folder_ / "."))
      EXPECT_EQ(entry.path().filename(), "tri.obj") << name;
  }
}

// Otherwise the first opened file would become standard output and receive its lines.
TEST_F(System, ClosedStreams) {
  ASSERT_EQ(run(fmt::format("{} -o {} -q", scene_, to("a.wrl"))).exit_code, 0);
  fs::create_directories(folder_ / "b");
  ASSERT_EQ(run(fmt::format("{} -o {} <&- >&- 2>&-", scene_, to("b/a.wrl"))).exit_code, 0);
  EXPECT_EQ(TempFolder::read(folder_ / "a.wrl"), TempFolder::read(folder_ / "b" / "a.wrl"));
  EXPECT_EQ(TempFolder::read(folder_ / "a_0.png"), TempFolder::read(folder_ / "b" / "a_0.png"));
}

TEST_F(System, NamesThatAreTooLong) {
  const std::string name(300, 'n');
  for (const std::string& arguments :
       {fmt::format("{} -o {}.glb", scene_, to(name)), fmt::format("{0}.obj -o {0}.glb", name),
        fmt::format("{} -o {} --report {}.json", scene_, to("w.glb"), to(name)),
        // Its own name would be short enough, but not those of its pages.
        fmt::format("{} -o {}.wrl", scene_, to(std::string(250, 'n')))}) {
    const RunResult r = run(arguments + " -q 2>&1");
    EXPECT_EQ(r.exit_code, 1) << r.output;
    EXPECT_EQ(std::count(r.output.begin(), r.output.end(), '\n'), 1) << r.output;
    EXPECT_EQ(folder_.count(), 1u);
  }
}

TEST_F(System, TexturesThatCannotBeLookedAtAreDefects) {
  folder_.write("m.mtl", "newmtl a\nmap_Kd " + std::string(300, 't') + ".png\n");
  folder_.write("t.obj",
                std::string("mtllib m.mtl\nusemtl a\nvt 0 0\nv 0 0 0 1 1 1\nv 1 0 0 1 1 1\n"
                            "v 0 1 0 1 1 1\nf 1/1 2/1 3/1\n"));
  const RunResult r = run(fmt::format("{} -o {} 2>&1", to("t.obj"), to("w.glb")));
  EXPECT_EQ(r.exit_code, 0) << r.output;
  EXPECT_NE(r.output.find("1 x textures that cannot be"), std::string::npos) << r.output;
}

TEST_F(System, ReportToAPipe) {
  const RunResult r = run(fmt::format("{} -o {} -q --report /dev/stdout", scene_, to("w.glb")));
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_EQ(r.output.substr(0, 1), "{");
  EXPECT_EQ(folder_.count(), 2u);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// Runs a command of the shell after it has limited itself to so many KiB of addresses.
RunResult run_limited(int kib, const std::string& command) {
  RunResult r;
  FILE* pipe = ::popen(fmt::format("ulimit -v {}; {} 2>&1", kib, command).c_str(), "r");
  char buffer[4096];
  while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe))
    r.output.append(buffer, n);
  const int status = ::pclose(pipe);
  r.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return r;
}

TEST_F(System, MemoryThatIsNotThere) {
  std::string obj;
  for (int i = 0; i < 60'000; ++i)
    obj += fmt::format("v {0} 0 0 1 1 1\nv {0} 1 0 1 1 1\nv {0} 1 1 1 1 1\nf -1 -2 -3\n", i);
  const fs::path scene = folder_.write("many.obj", obj);
  // With light, the module for image files would be what finds no room.
  const RunResult r = run_limited(50000, fmt::format("{} {} -o {} -q --threads 1 --charts-only",
                                                     ATLAS_EXPORT, scene.string(), to("w.glb")));
  EXPECT_EQ(r.exit_code, 1) << r.output;
  EXPECT_NE(r.output.find("many.obj: out of memory"), std::string::npos) << r.output;
  EXPECT_EQ(folder_.count(), 2u);
}

// OpenImageIO, which is for other formats than PNG and JPEG, would take 115 MiB.
TEST_F(System, ALitExportTakesLittleMemory) {
  for (const char* name : {"w.wrl", "w.glb", "w.obj"}) {
    const std::string report = to("r.json");
    ASSERT_EQ(run(fmt::format("{} -o {} --atlas-size 64 -q --report {}", scene_, to(name), report))
                  .exit_code,
              0);
    const std::string json = TempFolder::read(report);
    EXPECT_LT(test::json_field(json, "peak_mib"), 40) << name;
  }
  const RunResult r = run_limited(
      300000, fmt::format("{} {} -o {} --atlas-size 64 -q", ATLAS_EXPORT, scene_, to("v.glb")));
  EXPECT_EQ(r.exit_code, 0) << r.output;
}

// Root is not bound by a limit of processes. HOME is not known either.
class OrdinaryUser : public System {
 protected:
  void SetUp() override {
    System::SetUp();
    ASSERT_EQ(::chmod(folder_.path().c_str(), 0777), 0);
    if (shell(as_user(fmt::format("test -x {}", ATLAS_EXPORT))).exit_code != 0)
      GTEST_SKIP() << "the program is not accessible for another user";
  }
  static std::string as_user(const std::string& command) {
    if (::geteuid() != 0) return command;
    return "setpriv --reuid=65534 --regid=65534 --clear-groups " + command;
  }
  static RunResult run_few(int processes, const std::string& arguments) {
    return shell(fmt::format("env -u HOME prlimit --nproc={} {} 2>&1", processes,
                             as_user(fmt::format("{} {}", ATLAS_EXPORT, arguments))));
  }
};

TEST_F(OrdinaryUser, FewProcesses) {
  ASSERT_EQ(run(fmt::format("{} -o {} -q", scene_, to("a.glb"))).exit_code, 0);
  const std::string bytes = TempFolder::read(folder_ / "a.glb");  // which hold the name
  for (int processes = 1; processes <= 4; ++processes) {
    fs::remove(folder_ / "a.glb");
    const RunResult r =
        run_few(processes, fmt::format("{} -o {} -q --threads 4", scene_, to("a.glb")));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    EXPECT_EQ(r.output, "");
    EXPECT_TRUE(TempFolder::read(folder_ / "a.glb") == bytes) << processes;
  }
}

// Libraries that OpenImageIO needs would end the program where no thread can start.
TEST_F(OrdinaryUser, FewProcessesForOtherFormats) {
  for (int processes = 1; processes <= 4; ++processes) {
    const RunResult r = run_few(processes, fmt::format("{} -o {} -q --exr", scene_, to("b.glb")));
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_EQ(std::count(r.output.begin(), r.output.end(), '\n'), 1) << r.output;
    EXPECT_NE(r.output.find("more threads than the system grants"), std::string::npos) << r.output;
  }
}

// What so many threads reserve does not fit. oneTBB would end the program.
TEST_F(System, ThreadsThatCannotStart) {
  std::string obj;
  for (int i = 0; i < 14'400; ++i)
    obj += fmt::format("v {0} {1} 0\nv {2} {1} 0\nv {0} {3} 0\nf -1 -2 -3\n", i / 120, i % 120,
                       i / 120 + 1, i % 120 + 1);
  const fs::path scene = folder_.write("many.obj", obj);
  std::string first;
  for (const int threads : {1, 64, 250}) {
    const RunResult r =
        run_limited(600000, fmt::format("{} {} -o {} -q --charts-only --threads {}", ATLAS_EXPORT,
                                        scene.string(), to("w.obj"), threads));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    const std::string made = TempFolder::read(folder_ / "w.obj");
    if (first.empty()) first = made;
    EXPECT_EQ(made, first);
  }
}
#endif

TEST_F(System, ExtensionsInCapitals) {
  fs::rename(folder_ / "tri.obj", folder_ / "TRI.OBJ");
  for (const char* name : {"W.WRL", "V.GLB", "U.OBJ", "T.GLTF", "S.WRZ"}) {
    const RunResult r = run(fmt::format("{} -o {} -q 2>&1", to("TRI.OBJ"), to(name)));
    EXPECT_EQ(r.exit_code, 0) << r.output;
    EXPECT_TRUE(fs::exists(folder_ / name));
  }
  EXPECT_EQ(TempFolder::read(folder_ / "V.GLB").substr(0, 4), "glTF");
  EXPECT_FALSE(fs::exists(folder_ / "V_0.png"));  // the page is inside the .glb
  EXPECT_EQ(run(fmt::format("{0} -o {0} -q 2>&1", to("TRI.OBJ"))).exit_code, 2);
}

TEST_F(System, PagesOfAnEarlierExportAreNamed) {
  const std::string command = fmt::format("{} -o {}", scene_, to("w.wrl"));
  EXPECT_EQ(run(command).output.find("earlier"), std::string::npos);
  folder_.write("w_1.png", "old");
  folder_.write("w_2.png", "old");
  const RunResult r = run(command);
  EXPECT_EQ(r.exit_code, 0);
  EXPECT_NE(r.output.find("w_1.png to w_2.png: of an earlier export"), std::string::npos)
      << r.output;
  EXPECT_TRUE(fs::exists(folder_ / "w_2.png"));
  folder_.write("w_0.exr", "old");
  folder_.write("w_1.exr", "old");
  const std::string exr = run(command).output;
  EXPECT_NE(exr.find("w_0.exr to w_1.exr: of an earlier export with --exr"), std::string::npos)
      << exr;
  const std::string with = run(command + " --exr").output;
  EXPECT_NE(with.find(to("w_1.exr") + ": of an earlier export with more pages"), std::string::npos)
      << with;
}

TEST_F(System, ExrPagesOfAnEarlierExportAreNamedBesideAWorldThatHoldsItsImages) {
  const std::string command = fmt::format("{} -o {}", scene_, to("w.glb"));
  EXPECT_EQ(run(command + " --exr").output.find("earlier"), std::string::npos);
  EXPECT_NE(run(command).output.find(to("w_0.exr") + ": of an earlier export with --exr"),
            std::string::npos);
}

TEST_F(System, OnlyPagesThatFollowOnThoseOfTheWorldAreOfAnEarlierExport) {
  folder_.write("w_1.png", "old");
  folder_.write("w_3.png", "none of a row");
  const std::string one = to("w_1.png") + ": of an earlier export with more pages, no part of";
  EXPECT_NE(run(fmt::format("{} -o {}", scene_, to("w.wrl"))).output.find(one), std::string::npos);
  // These worlds have no images beside them.
  folder_.write("w_0.png", "old");
  for (const char* arguments : {"w.glb", "w.obj --charts-only", "w.glb --keep-scene --charts-only"})
    EXPECT_EQ(run(fmt::format("{} -o {}", scene_, to(arguments))).output.find("earlier"),
              std::string::npos)
        << arguments;
}

TEST_F(System, ScenesTooSmallForFloats) {
  folder_.write("tiny.obj", "v 0 0 0\nv 1e-39 0 0\nv 0 1e-39 0\nf 1 2 3\n");
  const RunResult r = run(fmt::format("{} -o {} 2>&1", to("tiny.obj"), to("w.glb")));
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.output.find("tiny.obj: the scene is 1.41421e-39 units across"), std::string::npos)
      << r.output;
}

TEST_F(System, OptionsThatContradictEachOtherAreNamed) {
  const RunResult r =
      run(fmt::format("{} -o {} --min-side 256 --atlas-size 64 2>&1", scene_, to("w.glb")));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.output.find("--min-side must be within 1..60 (--atlas-size 64, --mips 2)"),
            std::string::npos)
      << r.output;
  EXPECT_EQ(run(fmt::format("{} -o {} --memory 9MB --atlases 3 2>/dev/null", scene_, to("w.glb")))
                .exit_code,
            2);
  EXPECT_EQ(run(fmt::format("{} -o {} -q --memory 9000000TB", scene_, to("w.glb"))).exit_code, 0);
}

}  // namespace
}  // namespace atlas
