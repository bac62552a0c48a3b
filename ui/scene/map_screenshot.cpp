#include "core/products/residuals.h"
#include "ui/scene/offscreen_window.h"
#include "ui/scene/screenshots.h"

namespace tiltmap::ui {

Result<RgbImage> mapScreenshot(const SnapshotPtr& snapshot, const MapScreenshot& settings) {
  if (snapshot->scans().empty())
    return fail("there is nothing to draw: the project has no scans", snapshot->path().string(),
                "import or simulate some first");
  auto window = OffscreenWindow::make(settings.width_px, settings.height_px);
  if (!window) return fail(window.error());
  Scene scene;
  scene.attach((*window)->window());
  scene.setColours(settings.background == TopViewBackground::Dark ? SceneColours::dark()
                                                                  : SceneColours::white());
  (void)scene.setSettings(settings.scene);
  if (settings.scan) {
    const ScanId chosen = snapshot->scans()[*settings.scan].id;
    scene.setVisible([chosen](ScanId scan) { return scan == chosen; });
  }
  if (const auto troubles = scene.show(snapshot, settings.stage); !troubles.empty())
    return fail("a scan cannot be read: " + troubles.front(), snapshot->path().string(),
                "`tiltmap verify` says what is damaged");
  if (settings.scene.colouring == SceneColouring::Residual) {
    ProjectResiduals residuals(snapshot, settings.stage);
    ScanResiduals values;
    for (std::size_t i = 0; i < snapshot->scans().size(); ++i) {
      if (settings.scan && *settings.scan != i) continue;
      auto computed = residuals.of(i);
      if (!computed) return fail(computed.error());
      values[snapshot->scans()[i].id] = std::make_shared<const std::vector<float>>(std::move(*computed));
    }
    scene.setResiduals(values);
  }
  scene.setOrthographic(settings.view != SceneView::Iso && settings.view != SceneView::IsoBack);
  scene.setView(settings.view);
  scene.render();
  RgbImage picture = (*window)->picture();
  scene.detach();
  return picture;
}

}  // namespace tiltmap::ui
