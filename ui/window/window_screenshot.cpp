#include "ui/window/window_screenshot.h"

#include <QApplication>
#include <QElapsedTimer>
#include <QPainter>
#include <QTemporaryDir>
#include <QTimer>
#include <algorithm>
#include <cmath>

#include "core/project/project.h"
#include "ui/look/theme.h"
#include "ui/models/log.h"
#include "ui/models/log_model.h"
#include "ui/models/relaxation_model.h"
#include "ui/models/strings.h"
#include "ui/panels/depth_image_panel.h"
#include "ui/panels/scene_widget.h"
#include "ui/panels/view3d_panel.h"
#include "ui/window/dock_area.h"
#include "ui/window/gui_application.h"
#include "ui/window/main_window.h"

namespace tiltmap::ui {

namespace {

constexpr int kFont_pt = 9;  // as where no desktop says otherwise
constexpr int kSmallest_px = 160;
constexpr int kLargest_px = 8192;

// What Qt says of a screen that is not there is no news.
void keepQuiet(QtMsgType, const QMessageLogContext&, const QString&) {}

// Timers of zero length, layouts and thumbnails that come in the next round of the event loop; points,
// residuals and whatever else is read or computed aside.
void settle(Workspace& workspace, const QWidget& shown) {
  QElapsedTimer clock;
  clock.start();
  const auto reads = [&shown](auto* one_of) {
    using Panel = std::remove_pointer_t<decltype(one_of)>;
    const auto* itself = qobject_cast<const Panel*>(&shown);
    return (itself && itself->isReading()) ||
           std::ranges::any_of(shown.findChildren<Panel*>(), &Panel::isReading);
  };
  const auto busy = [&] {
    const JobStatus* job = workspace.jobs().current();
    const bool computes = job && job->phase == JobPhase::Running && !workspace.relaxation().isHolding();
    return computes || workspace.residuals().isComputing() ||
           reads(static_cast<View3dPanel*>(nullptr)) || reads(static_cast<DepthImagePanel*>(nullptr));
  };
  while (clock.elapsed() < 200 || (busy() && clock.elapsed() < 60000))
    QApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents, 20);
}

// A picture of the widget as Qt draws it, with each 3D view rendered apart and put in its place.
Result<QImage> pictureOf(QWidget& shown) {
  QImage picture = shown.grab().toImage();
  QPainter painter(&picture);
  for (SceneWidget* view : shown.findChildren<SceneWidget*>()) {
    if (!view->isVisibleTo(&shown) || view->width() < 16 || view->height() < 16) continue;
    const Result<QImage> scene = view->pictureWithoutScreen();
    if (!scene) return fail(scene.error());
    const QPoint place = view->mapTo(&shown, QPoint());
    painter.drawImage(QRect(place, view->size()), *scene);
    for (QObject* child : view->children())
      if (auto* above = qobject_cast<QWidget*>(child); above && above->isVisibleTo(view))
        above->render(&painter, above->mapTo(&shown, QPoint()), QRegion(), QWidget::DrawChildren);
  }
  painter.end();
  return picture;
}

RgbImage rgbImage(const QImage& picture) {
  const QImage rgb = picture.convertToFormat(QImage::Format_RGB888);
  RgbImage image(rgb.width(), rgb.height(), Rgb{});
  for (int y = 0; y < rgb.height(); ++y) {
    const uchar* line = rgb.constScanLine(y);
    for (int x = 0; x < rgb.width(); ++x) image.at(x, y) = {line[3 * x], line[3 * x + 1], line[3 * x + 2]};
  }
  return image;
}

void arrange(MainWindow& window, const WindowScreenshot& settings) {
  window.setPerspective(settings.perspective);
  for (const std::string& panel : settings.front) window.showPanel(qt(panel));
  Workspace& workspace = window.workspace();
  const SnapshotPtr snapshot = workspace.snapshot();
  if (settings.stage) workspace.display().setStage(settings.stage);
  if (settings.scan) workspace.selection().setCurrentScan(snapshot->scans()[*settings.scan].id);
}

// Runs the stepper's pair to its end and goes to the iteration.
Status step(StepperModel& stepper, const ProjectSnapshot& snapshot, const WindowScreenshot::Stepped& wanted) {
  stepper.parameters().setPreset(qt(wanted.preset));
  stepper.choose(snapshot.scans()[wanted.fixed].id, snapshot.scans()[wanted.moving].id);
  if (!stepper.isReady())
    return fail(utf8(stepper.problem()), "--pair", "name two scans of the project, as 0:1");
  stepper.setPace(0);
  stepper.run();
  while (!stepper.isEnded() && (stepper.isRunning() || stepper.isWorking()))
    QApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents, 20);
  if (!stepper.isEnded())
    return fail("the pair cannot be registered", "--pair",
                "`tiltmap verify` says whether its scans can be read");
  if (wanted.iteration && *wanted.iteration > stepper.count())
    return fail("there is no iteration " + std::to_string(*wanted.iteration), "--iteration",
                "the registration ends after " + std::to_string(stepper.count()));
  stepper.goTo(wanted.iteration.value_or(stepper.count()));
  return {};
}

