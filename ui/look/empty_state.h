// What an empty panel shows: what is missing and a button that helps.
#pragma once

#include <QWidget>

class QAction;
class QLabel;
class QToolButton;

namespace tiltmap::ui {

class EmptyState : public QWidget {
  Q_OBJECT

 public:
  explicit EmptyState(const QString& text, QAction* action = nullptr, QWidget* parent = nullptr);
  void setText(const QString& text);

 private:
  QLabel* label_;
};

}  // namespace tiltmap::ui
