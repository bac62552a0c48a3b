#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/products/scan_colours.h"
#include "core/project/job.h"
#include "core/project/operation.h"
#include "core/project/project.h"
#include "core/scan/point_cloud.h"
#include "tests/support/program.h"
#include "tests/support/project_samples.h"

namespace tiltmap {
namespace {

// Two scans of a 2 x 3 matrix, the second two metres to the right of the first.
class ExportOperationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    RangeImageData data;
    data.rows = 2;
    data.columns = 3;
    data.range_m.assign(6, 5.0F);
    data.code.assign(6, cell_code::kMeasured);
    data.code[4] = cell_code::kLmsNoSignal;
    data.line_tilt_rad = {-0.1, 0.1};
    Scan scan;
    scan.image = RangeImage::make(data).value();
    scan.geometry.rows = 2;
    scan.geometry.columns = 3;
    scan.geometry.azimuth_start_rad = 1.0;
    scan.geometry.azimuth_step_rad = 0.5;
    Scan second = scan;
    second.odometry = Pose::planar(2, 0, 0);
    cloud_ = cloudOf(*scan.image, scan.geometry);
    auto made = Project::create((folder_ / "p.tiltmap").string());
    ASSERT_TRUE(made);
    project_ = std::move(*made);
    ASSERT_TRUE(project_->apply(importEdit({scan, second})));
  }
  Result<OperationResult> run(ParameterValues values) {
    auto job = Job::start(*operations().find("export"), project_->snapshot(), "default", values);
    if (!job) return fail(job.error());
    (*job)->wait();
    return (*job)->result();
  }
  std::vector<Eigen::Vector3d> pointsOf(const std::string& name) {
    std::istringstream text(test::fileText(folder_.path() / name));
    std::vector<Eigen::Vector3d> points;
    for (std::string line; std::getline(text, line);) {
      std::istringstream words(line);
      Eigen::Vector3d p;
      words >> p.x() >> p.y() >> p.z();
      points.push_back(p);
    }
    return points;
  }
  test::TemporaryFolder folder_;
  std::unique_ptr<Project> project_;
  PointCloud cloud_;
};

TEST_F(ExportOperationTest, PointsStandWhereThePosesPutThem) {
  ASSERT_TRUE(run({{"file", (folder_ / "map.xyz").string()}}));
  const auto points = pointsOf("map.xyz");
  ASSERT_EQ(points.size(), 10U);
  EXPECT_LT((points[0] - cloud_.points[0]).norm(), 1e-3);
  EXPECT_LT((points[5] - cloud_.points[0] - Eigen::Vector3d(2, 0, 0)).norm(), 1e-3);
}

TEST_F(ExportOperationTest, StageAndScansAreChosen) {
  const auto snapshot = project_->snapshot();
  ASSERT_TRUE(
      project_->apply(posesEdit(Stage::Pairwise, {{snapshot->scans()[1].id, Pose::planar(7, 0, 0)}})));
  ASSERT_TRUE(run({{"file", (folder_ / "one.xyz").string()}, {"scans", std::string("1")}}));
  auto points = pointsOf("one.xyz");
  ASSERT_EQ(points.size(), 5U);
  EXPECT_LT((points[0] - cloud_.points[0] - Eigen::Vector3d(7, 0, 0)).norm(), 1e-3);
  ASSERT_TRUE(run({{"file", (folder_ / "one.xyz").string()},
                   {"scans", std::string("1")},
                   {"stage", std::string("odometry")}}));
  points = pointsOf("one.xyz");
  EXPECT_LT((points[0] - cloud_.points[0] - Eigen::Vector3d(2, 0, 0)).norm(), 1e-3);
}

TEST_F(ExportOperationTest, ScansHaveTheirColoursOfTheViews) {
  const auto snapshot = project_->snapshot();
  ASSERT_TRUE(project_->apply(colourEdit(*snapshot, {snapshot->scans()[1].id}, 0x0a141eU)));
  ASSERT_TRUE(run({{"file", (folder_ / "map.xyz").string()}, {"colour", std::string("scan")}}));
  std::istringstream text(test::fileText(folder_.path() / "map.xyz"));
  std::vector<Rgb> colours;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    double skipped = 0.0;
    int r = 0, g = 0, b = 0;
    words >> skipped >> skipped >> skipped >> r >> g >> b;
    colours.push_back(
        {static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(b)});
  }
  ASSERT_EQ(colours.size(), 10U);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(colours[i], i < 5 ? scanColour(0) : (Rgb{10, 20, 30}));
}

TEST_F(ExportOperationTest, ReducedHoldsFewer) {
  ASSERT_TRUE(
      run({{"file", (folder_ / "small.xyz").string()}, {"reduced", true}, {"reduction-distance", 50.0}}));
  EXPECT_LT(pointsOf("small.xyz").size(), 10U);
  EXPECT_GT(pointsOf("small.xyz").size(), 0U);
}

