// The latest thing the window has to say, above the panels: what happened, what to do, details that fold out.
#pragma once

#include <QFrame>

#include "ui/models/messages.h"

class QLabel;
class QPlainTextEdit;
class QTimer;
class QToolButton;

namespace tiltmap::ui {

class ActionRegistry;
class Theme;

// Errors and warnings stay until closed or followed by another message; notes go after some seconds.
class MessageBar : public QFrame {
  Q_OBJECT

 public:
  MessageBar(Messages& messages, ActionRegistry& actions, const Theme& theme, QWidget* parent = nullptr);

  void show(const Message& message);
  const Message& message() const { return message_; }

 private:
  void recolour();
  void copy() const;

  ActionRegistry& actions_;
  const Theme& theme_;
  Message message_;
  QLabel* sign_;
  QLabel* text_;
  QToolButton* action_;
  QToolButton* fold_;
  QToolButton* copy_;
  QPlainTextEdit* details_;
  QTimer* timer_;
};

}  // namespace tiltmap::ui
