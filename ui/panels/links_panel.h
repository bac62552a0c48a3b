// The links in a table, the worst first, and what one does with them.
#pragma once

#include <QWidget>

#include "ui/models/link_table_model.h"
#include "ui/panels/panel.h"

class QComboBox;
class QFrame;
class QLabel;
class QSortFilterProxyModel;
class QStackedWidget;
class QToolButton;

namespace tiltmap::ui {

class TableView;

class LinksPanel : public QWidget {
  Q_OBJECT

 public:
  explicit LinksPanel(const PanelContext& context, QWidget* parent = nullptr);

  LinkTableModel& model() const { return *model_; }
  TableView* view() const { return view_; }
  QModelIndex indexOf(LinkId link) const;  // in the view, sorted as it is

 private:
  QWidget* makeBar();
  QWidget* makeAddRow();
  QWidget* makeWhatIf();
  void refresh();
  void refreshButtons();
  void fillScans();
  void takeSelection();
  void showSelection();
  void setState(LinkState state);
  void deleteSelected();
  void registerAgain();
  void showBoth();
  void askWhatIf();
  void judge();
  void add(const char* method);

  PanelContext context_;
  LinkTableModel* model_;
  QSortFilterProxyModel* sorted_;
  TableView* view_;
  QStackedWidget* pages_ = nullptr;
  QLabel* summary_ = nullptr;
  QToolButton* add_ = nullptr;
  QToolButton* state_ = nullptr;
  QToolButton* delete_ = nullptr;
  QToolButton* again_ = nullptr;
  QToolButton* show_ = nullptr;
  QToolButton* what_if_ = nullptr;
  QToolButton* judge_ = nullptr;
  QFrame* add_row_ = nullptr;
  QComboBox* fixed_ = nullptr;
  QComboBox* moving_ = nullptr;
  QToolButton* add_register_ = nullptr;
  QToolButton* add_placed_ = nullptr;
  QFrame* said_ = nullptr;
  QLabel* said_text_ = nullptr;
  QToolButton* said_disable_ = nullptr;
  bool following_ = false;
};

}  // namespace tiltmap::ui
