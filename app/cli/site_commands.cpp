// tiltmap pin P.tiltmap [SCANS|none], tiltmap aerial add|place|show|remove P.tiltmap ...: what a person knows
// about the site.
#include "app/cli/operation_runner.h"
#include "core/base/text.h"
#include "core/project/operations/index_list.h"

namespace tiltmap::cli {

namespace {

struct PinWords {
  std::string project, scans;
};

int printPins(Context& context, const std::string& project) {
  const auto snapshot = readProject(project);
  if (!snapshot) return context.console.failed(snapshot.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (const ScanId scan : (*snapshot)->pins()) {
    const std::size_t index = (*snapshot)->indexOf(scan).value();
    list.push_back(index);
    text += (text.empty() ? "" : ", ") + std::to_string(index);
  }
  context.console.printJson({{"pins", list}});
  context.console.print(text.empty() ? "no scan is pinned; scan 0 never moves" : text);
  return kDone;
}

struct AerialWords {
  std::string project, file;
  std::vector<std::string> points;
};

Result<SitePicturePoint> pointOf(const std::string& text) {
  std::vector<double> numbers;
  for (const std::string_view part : splitAt(text, ','))
    if (const auto number = parseReal(trimmed(part))) numbers.push_back(*number);
  if (numbers.size() != 4)
    return fail(printable(text) + " is not a point", "--point",
                "write column and row in the picture (px), then x and y in the world (m): 120,455,3.5,-10");
  return SitePicturePoint{{numbers[0], numbers[1]}, {numbers[2], numbers[3]}};
}

Result<SitePicturePoints> pointsOf(const AerialWords& words) {
  SitePicturePoints points;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto point = pointOf(words.points.at(i));
    if (!point) return fail(point.error());
    points[i] = *point;
  }
  return points;
}

int showAerial(Context& context, const AerialWords& words) {
  const auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto& picture = (*snapshot)->sitePicture();
  if (!picture) {
    context.console.printJson({{"picture", nullptr}});
    context.console.print("the project has no picture of the site");
    return kDone;
  }
  nlohmann::json points = nlohmann::json::array();
  std::string text = picture->name + " (" + picture->media_type + ")";
  for (const SitePicturePoint& p : picture->points) {
    points.push_back({p.picture_px.x(), p.picture_px.y(), p.world_m.x(), p.world_m.y()});
    text += "\npixel " + fixedReal(p.picture_px.x(), 1) + ", " + fixedReal(p.picture_px.y(), 1) + " is at " +
            fixedReal(p.world_m.x(), 3) + " m, " + fixedReal(p.world_m.y(), 3) + " m";
  }
  const auto placed = SitePicturePlacement::make(picture->points);
  if (!placed) return context.console.failed(placed.error());
  context.console.printJson({{"picture", picture->name},
                             {"media_type", picture->media_type},
                             {"points", points},
                             {"metres_per_pixel", placed->metresPerPixel()}});
  context.console.print(text + "\n" + fixedReal(1000.0 * placed->metresPerPixel(), 1) + " mm a pixel");
  return kDone;
}

void addPoints(CLI::App& command, AerialWords& words) {
  command
      .add_option(
          "--point", words.points,
          "Twice: column and row in the picture (px) and x and y in the world (m), as 120,455,3.5,-10")
      ->required()
      ->expected(2)
      ->allow_extra_args(false)
      ->take_all();
}

template <class Make>
void addAerialEdit(CLI::App& aerial, Chosen& chosen, const char* name, const char* help, bool file,
                   bool points, Make make) {
  auto words = std::make_shared<AerialWords>();
  auto* command = aerial.add_subcommand(name, help);
  command->add_option("project", words->project, "The project")->required();
  if (file) command->add_option("file", words->file, "The picture: JPEG, PNG, TIFF, BMP, ...")->required();
  if (points) addPoints(*command, *words);
  command->callback([words, make, &chosen] {
    chosen.body = [words, make](Context& context) -> int {
      return editCommand(context, words->project,
                         [&](const SnapshotPtr& snapshot) { return make(*snapshot, *words); });
    };
  });
}

void addAerial(CLI::App& app, Chosen& chosen) {
  auto* aerial = app.add_subcommand("aerial", "A picture of the site from above: add, place, show, remove");
  aerial->require_subcommand(1);
  addAerialEdit(*aerial, chosen, "add", "Put a picture under the site map, placed by two points", true, true,
                [](const ProjectSnapshot&, const AerialWords& words) {
                  return pointsOf(words).and_then(
                      [&](const SitePicturePoints& points) { return sitePictureEdit(words.file, points); });
                });
  addAerialEdit(*aerial, chosen, "place", "Place the picture anew", false, true,
                [](const ProjectSnapshot& snapshot, const AerialWords& words) {
                  return pointsOf(words).and_then([&](const SitePicturePoints& points) {
                    return placeSitePictureEdit(snapshot, points);
                  });
                });
  addAerialEdit(
      *aerial, chosen, "remove", "Take it out", false, false,
      [](const ProjectSnapshot& snapshot, const AerialWords&) { return removeSitePictureEdit(snapshot); });
  auto words = std::make_shared<AerialWords>();
  auto* show = aerial->add_subcommand("show", "Which picture there is, and where it lies");
  show->add_option("project", words->project, "The project")->required();
  show->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return showAerial(context, *words); };
  });
}

}  // namespace

void addSite(CLI::App& app, Chosen& chosen) {
  auto words = std::make_shared<PinWords>();
  auto* command =
      app.add_subcommand("pin", "Say which scans a relaxation leaves where they are, or read which");
  command->add_option("project", words->project, "The project")->required();
  auto* scans =
      command->add_option("scans", words->scans, "Such as 3 or 0,5 or 2-4, these and no others; or none");
  command->callback([words, scans, &chosen] {
    chosen.body = [words, scans](Context& context) -> int {
      if (scans->count() == 0) return printPins(context, words->project);
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) -> Result<ProjectEdit> {
        if (words->scans == "none") return pinsEdit(*snapshot, {});
        return parseIndexList(words->scans, static_cast<int>(snapshot->scans().size()), "tiltmap pin")
            .map([&](const std::vector<int>& list) {
              std::vector<ScanId> pins;
              for (const int index : list)
                pins.push_back(snapshot->scans()[static_cast<std::size_t>(index)].id);
              return pinsEdit(*snapshot, std::move(pins));
            });
      });
    };
  });
  addAerial(app, chosen);
}

}  // namespace tiltmap::cli
