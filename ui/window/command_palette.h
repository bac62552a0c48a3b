// Ctrl+K: every action, found by letters of its name or words of its help.
#pragma once

#include <QDialog>

class QAction;
class QLineEdit;
class QListWidget;

namespace tiltmap::ui {

class ActionRegistry;

class CommandPalette : public QDialog {
  Q_OBJECT

 public:
  explicit CommandPalette(ActionRegistry& actions, QWidget* parent);

  void popUp();
  // Best first: the beginning of the name, words of the name, letters in order, words of the help.
  static int score(const QAction& action, const QString& wanted);

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void filter(const QString& wanted);
  void runCurrent();

  ActionRegistry& actions_;
  QLineEdit* search_;
  QListWidget* list_;
};

}  // namespace tiltmap::ui
