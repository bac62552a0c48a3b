// The small operations on one scan, ours and the peers', under Google Benchmark.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/scan/range_image.h"
#include "tests/benchmarks/table.h"

namespace tiltmap::benchmarks {

// One simulated scan, and the points of its neighbour, carried into its frame, to look up.
struct OperationInput {
  Scan scan;
  std::vector<Eigen::Vector3d> cell_points;  // one slot a cell
  std::vector<Eigen::Vector3d> points;       // of the cells that hold one
  std::vector<Eigen::Vector3d> queries;
};

struct Operation {
  std::string subject;
  std::string program;
  // Timed. What comes back tells the work it did (points kept, mean distance), so that rows can be compared
  // and nothing is optimised away.
  std::function<double()> run;
  std::string result;  // what that number is: "points left"
};

inline constexpr double kLineDistanceM = 0.5;  // thesis 4.2.2.3
inline constexpr std::size_t kLeafSize = 10;   // thesis 4.2.3
inline constexpr std::size_t kSeveral = 10;    // neighbours asked for
inline constexpr double kRadiusM = 0.25;
inline constexpr int kNormalNeighbours = 12;

// Subjects, so that ours and the peers' agree.
inline constexpr const char* kMedianSquare = "median filter, 3 x 3";
inline constexpr const char* kMatrixNormals = "normals from the matrix";
inline constexpr const char* kCloudNormals = "normals of an unordered cloud, 12 neighbours";
inline constexpr const char* kReduction = "reduction to 0.5 m";
inline constexpr const char* kTreeBuild = "tree, build (all points)";
inline constexpr const char* kNearest = "tree, nearest (all points of the next scan)";
inline constexpr const char* kTenNearest = "tree, 10 nearest (all points of the next scan)";
inline constexpr const char* kWithin = "tree, within 0.25 m (all points of the next scan)";

// The references stay with the operations: the input must outlive them.
std::vector<Operation> ownOperations(const OperationInput& input);
std::vector<Operation> pclOperations(const OperationInput& input);
std::vector<Operation> nanoflannOperations(const OperationInput& input);

// Runs all, interleaved, `repetitions` times each, and adds a row for each: its quietest repetition.
void addOperationRows(Table& table, const std::vector<Operation>& operations, int repetitions);

}  // namespace tiltmap::benchmarks
