#include <gtest/gtest.h>

#include "core/io/scan_reader.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::TemporaryFolder;

struct Table {
  const char* name;
  const char* text;
  bool intensity;
  const char* warning;  // a word of it; empty for no warning
};

class XyzGuess : public testing::TestWithParam<Table> {};

// All tables say the same: (1, 2, 3) with 10 and (4, 5, 6) with 20.
TEST_P(XyzGuess, FindsTheColumnsAndTellsWhatItTookThemFor) {
  const TemporaryFolder folder;
  const auto result = readScans(folder.write("a.xyz", GetParam().text), {});
  ASSERT_TRUE(result) << result.error().what << " " << result.error().where;
  const Scan& scan = result->scans[0].scan;
  const auto points = cellPoints(*scan.image, scan.geometry);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_LT((points[0] - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  EXPECT_LT((points[1] - Eigen::Vector3d(4, 5, 6)).norm(), 1e-6);
  ASSERT_EQ(scan.image->hasIntensity(), GetParam().intensity);
  if (GetParam().intensity) {
    EXPECT_FLOAT_EQ(scan.image->intensity(1), 20.0F);
  }
  std::string warnings;
  for (const std::string& text : result->warnings) warnings += text + "\n";
  EXPECT_NE(warnings.find(GetParam().warning), std::string::npos) << warnings;
  EXPECT_EQ(warnings.empty(), std::string(GetParam().warning).empty()) << warnings;
}

INSTANTIATE_TEST_SUITE_P(
    Table, XyzGuess,
    testing::Values(
        Table{"Three", "1 2 3\n4 5 6\n", false, "x y z"}, Table{"Tabs", "1\t2\t3\n4\t5\t6\n", false, "x y z"},
        Table{"Four", "1 2 3 10\n4 5 6 20\n", true, "intensity"},
        Table{"Colour", "1 2 3 255 0 7\n4 5 6 1 2 3\n", false, "red green blue"},
        Table{"Normal", "1 2 3 0.6 -0.8 0\n4 5 6 0 0 1\n", false, "normal"},
        Table{"Pts", "2\n1 2 3 10 255 0 7\n4 5 6 20 1 2 3\n", true, "intensity red green blue"},
        Table{"More", "1 2 3 10 0.5\n4 5 6 20 0.5\n", true, "1 more left out"},
        Table{"Commas", "1, 2, 3, 10\n4,5,6,20\n", true, "intensity"},
        Table{"EndsInSeparator", "1,2,3,10,\n4,5,6,20,\n", true, "intensity"},
        Table{"Names", "# scan\nz,y,Intensity,x\n3,2,10,1\n6,5,20,4\n", true, ""},
        Table{"NamesWithBlanks", "X Y Z I\n1 2 3 10\n4 5 6 20\n", true, ""},
        Table{"NamesWithUnits", "\"x (m)\";\"y (m)\";\"z (m)\";intensity\n1;2;3;10\n4;5;6;20\n", true, ""},
        Table{"NamesAndOthers", "time,x,y,z,ring\n0.1,1,2,3,9\n0.2,4,5,6,9\n", false, "time, ring"},
        Table{"DecimalCommas", "1,0;2,0;3,0;10\n4,0;5,0;6,0;20\n", true, "intensity"},
        Table{"Comments", "// a\n# b\n\n1 2 3\n# c\n4 5 6\n", false, "x y z"},
        Table{"Exponents", "1e0 +2 3.0\n.4e1 5. 6\n", false, "x y z"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace tiltmap
