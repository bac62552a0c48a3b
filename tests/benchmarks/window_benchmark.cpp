// What the window's users wait for: frames while the map is turned, the whole picture afterwards, the start
// of the program. A program of its own, to be run on a display by tests/benchmarks/run; prints one JSON
// object.
#include <QApplication>
#include <QElapsedTimer>
#include <QMouseEvent>
#include <QOpenGLWidget>
#include <QTimer>
#include <QWindow>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "core/base/text.h"
#include "core/project/project.h"
#include "core/world/experiment.h"
#include "ui/look/theme.h"
#include "ui/models/capture_model.h"
#include "ui/models/strings.h"
#include "ui/panels/view3d_panel.h"
#include "ui/window/dock_area.h"
#include "ui/window/main_window.h"

namespace {

using namespace tiltmap;
using Eigen::Vector2d;
using Json = nlohmann::json;

constexpr int kWidth = 1170, kHeight = 553;

// Kilobytes of the line of /proc/self/status.
long memoryKb(const std::string& name) {
  std::ifstream file("/proc/self/status");
  std::string line;
  while (std::getline(file, line))
    if (line.starts_with(name + ":")) return std::strtol(line.c_str() + name.size() + 1, nullptr, 10);
  return 0;
}

double nowMs() {
  std::timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

// Of this thread alone: what it did itself, however long it waited for the machine.
double threadMs() {
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

// Of all threads of this process: what a frame costs, however busy the machine is.
double cpuMs() {
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

// A simulated survey driven again and again, each time beside the last: as many points as are wanted.
void largeProject(const std::filesystem::path& folder, std::size_t points) {
  const Experiment experiment = Experiment::make(ExperimentId::Exp2Fixed, 1).value();
  std::vector<Scan> drive;
  std::size_t of_drive = 0;
  for (int stop = 0; stop < experiment.stops(); ++stop) {
    SimulatedStop made = experiment.simulate(stop, 0).value();
    made.scan.odometry = made.truth;
    of_drive += made.scan.image->validCells();
    drive.push_back(std::move(made.scan));
  }
  std::filesystem::remove(folder / "large.tiltmap");
  auto project = Project::create(folder / "large.tiltmap").value();
  const std::size_t drives = (points + of_drive - 1) / of_drive;
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(drives))));
  for (std::size_t k = 0; k < drives; ++k) {
    std::vector<Scan> again = drive;
    const Pose there =
        Pose::planar(90.0 * static_cast<double>(k % side), 90.0 * static_cast<double>(k / side), 0);
    for (Scan& scan : again) {
      scan.odometry = there * scan.odometry;
      // Another matrix each time, as another stop would have: equal ones are stored once.
      RangeImageData data = scan.image->data();
      data.line_tilt_rad[0] += 1e-9 * static_cast<double>(k + 1);
      scan.image = RangeImage::make(std::move(data)).value();
    }
    (void)project->apply(importEdit(std::move(again))).value();
  }
}

void send(QWidget& widget, QEvent::Type type, const QPointF& place, Qt::MouseButton which,
          Qt::MouseButtons held) {
  QMouseEvent event(type, place, widget.mapToGlobal(place.toPoint()), which, held, Qt::NoModifier);
  QApplication::sendEvent(&widget, &event);
}

// Tiles of 24 pixels that the points lie in.
std::set<std::pair<int, int>> tilesOf(const ui::Scene& scene, const std::vector<Eigen::Vector3d>& points) {
  std::set<std::pair<int, int>> tiles;
  for (const Eigen::Vector3d& p : points) {
    const Vector2d pixel = scene.pixelOf(p);
    if (pixel.minCoeff() >= 0 && pixel.x() < kWidth && pixel.y() < kHeight)
      tiles.emplace(static_cast<int>(pixel.x()) / 24, static_cast<int>(pixel.y()) / 24);
  }
  return tiles;
}

Json frames(const std::filesystem::path& folder, std::size_t wanted, const std::string& colouring,
            bool shaded) {
  {
    largeProject(folder, wanted);  // and closed again
  }
  Json result;
  ui::Preferences preferences(ui::qt((folder / "settings.ini").string()));
  preferences.setText("view3d/colouring", ui::qt(colouring));
  preferences.setText("view3d/shaded", shaded ? "1" : "0");
  ui::Theme theme(preferences);
  auto* window = new ui::MainWindow(preferences, theme);
  window->resize(1366, 768);
  window->show();
  auto* panel = qobject_cast<ui::View3dPanel*>(window->docks().panel("view3d"));
  auto& widget = *qobject_cast<QOpenGLWidget*>(panel->view());
  ui::Scene& scene = panel->scene();
  // A window of its own, as when it is dragged out of the others.
  panel->setParent(nullptr);
  widget.setFixedSize(kWidth, kHeight);
  panel->show();
  QApplication::processEvents();
  const double before_open = nowMs();
  if (!window->workspace().session().open(ui::qt((folder / "large.tiltmap").string()))) return result;
  result["open_ms"] = nowMs() - before_open;
  result["scans"] = window->workspace().snapshot()->scans().size();
  int swapped = 0;
  QObject::connect(&widget, &QOpenGLWidget::frameSwapped, [&swapped] { ++swapped; });
  const auto untilRefined = [&] {
    const double begin = nowMs();
    do QApplication::processEvents(QEventLoop::AllEvents, 5);
    while (panel->isReading() || scene.isMoving() || !scene.isRefined());
    return nowMs() - begin;
  };
  result["first_ms"] = untilRefined();
  result["points"] = scene.pointsDrawn();

  // Turned with the mouse; each frame is on the screen before the next move.
  std::vector<double> times;
  const QPointF middle(kWidth / 2.0, kHeight / 2.0);
  send(widget, QEvent::MouseButtonPress, middle, Qt::LeftButton, Qt::LeftButton);
  double cpu_begin = 0.0;
  for (int k = 1; k <= 80; ++k) {
    const double begin = nowMs();
    const int before = swapped;
    send(widget, QEvent::MouseMove, middle + QPointF(6.0 * k, 20.0 * std::sin(0.1 * k)), Qt::NoButton,
         Qt::LeftButton);
    while (swapped == before) QApplication::processEvents(QEventLoop::AllEvents, 5);
    if (k == 5) cpu_begin = cpuMs();
    if (k > 5) times.push_back(nowMs() - begin);
  }
  result["cpu_ms_per_frame"] = (cpuMs() - cpu_begin) / static_cast<double>(times.size());
  result["moving_points"] = scene.pointsDrawn();
  result["moving_tiles"] = tilesOf(scene, scene.movingPoints()).size();
  // The next piece of the picture, which a move has to wait for if it comes just then.
  send(widget, QEvent::MouseButtonRelease, middle + QPointF(480.0, 0.0), Qt::LeftButton, Qt::NoButton);
  const double begin_refining = nowMs();
  double longest = 0.0;
  do {
    const double begin = nowMs();
    QApplication::processEvents(QEventLoop::AllEvents, 1);
    longest = std::max(longest, nowMs() - begin);
  } while (scene.isMoving() || !scene.isRefined());
  result["refined_ms"] = nowMs() - begin_refining;
  result["longest_piece_ms"] = longest;
  double sum = 0.0;
  for (const double t : times) sum += t;
  std::sort(times.begin(), times.end());
  result["frames_per_s"] = 1e3 * static_cast<double>(times.size()) / sum;
  result["slowest_twentieth_ms"] = times[times.size() * 19 / 20];
  result["memory_mb"] = static_cast<double>(memoryKb("VmRSS")) / 1024.0;
  result["memory_peak_mb"] = static_cast<double>(memoryKb("VmHWM")) / 1024.0;
  panel->hide();
  delete panel;  // before what it looks at
  window->closeNow();
  delete window;
  return result;
}

// Since this process was started, as the kernel has it (to 10 ms).
double ageMs() {
  std::ifstream file("/proc/self/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  std::istringstream rest(text.substr(text.rfind(')') + 2));
  std::string word;
  for (int field = 3; field <= 22; ++field) rest >> word;
  std::timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  const double now = static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
  return now - 1e3 * std::stod(word) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

// The program's start as its user meets it.
Json start(const std::string& project, const std::filesystem::path& folder) {
  Json result;
  ui::Preferences preferences(ui::qt((folder / "settings.ini").string()));
  ui::Theme theme(preferences);
  auto* window = new ui::MainWindow(preferences, theme);
  window->resize(1366, 768);
  window->show();
  while (!window->windowHandle() || !window->windowHandle()->isExposed())
    QApplication::processEvents(QEventLoop::AllEvents, 5);
  QApplication::processEvents();
  result["usable_ms"] = ageMs();
  const double before_open = nowMs();
  if (!window->workspace().session().open(ui::qt(project)))
    result["trouble"] = "the project cannot be opened";
  auto* panel = qobject_cast<ui::View3dPanel*>(window->docks().panel("view3d"));
  int swapped = 0;
  QObject::connect(qobject_cast<QOpenGLWidget*>(panel->view()), &QOpenGLWidget::frameSwapped,
                   [&swapped] { ++swapped; });
  while (swapped == 0 || panel->isReading() || !panel->scene().isRefined())
    QApplication::processEvents(QEventLoop::AllEvents, 5);
  result["drawn_ms"] = nowMs() - before_open;
  result["points"] = panel->scene().pointsDrawn();
  result["scans"] = window->workspace().snapshot()->scans().size();
  QElapsedTimer settle;
  settle.start();
  while (settle.elapsed() < 500) QApplication::processEvents(QEventLoop::AllEvents, 20);
  result["memory_mb"] = static_cast<double>(memoryKb("VmRSS")) / 1024.0;
  result["memory_peak_mb"] = static_cast<double>(memoryKb("VmHWM")) / 1024.0;
  window->closeNow();
  delete window;
  return result;
}

// How late the event loop serves a timer of 5 ms while the scanner says nothing more, until it is given up
// and looked for, and while it is looked for: milliseconds, and of how many looks.
Json latencyWhileSilent(ui::CaptureModel& model, const auto& until) {
  constexpr double kEveryMs = 5.0, kLongMs = 8000.0;
  Json result;
  std::vector<double> late;
  double last = nowMs(), worked = threadMs(), most_work = 0.0;
  QTimer timer;
  timer.setTimerType(Qt::PreciseTimer);
  QObject::connect(&timer, &QTimer::timeout, [&] {
    const double now = nowMs();
    late.push_back(std::max(0.0, now - last - kEveryMs));
    last = now;
    most_work = std::max(most_work, threadMs() - worked);
    worked = threadMs();
  });
  model.order("silent");
  timer.start(static_cast<int>(kEveryMs));
  last = nowMs();
  const double begin = nowMs();
  bool noticed = false;
  (void)until([&] {
    noticed = noticed || model.state() == StationState::Reconnecting;
    return nowMs() - begin > kLongMs;
  });
  timer.stop();
  if (late.empty()) return result;
  std::sort(late.begin(), late.end());
  result["noticed"] = noticed;
  result["looks"] = late.size();
  result["median_ms"] = late[late.size() / 2];
  result["worst_ms"] = late.back();
  result["most_work_ms"] = most_work;
  return result;
}

// Stops captured in the window with emulated instruments, and how long each verdict took after its last line.
Json verdicts(const std::filesystem::path& folder, int stops) {
  constexpr double kSpeed = 4.0, kPatienceMs = 120e3;
  const auto until = [](const auto& condition) {
    const double begin = nowMs();
    while (!condition() && nowMs() - begin < kPatienceMs)
      QApplication::processEvents(QEventLoop::AllEvents, 5);
    return condition();
  };
  Json result;
  ui::Preferences preferences(ui::qt((folder / "settings.ini").string()));
  ui::Theme theme(preferences);
  auto* window = new ui::MainWindow(preferences, theme);
  window->resize(1366, 768);
  window->show();
  std::filesystem::remove(folder / "verdict.tiltmap");
  if (!window->workspace().session().create(ui::qt((folder / "verdict.tiltmap").string()))) return result;
  window->setPerspective(ui::Perspective::Capture);
  ui::CaptureModel& model = ui::captureModel(window->workspace());
  CaptureSettings source;
  source.emulate = CaptureDrive::Exp2Fixed;
  source.speed = kSpeed;
  model.connectTo(source);
  bool well = until([&] { return model.state() == StationState::Ready; });
  result["milliseconds"] = Json::array();
  result["lights"] = Json::array();
  for (int stop = 1; well && stop <= stops; ++stop) {
    model.start({});
    well = until([&] {
      return model.now().sweep.number == stop && model.state() == StationState::Verdict &&
             model.verdict().judgement().has_value();
    });
    if (!well) break;
    const auto& judgement = *model.verdict().judgement();
    result["milliseconds"].push_back(1e3 * judgement.after_last_line_s);
    result["lights"].push_back(ui::utf8(ui::captureLightName(judgement.light)));
  }
  if (!well) result["trouble"] = ui::utf8(model.title() + ": " + model.sentence());
  if (well) result["silent"] = latencyWhileSilent(model, until);
  window->closeNow();
  delete window;
  std::filesystem::remove(folder / "verdict.tiltmap");
  return result;
}

}  // namespace

// frames FOLDER POINTS COLOURING [shaded] | start FOLDER PROJECT | verdict FOLDER STOPS
int main(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 3) return 2;
  QApplication::setAttribute(Qt::AA_EnableHighDpiScaling);
  QApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
  QApplication::setAttribute(Qt::AA_ShareOpenGLContexts);
  QApplication application(argc, argv);
  const std::filesystem::path folder = words[1];
  std::filesystem::create_directories(folder);
  Json result;
  if (words[0] == "frames" && words.size() > 3)
    result = frames(folder, static_cast<std::size_t>(std::stoull(words[2])), words[3],
                    words.size() > 4 && words[4] == "shaded");
  else if (words[0] == "start")
    result = start(words[2], folder);
  else if (words[0] == "verdict")
    result = verdicts(folder, std::stoi(words[2]));
  std::cout << result.dump() << std::endl;
  std::filesystem::remove(folder / "large.tiltmap");
  return 0;
}
