// Menu entry and file type: what a double click on a project comes to.
#include <cstdlib>

#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace tiltmap::test {
namespace {

class Desktop : public ::testing::Test {
 protected:
  // The words as bash runs them, with a home of the test's own; what it wrote to standard output.
  struct Shell {
    int code = -1;
    std::string out;
  };
  Shell shell(const std::string& words) {
    const std::string home = "'" + (folder_ / "home").string() + "'";
    const std::string command =
        "mkdir -p " + home + " && cd " + home +
        " && env -u XDG_CURRENT_DESKTOP -u DESKTOP_SESSION HOME=" + home + " XDG_DATA_HOME=" + home +
        "/data XDG_CONFIG_HOME=" + home + "/config XDG_DATA_DIRS=/usr/share root='" + TILTMAP_SOURCE_DIR +
        "' bash -c '. \"$root/packaging/desktop.sh\"; " + words + "' >" + home + "/out 2>" + home + "/err";
    Shell result;
    result.code = std::system(command.c_str());
    result.out = fileText(folder_ / "home" / "out");
    while (!result.out.empty() && result.out.back() == '\n') result.out.pop_back();
    return result;
  }
  static bool there(const std::string& tool) {
    return std::system(("command -v " + tool + " >/dev/null").c_str()) == 0;
  }
  // A program that writes down the words it was called with; its folder has a name that needs quoting.
  std::filesystem::path stub() {
    const auto folder = folder_ / "a program's $folder";
    std::filesystem::create_directories(folder);
    const auto program = folder / "tiltmap";
    writeFile(program, "#!/bin/sh\nprintf '%s\\n' \"$@\" > \"" + (folder_ / "words.txt").string() + "\"\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    return program;
  }
  void install() {
    writeFile(folder_ / "program.txt", stub().string());
    ASSERT_EQ(shell("install_desktop \"$(cat ../program.txt)\"").code, 0);
  }
  std::filesystem::path data() { return folder_ / "home" / "data"; }
  TemporaryFolder folder_;
};

TEST_F(Desktop, TheEntryIsValid) {
  if (!there("desktop-file-validate")) GTEST_SKIP() << "desktop-file-validate is not installed";
  install();
  const Shell result = shell("desktop-file-validate data/applications/tiltmap.desktop");
  EXPECT_EQ(result.code, 0) << result.out << fileText(folder_ / "home" / "err");
  EXPECT_EQ(result.out, "");
  for (const char* icon : {"icons/hicolor/scalable/apps/tiltmap.svg",
                           "icons/hicolor/scalable/mimetypes/application-x-tiltmap.svg"})
    EXPECT_TRUE(std::filesystem::exists(data() / icon)) << icon;
}

TEST_F(Desktop, AProjectIsKnownByNameAndByContent) {
  if (!there("update-mime-database") || !there("xdg-mime")) GTEST_SKIP() << "no MIME tools are installed";
  install();
  ASSERT_EQ(tiltmap({"new", "p.tiltmap"}, folder_.path()).exit_code, 0);
  EXPECT_EQ(shell("XDG_CURRENT_DESKTOP=GNOME xdg-mime query filetype ../p.tiltmap").out,
            "application/x-tiltmap");
  EXPECT_EQ(shell("xdg-mime query default application/x-tiltmap").out, "tiltmap.desktop");
  if (there("gio")) {
    std::filesystem::copy_file(folder_ / "p.tiltmap", folder_ / "renamed");
    EXPECT_NE(shell("gio info -a standard::content-type ../renamed").out.find("application/x-tiltmap"),
              std::string::npos);
  }
}

TEST_F(Desktop, ADoubleClickOpensTheProjectInTheWindow) {
  if (!there("gio")) GTEST_SKIP() << "gio is not installed";
  install();
  ASSERT_EQ(tiltmap({"new", "my survey.tiltmap"}, folder_.path()).exit_code, 0);
  ASSERT_EQ(shell("gio launch data/applications/tiltmap.desktop \"../my survey.tiltmap\"; sleep 0.5").code,
            0);
  const std::string words = fileText(folder_ / "words.txt");
  EXPECT_EQ(words.substr(0, 4), "gui\n") << fileText(folder_ / "home" / "err");
  EXPECT_NE(words.find("my survey.tiltmap\n"), std::string::npos) << words;
}

TEST_F(Desktop, RemovingTakesEverythingAway) {
  install();
  EXPECT_TRUE(std::filesystem::exists(data() / "applications" / "tiltmap.desktop"));
  ASSERT_EQ(shell("remove_desktop").code, 0);
  for (const char* file : {"applications/tiltmap.desktop", "mime/packages/tiltmap.xml",
                           "icons/hicolor/scalable/apps/tiltmap.svg"})
    EXPECT_FALSE(std::filesystem::exists(data() / file)) << file;
}

}  // namespace
}  // namespace tiltmap::test
