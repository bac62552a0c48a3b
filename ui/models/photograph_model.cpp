#include "ui/models/photograph_model.h"

#include <QBuffer>
#include <QFileInfo>
#include <QImageReader>
#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/project/photographs.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

// Turned as its camera says, no larger than wanted.
QImage decoded(const std::string& contents, QString& trouble) {
  QByteArray bytes = QByteArray::fromRawData(contents.data(), static_cast<int>(contents.size()));
  QBuffer buffer(&bytes);
  QImageReader reader(&buffer);
  reader.setAutoTransform(true);
  reader.setDecideFormatFromContent(true);
  constexpr int kLargest = PhotographModel::kLargest_px;
  if (const QSize size = reader.size(); size.width() > kLargest || size.height() > kLargest)
    reader.setScaledSize(size.scaled(kLargest, kLargest, Qt::KeepAspectRatio));
  const QImage picture = reader.read();
  if (picture.isNull()) trouble = "This kind of picture cannot be shown here. Save it to see it elsewhere.";
  return picture;
}

}  // namespace

bool isPictureName(const QString& file) {
  static const QStringList kSuffixes = {"jpg", "jpeg", "png", "webp", "gif", "tif", "tiff", "bmp", "heic"};
  return kSuffixes.contains(QFileInfo(file).suffix().toLower());
}

PhotographModel::PhotographModel(Workspace& workspace, QObject* parent)
    : QAbstractListModel(parent), workspace_(workspace) {
  connect(&workspace.selection(), &Selection::scansChanged, this, &PhotographModel::refresh);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &PhotographModel::refresh);
  // Numbers of photographs come again in another project.
  connect(&workspace.session(), &ProjectSession::closed, this, [this] {
    beginResetModel();
    shown_.clear();
    scan_.reset();
    worker_.cancel();
    endResetModel();
  });
  refresh();
}

void PhotographModel::refresh() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  const auto current = workspace_.selection().currentScan();
  const ScanEntry* scan = snapshot && current ? snapshot->find(*current) : nullptr;
  if (!scan && snapshot && !snapshot->scans().empty()) scan = &snapshot->scans().front();
  const auto id = scan ? std::optional(scan->id) : std::nullopt;
  const std::vector<Photograph> photographs = scan ? scan->photographs : std::vector<Photograph>();
  if (id == scan_ && std::ranges::equal(photographs, shown_, {}, &Photograph::id,
                                        [](const Shown& shown) { return shown.photograph.id; }))
    return;
  beginResetModel();
  std::vector<Shown> known = std::exchange(shown_, {});
  scan_ = id;
  for (const Photograph& photograph : photographs) {
    const auto found =
        std::ranges::find_if(known, [&](const Shown& shown) { return shown.photograph.id == photograph.id; });
    shown_.push_back(found == known.end() ? Shown{photograph, {}, {}, {}} : std::move(*found));
  }
  endResetModel();
  read();
}

void PhotographModel::read() {
  std::vector<std::int64_t> wanted;
  for (const Shown& shown : shown_)
    if (shown.picture.isNull() && shown.trouble.isEmpty()) wanted.push_back(shown.photograph.id);
  if (wanted.empty()) return worker_.cancel();
  struct Read {
    std::int64_t photograph = 0;
    QImage picture;
    QString trouble;
  };
  worker_.start([this, wanted,
                 snapshot = workspace_.snapshot()](const std::stop_token& stop) -> BackgroundWorker::Done {
    std::vector<Read> read;
    for (const std::int64_t photograph : wanted) {
      if (stop.stop_requested()) return {};
      Read one{photograph, {}, {}};
      const auto contents = photographContents(*snapshot, photograph);
      if (contents)
        one.picture = decoded(*contents, one.trouble);
      else
        one.trouble = qt(contents.error().what) + ": " + qt(contents.error().remedy);
      read.push_back(std::move(one));
    }
    return [this, read = std::move(read)] {
      for (const Read& one : read) take(one.photograph, one.picture, one.trouble);
    };
  });
}

