#include "core/products/depth_figure.h"
#include "core/products/residuals.h"
#include "ui/scene/screenshots.h"

namespace tiltmap::ui {

Result<RgbImage> depthScreenshot(const SnapshotPtr& snapshot, const DepthScreenshot& settings) {
  const auto scan = snapshot->scanAt(static_cast<long long>(settings.scan));
  if (!scan) return fail(scan.error());
  const auto image = (*scan)->image();
  if (!image) return fail(image.error());
  std::vector<float> residuals;
  if (settings.quantity == DepthQuantity::Residual) {
    auto computed = ProjectResiduals(snapshot, settings.stage).of(settings.scan);
    if (!computed) return fail(computed.error());
    residuals = std::move(*computed);
  }
  const auto depth = depthImageOf(*image, (*scan)->geometry, settings.quantity, residuals);
  if (!depth) return fail(depth.error());
  DepthFigureSettings figure;
  figure.width_px = settings.width_px;
  figure.height_px = settings.height_px;
  figure.background = settings.background;
  figure.title = "Scan " + std::to_string(settings.scan) + ": " + (*scan)->name;
  return drawDepthFigure(*depth, figure).map([](const DepthFigure& drawn) { return drawn.image; });
}

}  // namespace tiltmap::ui
