// Tests headless playing: pictures, and what ends it early.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <utility>

#include "libatlas/image/image_io.h"
#include "libatlas/view/play.h"
#include "tests/support/full_disk.h"
#include "tests/view/play_folder.h"
#include "tests/view/shapes.h"

namespace atlas::testing {
namespace {

namespace fs = std::filesystem;

using Play = Folder;

// A courtyard that is ready to be played, small and in three frames.
struct Show {
  Show() {
    options.camera = view.camera;
    options.light = *LightPath::make({});
    options.frames = 3;
  }
  Result<PlaySummary> play(const Context& context = {}) {
    return play_headless(test_context(), renderer, options, context);
  }

  View view = courtyard_view();
  Renderer renderer = must_render(view.scene, small());
  PlayOptions options;
};

TEST_F(Play, RecordsNumberedPicturesAndTheLastOne) {
  Show show;
  PlayOptions& o = show.options;
  o.record = path_ / "series";
  o.screenshot = path_ / "last.png";
  const Result<PlaySummary> done = show.play();
  ASSERT_TRUE(done.ok()) << done.status().message();
  EXPECT_EQ(done->frames, 3);
  EXPECT_EQ(done->recorded, 3);
  for (const char* name : {"frame00000.png", "frame00001.png", "frame00002.png"}) {
    const Result<Image8> image = read_image8(o.record / name);
    ASSERT_TRUE(image.ok());
    EXPECT_EQ(image->width, 48);
  }
  EXPECT_EQ(read_image8(o.record / "frame00002.png")->texels, read_image8(o.screenshot)->texels);
}

TEST_F(Play, AFullDiskLeavesNoPicture) {
  Show show;
  PlayOptions& o = show.options;
  for (auto* file : {&o.screenshot, &o.record}) {
    o.screenshot.clear();
    o.record.clear();
    *file = path_ / "p.png";
    if (file == &o.screenshot) std::ofstream(*file) << "what was there before";
    const test::FullDisk full(200);
    const Result<PlaySummary> done = show.play();
    ASSERT_EQ(done.status().code(), ErrorCode::io);
    EXPECT_NE(done.status().message().find("p.png"), std::string::npos);
    EXPECT_EQ(done.status().message().find(".part"), std::string::npos) << done.status().message();
    if (file == &o.screenshot) {
      EXPECT_EQ(fs::file_size(*file), 21u);  // unchanged
      fs::remove(*file);
    }
    EXPECT_TRUE(fs::is_empty(file == &o.record ? *file : path_));
  }
}

TEST_F(Play, ErrorsAreOneLine) {
  Show show;
  PlayOptions& o = show.options;
  std::ofstream(path_ / "file") << "x";
  o.record = path_ / "file" / "series";
  const Result<PlaySummary> done = show.play();
  ASSERT_FALSE(done.ok());
  EXPECT_EQ(done.status().code(), ErrorCode::io);
  EXPECT_EQ(done.status().message().find('\n'), std::string::npos);
  std::atomic<bool> cancel = true;
  Context context;
  context.cancel = &cancel;
  o.record.clear();
  EXPECT_EQ(show.play(context).status().code(), ErrorCode::cancelled);
}

TEST_F(Play, ALostContextIsOneLineThatSaysWhy) {
  Show show;
  GlContext& gl = test_context();
  EXPECT_TRUE(gl.check_alive().ok());
  const std::pair<unsigned, const char*> cases[] = {{GL_GUILTY_CONTEXT_RESET, "this program"},
                                                    {GL_INNOCENT_CONTEXT_RESET, "another program"},
                                                    {GL_UNKNOWN_CONTEXT_RESET, "does not tell"}};
  for (const auto& [reset, reason] : cases) {
    int frames = 0;
    gl.set_reset_source([&, after = reset] { return ++frames < 2 ? GL_NO_ERROR : after; });
    const Result<PlaySummary> done = show.play();
    gl.set_reset_source({});
    ASSERT_FALSE(done.ok());
    EXPECT_EQ(frames, 2) << "nothing is drawn after the reset";
    EXPECT_EQ(done.status().code(), ErrorCode::unsupported);
    EXPECT_NE(done.status().message().find("context is lost"), std::string::npos);
    EXPECT_NE(done.status().message().find(reason), std::string::npos);
    EXPECT_EQ(done.status().message().find('\n'), std::string::npos);
  }
  EXPECT_TRUE(show.play().ok());
}

// The driver is asked to report resets, not only our code.
TEST_F(Play, ContextsAreMadeSoThatTheyTellOfResets) {
  test_context();
  GLint strategy = 0;
  glGetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
  EXPECT_EQ(strategy, GL_LOSE_CONTEXT_ON_RESET);
}

}  // namespace
}  // namespace atlas::testing
