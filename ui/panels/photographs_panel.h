// The photographs of the current stop: add, see, save, remove.
#pragma once

#include <QWidget>

#include "ui/panels/panel.h"

class QLabel;
class QLineEdit;
class QListView;
class QStackedLayout;
class QToolButton;

namespace tiltmap::ui {

class PhotographModel;
class PictureView;

class PhotographsPanel : public QWidget {
  Q_OBJECT

 public:
  explicit PhotographsPanel(const PanelContext& context, QWidget* parent = nullptr);

  PhotographModel& model() { return *model_; }
  QListView* list() { return list_; }
  // With what the caption's field says.
  void add(const QStringList& files);
  // Where the files are asked for.
  void askForFilesToAdd();

 private:
  void buildBar();
  void refresh();
  int currentRow() const;
  void askWhereToSave();

  PanelContext context_;
  PhotographModel* model_;
  QWidget* bar_;
  QLabel* which_;
  QLineEdit* caption_;
  QToolButton* save_;
  QToolButton* remove_;
  QListView* list_;
  PictureView* picture_;
  QStackedLayout* pages_;
};

}  // namespace tiltmap::ui
