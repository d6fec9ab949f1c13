// Command lines that are wrong, odd or contradictory: the program prints one line that names the
// option and the remedy, exits with code 2, and writes nothing.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;

class Mistakes : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    dir_ = fs::temp_directory_path() / fmt::format("mistakes_{}_{}", info->name(), ::getpid());
    fs::create_directories(dir_ / "images");
    write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
    write("r.csv", "10,10\n");
  }
  void TearDown() override { fs::remove_all(dir_); }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name, std::ios::binary) << text;
  }
  long files() const {
    return std::distance(fs::recursive_directory_iterator(dir_),
                         fs::recursive_directory_iterator());
  }
  void expect_complaint(const std::string& program, const std::string& arguments,
                        const std::string& words) const {
    const long before = files();
    FILE* pipe = ::popen(
        fmt::format("cd '{}' && '{}' {} 2>&1", dir_.string(), program, arguments).c_str(), "r");
    std::string text;
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) text.append(buffer, n);
    const int status = ::pclose(pipe);
    EXPECT_EQ(WIFEXITED(status) ? WEXITSTATUS(status) : 128, 2) << arguments << "\n" << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_NE(text.find("error: " + words), text.npos) << arguments << "\n" << text;
    EXPECT_EQ(files(), before) << arguments;
  }
  fs::path dir_;
};

TEST_F(Mistakes, AMisspeltOptionIsTheReasonWhyAnotherIsMissing) {
  expect_complaint(ATLAS_EXPORT, "t.obj --ouput a.wrl",
                   "unknown option --ouput: is --output meant?");
  expect_complaint(ATLAS_EXPORT, "t.obj --otuput a.wrl",
                   "unknown option --otuput: is --output meant?");
  expect_complaint(ATLAS_EXPORT, "--atlas 3",
                   "unknown option --atlas: is --atlases or --atlas-size meant?");
  expect_complaint(ATLAS_EXPORT, "--hlep", "unknown option --hlep: is --help meant?");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --threshhold=1",
                   "unknown option --threshhold=1: is --threshold meant?");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --nope",
                   "unknown option or one name too many: --nope");
  expect_complaint(ATLAS_EXPORT, "-t.obj -o a.obj", "unknown option or one name too many: -t.obj");
  expect_complaint(ATLAS_PACK, "rects r.csv -o a.csv --extrude 2",
                   "unknown option or one name too many: --extrude");
}

// The first 120 bytes are shown, but no half of a character.
TEST_F(Mistakes, LongWordsAreToldByTheirBeginning) {
  std::string accents;
  for (int i = 0; i < 58; ++i) accents += "é";
  const std::string words = "unknown option or one name too many: ";
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --x" + accents + accents,
                   words + "--x" + accents + "... (--help");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --xy" + accents + accents,
                   words + "--xy" + accents + "... (--help");
  const std::string longest = "--" + std::string(118, 'y');
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj " + longest, words + longest + " (--help");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj " + longest + "yy", words + longest + "... (");
}

TEST_F(Mistakes, AMisspeltCommandIsToldBeforeItsOptions) {
  expect_complaint(ATLAS_PACK, "rect r.csv",
                   "'rect' is none of the commands rects, images, mesh: is rects meant? (--help "
                   "lists the commands)");
  expect_complaint(ATLAS_PACK, "image images -o a",
                   "'image' is none of the commands rects, images, mesh: is images meant?");
  expect_complaint(ATLAS_PACK, "image r.csv -o a",
                   "'image' is none of the commands rects, images, mesh: is images meant?");
  expect_complaint(ATLAS_PACK, "shelve r.csv -o a",
                   "'shelve' is none of the commands rects, images, mesh (--help");
  expect_complaint(ATLAS_PACK, "--nope", "unknown option or one name too many: --nope");
  expect_complaint(ATLAS_PACK, "", "the name of a command is needed first (--help lists the comma");
  expect_complaint(ATLAS_PACK, "rects", "sizes is required (rects --help lists the options)");
}

TEST_F(Mistakes, OptionsWithoutTheirValue) {
  expect_complaint(ATLAS_PLAY, "t.obj --headless --bench", "--bench needs a value after it");
  expect_complaint(ATLAS_PLAY, "t.obj --headless --north", "--north needs a value after it");
  expect_complaint(ATLAS_EXPORT, "t.obj --output", "--output needs a value after it");
  expect_complaint(ATLAS_PACK, "rects r.csv -o a.csv --budget", "--budget needs a value after it");
}

TEST_F(Mistakes, NumbersOutOfRangeAreToldTheirRangeAndUnit) {
  expect_complaint(ATLAS_PACK, "rects r.csv -o a.csv --page 3000000000x10",
                   "--page: '3000000000x10' must be WIDTHxHEIGHT, e.g. 2048x2048, with sides of "
                   "1..1073741824");
  expect_complaint(ATLAS_PACK, "rects r.csv -o a.csv --preset best --budget 1h",
                   "--budget: '1h' must be a duration such as 1s, 500ms or 2m (without a unit: "
                   "seconds)");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --memory 10",
                   "--memory 10: 10 bytes, less than the 21845 of a single page of 64 x 64");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --memory lots",
                   "--memory lots: give a size such as 800MB, in kB, MB");
}

