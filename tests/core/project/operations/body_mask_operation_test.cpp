// A simulated survey whose scanner always sees a part of the machine that carries it.
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/base/random.h"
#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "core/registration/prepared_scan.h"
#include "core/scan/point_cloud.h"
#include "core/world/experiment.h"
#include "tests/support/project_samples.h"
#include "tests/support/temporary_folder.h"

namespace tiltmap {
namespace {

using test::must;

constexpr int kStops = 3;

// A bumper that is seen by the lowest lines, and a mast beside the scanner that all lines see. The bumper
// comes as near as 0.35 m; the mast stands 0.62 m away.
bool isBumper(int row, int column) {
  return row < 9 && column >= 160 && column < 200;
}
bool isMast(int column) {
  return column >= 20 && column < 26;
}
bool isBody(int row, int column) {
  return isBumper(row, column) || isMast(column);
}
bool isBodyOrMargin(int row, int column) {
  for (int r = row - 1; r <= row + 1; ++r)
    for (int c = column - 1; c <= column + 1; ++c)
      if (r >= 0 && c >= 0 && isBody(r, c)) return true;
  return false;
}

const std::vector<Scan>& scansWithBody() {
  static const std::vector<Scan> scans = [] {
    std::vector<Scan> made;
    for (const SimulatedStop& stop : must(simulateExperiment(ExperimentId::Exp2Fixed, 1, kStops, 2))) {
      Scan scan = stop.scan;
      RangeImageData data = scan.image->data();
      RandomStream random(7 + made.size());
      for (int row = 0; row < data.rows; ++row)
        for (int column = 0; column < data.columns; ++column) {
          if (!isBody(row, column)) continue;
          const std::size_t cell = scan.image->index(row, column);
          data.range_m[cell] =
              static_cast<float>((isMast(column) ? 0.62 : 0.35 + 0.01 * row) + random.uniform(-0.01, 0.01));
          data.code[cell] = cell_code::kMeasured;
        }
      scan.image = must(RangeImage::make(std::move(data)));
      made.push_back(std::move(scan));
    }
    return made;
  }();
  return scans;
}

class BodyMaskOperationTest : public ::testing::Test {
 protected:
  void SetUp() override { open("p.tiltmap"); }
  void open(const std::string& name) {
    project_.reset();
    project_ = must(Project::create((folder_ / name).string()));
    must(project_->apply(importEdit(scansWithBody())));
  }
  Result<OperationResult> run(const std::string& id, const ParameterValues& values) {
    auto job = Job::start(*operations().find(id), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    auto result = (*job)->result();
    if (result)
      if (auto change = (*job)->accept(*project_); !change) return fail(change.error());
    return result;
  }
  Scan scan(std::size_t i) { return must(project_->snapshot()->scans()[i].scan()); }
  std::size_t bodyPoints(const Scan& scan) {
    std::size_t found = 0;
    for (const std::uint32_t cell : cloudOf(*scan.image, scan.geometry).cell)
      found += isBody(static_cast<int>(cell) / scan.image->columns(),
                      static_cast<int>(cell) % scan.image->columns());
    return found;
  }
  // What registration works on, within reach of the body.
  std::size_t nearElements(const Scan& scan) {
    const PreparedScanPtr prepared = prepare(scan, {});
    EXPECT_GT(prepared->elements.size(), 50U);
    std::size_t near = 0;
    for (const Eigen::Vector3d& p : prepared->elements.position) near += p.norm() < 0.8;
    for (std::size_t i = 0; i < prepared->cells.size(); ++i)
      near += std::hypot(prepared->cells.x[i], prepared->cells.y[i], prepared->cells.z[i]) < 0.8F;
    return near;
  }
  // Points of an exported map as near to a stop as its own body.
  std::size_t mapPointsOnTheMachine() {
    const std::string file = (folder_ / ("map" + std::to_string(++maps_) + ".xyz")).string();
    must(run("export", {{"file", file}, {"colour", std::string("none")}}));
    std::vector<Eigen::Vector3d> stops;
    for (const ScanEntry& entry : project_->snapshot()->scans())
      stops.push_back(entry.odometry().translation());
    std::ifstream in(file);
    std::size_t near = 0, points = 0;
    double x = 0.0, y = 0.0, z = 0.0;
    while (in >> x >> y >> z) {
      ++points;
      for (const Eigen::Vector3d& stop : stops) near += (Eigen::Vector3d(x, y, z) - stop).norm() < 0.8;
    }
    EXPECT_GT(points, 10'000U);
    return near;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  int maps_ = 0;
};

TEST_F(BodyMaskOperationTest, MaskedCellsReachNeitherMapNorRegistrationAndOthersAreUntouched) {
  EXPECT_GT(bodyPoints(scan(1)), 900U);
  EXPECT_GT(nearElements(scan(1)), 0U) << "without the mask the body takes part";
  EXPECT_GT(mapPointsOnTheMachine(), 500U) << "one in each cell of the reduced map";
  const auto looked = run("body-mask", {});
  ASSERT_TRUE(looked) << looked.error().what;
  EXPECT_TRUE(looked->edit.empty());

  // The mask alone has to do it.
  const auto applied = run("body-mask", {{"apply", true}, {"minimum-range", false}});
  ASSERT_TRUE(applied) << applied.error().what;
  for (std::size_t i = 0; i < kStops; ++i) {
    const Scan now = scan(i);
    EXPECT_EQ(now.geometry.minimum_range_m, 0.0);
    const RangeImage& before = *scansWithBody()[i].image;
    std::size_t others_changed = 0;
    for (int row = 0; row < before.rows(); ++row)
      for (int column = 0; column < before.columns(); ++column) {
        if (isBody(row, column)) {
          ASSERT_EQ(now.image->code(row, column), cell_code::kMasked) << row << " " << column;
        }
        if (isBodyOrMargin(row, column)) continue;
        others_changed += now.image->code(row, column) != before.code(row, column) ||
                          now.image->range(row, column) != before.range(row, column);
      }
    EXPECT_EQ(others_changed, 0U);
    EXPECT_EQ(bodyPoints(now), 0U);
    EXPECT_EQ(nearElements(now), 0U);
  }
  EXPECT_EQ(mapPointsOnTheMachine(), 0U);
  ASSERT_TRUE(run("register", {}));
  for (const Link& link : project_->snapshot()->links()) EXPECT_TRUE(link.succeeded);
}

TEST_F(BodyMaskOperationTest, IsUndoneKeptOverACalibrationAndOverReopening) {
  must(run("body-mask", {{"apply", true}}));
  const auto& history = project_->snapshot()->history();
  EXPECT_NE(history.back().title.find("cells out of 3 scans"), std::string::npos) << history.back().title;
  EXPECT_EQ(scan(0).image->code(0, 170), cell_code::kMasked);
  const auto again = run("body-mask", {{"apply", true}});
  ASSERT_TRUE(again);
  EXPECT_TRUE(again->edit.empty()) << "there is no body left to find";

  ProjectEdit calibrated{"calibrate", {}, nullptr, {}, {}};
  SetGeometry step{project_->snapshot()->scans()[0].id, project_->snapshot()->scans()[0].geometry};
  step.geometry.range_offset_m = 0.01;
  calibrated.steps.emplace_back(step);
  must(project_->apply(calibrated));
  EXPECT_EQ(scan(0).image->code(0, 170), cell_code::kMasked);

  const auto path = project_->path();
  project_.reset();
  project_ = must(Project::open(path, Access::ReadWrite));
  EXPECT_EQ(scan(0).image->code(0, 170), cell_code::kMasked);
  EXPECT_TRUE(project_->verify());
  must(project_->undo());
  must(project_->undo());
  for (std::size_t i = 0; i < kStops; ++i)
    EXPECT_EQ(scan(i).image->data().code, scansWithBody()[i].image->data().code);
  must(project_->redo());
  EXPECT_EQ(scan(0).image->code(0, 170), cell_code::kMasked);
  must(project_->compact());
  EXPECT_EQ(scan(0).image->code(0, 170), cell_code::kMasked);
  EXPECT_GT(scan(0).geometry.minimum_range_m, 0.6);
}

TEST_F(BodyMaskOperationTest, AFileGivesTheMaskToOtherScansOfTheScanner) {
  const std::string file = (folder_ / "mask.json").string();
  must(run("body-mask", {{"out", file}}));
  EXPECT_FALSE(run("body-mask", {{"from", file}})) << "without apply";
  EXPECT_FALSE(run("body-mask", {{"from", file}, {"apply", true}, {"out", file}}));
  EXPECT_FALSE(run("body-mask", {{"from", file + "x"}, {"apply", true}}));
  const auto given = run("body-mask", {{"from", file}, {"apply", true}, {"scans", std::string("2")}});
  ASSERT_TRUE(given) << given.error().what;
  EXPECT_EQ(bodyPoints(scan(2)), 0U);
  EXPECT_GT(bodyPoints(scan(0)), 900U) << "was not named";

  Scan small = scansWithBody()[0];
  small.geometry.rows = 1;
  RangeImageData line{1,  361, std::vector<float>(361, 5.0F), std::vector<CellCode>(361, 0), {}, {0.0},
                      {}, {}};
  small.image = must(RangeImage::make(std::move(line)));
  must(project_->apply(importEdit({small})));
  const auto refused = run("body-mask", {{"from", file}, {"apply", true}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().what.find("101 x 361"), std::string::npos) << refused.error().what;
}

}  // namespace
}  // namespace tiltmap
