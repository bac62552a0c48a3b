#include "core/io/scan_reader.h"

#include <gtest/gtest.h>

#include "small_files.h"
#include "support/temporary_folder.h"

namespace tiltmap {
namespace {

using namespace test;

TEST(ScanReader, RecognisesWhatItIsGivenByContentAndElseByName) {
  const TemporaryFolder folder;
  struct Case {
    const char* name;
    std::string bytes;
  };
  for (const Case& c : {Case{"a.dat", asciiPcd()}, Case{"b.txt", binaryPcd()}, Case{"c", littlePly()},
                        Case{"d.bin", asciiVtk()}, Case{"e.pts", ptx()}, Case{"f.3D", uos()},
                        Case{"g.CSV", csv()}, Case{"h.asc", xyz()}}) {
    const auto result = readScans(folder.write(c.name, c.bytes), {});
    EXPECT_TRUE(result) << c.name << ": " << result.error().what;
  }
}

TEST(ScanReader, SaysWhatItSawWhenTheFormatDoesNotFit) {
  const TemporaryFolder folder;
  const auto wrong = readScans(folder.write("a.pcd", asciiPly()), {ScanFormat::Pcd, 0.0, 0.0});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().what.find("ply"), std::string::npos);
  EXPECT_NE(wrong.error().where.find("a.pcd"), std::string::npos);
  const auto unknown = readScans(folder.write("photo.jpg", "\xff\xd8\xff\xe0JFIF"), {});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().where.find("photo.jpg"), std::string::npos);
  EXPECT_NE(unknown.error().what.find("JFIF"), std::string::npos) << unknown.error().what;
  EXPECT_NE(unknown.error().remedy.find("pcd"), std::string::npos);
}

TEST(ScanReader, EveryFormatHasItsWord) {
  EXPECT_EQ(scanFormatNames().size(), 7U);
  EXPECT_EQ(scanFormatName(ScanFormat::Uos), "uos");
  for (const auto& [name, format] : scanFormatNames()) EXPECT_EQ(scanFormatName(format), name);
}

TEST(ScanReader, BoundsThatLeaveNothingAreRefused) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.pcd", asciiPcd());
  for (const auto& [low, high] : {std::pair{5.0, 2.0}, std::pair{-1.0, 0.0}, std::pair{3.0, 3.0},
                                  std::pair{std::numeric_limits<double>::quiet_NaN(), 0.0}})
    EXPECT_FALSE(readScans(file, {ScanFormat::Auto, low, high})) << low << " " << high;
  EXPECT_FALSE(readScans(file, {ScanFormat::Auto, 100.0, 0.0})) << "no point is left";
}

TEST(ScanReader, BoundsMarkCellsInEveryFormatAndStayWithTheGeometry) {
  const TemporaryFolder folder;
  for (const std::string& bytes : {asciiPcd(), littlePly(), asciiVtk()}) {
    const auto result = readScans(folder.write("a.dat", bytes), {ScanFormat::Auto, 5.0, 12.0});
    ASSERT_TRUE(result) << result.error().what;
    const Scan& scan = result->scans[0].scan;
    EXPECT_EQ(scan.image->validCells(), 1U);
    EXPECT_EQ(scan.image->code(0), cell_code::kOutOfBounds);
    EXPECT_EQ(scan.image->code(1), cell_code::kMeasured);
    EXPECT_EQ(scan.image->code(2), cell_code::kOutOfBounds);
    EXPECT_EQ(scan.geometry.minimum_range_m, 5.0);
    EXPECT_EQ(scan.geometry.maximum_range_m, 12.0);
  }
}

TEST(ScanReader, TellsItsProgress) {
  const TemporaryFolder folder;
  std::vector<double> told;
  const JobControl control{[&](const Progress& p) { told.push_back(p.fraction); }, {}};
  ASSERT_TRUE(readScans(folder.write("a.pcd", asciiPcd()), {}, control));
  ASSERT_GE(told.size(), 2U);
  EXPECT_EQ(told.front(), 0.0);
  EXPECT_EQ(told.back(), 1.0);
}

}  // namespace
}  // namespace tiltmap