TEST_F(Mistakes, NamesAreNotEmpty) {
  expect_complaint(ATLAS_EXPORT, "t.obj -o ''", "--output is empty");
  expect_complaint(ATLAS_EXPORT, "'' -o a.obj", "scene is empty");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --texel ''", "--texel is empty");
  expect_complaint(ATLAS_PACK, "images images -o ''", "--output is empty");
  expect_complaint(ATLAS_PACK, "images images -o ../",
                   "../: is a folder (add the pages' base name)");
  expect_complaint(ATLAS_PLAY, "t.obj --headless --screenshot ''", "--screenshot is empty");
}

TEST_F(Mistakes, AQuietPlanTellsNothing) {
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --plan -q", "--plan with --quiet tells nothing");
  expect_complaint(ATLAS_PLAY, "t.obj --plan -q", "--plan with --quiet tells nothing");
}

TEST_F(Mistakes, NumbersThatLeaveNoRoom) {
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --unit 1e300", "--unit 1e300: give m, cm");
  expect_complaint(ATLAS_EXPORT, "t.obj -o a.obj --unit 1e-300", "--unit 1e-300: give m, cm");
  for (const char* options :
       {"--border 1024 --padding 0 --align 1", "--border 0 --padding 2048 --align 1",
        "--border 0 --padding 0 --align 4096", "--border 1048576 --padding 0 --align 1048576"}) {
    std::string words = options;
    words.replace(words.find(" --padding"), 1, ", ");
    words.replace(words.find(" --align"), 1, " and ");
    expect_complaint(ATLAS_PACK, fmt::format("mesh t.obj -o a.obj {}", options), words);
  }
}

TEST_F(Mistakes, OptionsThatWouldChangeNothing) {
  expect_complaint(ATLAS_PACK, "rects r.csv -o a.csv --budget 1s", "--budget is for --preset best");
  expect_complaint(ATLAS_PACK, "rects r.csv -o a.csv --effort 9 --preset fast",
                   "--effort is for --preset best");
  expect_complaint(ATLAS_PACK, "images images -o a --no-trim --trim-threshold 5",
                   "--trim-threshold excludes --no-trim");
  const std::string play = "t.obj --headless --software ";
  expect_complaint(ATLAS_PLAY, play + "--view-distance 5", "--view-distance requires --fit-view");
  expect_complaint(ATLAS_PLAY, play + "-k 3 --interval-degrees 5", "--interval excludes");
  expect_complaint(ATLAS_PLAY, play + "--bench-frames 5", "--bench-frames requires --bench");
  expect_complaint(ATLAS_PLAY, play + "--bench b --record c", "--record excludes --bench");
  expect_complaint(ATLAS_PLAY, play + "--close-after 5", "--close-after is for a window");
  expect_complaint(ATLAS_PLAY, "t.obj --frames 5", "--frames is for --headless");
}

TEST_F(Mistakes, LightsAndDirectionsNameTheirOption) {
  const std::string play = "t.obj --headless --software ";
  expect_complaint(ATLAS_PLAY, play + "--north y",
                   "--north takes 3 values with commas between them");
  expect_complaint(ATLAS_PLAY, play + "--north 0,1,0,0",
                   "--north takes 3 values with commas between them, not 4");
  expect_complaint(ATLAS_PLAY, play + "--north 0,1,0", "--light sun:172,50.45,9: up and north");
  expect_complaint(ATLAS_PLAY, play + "--light sun:172,91,9",
                   "--light sun:172,91,9: the sun needs");
  expect_complaint(ATLAS_PLAY, play + "--light moon", "--light moon: the kinds are fixed,");
}

TEST_F(Mistakes, ConfigurationFilesAreNamedAndKeepTheTerminalClean) {
  write("c.ini", "nope=0\n");
  expect_complaint(ATLAS_PLAY, "t.obj --headless --config c.ini", "c.ini: 'nope' is no option");
  write("d.ini", "\x1b[2J\x07garbage\n");
  expect_complaint(ATLAS_PLAY, "t.obj --headless --config d.ini",
                   "d.ini: '?[2J?garbage' is no option");
  write("e.ini", "no-snap=maybe\n");
  expect_complaint(ATLAS_PLAY, "t.obj --headless --config e.ini",
                   "--no-snap maybe: is neither true nor false");
}

TEST_F(Mistakes, TheCabinsGeneratorComplainsAsTheOthersDo) {
  expect_complaint(ATLAS_MAKE_CABIN, "--ouput a.obj", "unknown option --ouput: is --output meant?");
  expect_complaint(ATLAS_MAKE_CABIN, "-o ''", "--output is empty");
  expect_complaint(ATLAS_MAKE_CABIN, "-o a.obj -o b.obj", "--output is given more than once");
  expect_complaint(ATLAS_MAKE_CABIN, "-o a.obj -n 5", "--triangles: '5' must be 10000..20000000");
  expect_complaint(ATLAS_MAKE_CABIN, "-o a.obj --up x", "--up: 'x' must be one of y, z");
  expect_complaint(ATLAS_MAKE_CABIN, "-o 'a\x1b[2J.txt'", "a?[2J.txt: unknown ending");
}

TEST_F(Mistakes, ThePreviewOfACabinIsNoneOfItsTextures) {
  expect_complaint(ATLAS_MAKE_CABIN, "-q -n 10000 -o cabin.obj --preview ./wood.png",
                   "./wood.png: is the name of a texture of the scene");
}

}  // namespace
