#include "ui/panels/history_panel.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/models/history_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/table_view.h"

namespace tiltmap::ui {

HistoryPanel::HistoryPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new HistoryModel(context.workspace.session(), this)),
      view_(new TableView(this)) {
  view_->setObjectName("history-view");
  view_->setAccessibleName("History of edits");
  view_->setToolTip("Every edit, the latest below; a double click goes back or forth to one");
  view_->setModel(model_);
  view_->setSelectionMode(QAbstractItemView::SingleSelection);
  view_->horizontalHeader()->setSectionResizeMode(HistoryModel::What, QHeaderView::Stretch);
  view_->horizontalHeader()->setSectionResizeMode(HistoryModel::When, QHeaderView::ResizeToContents);
  view_->horizontalHeader()->setSectionResizeMode(HistoryModel::State, QHeaderView::ResizeToContents);

  auto* bar = new QHBoxLayout;
  bar->setContentsMargins(8, 4, 8, 4);
  bar->setSpacing(4);
  for (const char* id : {"edit.undo", "edit.redo"}) {
    auto* button = new QToolButton(this);
    button->setDefaultAction(context.actions.get(id));
    button->setAutoRaise(true);
    button->setFocusPolicy(Qt::StrongFocus);
    bar->addWidget(button);
  }
  bar->addStretch();
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addLayout(bar);
  layout->addWidget(view_);
  connect(view_, &QAbstractItemView::activated, this, &HistoryPanel::goTo);
  connect(view_, &QAbstractItemView::doubleClicked, this, &HistoryPanel::goTo);
  connect(model_, &QAbstractItemModel::modelReset, this,
          [this] { view_->scrollTo(model_->index(model_->currentRow(), 0)); });
}

void HistoryPanel::goTo(const QModelIndex& index) {
  if (!index.isValid() || index.row() == model_->currentRow()) return;
  if (context_.workspace.jobs().busy()) {
    context_.workspace.messages().note("The work that is running must end first, or be cancelled.");
    return;
  }
  (void)context_.workspace.session().goTo(index.row());
}

}  // namespace tiltmap::ui
