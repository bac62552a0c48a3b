// The bottom line: what is being computed with progress, time left and Cancel; else what the project holds.
#pragma once

#include <QFrame>

class QLabel;
class QProgressBar;
class QPushButton;

namespace tiltmap::ui {

class Workspace;

class JobBar : public QFrame {
  Q_OBJECT

 public:
  explicit JobBar(Workspace& workspace, QWidget* parent = nullptr);

 private:
  void refresh();
  void refreshProject();

  Workspace& workspace_;
  QLabel* title_;
  QProgressBar* progress_;
  QLabel* message_;
  QPushButton* accept_;
  QPushButton* cancel_;
  QLabel* project_;
};

}  // namespace tiltmap::ui
