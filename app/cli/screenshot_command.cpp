// tiltmap screenshot P.tiltmap OUT.png: a picture, with no display and no window.
#include <algorithm>
#include <cctype>

#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "core/products/png.h"
#include "core/project/operations/pair_list.h"
#include "ui/scene/screenshots.h"
#include "ui/window/window_screenshot.h"

namespace tiltmap::cli {

namespace {

struct ScreenshotWords {
  std::string project, file;
  std::string panel = "map", size, stage, view = "iso", colour = "scan", quantity = "range", points = "all";
  std::string perspective = "inspect", theme = "dark";
  std::vector<std::string> front;
  std::string pair, preset = "default", relax;
  int iteration = -1, relax_step = 0;
  double scale = 1.0;
  long long scan = -1;
  double point_size = 2.0;
  bool white = false, shaded = false;
};

struct Size {
  int width = 0, height = 0;
};

Result<Size> sizeOf(const std::string& text) {
  const auto parts = splitAt(text, 'x');
  const auto width = parts.size() == 2 ? parseInteger(parts[0]) : std::nullopt;
  const auto height = parts.size() == 2 ? parseInteger(parts[1]) : std::nullopt;
  if (!width || !height || *width < 1 || *height < 1 || *width > 16384 || *height > 16384)
    return fail(printable(text) + " is not a size", "--size",
                "write width and height in pixels: 1600x900, up to 16384x16384");
  return Size{static_cast<int>(*width), static_cast<int>(*height)};
}

Result<RgbImage> mapPicture(const SnapshotPtr& snapshot, const ScreenshotWords& words, const Size& size) {
  ui::MapScreenshot settings;
  settings.width_px = size.width;
  settings.height_px = size.height;
  settings.background = words.white ? TopViewBackground::White : TopViewBackground::Dark;
  const auto stage = stageOrLatest(*snapshot, words.stage);
  if (!stage) return fail(stage.error());
  settings.stage = *stage;
  const auto view = ui::parseSceneView(words.view);
  if (!view) return fail(view.error());
  settings.view = *view;
  const auto colouring = ui::parseSceneColouring(words.colour);
  if (!colouring) return fail(colouring.error());
  settings.scene.colouring = *colouring;
  settings.scene.point_px = words.point_size;
  settings.scene.shaded = words.shaded;
  settings.scene.reduced = words.points == "reduced";
  if (words.scan >= 0) {
    if (const auto scan = snapshot->scanAt(words.scan); !scan) return fail(scan.error());
    settings.scan = static_cast<std::size_t>(words.scan);
  }
  return ui::mapScreenshot(snapshot, settings);
}

Result<RgbImage> depthPictureOf(const SnapshotPtr& snapshot, const ScreenshotWords& words, const Size& size) {
  ui::DepthScreenshot settings;
  settings.width_px = size.width;
  settings.height_px = size.height;
  settings.background = words.white ? TopViewBackground::White : TopViewBackground::Dark;
  const auto scan = snapshot->scanAt(std::max(0LL, words.scan));
  if (!scan) return fail(scan.error());
  settings.scan = static_cast<std::size_t>(std::max(0LL, words.scan));
  const auto quantity = parseDepthQuantity(words.quantity);
  if (!quantity) return fail(quantity.error());
  settings.quantity = *quantity;
  const auto stage = stageOrLatest(*snapshot, words.stage);
  if (!stage) return fail(stage.error());
  settings.stage = *stage;
  return ui::depthScreenshot(snapshot, settings);
}

Result<RgbImage> windowPicture(const SnapshotPtr& snapshot, const ScreenshotWords& words, const Size& size) {
  ui::WindowScreenshot settings;
  settings.panel = words.panel;
  settings.width_px = size.width;
  settings.height_px = size.height;
  settings.scale = words.scale;
  settings.theme = words.theme == "light"           ? ui::ThemeChoice::Light
                   : words.theme == "high-contrast" ? ui::ThemeChoice::HighContrast
                                                    : ui::ThemeChoice::Dark;
  settings.colouring = words.colour;
  settings.quantity = words.quantity;
  settings.perspective = ui::parsePerspective(words.perspective).value_or(ui::Perspective::Inspect);
  settings.front = words.front;
  if (words.scan >= 0) settings.scan = static_cast<std::size_t>(words.scan);
  if (!words.pair.empty()) {
    const auto pairs = parsePairList(words.pair, static_cast<int>(snapshot->scans().size()));
    if (!pairs) return fail(pairs.error());
    if (auto known = operations().find("register")->presetValues(words.preset); !known)
      return fail(known.error());
    settings.stepped = {static_cast<std::size_t>(pairs->front().first),
                        static_cast<std::size_t>(pairs->front().second),
                        words.preset,
                        {}};
    if (words.iteration >= 0) settings.stepped->iteration = words.iteration;
  }
  if (!words.relax.empty()) {
    settings.relaxed = {words.relax, {}};
    if (words.relax_step > 0) settings.relaxed->step = words.relax_step;
  }
  if (!words.stage.empty()) {
    const auto stage = stageOrLatest(*snapshot, words.stage);
    if (!stage) return fail(stage.error());
    settings.stage = *stage;
  }
  return ui::windowScreenshot(words.project, settings);
}

// Where no size is asked for; a depth image of the given width is as high as it needs.
Size usualSize(const std::string& panel) {
  if (panel == "map") return {1600, 900};
  if (panel == "depth") return {1200, 0};
  return panel == "window" ? Size{1366, 768} : Size{800, 600};
}

int takeScreenshot(Context& context, const ScreenshotWords& words) {
  const Result<Size> size = words.size.empty() ? usualSize(words.panel) : sizeOf(words.size);
  if (!size) return context.console.wrongUsage(size.error());
  if (Status status = checkOutput(words.file, words.project); !status)
    return context.console.failed(status.error());
  const auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto draw = words.panel == "map"     ? mapPicture
                    : words.panel == "depth" ? depthPictureOf
                                             : windowPicture;
  const auto picture = draw(*snapshot, words, *size);
  if (!picture) return context.console.failed(picture.error());
  if (Status status = writePng(words.file, *picture); !status) return context.console.failed(status.error());
  context.console.printJson({{"file", words.file},
                             {"panel", words.panel},
                             {"width", picture->width},
                             {"height", picture->height},
                             {"warnings", nlohmann::json::array()}});
  context.console.print("wrote " + words.file + " (" + std::to_string(picture->width) + " x " +
                        std::to_string(picture->height) + ")");
  return kDone;
}

}  // namespace

void addScreenshot(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<ScreenshotWords>();
  auto* command = app.add_subcommand("screenshot", "A picture of the map or of a scan; needs no display");
  command->add_option("project", words->project, "The project")->required();
  command->add_option("file", words->file, "The PNG file to write")->required();
  const std::vector<std::string> panels = ui::panelNames();
  std::vector<std::string> pictures = {"map", "depth", "window"};
  pictures.insert(pictures.end(), panels.begin(), panels.end());
  command
      ->add_option("--panel", words->panel,
                   "map (the scans in 3D), depth (a range matrix), window (all of it), or one of its panels")
      ->check(CLI::IsMember(pictures));
  command->add_option("--size", words->size, "Width and height in pixels: 1600x900");
  command->add_option("--stage", words->stage, "Whose poses place the scans; default: the latest");
  command->add_option("--view", words->view, "Of the map, default iso")
      ->check(CLI::IsMember({"top", "front", "side", "iso"}));
  command->add_option("--scan", words->scan, "Number of a scan, from 0: the map shows it alone")
      ->check(CLI::NonNegativeNumber);
  command
      ->add_option("--colour", words->colour,
                   "Points by scan, height, range, intensity, normal, age or residual")
      ->check(CLI::IsMember({"scan", "height", "range", "intensity", "normal", "age", "residual"}));
  command
      ->add_option("--quantity", words->quantity,
                   "Depth image of range, median, planar-median, changed, normal, incidence, intensity, code "
                   "or residual")
      ->check(CLI::IsMember({"range", "median", "planar-median", "changed", "normal", "incidence",
                             "intensity", "code", "residual"}));
  command->add_option("--perspective", words->perspective, "Of the window, default inspect")
      ->check(CLI::IsMember({"capture", "inspect", "register", "relax"}));
  command->add_option("--front", words->front, "Panels of the window that are brought to the front")
      ->check(CLI::IsMember(panels));
  command->add_option("--pair", words->pair, "FIXED:MOVING that the ICP stepper shows, run to its end");
  command
      ->add_option("--iteration", words->iteration, "Of the ICP stepper, 0 is the start; default: the last")
      ->check(CLI::NonNegativeNumber)
      ->needs("--pair");
  command->add_option("--preset", words->preset, "Of the ICP stepper: default or thesis")->needs("--pair");
  command
      ->add_option("--relax", words->relax,
                   "Preset of a relaxation whose proposal window and panels show; the project is not touched")
      ->check(CLI::IsMember({"default", "thesis", "sequential"}));
  command->add_option("--relax-step", words->relax_step, "Held within this step instead, 1 is the first")
      ->check(CLI::PositiveNumber)
      ->needs("--relax");
  command->add_option("--theme", words->theme, "Of window and panels: dark, light or high-contrast")
      ->check(CLI::IsMember({"dark", "light", "high-contrast"}));
  command->add_option("--scale", words->scale, "Of window and panels, as on a fine screen: 1 to 4")
      ->check(CLI::Range(1.0, 4.0));
  command->add_option("--points", words->points, "all or reduced")->check(CLI::IsMember({"all", "reduced"}));
  command->add_option("--point-size", words->point_size, "Pixels, 1 to 20")->check(CLI::Range(1.0, 20.0));
  command->add_flag("--shaded", words->shaded, "Map: points behind their neighbours are darker");
  command->add_flag("--white", words->white, "On white, for print");
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return takeScreenshot(context, *words); };
  });
}

}  // namespace tiltmap::cli
