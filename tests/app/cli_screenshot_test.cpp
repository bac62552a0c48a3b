// Pictures without a display: the program runs with neither DISPLAY nor WAYLAND_DISPLAY
// (tests/support/program.h).
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/png_pixels.h"
#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

using nlohmann::json;

class CliScreenshot : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"new", "p.tiltmap"}).exit_code, 0);
    ASSERT_EQ(run({"simulate", "p.tiltmap", "--experiment", "exp1", "--seed", "1"}).exit_code, 0);
  }
  ProgramRun run(const std::vector<std::string>& words) { return tiltmap(words, folder_.path()); }
  // Skips where there is no OpenGL without a display.
  bool rendered(const ProgramRun& result) {
    if (result.err.find("EGL") != std::string::npos) return false;
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return true;
  }
  TemporaryFolder folder_;
};

TEST_F(CliScreenshot, MapIsDrawnWithoutADisplay) {
  const ProgramRun result =
      run({"screenshot", "p.tiltmap", "map.png", "--size", "640x480", "--view", "top", "--json"});
  if (!rendered(result)) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.err, "");  // nothing of the OpenGL loader's complaints
  const json object = json::parse(result.out);
  EXPECT_EQ(object["file"], "map.png");
  EXPECT_EQ(object["width"], 640);
  EXPECT_EQ(object["height"], 480);
  EXPECT_TRUE(object["warnings"].empty());
  const RgbImage picture = pngPixels(folder_.path() / "map.png");
  ASSERT_EQ(picture.width, 640);
  ASSERT_EQ(picture.height, 480);
  std::set<std::string> colours;
  for (const Rgb colour : picture.pixels) colours.insert(hexOf(colour));
  EXPECT_GT(colours.size(), 100U);
}

TEST_F(CliScreenshot, ViewsStagesAndScansDiffer) {
  std::set<std::string> files;
  const std::vector<std::vector<std::string>> choices = {{"--view", "top"},
                                                         {"--view", "side"},
                                                         {"--view", "iso"},
                                                         {"--view", "top", "--stage", "truth"},
                                                         {"--view", "top", "--scan", "2"},
                                                         {"--view", "top", "--colour", "height"},
                                                         {"--view", "top", "--white"},
                                                         {"--panel", "depth"},
                                                         {"--panel", "depth", "--scan", "1"},
                                                         {"--panel", "depth", "--quantity", "changed"}};
  for (const auto& choice : choices) {
    std::vector<std::string> words = {"screenshot", "p.tiltmap", "x.png", "--size", "400x300"};
    words.insert(words.end(), choice.begin(), choice.end());
    const ProgramRun result = run(words);
    if (!rendered(result)) GTEST_SKIP() << result.err;
    EXPECT_TRUE(files.insert(fileText(folder_.path() / "x.png")).second) << choice.back();
  }
}

TEST_F(CliScreenshot, DepthImageNeedsNoOpenGlAndHasTheSizeAsked) {
  ASSERT_EQ(run({"screenshot", "p.tiltmap", "d.png", "--panel", "depth", "--scan", "4", "--size", "700x420"})
                .exit_code,
            0);
  const RgbImage picture = pngPixels(folder_.path() / "d.png");
  EXPECT_EQ(picture.width, 700);
  EXPECT_EQ(picture.height, 420);
}

int coloursIn(const RgbImage& picture, double left, double top, double right, double bottom) {
  std::set<std::string> colours;
  for (int y = static_cast<int>(top * picture.height); y < bottom * picture.height; ++y)
    for (int x = static_cast<int>(left * picture.width); x < right * picture.width; ++x)
      colours.insert(hexOf(picture.at(x, y)));
  return static_cast<int>(colours.size());
}

