// A table as all panels show one: rows selected as a whole, copied as text.
#pragma once

#include <QTableView>

namespace tiltmap::ui {

class TableView : public QTableView {
  Q_OBJECT

 public:
  explicit TableView(QWidget* parent = nullptr);
  // The selected rows (all where none is), tab-separated, with the header: what a spreadsheet takes.
  QString selectedText() const;
  void copy() const;

 protected:
  void keyPressEvent(QKeyEvent* event) override;
};

}  // namespace tiltmap::ui
