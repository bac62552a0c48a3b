// From the tables to a snapshot.
#pragma once

#include <memory>

#include "core/project/image_store.h"
#include "core/project/project_snapshot.h"

namespace tiltmap {

class SnapshotReader {
 public:
  // All tables but the matrices and attachments, as the connection sees them: call inside a transaction,
  // which makes them fit together. Throws StoreFailure.
  static SnapshotPtr read(const Database& database, std::shared_ptr<ImageStore> store);
  static std::int64_t storedRevision(const Database& database);
  // The snapshot with one scan's line count moved on, without reading everything again: a capture does this
  // several times a second.
  static SnapshotPtr withLine(const ProjectSnapshot& snapshot, ScanId scan, std::int64_t revision, int lines,
                              std::size_t valid_cells);
};

// One row of scanner_geometry from the given column on, and the row that holds these values (made if need
// be).
ScannerGeometry geometryFrom(const Statement& row, int first_column);
// With a mask of cells as core/scan/cell_mask.h writes it; nothing: none.
std::int64_t geometryRow(const Database& database, const ScannerGeometry& geometry,
                         const std::optional<std::string>& body_mask = std::nullopt);
// The mask that belongs to a row of scanner_geometry.
std::optional<std::string> storedBodyMask(const Database& database, std::int64_t geometry_id);
inline constexpr const char* kGeometryColumns =
    "rows, columns, azimuth_start_rad, azimuth_step_rad, tilt_start_rad, tilt_step_rad, tilt_zero_rad, "
    "lever_arm_x_m, lever_arm_y_m, lever_arm_z_m, mounting_qx, mounting_qy, mounting_qz, mounting_qw, "
    "range_offset_m, minimum_range_m, maximum_range_m";

// A pose from seven columns, x y z qx qy qz qw, from the given one on. Throws StoreFailure for what is no
// rotation.
Pose poseFrom(const Database& database, const Statement& row, int first_column);
// A pose as one text, "x y z qx qy qz qw", that reads back as the same numbers.
std::string storedPoseText(const Pose& pose);

}  // namespace tiltmap
