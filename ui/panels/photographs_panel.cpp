#include "ui/panels/photographs_panel.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QListView>
#include <QPainter>
#include <QStackedLayout>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/look/icons.h"
#include "ui/models/photograph_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

// One picture, as large as there is room for it.
class PictureView : public QWidget {
 public:
  using QWidget::QWidget;
  void show(const QImage& picture, const QString& text) {
    picture_ = picture;
    text_ = text;
    update();
  }
  QSize sizeHint() const override { return {320, 240}; }
  QSize minimumSizeHint() const override { return {120, 90}; }

 protected:
  void paintEvent(QPaintEvent*) override {
    QPainter painter(this);
    painter.fillRect(rect(), palette().color(QPalette::Base));
    if (picture_.isNull()) {
      painter.setPen(palette().color(QPalette::PlaceholderText));
      painter.drawText(rect().adjusted(16, 16, -16, -16), Qt::AlignCenter | Qt::TextWordWrap, text_);
      return;
    }
    const QSize room = size() - QSize(16, 16);
    const QSize shown = picture_.size().scaled(room, Qt::KeepAspectRatio);
    QRect place(QPoint(), shown);
    place.moveCenter(rect().center());
    painter.setRenderHint(QPainter::SmoothPixmapTransform);
    painter.drawImage(place, picture_);
  }

 private:
  QImage picture_;
  QString text_;
};

PhotographsPanel::PhotographsPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new PhotographModel(context.workspace, this)),
      list_(new QListView(this)),
      picture_(new PictureView(this)) {
  buildBar();
  describe(list_, "photographs-list", "Photographs of the stop",
           "The photographs that were taken at the selected stop");
  list_->setModel(model_);
  list_->setFrameShape(QFrame::NoFrame);
  list_->setIconSize(QSize(PhotographModel::kSmall_px, PhotographModel::kSmall_px * 3 / 4));
  list_->setUniformItemSizes(true);
  list_->setFixedWidth(220);
  describe(picture_, "photographs-picture", "The photograph", "The photograph chosen in the list");
  auto* both = new QWidget(this);
  auto* row = new QHBoxLayout(both);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(1);
  row->addWidget(list_);
  row->addWidget(picture_, 1);
  auto* empty = new EmptyState("No photograph of this stop yet. Add some, or drop them on the window.",
                               context.actions.find("edit.photograph"), this);
  empty->setObjectName("photographs-empty");
  auto* pages = new QWidget(this);
  pages_ = new QStackedLayout(pages);
  pages_->addWidget(empty);
  pages_->addWidget(both);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(bar_);
  layout->addWidget(pages, 1);
  setFocusProxy(list_);

  connect(list_->selectionModel(), &QItemSelectionModel::currentChanged, this, &PhotographsPanel::refresh);
  connect(model_, &QAbstractItemModel::modelReset, this, [this] {
    if (model_->rowCount() > 0) list_->setCurrentIndex(model_->index(model_->rowCount() - 1));
    refresh();
  });
  connect(model_, &PhotographModel::pictureRead, this, &PhotographsPanel::refresh);
  connect(&context.workspace.jobs(), &JobQueue::busyChanged, this, &PhotographsPanel::refresh);
  // A stop may have another place or name, or the project be another.
  connect(&context.workspace.session(), &ProjectSession::snapshotReplaced, this, &PhotographsPanel::refresh);
  if (model_->rowCount() > 0) list_->setCurrentIndex(model_->index(model_->rowCount() - 1));
  refresh();
}

void PhotographsPanel::buildBar() {
  bar_ = new QWidget(this);
  auto* layout = new QHBoxLayout(bar_);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(8);
  which_ = new QLabel(bar_);
  which_->setObjectName("photographs-stop");
  which_->setAccessibleName("The stop whose photographs are shown");
  caption_ = new QLineEdit(bar_);
  describe(caption_, "photographs-caption", "Caption of the photographs that are added next",
           "What the photographs that are added next show; kept with each of them");
  caption_->setPlaceholderText("Caption of the next");
  caption_->setMaximumWidth(220);
  auto* add = new QToolButton(bar_);
  add->setDefaultAction(context_.actions.get("edit.photograph"));
  add->setObjectName("photographs-add");
  add->setAccessibleName("Add photographs");
  add->setText("Add…");
  add->setIcon(icon("list-add"));
  add->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  add->setAutoRaise(true);
  save_ = toolButton(bar_, "photographs-save", "Save…", "Write the photograph to a file, as it was put in");
  save_->setIcon(icon("document-save"));
  remove_ = toolButton(bar_, "photographs-remove", "Remove",
                       "Take the photograph out of the project; undo brings it back");
  remove_->setIcon(icon("edit-delete"));
  for (QToolButton* button : {add, save_, remove_}) button->setFocusPolicy(Qt::StrongFocus);
  for (QToolButton* button : {save_, remove_}) button->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  connect(save_, &QToolButton::clicked, this, &PhotographsPanel::askWhereToSave);
  connect(remove_, &QToolButton::clicked, this, [this, add] {
    (void)model_->remove(currentRow());
    // Not to the caption, which would take Undo for its own.
    (model_->rowCount() > 0 ? static_cast<QWidget*>(list_) : add)->setFocus();
  });
  layout->addWidget(which_);
  layout->addStretch();
  for (QWidget* widget : std::initializer_list<QWidget*>{caption_, add, save_, remove_})
    layout->addWidget(widget);
}

int PhotographsPanel::currentRow() const {
  return list_->currentIndex().isValid() ? list_->currentIndex().row() : -1;
}

void PhotographsPanel::refresh() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const auto scan = model_->scan();
  const auto stop = snapshot && scan ? snapshot->indexOf(*scan) : std::nullopt;
  which_->setText(stop ? QString("Stop %1: %2").arg(*stop).arg(qt(snapshot->scans()[*stop].name))
                       : QString("No stop"));
  const int row = currentRow();
  const bool writable = context_.workspace.session().isWritable() && !context_.workspace.jobs().busy();
  caption_->setEnabled(stop && writable);
  save_->setEnabled(row >= 0);
  remove_->setEnabled(row >= 0 && writable);
  pages_->setCurrentIndex(model_->rowCount() > 0 ? 1 : 0);
  QString text = model_->trouble(row);
  if (text.isEmpty()) text = row < 0 ? "Choose a photograph in the list." : "Reading the photograph…";
  picture_->show(model_->picture(row), text);
}

void PhotographsPanel::add(const QStringList& files) {
  if (model_->add(files, caption_->text().trimmed())) caption_->clear();
}

void PhotographsPanel::askForFilesToAdd() {
  askForFiles(this, context_.workspace.preferences(),
              {FileQuestion::OpenMany, "Add photographs", kPictureFilter, {}, "photographs", {}},
              [this](const QStringList& files) { add(files); });
}

void PhotographsPanel::askWhereToSave() {
  const int row = currentRow();
  askForFiles(
      this, context_.workspace.preferences(),
      {FileQuestion::Save, "Save photograph", kPictureFilter, {}, "photographs", model_->proposedName(row)},
      [this, row](const QStringList& files) {
        if (model_->save(row, files.front())) context_.workspace.messages().note("Wrote " + files.front());
      });
}

}  // namespace tiltmap::ui