TEST_F(CliScreenshot, TheWholeWindowIsDrawnWithThe3dViewInIt) {
  const std::string before = fileText(folder_.path() / "p.tiltmap");
  const ProgramRun result = run({"screenshot", "p.tiltmap", "w.png", "--panel", "window", "--scan", "1"});
  if (!rendered(result)) GTEST_SKIP() << result.err;
  EXPECT_EQ(result.err, "");
  const RgbImage picture = pngPixels(folder_.path() / "w.png");
  ASSERT_EQ(picture.width, 1366);
  ASSERT_EQ(picture.height, 768);
  // In the middle of the right half stand the scans in 3D, each in its colour; a view that was left empty
  // would be a gradient of a dozen greys.
  EXPECT_GT(coloursIn(picture, 0.4, 0.2, 0.9, 0.5), 40);
  EXPECT_GT(coloursIn(picture, 0.0, 0.1, 0.25, 0.5), 20) << "the project tree";
  EXPECT_GT(coloursIn(picture, 0.4, 0.65, 0.9, 0.9), 40) << "the depth image";
  EXPECT_LT(picture.at(3, 760).r, 60) << "dark";
  EXPECT_EQ(fileText(folder_.path() / "p.tiltmap"), before);
  ASSERT_EQ(
      run({"screenshot", "p.tiltmap", "l.png", "--panel", "window", "--theme", "light", "--size", "1280x720"})
          .exit_code,
      0);
  const RgbImage light = pngPixels(folder_.path() / "l.png");
  EXPECT_EQ(light.width, 1280);
  EXPECT_GT(light.at(3, 712).r, 200);
}

