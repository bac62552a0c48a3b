#include "core/calibration/calibration_file.h"

#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

Calibration sample() {
  Calibration calibration;
  ErrorVector errors;
  errors << 0.01, 0.0, -0.05, 0.04, 0.0, -0.02, 0.015, 0.03;
  calibration.geometry = corrected(ScannerGeometry(), errors);
  calibration.estimates = {{ScannerError::TiltZero, EstimateState::Weak, 0.0, 0.0, 0.002, "no ground"}};
  return calibration;
}

class CalibrationFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto path = folder_ / "c.json";
    std::ofstream(path) << text;
    return path;
  }
  test::TemporaryFolder folder_;
};

TEST_F(CalibrationFile, IsReadBackAsItWasWritten) {
  const std::string text = calibrationText(sample(), {"stop 0", "stop \"1\""}, "2031-04-05T06:07:08.901Z");
  const auto read = readCalibration(write(text));
  ASSERT_TRUE(read) << read.error().what;
  EXPECT_TRUE(sameCalibration(*read, sample().geometry));
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json["scan_names"][1], "stop \"1\"");
  EXPECT_EQ(json["date"], "2031-04-05T06:07:08.901Z");
  EXPECT_EQ(json["estimates"][0]["state"], "weak");
  EXPECT_EQ(json["estimates"][0]["deviation"], 0.002);
}

TEST_F(CalibrationFile, TakesTheCalibratedMembersOnly) {
  ScannerGeometry other;
  other.rows = 7;
  other.minimum_range_m = 0.4;
  takeCalibration(sample().geometry, other);
  EXPECT_TRUE(sameCalibration(other, sample().geometry));
  EXPECT_EQ(other.rows, 7);
  EXPECT_EQ(other.minimum_range_m, 0.4);
  EXPECT_FALSE(sameCalibration(other, ScannerGeometry()));
}

TEST_F(CalibrationFile, OtherFilesAreRefused) {
  EXPECT_FALSE(readCalibration(folder_ / "missing.json"));
  for (const char* text :
       {"", "{", "[]", "7", "{}", R"({"format": 3})", R"({"format": "tiltmap calibration 1"})",
        R"({"format": "tiltmap calibration 2", "geometry": {}})"})
    EXPECT_FALSE(readCalibration(write(text))) << text;
  auto json = nlohmann::json::parse(calibrationText(sample(), {}, ""));
  json["geometry"]["mounting_xyzw"] = {1, 1, 1, 1};
  EXPECT_FALSE(readCalibration(write(json.dump())));
  json["geometry"]["mounting_xyzw"] = {"x", 1, 1, 1};
  EXPECT_FALSE(readCalibration(write(json.dump())));
  json = nlohmann::json::parse(calibrationText(sample(), {}, ""));
  json["geometry"].erase("range_offset_m");
  EXPECT_FALSE(readCalibration(write(json.dump())));
}

}  // namespace
}  // namespace tiltmap
