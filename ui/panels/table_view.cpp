#include "ui/panels/table_view.h"

#include <QApplication>
#include <QClipboard>
#include <QHeaderView>
#include <QKeyEvent>
#include <algorithm>

namespace tiltmap::ui {

TableView::TableView(QWidget* parent) : QTableView(parent) {
  setFrameShape(QFrame::NoFrame);
  setShowGrid(false);
  setAlternatingRowColors(true);
  setSelectionBehavior(QAbstractItemView::SelectRows);
  setEditTriggers(QAbstractItemView::NoEditTriggers);
  setWordWrap(false);
  setTabKeyNavigation(false);
  verticalHeader()->hide();
  verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  horizontalHeader()->setHighlightSections(false);
  horizontalHeader()->setDefaultAlignment(Qt::AlignLeft | Qt::AlignVCenter);
}

QString TableView::selectedText() const {
  QModelIndexList rows = selectionModel() ? selectionModel()->selectedRows() : QModelIndexList();
  if (rows.isEmpty() && model())
    for (int row = 0; row < model()->rowCount(); ++row) rows << model()->index(row, 0);
  std::sort(rows.begin(), rows.end());
  if (rows.isEmpty()) return {};
  QStringList header;
  const int columns = model()->columnCount();
  for (int c = 0; c < columns; ++c) header << model()->headerData(c, Qt::Horizontal).toString();
  QString text = header.join('\t') + "\n";
  for (const QModelIndex& row : rows) {
    QStringList cells;
    for (int c = 0; c < columns; ++c) cells << row.siblingAtColumn(c).data().toString();
    text += cells.join('\t') + "\n";
  }
  return text;
}

void TableView::setEvenColumns() {
  even_columns_ = true;
  connect(model(), &QAbstractItemModel::modelReset, this, &TableView::fitColumns);
  fitColumns();
}

void TableView::fitColumns() {
  if (!even_columns_) return;
  int widest = 0;
  const int columns = horizontalHeader()->count();
  for (int c = 0; c < columns; ++c)
    widest = std::max({widest, horizontalHeader()->sectionSizeHint(c), sizeHintForColumn(c)});
  const bool fits = widest * columns <= viewport()->width();
  horizontalHeader()->setSectionResizeMode(fits ? QHeaderView::Stretch : QHeaderView::ResizeToContents);
  horizontalHeader()->setStretchLastSection(!fits);
}

void TableView::resizeEvent(QResizeEvent* event) {
  QTableView::resizeEvent(event);
  fitColumns();
}

void TableView::copy() const {
  QApplication::clipboard()->setText(selectedText());
}

void TableView::keyPressEvent(QKeyEvent* event) {
  if (event->matches(QKeySequence::Copy)) return copy();
  QTableView::keyPressEvent(event);
}

}  // namespace tiltmap::ui