// Out as one file a scan, in as another project: matrix, pose, intensity.
class ExportedAndImported : public ExportOperationTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(ExportedAndImported, ScansKeepMatrixPoseAndIntensity) {
  const test::ImageOptions size{41, 91, true, false, false};
  auto made = Project::create(folder_ / "from.tiltmap");
  ASSERT_TRUE(made);
  project_ = std::move(*made);
  std::vector<Scan> scans;
  for (std::uint64_t i = 0; i < 3; ++i) {
    Scan scan;
    scan.geometry.rows = size.rows;
    scan.geometry.columns = size.columns;
    scan.geometry.azimuth_step_rad = 2.0 * kDegree;
    scan.geometry.tilt_start_rad = -30.0 * kDegree;
    scan.geometry.tilt_step_rad = 1.5 * kDegree;
    RangeImageData data = test::sampleImage(i + 1, size)->data();
    for (int row = 0; row < size.rows; ++row)
      data.line_tilt_rad[static_cast<std::size_t>(row)] = scan.geometry.tiltOfRow(row);
    scan.image = *RangeImage::make(std::move(data));
    scan.odometry = i == 0 ? Pose() : test::samplePose(i);
    scan.name = "stop " + std::to_string(i);
    scans.push_back(std::move(scan));
  }
  ASSERT_TRUE(project_->apply(importEdit(scans)));
  const std::string extension = GetParam();
  const auto exported = run({{"file", (folder_ / ("out." + extension)).string()},
                             {"per-scan", true},
                             {"scans", std::string("1,2")},
                             {"colour", std::string("height")}});
  ASSERT_TRUE(exported) << exported.error().what << " " << exported.error().where;
  const auto report = nlohmann::json::parse(exported->report_json);
  std::string files;
  std::vector<std::string> names;
  for (const auto& file : report["files"])
    if (file.get<std::string>().ends_with("." + extension)) names.push_back(file);  // not the .pose
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[1], (folder_ / ("out002." + extension)).string());
  for (const std::string& name : names) files += name + "\n";

  auto into = Project::create(folder_ / "into.tiltmap");
  ASSERT_TRUE(into);
  auto job = Job::start(*operations().find("import"), (*into)->snapshot(), "default", {{"files", files}});
  ASSERT_TRUE(job);
  (*job)->wait();
  ASSERT_TRUE((*job)->result()) << (*job)->result().error().what;
  ASSERT_TRUE((*job)->accept(**into));
  const auto snapshot = (*into)->snapshot();
  ASSERT_EQ(snapshot->scans().size(), 2U);
  // The first imported scan is the world.
  const Pose expected = scans[1].odometry.inverse() * scans[2].odometry;
  EXPECT_LT(difference(snapshot->scans()[1].odometry(), expected).translation_m, 1e-6);
  EXPECT_LT(difference(snapshot->scans()[1].odometry(), expected).rotation_rad, 1e-7);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto image = snapshot->scans()[i].image();
    ASSERT_TRUE(image);
    const RangeImage& original = *scans[i + 1].image;
    ASSERT_EQ((*image)->rows(), size.rows);
    ASSERT_EQ((*image)->columns(), size.columns);
    ASSERT_TRUE((*image)->hasIntensity());
    const auto a = cellPoints(**image, snapshot->scans()[i].geometry);
    const auto b = cellPoints(original, scans[i + 1].geometry);
    for (std::size_t cell = 0; cell < original.cells(); ++cell) {
      ASSERT_EQ((*image)->hasPoint(cell), original.hasPoint(cell)) << cell;
      if (!original.hasPoint(cell)) continue;
      ASSERT_LT((a[cell] - b[cell]).norm(), 5e-5);
      ASSERT_FLOAT_EQ((*image)->intensity(cell), original.intensity(cell));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, ExportedAndImported, ::testing::Values("ply", "pcd", "ptx", "3d"),
                         [](const auto& test) {
                           return test.param == std::string("3d") ? "uos" : std::string(test.param);
                         });

TEST_F(ExportOperationTest, OneFileAScanOrNone) {
  ASSERT_TRUE(run({{"file", (folder_ / "map.csv").string()}, {"per-scan", true}, {"reduced", true}}));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "map000.csv"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "map001.csv"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "map.csv"));
  const std::string first = test::bytesOf(folder_ / "map000.csv");
  const std::size_t before = folder_.entries();
  // The name of the second one is taken by a folder: the first is not replaced either.
  std::filesystem::create_directory(folder_ / "b001.csv");
  const auto refused = run({{"file", (folder_ / "b.csv").string()}, {"per-scan", true}});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().where.find("b001.csv"), std::string::npos);
  EXPECT_EQ(folder_.entries(), before + 1);
  EXPECT_EQ(test::bytesOf(folder_ / "map000.csv"), first);
  EXPECT_FALSE(run({{"file", (folder_ / "none/map.csv").string()}, {"per-scan", true}}));
}

TEST_F(ExportOperationTest, CancelledItLeavesNoFile) {
  const std::size_t before = folder_.entries();
  for (const bool per_scan : {false, true})
    for (const std::string name : {"a.ply", "a.pcd", "a.ptx", "a.vtk", "a.xyz", "a.csv"}) {
      std::stop_source stop;
      const JobControl control{[&](const Progress& progress) {
                                 if (progress.message.starts_with("writing")) stop.request_stop();
                               },
                               stop.get_token()};
      const auto result = operations().find("export")->run(
          project_->snapshot(), {{"file", (folder_ / name).string()}, {"per-scan", per_scan}}, control);
      ASSERT_FALSE(result) << name;
      EXPECT_EQ(result.error().what, kCancelled);
      EXPECT_EQ(folder_.entries(), before) << name;
    }
}

TEST_F(ExportOperationTest, RefusalsWriteNothing) {
  EXPECT_FALSE(run({{"file", (folder_ / "map.stl").string()}}));
  EXPECT_FALSE(run({{"file", (folder_ / "map.ply").string()}, {"stage", std::string("relaxed")}}));
  EXPECT_FALSE(run({{"file", (folder_ / "map.ply").string()}, {"scans", std::string("2")}}));
  EXPECT_FALSE(run({}));
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "map.ply"));
}

}  // namespace
}  // namespace tiltmap
