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
  // Columns share the width evenly where all of them fit with their texts, else each is as wide as its text and the
  // table scrolls.
  void setEvenColumns();
  void copy() const;

 protected:
  void resizeEvent(QResizeEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void fitColumns();

  bool even_columns_ = false;
};

}  // namespace tiltmap::ui
