#include "hardware/tilt/mip50_table.h"

#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "hardware/tilt/mip50_codec.h"

namespace tiltmap {
namespace {

TEST(Mip50Table, ItsTextGivesItBack) {
  Mip50Table table;
  table.errors = {{7, "position error limit"}, {9, " # odd \\ \t"}};
  table.move_factor = 3.25;
  table.repeats = 5;
  table.command_end = "\n\r ";
  const auto again = parseMip50Table(mip50TableText(table), "test");
  ASSERT_TRUE(again) << again.error().what;
  EXPECT_EQ(*again, table);
}

TEST(Mip50Table, AnEditedLineChangesWhatIsSent) {
  const auto table = parseMip50Table(
      "# ours\nmove-absolute = M{axis}:{value};   # another firmware\r\nrefusal.200=hot\n"
      "command-end =\n",
      "test");
  ASSERT_TRUE(table) << table.error().what;
  EXPECT_EQ(encodeCommand(*table, {Mip50Verb::MoveAbsolute, 2, -5.0, 0}), "M2:-5;");
  EXPECT_EQ(table->refusals.at(200), "hot");
  EXPECT_EQ(table->refusals.at(180), "position regulation is off");
  EXPECT_EQ(table->command_end, "");
  EXPECT_EQ(table->home, Mip50Table{}.home);
}

TEST(Mip50Table, MistakesAreNamedWithTheirLine) {
  const auto mistake = [](const char* text) {
    const auto table = parseMip50Table(text, "t.txt");
    EXPECT_FALSE(table) << text;
    return table ? Error{} : table.error();
  };
  EXPECT_EQ(mistake("\nmove-absolut = A{axis}x{value}G\n").where, "t.txt, line 2");
  EXPECT_NE(mistake("move-absolut = A{axis}x{value}G").remedy.find("move-absolute"), std::string::npos);
  EXPECT_NE(mistake("home = HG").what.find("{axis}"), std::string::npos);
  EXPECT_NE(mistake("move-absolute = A{axis}xG").what.find("{value}"), std::string::npos);
  EXPECT_NE(mistake("read-parameter = q{axis}xG").what.find("{parameter}"), std::string::npos);
  EXPECT_NE(mistake("done = X\\q").what.find("backslash"), std::string::npos);
  EXPECT_NE(mistake("done = X\\").what.find("backslash"), std::string::npos);
  EXPECT_NE(mistake("done = X\\x1").what.find("backslash"), std::string::npos);
  mistake("answer = 0");
  mistake("answer = soon");
  mistake("repeats = -1");
  mistake("repeats = 1.5");
  mistake("refusal.x = what");
  mistake("just words");
  EXPECT_TRUE(parseMip50Table("", "t"));
}

TEST(Mip50Table, AFileThatIsNotThereIsAnError) {
  EXPECT_FALSE(readMip50Table("/nowhere/at/all.txt"));
}

// The copy that people begin to edit from.
TEST(Mip50Table, TheShippedFileIsTheBuiltInTable) {
  const std::string path = TILTMAP_SOURCE_DIR "/resources/instruments/mip50.txt";
  const auto table = readMip50Table(path);
  ASSERT_TRUE(table) << table.error().what;
  EXPECT_EQ(*table, Mip50Table{});
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), mip50TableText(Mip50Table{}));
}

}  // namespace
}  // namespace tiltmap
