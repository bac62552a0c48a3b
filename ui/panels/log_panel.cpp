#include "ui/panels/log_panel.h"

#include <QComboBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QScrollBar>
#include <QSortFilterProxyModel>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/models/log_model.h"
#include "ui/panels/table_view.h"

namespace tiltmap::ui {

LogPanel::LogPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent), view_(new TableView(this)) {
  auto* filter = new QSortFilterProxyModel(this);
  filter->setSourceModel(&sharedLogModel());
  filter->setFilterKeyColumn(LogModel::Text);
  filter->setFilterCaseSensitivity(Qt::CaseInsensitive);
  view_->setObjectName("log-view");
  view_->setAccessibleName("Log");
  view_->setToolTip("What the program did; Ctrl+C copies the selected lines");
  view_->setModel(filter);
  view_->horizontalHeader()->setStretchLastSection(true);
  view_->setColumnWidth(LogModel::Time, fontMetrics().horizontalAdvance("00:00:00.000") + 24);
  view_->setColumnWidth(LogModel::Level, fontMetrics().horizontalAdvance("warning") + 24);

  auto* search = new QLineEdit(this);
  search->setObjectName("log-filter");
  search->setPlaceholderText("Show lines with …");
  search->setAccessibleName("Filter of the log");
  search->setToolTip("Show only lines that hold this text");
  search->setClearButtonEnabled(true);
  connect(search, &QLineEdit::textChanged, filter, &QSortFilterProxyModel::setFilterFixedString);
  auto* folder = new QToolButton(this);
  folder->setDefaultAction(context.actions.get("help.log-folder"));
  folder->setAutoRaise(true);
  folder->setFocusPolicy(Qt::StrongFocus);

  auto* bar = new QHBoxLayout;
  bar->setContentsMargins(8, 4, 8, 4);
  bar->addWidget(search, 1);
  bar->addWidget(folder);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addLayout(bar);
  layout->addWidget(view_);

  // Follows the newest line unless its reader has scrolled back.
  connect(filter, &QAbstractItemModel::rowsAboutToBeInserted, this, [this] {
    const QScrollBar* bar_at = view_->verticalScrollBar();
    if (bar_at->value() == bar_at->maximum())
      QMetaObject::invokeMethod(view_, &QTableView::scrollToBottom, Qt::QueuedConnection);
  });
  view_->scrollToBottom();
}

}  // namespace tiltmap::ui