// Starts a relaxation and waits until it is held, or proposes its result.
Status relax(Workspace& workspace, const WindowScreenshot::Relaxed& wanted) {
  RelaxationModel& relaxation = workspace.relaxation();
  JobRequest request;
  request.operation = operations().find("relax");
  request.preset = qt(wanted.preset);
  request.ask = true;
  request.title = "Relax all scans (" + request.preset + ")";
  relaxation.holdNextAt(wanted.step.value_or(0));
  const auto job = workspace.start(request);
  const auto over = [&] { return !job || workspace.jobs().find(*job)->over(); };
  while (!over() && !relaxation.isProposal() && !relaxation.isHolding())
    QApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents, 20);
  if (over())
    return fail("the relaxation did not come to a result", "--relax", "`tiltmap relax` tells why not");
  if (wanted.step && relaxation.isProposal())
    return fail("there is no step " + std::to_string(*wanted.step), "--relax-step",
                "the relaxation ends after " + std::to_string(relaxation.step()));
  return {};
}

Result<QImage> shoot(MainWindow& window, const WindowScreenshot& settings) {
  window.resize(settings.width_px, settings.height_px);
  window.show();
  window.resize(settings.width_px, settings.height_px);
  arrange(window, settings);
  if (settings.stepped)
    if (Status stepped =
            step(window.workspace().stepper(), *window.workspace().snapshot(), *settings.stepped);
        !stepped)
      return fail(stepped.error());
  if (settings.relaxed)
    if (Status relaxed = relax(window.workspace(), *settings.relaxed); !relaxed) return fail(relaxed.error());
  settle(window.workspace(), window);
  if (settings.panel == "window") return pictureOf(window);
  for (const PanelInfo& info : panels()) {
    if (info.id != qt(settings.panel)) continue;
    const std::unique_ptr<QWidget> panel(info.make(window.docks().context()));
    panel->setAutoFillBackground(true);
    panel->resize(settings.width_px, settings.height_px);
    panel->show();
    settle(window.workspace(), *panel);
    return pictureOf(*panel);
  }
  return fail("there is no panel \"" + settings.panel + "\"", "--panel", "choose one that the help names");
}

Status checkSettings(const ProjectSnapshot& snapshot, const WindowScreenshot& settings) {
  for (const int side : {settings.width_px, settings.height_px})
    if (side < kSmallest_px || side * settings.scale > kLargest_px)
      return fail("a window of " + std::to_string(settings.width_px) + " x " +
                      std::to_string(settings.height_px) + " pixels cannot be drawn",
                  "--size", "choose 160 to 8192 pixels for either side, scaling included");
  if (settings.stepped)
    for (const std::size_t place : {settings.stepped->fixed, settings.stepped->moving})
      if (const auto scan = snapshot.scanAt(static_cast<long long>(place)); !scan) return fail(scan.error());
  if (settings.scan)
    if (const auto scan = snapshot.scanAt(static_cast<long long>(*settings.scan)); !scan)
      return fail(scan.error());
  return {};
}

}  // namespace

std::optional<Perspective> parsePerspective(const std::string& name) {
  for (const Perspective perspective : kPerspectives)
    if (perspectiveName(perspective).toLower() == qt(name)) return perspective;
  return {};
}

std::vector<std::string> panelNames() {
  std::vector<std::string> names;
  for (const PanelInfo& panel : panels()) names.push_back(utf8(panel.id));
  return names;
}

Result<RgbImage> windowScreenshot(const std::filesystem::path& project, const WindowScreenshot& settings) {
  const QTemporaryDir folder;
  if (!folder.isValid())
    return fail("there is no place for temporary files", utf8(folder.errorString()),
                "make room in the folder that TMPDIR names");
  const auto copy = pathOf(folder.path()) / project.filename();
  {
    auto original = Project::open(project, Access::ReadOnly);
    if (!original) return fail(original.error());
    if (Status good = checkSettings(*(*original)->snapshot(), settings); !good) return fail(good.error());
    if (Status copied = (*original)->saveCopy(copy); !copied) return fail(copied.error());
  }
  // Whatever display there is stays out of it: the same picture everywhere.
  for (const char* display : {"DISPLAY", "WAYLAND_DISPLAY", "QT_STYLE_OVERRIDE", "QT_FONT_DPI"})
    qunsetenv(display);
  qputenv("QT_QPA_PLATFORM", "offscreen");
  qputenv("QT_SCALE_FACTOR", QByteArray::number(settings.scale));
  qputenv("XDG_RUNTIME_DIR", folder.path().toUtf8());
  const auto handler = qInstallMessageHandler(keepQuiet);
  Result<QImage> picture = QImage();
  {
    static char name[] = "tiltmap";
    static char* words[] = {name, nullptr};
    static int count = 1;
    prepareApplication();
    QApplication application(count, words);
    nameApplication();
    QApplication::setCursorFlashTime(0);
    QApplication::setFont(QFont("Sans Serif", kFont_pt));
    sharedLogModel();
    Preferences preferences(folder.filePath("settings.ini"));
    preferences.setTheme(settings.theme);
    preferences.setText("view3d/colouring", qt(settings.colouring));
    preferences.setText("depth/quantity-0", qt(settings.quantity));
    const Theme theme(preferences);
    {
      // Deleted by hand: the window deletes itself only when it is closed.
      const std::unique_ptr<MainWindow> window = std::make_unique<MainWindow>(preferences, theme);
      if (Status opened = window->workspace().session().open(qt(copy)); !opened)
        picture = fail(opened.error());
      else
        picture = shoot(*window, settings);
    }
    QCoreApplication::sendPostedEvents(nullptr, QEvent::DeferredDelete);
  }
  qInstallMessageHandler(handler);
  if (!picture) return fail(picture.error());
  return rgbImage(*picture);
}

}  // namespace tiltmap::ui