TEST_F(CliScreenshot, APanelIsDrawnAloneAsOnAFineScreen) {
  const ProgramRun result = run({"screenshot", "p.tiltmap", "t.png", "--panel", "project-tree", "--size",
                                 "400x300", "--scale", "2", "--theme", "light"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const RgbImage picture = pngPixels(folder_.path() / "t.png");
  EXPECT_EQ(picture.width, 800);
  EXPECT_EQ(picture.height, 600);
  EXPECT_GT(coloursIn(picture, 0, 0, 1, 1), 20);
}

// The panels of registration, relaxation, site map and links, in the states that they are made for.
TEST_F(CliScreenshot, EveryPanelOfRegistrationAndRelaxationIsDrawnInItsStates) {
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  const std::string before = fileText(folder_.path() / "p.tiltmap");
  const auto revision = run({"history", "p.tiltmap"}).out;
  const std::vector<std::vector<std::string>> choices = {
      {"stepper"},
      {"stepper", "--pair", "0:1", "--iteration", "0"},
      {"stepper", "--pair", "0:1", "--iteration", "3"},
      {"stepper", "--pair", "1:2", "--preset", "thesis"},
      {"stepper-plots"},
      {"stepper-plots", "--pair", "0:1"},
      {"stepper-view"},
      {"stepper-view", "--pair", "0:1", "--iteration", "1"},
      {"relax"},
      {"relax", "--relax", "default"},
      {"relax", "--relax", "thesis", "--relax-step", "2"},
      {"sitemap"},
      {"sitemap", "--relax", "thesis", "--relax-step", "2"},
      {"links"},
      {"links", "--theme", "high-contrast"},
      {"view3d", "--relax", "thesis", "--relax-step", "2"}};
  std::set<std::string> files;
  for (const auto& choice : choices) {
    std::vector<std::string> words = {"screenshot", "p.tiltmap", "x.png", "--size", "640x480", "--panel"};
    words.insert(words.end(), choice.begin(), choice.end());
    const ProgramRun result = run(words);
    if (!rendered(result)) GTEST_SKIP() << result.err;
    EXPECT_EQ(result.err, "");
    const RgbImage picture = pngPixels(folder_.path() / "x.png");
    ASSERT_EQ(picture.width, 640) << choice.front();
    EXPECT_GT(coloursIn(picture, 0, 0, 1, 1), 20) << choice.front();
    EXPECT_TRUE(files.insert(fileText(folder_.path() / "x.png")).second) << choice.front();
  }
  EXPECT_EQ(run({"history", "p.tiltmap"}).out, revision);
  EXPECT_EQ(fileText(folder_.path() / "p.tiltmap"), before) << "a picture stores nothing";
}

TEST_F(CliScreenshot, AHeldRelaxationIsTheSamePictureEveryTime) {
  ASSERT_EQ(run({"register", "p.tiltmap"}).exit_code, 0);
  std::set<std::string> files;
  for (int turn = 0; turn < 2; ++turn) {
    const ProgramRun result = run({"screenshot", "p.tiltmap", "x.png", "--panel", "sitemap", "--relax",
                                   "thesis", "--relax-step", "3", "--size", "400x300"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    files.insert(fileText(folder_.path() / "x.png"));
  }
  EXPECT_EQ(files.size(), 1U);
}

TEST_F(CliScreenshot, WindowPicturesDependOnWhatWasAsked) {
  std::set<std::string> files;
  const std::vector<std::vector<std::string>> choices = {{"--perspective", "inspect"},
                                                         {"--perspective", "register"},
                                                         {"--front", "history"},
                                                         {"--front", "localisation"},
                                                         {"--scan", "2"},
                                                         {"--stage", "truth"}};
  for (const auto& choice : choices) {
    std::vector<std::string> words = {"screenshot", "p.tiltmap", "x.png", "--panel", "window"};
    words.insert(words.end(), choice.begin(), choice.end());
    const ProgramRun result = run(words);
    if (!rendered(result)) GTEST_SKIP() << result.err;
    EXPECT_TRUE(files.insert(fileText(folder_.path() / "x.png")).second) << choice.back();
  }
}

TEST_F(CliScreenshot, RefusalsSayWhatToDoAndWriteNothing) {
  const auto refused = [&](std::vector<std::string> words, int code, const std::string& part) {
    words.insert(words.begin(), "screenshot");
    const ProgramRun result = run(words);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "no.png"));
  };
  refused({"p.tiltmap", "no.png", "--size", "640"}, 2, "size");
  refused({"p.tiltmap", "no.png", "--size", "99999x10"}, 2, "16384");
  refused({"p.tiltmap", "no.png", "--panel", "sky"}, 2, "sky");
  refused({"p.tiltmap", "no.png", "--view", "up"}, 2, "up");
  refused({"p.tiltmap", "no.png", "--stage", "relaxed"}, 1, "relaxed");
  refused({"p.tiltmap", "no.png", "--scan", "77"}, 1, "77");
  refused({"p.tiltmap", "no.png", "--panel", "depth", "--scan", "77"}, 1, "77");
  refused({"missing.tiltmap", "no.png"}, 1, "missing.tiltmap");
  refused({"p.tiltmap", "no.png", "--panel", "window", "--scan", "77"}, 1, "77");
  refused({"p.tiltmap", "no.png", "--panel", "window", "--size", "100x100"}, 1, "160");
  refused({"p.tiltmap", "no.png", "--panel", "window", "--scale", "9"}, 2, "scale");
  refused({"p.tiltmap", "no.png", "--panel", "window", "--perspective", "sky"}, 2, "sky");
  refused({"p.tiltmap", "no.png", "--panel", "relax", "--relax-step", "2"}, 2, "relax");
  refused({"p.tiltmap", "no.png", "--panel", "relax", "--relax", "default", "--relax-step", "9999"}, 1,
          "9999");
  refused({"p.tiltmap", "no.png", "--panel", "stepper", "--pair", "0:0"}, 1, "itself");
  refused({"p.tiltmap", "no.png", "--panel", "stepper", "--pair", "0:1", "--iteration", "9999"}, 1, "9999");
  const ProgramRun result = run({"screenshot", "p.tiltmap", "p.tiltmap"});
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(run({"info", "p.tiltmap"}).exit_code, 0);  // still a project
}

TEST_F(CliScreenshot, AnEmptyProjectHasNothingToDraw) {
  ASSERT_EQ(run({"new", "empty.tiltmap"}).exit_code, 0);
  for (const char* panel : {"map", "depth"}) {
    const ProgramRun result = run({"screenshot", "empty.tiltmap", "no.png", "--panel", panel});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "no.png"));
  }
}

}  // namespace
}  // namespace tiltmap::test
