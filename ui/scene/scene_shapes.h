// The lines and marks of a scene as VTK data.
#pragma once

#include <vector>
#include <vtkSmartPointer.h>

#include <Eigen/Core>

#include "core/geometry/pose.h"

class vtkPolyData;

namespace tiltmap::ui {

// The path from stop to stop, and on each stop an arrow along its heading: `length_m` long, flat. World
// frame.
vtkSmartPointer<vtkPolyData> pathShape(const std::vector<Pose>& world_from_scan, double length_m);
// Lines every spacing_m over a rectangle at one height.
vtkSmartPointer<vtkPolyData> gridShape(const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                                       double spacing_m);
// The twelve edges of an upright box.
vtkSmartPointer<vtkPolyData> boxShape(const Eigen::Vector3d& low, const Eigen::Vector3d& high);
// One or two places, a line between them.
vtkSmartPointer<vtkPolyData> measureShape(const std::vector<Eigen::Vector3d>& places);
// A beam: a line and its end.
vtkSmartPointer<vtkPolyData> beamShape(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace tiltmap::ui
