// Where the stops are, by stage; copied and exported.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QComboBox;
class QLabel;
class QToolButton;

namespace tiltmap::ui {

class LocalisationModel;
class TableView;

class LocalisationPanel : public QWidget {
  Q_OBJECT

 public:
  explicit LocalisationPanel(const PanelContext& context, QWidget* parent = nullptr);

  TableView* view() const { return view_; }
  LocalisationModel& model() const { return *model_; }
  void exportTo(const QString& path);

 private:
  void refresh();
  void askExport();
  void takeSelection();
  void showSelection();

  PanelContext context_;
  LocalisationModel* model_;
  QComboBox* stage_;
  QLabel* summary_;
  QToolButton* copy_;
  QToolButton* export_;
  TableView* view_;
  bool following_ = false;
};

}  // namespace tiltmap::ui
