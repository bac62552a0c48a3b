// tiltmap photo add|list|save|remove P.tiltmap ...: pictures taken at the stops.
#include "app/cli/operation_runner.h"
#include "core/base/atomic_file.h"
#include "core/project/photographs.h"

namespace tiltmap::cli {

namespace {

struct PhotoWords {
  std::string project;
  long long scan = 0;
  long long photograph = 0;
  std::string file;
  std::string caption;
  bool outside = false;
};

int listPhotographs(Context& context, const PhotoWords& words) {
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  nlohmann::json list = nlohmann::json::array();
  std::string text;
  for (std::size_t i = 0; i < (*snapshot)->scans().size(); ++i)
    for (const Photograph& photograph : (*snapshot)->scans()[i].photographs) {
      list.push_back({{"id", photograph.id},
                      {"scan", i},
                      {"caption", photograph.caption},
                      {"media_type", photograph.media_type},
                      {"path", photograph.path},
                      {"bytes", photograph.bytes}});
      text += std::to_string(photograph.id) + "  stop " + std::to_string(i) + "  " + photograph.media_type +
              "  " +
              (photograph.path.empty() ? std::to_string(photograph.bytes) + " bytes" : photograph.path) +
              (photograph.caption.empty() ? "" : "  " + photograph.caption) + "\n";
    }
  context.console.printJson({{"photographs", list}});
  context.console.print(text.empty() ? "there are no photographs" : text);
  return kDone;
}

int savePhotograph(Context& context, const PhotoWords& words) {
  if (Status status = checkOutput(words.file, words.project); !status)
    return context.console.failed(status.error());
  auto snapshot = readProject(words.project);
  if (!snapshot) return context.console.failed(snapshot.error());
  const auto contents = photographContents(**snapshot, words.photograph);
  if (!contents) return context.console.failed(contents.error());
  if (Status status = writeFileAtomically(words.file, *contents); !status)
    return context.console.failed(status.error());
  context.console.printJson({{"file", words.file}, {"bytes", contents->size()}});
  context.console.print("wrote " + words.file);
  return kDone;
}

void addAdd(CLI::App& photo, Chosen& chosen) {
  auto words = std::make_shared<PhotoWords>();
  auto* command = photo.add_subcommand("add", "Put a picture into the project");
  command->add_option("project", words->project, "The project")->required();
  command->add_option("scan", words->scan, "Number of the stop it was taken at, from 0")->required();
  command->add_option("file", words->file, "JPEG, PNG, WebP, GIF, TIFF, BMP or HEIC")->required();
  command->add_option("--caption", words->caption, "What it shows");
  command->add_flag("--outside", words->outside, "Remember where the file is instead of keeping a copy");
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) {
        return snapshot->scanAt(words->scan).and_then([&](const ScanEntry* scan) {
          return photographFromFile(words->file, words->caption, !words->outside)
              .map([&](NewPhotograph photograph) { return addPhotographEdit(*scan, std::move(photograph)); });
        });
      });
    };
  });
}

void addRemove(CLI::App& photo, Chosen& chosen) {
  auto words = std::make_shared<PhotoWords>();
  auto* command = photo.add_subcommand("remove", "Take a picture out");
  command->add_option("project", words->project, "The project")->required();
  command->add_option("photograph", words->photograph, "Its number, as `tiltmap photo list` shows it")
      ->required();
  command->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int {
      return editCommand(context, words->project, [&](const SnapshotPtr& snapshot) {
        return removePhotographEdit(*snapshot, words->photograph);
      });
    };
  });
}

}  // namespace

void addPhoto(CLI::App& app, Chosen& chosen) {
  auto* photo = app.add_subcommand("photo", "Pictures taken at the stops: add, list, save, remove");
  photo->require_subcommand(1);
  addAdd(*photo, chosen);
  auto words = std::make_shared<PhotoWords>();
  auto* list = photo->add_subcommand("list", "Which pictures there are");
  list->add_option("project", words->project, "The project")->required();
  list->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return listPhotographs(context, *words); };
  });
  auto* save = photo->add_subcommand("save", "Write a picture to a file, as it was put in");
  save->add_option("project", words->project, "The project")->required();
  save->add_option("photograph", words->photograph, "Its number, as `tiltmap photo list` shows it")
      ->required();
  save->add_option("file", words->file, "Where to write it")->required();
  save->callback([words, &chosen] {
    chosen.body = [words](Context& context) -> int { return savePhotograph(context, *words); };
  });
  addRemove(*photo, chosen);
}

}  // namespace tiltmap::cli
