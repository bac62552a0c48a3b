#include "ui/models/messages.h"

#include "core/base/text.h"
#include "ui/models/log.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

// "the file ends early" to "The file ends early."
QString sentence(QString text) {
  if (text.isEmpty()) return text;
  text[0] = text[0].toUpper();
  if (!QString(".!?").contains(text.back())) text += '.';
  return text;
}

LogLevel levelOf(MessageKind kind) {
  switch (kind) {
    case MessageKind::Note:
      return LogLevel::Info;
    case MessageKind::Warning:
      return LogLevel::Warning;
    case MessageKind::Error:
      return LogLevel::Error;
  }
  return LogLevel::Info;
}

}  // namespace

void Messages::show(const Message& message) {
  QString line = message.text;
  if (!message.remedy.isEmpty()) line += " " + message.remedy;
  if (!message.details.isEmpty()) line += "\n" + message.details;
  logLine(levelOf(message.kind), line);
  latest_ = message;
  Q_EMIT shown(message);
}

void Messages::error(const Error& error) {
  Message message;
  message.kind = MessageKind::Error;
  message.text = sentence(qt(error.what));
  message.remedy = sentence(qt(error.remedy));
  if (!error.where.empty()) message.details = "Where: " + qt(error.where);
  show(message);
}

void Messages::warnings(const QString& title, const std::vector<std::string>& warnings) {
  if (warnings.empty()) return;
  Message message;
  message.kind = MessageKind::Warning;
  message.text = warnings.size() == 1
                     ? title + ": " + qt(warnings.front()) + "."
                     : QString("%1: done, with %2 warnings.").arg(title).arg(warnings.size());
  if (warnings.size() > 1) message.details = qt(joined(warnings, "\n"));
  show(message);
}

void Messages::note(const QString& text) {
  show({MessageKind::Note, text, {}, {}, {}});
}

}  // namespace tiltmap::ui
