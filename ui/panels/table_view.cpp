#include "ui/panels/table_view.h"

#include <QApplication>
#include <QClipboard>
#include <QHeaderView>
#include <QKeyEvent>

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

void TableView::copy() const {
  QApplication::clipboard()->setText(selectedText());
}

void TableView::keyPressEvent(QKeyEvent* event) {
  if (event->matches(QKeySequence::Copy)) return copy();
  QTableView::keyPressEvent(event);
}

}  // namespace tiltmap::ui
