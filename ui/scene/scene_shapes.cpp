#include "ui/scene/scene_shapes.h"

#include <cmath>
#include <vtkCellArray.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

namespace tiltmap::ui {

using Eigen::Vector3d;

namespace {

vtkIdType add(vtkPoints& points, const Vector3d& p) {
  return points.InsertNextPoint(p.data());
}

void addLine(vtkPoints& points, vtkCellArray& lines, const Vector3d& a, const Vector3d& b) {
  const vtkIdType ids[2] = {add(points, a), add(points, b)};
  lines.InsertNextCell(2, ids);
}

}  // namespace

vtkSmartPointer<vtkPolyData> pathShape(const std::vector<Pose>& world_from_scan, double length_m) {
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto lines = vtkSmartPointer<vtkCellArray>::New(), faces = vtkSmartPointer<vtkCellArray>::New();
  for (std::size_t i = 0; i < world_from_scan.size(); ++i) {
    const Vector3d stop = world_from_scan[i].translation();
    if (i > 0) addLine(*points, *lines, world_from_scan[i - 1].translation(), stop);
    const Vector3d ahead = world_from_scan[i].heading();
    const Vector3d side = world_from_scan[i].rotation().col(0);
    const vtkIdType corners[4] = {add(*points, stop + 0.62 * length_m * ahead),
                                  add(*points, stop - 0.38 * length_m * ahead + 0.30 * length_m * side),
                                  add(*points, stop - 0.20 * length_m * ahead),
                                  add(*points, stop - 0.38 * length_m * ahead - 0.30 * length_m * side)};
    const vtkIdType left[3] = {corners[0], corners[1], corners[2]};
    const vtkIdType right[3] = {corners[0], corners[2], corners[3]};
    faces->InsertNextCell(3, left);
    faces->InsertNextCell(3, right);
  }
  shape->SetPoints(points);
  shape->SetLines(lines);
  shape->SetPolys(faces);
  return shape;
}

vtkSmartPointer<vtkPolyData> gridShape(const Vector3d& low, const Vector3d& high, double spacing_m) {
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto lines = vtkSmartPointer<vtkCellArray>::New();
  const auto down = [&](double v) { return std::floor(v / spacing_m) * spacing_m; };
  const auto upper = [&](double v) { return std::ceil(v / spacing_m) * spacing_m; };
  const double x0 = down(low.x()), x1 = upper(high.x()), y0 = down(low.y()), y1 = upper(high.y());
  for (double x = x0; x <= x1 + 0.5 * spacing_m; x += spacing_m)
    addLine(*points, *lines, {x, y0, low.z()}, {x, y1, low.z()});
  for (double y = y0; y <= y1 + 0.5 * spacing_m; y += spacing_m)
    addLine(*points, *lines, {x0, y, low.z()}, {x1, y, low.z()});
  shape->SetPoints(points);
  shape->SetLines(lines);
  return shape;
}

vtkSmartPointer<vtkPolyData> boxShape(const Vector3d& low, const Vector3d& high) {
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto lines = vtkSmartPointer<vtkCellArray>::New();
  const auto corner = [&](int k) {
    return Vector3d((k & 1 ? high : low).x(), (k & 2 ? high : low).y(), (k & 4 ? high : low).z());
  };
  for (int k = 0; k < 8; ++k)
    for (const int bit : {1, 2, 4})
      if (!(k & bit)) addLine(*points, *lines, corner(k), corner(k | bit));
  shape->SetPoints(points);
  shape->SetLines(lines);
  return shape;
}

vtkSmartPointer<vtkPolyData> measureShape(const std::vector<Vector3d>& places) {
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto lines = vtkSmartPointer<vtkCellArray>::New(), ends = vtkSmartPointer<vtkCellArray>::New();
  for (const Vector3d& place : places) {
    const vtkIdType end = add(*points, place);
    ends->InsertNextCell(1, &end);
  }
  const vtkIdType both[2] = {0, 1};
  if (places.size() >= 2) lines->InsertNextCell(2, both);
  shape->SetPoints(points);
  shape->SetVerts(ends);
  shape->SetLines(lines);
  return shape;
}

vtkSmartPointer<vtkPolyData> beamShape(const Vector3d& from, const Vector3d& to) {
  auto shape = vtkSmartPointer<vtkPolyData>::New();
  const auto points = vtkSmartPointer<vtkPoints>::New();
  const auto lines = vtkSmartPointer<vtkCellArray>::New(), ends = vtkSmartPointer<vtkCellArray>::New();
  addLine(*points, *lines, from, to);
  const vtkIdType end = 1;
  ends->InsertNextCell(1, &end);
  shape->SetPoints(points);
  shape->SetVerts(ends);
  shape->SetLines(lines);
  return shape;
}

}  // namespace tiltmap::ui
