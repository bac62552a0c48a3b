// What the window has to tell its user: errors where something went wrong, notes where something was done.
#pragma once

#include <QObject>
#include <QString>
#include <optional>

#include "core/base/result.h"

namespace tiltmap::ui {

enum class MessageKind { Note, Warning, Error };

struct Message {
  MessageKind kind = MessageKind::Note;
  QString text;     // what happened, and where
  QString remedy;   // what to do
  QString details;  // folded away until asked for
  QString action;   // id of an action that helps; empty: none
};

// Everything shown is also in the log.
class Messages : public QObject {
  Q_OBJECT

 public:
  using QObject::QObject;

  void show(const Message& message);
  void error(const Error& error);
  void warnings(const QString& title, const std::vector<std::string>& warnings);
  void note(const QString& text);
  std::optional<Message> latest() const { return latest_; }

 Q_SIGNALS:
  void shown(const tiltmap::ui::Message& message);

 private:
  std::optional<Message> latest_;
};

}  // namespace tiltmap::ui
