// Pictures of a project without a window: for `tiltmap screenshot`, lessons and reports.
#pragma once

#include <optional>

#include "core/products/depth_image.h"
#include "core/products/rgb_image.h"
#include "core/products/top_view.h"
#include "core/project/project_snapshot.h"
#include "ui/scene/scene.h"

namespace tiltmap::ui {

struct ScreenshotSettings {
  int width_px = 1600;
  int height_px = 900;
  TopViewBackground background = TopViewBackground::Dark;
};

struct MapScreenshot : ScreenshotSettings {
  Stage stage = Stage::Odometry;
  SceneView view = SceneView::Iso;
  std::optional<std::size_t> scan;  // that one only
  SceneSettings scene;
};

// The 3D view; orthographic, except for iso. Error: no OpenGL, a project without scans, a scan that cannot be
// read.
Result<RgbImage> mapScreenshot(const SnapshotPtr& snapshot, const MapScreenshot& settings);

struct DepthScreenshot : ScreenshotSettings {
  std::size_t scan = 0;
  DepthQuantity quantity = DepthQuantity::Range;
  Stage stage = Stage::Odometry;  // of residuals
};

// The depth image of one scan with its axes.
Result<RgbImage> depthScreenshot(const SnapshotPtr& snapshot, const DepthScreenshot& settings);

}  // namespace tiltmap::ui