void PhotographModel::take(std::int64_t photograph, const QImage& picture, const QString& trouble) {
  for (int row = 0; row < rowCount(); ++row) {
    Shown& shown = shown_[static_cast<std::size_t>(row)];
    if (shown.photograph.id != photograph) continue;
    shown.picture = picture;
    shown.trouble = trouble;
    if (!picture.isNull())
      shown.small =
          picture.scaled(2 * kSmall_px, 2 * kSmall_px, Qt::KeepAspectRatio, Qt::SmoothTransformation);
    shown.small.setDevicePixelRatio(2.0);
    Q_EMIT dataChanged(index(row), index(row));
    Q_EMIT pictureRead(row);
  }
}

const Photograph* PhotographModel::photograph(int row) const {
  return row >= 0 && row < rowCount() ? &shown_[static_cast<std::size_t>(row)].photograph : nullptr;
}

QImage PhotographModel::picture(int row) const {
  return photograph(row) ? shown_[static_cast<std::size_t>(row)].picture : QImage();
}

QString PhotographModel::trouble(int row) const {
  return photograph(row) ? shown_[static_cast<std::size_t>(row)].trouble : QString();
}

Status PhotographModel::told(Status status) const {
  if (!status) workspace_.messages().error(status.error());
  return status;
}

Status PhotographModel::add(const QStringList& files, const QString& caption) {
  const SnapshotPtr snapshot = workspace_.snapshot();
  const ScanEntry* scan = snapshot && scan_ ? snapshot->find(*scan_) : nullptr;
  if (!scan)
    return told(fail("a photograph belongs to a stop", "photographs", "select the stop it was taken at"));
  ProjectEdit all;
  for (const QString& file : files) {
    auto photograph = photographFromFile(pathOf(file), utf8(caption), true);
    if (!photograph) return told(fail(photograph.error()));
    ProjectEdit one = addPhotographEdit(*scan, std::move(*photograph));
    all.title =
        files.size() == 1 ? one.title : std::to_string(files.size()) + " photographs of " + scan->name;
    std::ranges::move(one.steps, std::back_inserter(all.steps));
  }
  return all.empty() ? Status() : workspace_.session().apply(all);
}

Status PhotographModel::remove(int row) {
  const Photograph* removed = photograph(row);
  if (!removed) return {};
  const auto edit = removePhotographEdit(*workspace_.snapshot(), removed->id);
  return edit ? workspace_.session().apply(*edit) : told(fail(edit.error()));
}

Status PhotographModel::save(int row, const QString& file) const {
  const Photograph* saved = photograph(row);
  if (!saved) return {};
  const auto contents = photographContents(*workspace_.snapshot(), saved->id);
  if (!contents) return told(fail(contents.error()));
  return told(writeFileAtomically(pathOf(file), *contents));
}

QString PhotographModel::proposedName(int row) const {
  const Photograph* saved = photograph(row);
  const auto stop = scan_ ? workspace_.snapshot()->indexOf(*scan_) : std::nullopt;
  if (!saved || !stop) return {};
  return QString("stop-%1-%2%3").arg(*stop).arg(row + 1).arg(qt(pictureExtension(saved->media_type)));
}

int PhotographModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(shown_.size());
}

QVariant PhotographModel::data(const QModelIndex& index, int role) const {
  const Photograph* shown = index.isValid() ? photograph(index.row()) : nullptr;
  if (!shown) return {};
  const Shown& here = shown_[static_cast<std::size_t>(index.row())];
  if (role == Qt::DisplayRole)
    return shown->caption.empty() ? QString("Photograph %1").arg(index.row() + 1) : qt(shown->caption);
  if (role == Qt::DecorationRole) return here.small.isNull() ? QVariant() : QVariant(here.small);
  if (role == Qt::ToolTipRole) {
    const QString where = shown->path.empty()
                              ? QString("in the project, %1 kB").arg((shown->bytes + 999) / 1000)
                              : "in the file " + qt(shown->path);
    return data(index, Qt::DisplayRole).toString() + "\n" + qt(shown->media_type) + ", " + where +
           (here.trouble.isEmpty() ? QString() : "\n" + here.trouble);
  }
  return {};
}

}  // namespace tiltmap::ui
