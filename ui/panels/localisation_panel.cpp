#include "ui/panels/localisation_panel.h"

#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QToolButton>
#include <QVBoxLayout>

#include "core/base/atomic_file.h"
#include "core/io/pose_file.h"
#include "ui/look/icons.h"
#include "ui/models/localisation_model.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/table_view.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

QToolButton* toolButton(const QString& name, const QString& text, const QString& help, QWidget* parent) {
  auto* button = new QToolButton(parent);
  button->setIcon(icon(name));
  button->setText(text);
  button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  button->setAutoRaise(true);
  button->setToolTip(help);
  button->setAccessibleDescription(help);
  button->setFocusPolicy(Qt::StrongFocus);
  return button;
}

}  // namespace

LocalisationPanel::LocalisationPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new LocalisationModel(context.workspace, this)),
      stage_(new QComboBox(this)),
      summary_(new QLabel(this)),
      copy_(toolButton("edit-copy", "Copy", "Copy the whole table as text, in metres", this)),
      export_(toolButton("document-export", "Export…",
                         "Write the table as .csv, as text (.txt) or as TUM poses (.tum), in metres", this)),
      view_(new TableView(this)) {
  stage_->setObjectName("localisation-stage");
  stage_->setAccessibleName("Stage of the poses");
  stage_->setSizeAdjustPolicy(QComboBox::AdjustToContents);
  stage_->setToolTip("Whose poses: the stage places the scans in all views");
  // It wraps: in one line it would take from the panels beside.
  summary_->setWordWrap(true);
  summary_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  copy_->setObjectName("localisation-copy");
  export_->setObjectName("localisation-export");
  view_->setObjectName("localisation-view");
  view_->setAccessibleName("Localisation table");
  view_->setToolTip("Where the stops are at the stage chosen above; Ctrl+C copies the selected rows");
  view_->setModel(model_);
  view_->setEvenColumns();
  view_->horizontalHeader()->setMinimumSectionSize(48);

  auto* bar = new QHBoxLayout;
  bar->setContentsMargins(8, 4, 8, 4);
  bar->setSpacing(8);
  bar->addWidget(stage_);
  bar->addWidget(summary_, 1);
  bar->addWidget(copy_);
  bar->addWidget(export_);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addLayout(bar);
  layout->addWidget(view_);

  connect(model_, &QAbstractItemModel::modelReset, this, &LocalisationPanel::refresh);
  connect(stage_, qOverload<int>(&QComboBox::activated), this, [this](int row) {
    const QVariant chosen = stage_->itemData(row);
    context_.workspace.display().setStage(chosen.isValid() ? std::optional(static_cast<Stage>(chosen.toInt()))
                                                           : std::nullopt);
  });
  connect(copy_, &QToolButton::clicked, this, [this] {
    QApplication::clipboard()->setText(model_->asText());
    context_.workspace.messages().note("The localisation table is on the clipboard.");
  });
  connect(export_, &QToolButton::clicked, this, &LocalisationPanel::askExport);
  connect(view_->selectionModel(), &QItemSelectionModel::selectionChanged, this,
          &LocalisationPanel::takeSelection);
  connect(&context.workspace.selection(), &Selection::scansChanged, this, &LocalisationPanel::showSelection);
  refresh();
}

void LocalisationPanel::refresh() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const QSignalBlocker blocker(stage_);
  stage_->clear();
  stage_->addItem("Latest stage");
  if (snapshot) {
    stage_->setItemText(0, "Latest: " + stageTitle(snapshot->latestStage()).toLower());
    for (const Stage stage : snapshot->stages()) stage_->addItem(stageTitle(stage), static_cast<int>(stage));
    if (const auto chosen = context_.workspace.display().chosenStage())
      stage_->setCurrentIndex(std::max(0, stage_->findData(static_cast<int>(*chosen))));
  }
  summary_->setText(model_->summary());
  copy_->setEnabled(model_->rowCount() > 0);
  export_->setEnabled(model_->rowCount() > 0);
  showSelection();
}

void LocalisationPanel::takeSelection() {
  if (following_) return;
  following_ = true;
  std::vector<ScanId> scans;
  const QModelIndexList rows = view_->selectionModel()->selectedRows();
  for (const QModelIndex& index : rows) scans.push_back(model_->scanAt(index.row()));
  const QModelIndex current = view_->currentIndex();
  context_.workspace.selection().setScans(
      std::move(scans), current.isValid() ? std::optional(model_->scanAt(current.row())) : std::nullopt);
  following_ = false;
}

void LocalisationPanel::showSelection() {
  if (following_) return;
  following_ = true;
  QItemSelection rows;
  for (const ScanId scan : context_.workspace.selection().scans())
    if (const int row = model_->rowOf(scan); row >= 0 && row < model_->rowCount())
      rows.select(model_->index(row, 0), model_->index(row, model_->columnCount() - 1));
  view_->selectionModel()->select(rows, QItemSelectionModel::ClearAndSelect);
  following_ = false;
}

void LocalisationPanel::askExport() {
  askForFiles(this, context_.workspace.preferences(),
              {FileQuestion::Save, "Export the localisation table",
               "Spreadsheet (*.csv);;Text (*.txt);;TUM poses (*.tum)", "csv", "exports",
               context_.workspace.session().name() + "-" + qt(model_->table().stage) + ".csv"},
              [this](const QStringList& files) { exportTo(files.front()); });
}

void LocalisationPanel::exportTo(const QString& path) {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  if (!snapshot) return;
  std::string text;
  if (path.endsWith(".tum")) {
    IndexedPoses poses;
    int index = 0;
    for (const Pose& pose : snapshot->filledPoses(model_->stage())) poses.emplace(index++, pose);
    text = posesTumText(poses);
  } else {
    text = utf8(path.endsWith(".txt") ? model_->asText() : model_->asCsv());
  }
  if (const Status status = writeFileAtomically(pathOf(path), text); !status)
    context_.workspace.messages().error(status.error());
  else
    context_.workspace.messages().note("Written: " + path);
}

}  // namespace tiltmap::ui
