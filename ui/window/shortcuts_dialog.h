// Every action with its keys.
#pragma once

#include <QDialog>

class QTableWidget;

namespace tiltmap::ui {

class ActionRegistry;

class ShortcutsDialog : public QDialog {
  Q_OBJECT

 public:
  explicit ShortcutsDialog(const ActionRegistry& actions, QWidget* parent = nullptr);

 private:
  void fill(const QString& wanted);

  const ActionRegistry& actions_;
  QTableWidget* table_;
};

}  // namespace tiltmap::ui
