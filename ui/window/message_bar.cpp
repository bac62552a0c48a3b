#include "ui/window/message_bar.h"

#include <QApplication>
#include <QClipboard>
#include <QHBoxLayout>
#include <QLabel>
#include <QPlainTextEdit>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/icons.h"
#include "ui/look/theme.h"

namespace tiltmap::ui {

namespace {

constexpr int kNoteMilliseconds = 6000;

QToolButton* flatButton(const QString& name, const QString& text, const QString& help, QWidget* parent) {
  auto* button = new QToolButton(parent);
  button->setObjectName(name);
  button->setText(text);
  button->setToolTip(help);
  button->setAutoRaise(true);
  button->setFocusPolicy(Qt::StrongFocus);
  return button;
}

QString signOf(MessageKind kind) {
  switch (kind) {
    case MessageKind::Note:
      return "dialog-information";
    case MessageKind::Warning:
      return "dialog-warning";
    case MessageKind::Error:
      return "dialog-error";
  }
  return {};
}

}  // namespace

MessageBar::MessageBar(Messages& messages, ActionRegistry& actions, const Theme& theme, QWidget* parent)
    : QFrame(parent),
      actions_(actions),
      theme_(theme),
      sign_(new QLabel(this)),
      text_(new QLabel(this)),
      action_(new QToolButton(this)),
      fold_(flatButton("message-details", "Details", "Show or hide the details", this)),
      copy_(flatButton("message-copy", "Copy", "Copy the whole message as text", this)),
      details_(new QPlainTextEdit(this)),
      timer_(new QTimer(this)) {
  setObjectName("message-bar");
  setAccessibleName("Message");
  setAutoFillBackground(true);
  text_->setObjectName("message-text");
  text_->setWordWrap(true);
  text_->setTextFormat(Qt::RichText);
  text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  action_->setObjectName("message-action");
  action_->setFocusPolicy(Qt::StrongFocus);
  action_->setToolTip("What helps");
  action_->setAccessibleName("What helps");
  action_->setToolButtonStyle(Qt::ToolButtonTextOnly);
  fold_->setCheckable(true);
  details_->setObjectName("message-details-text");
  details_->setAccessibleName("Details of the message");
  details_->setToolTip("Details of the message; text can be selected and copied");
  details_->setReadOnly(true);
  details_->setMaximumHeight(fontMetrics().height() * 7);
  auto* close = flatButton("message-close", {}, "Close this message", this);
  close->setIcon(icon("close"));
  close->setAccessibleName("Close the message");

  auto* line = new QHBoxLayout;
  line->setSpacing(8);
  line->addWidget(sign_, 0, Qt::AlignTop);
  line->addWidget(text_, 1);
  line->addWidget(action_);
  line->addWidget(fold_);
  line->addWidget(copy_);
  line->addWidget(close);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(12, 6, 8, 6);
  layout->setSpacing(4);
  layout->addLayout(line);
  layout->addWidget(details_);
  timer_->setSingleShot(true);

  connect(&messages, &Messages::shown, this, &MessageBar::show);
  connect(fold_, &QToolButton::toggled, details_, &QWidget::setVisible);
  connect(copy_, &QToolButton::clicked, this, &MessageBar::copy);
  connect(close, &QToolButton::clicked, this, &QWidget::hide);
  connect(action_, &QToolButton::clicked, this, [this] {
    hide();
    actions_.trigger(message_.action);
  });
  connect(timer_, &QTimer::timeout, this, &QWidget::hide);
  connect(&theme, &Theme::changed, this, &MessageBar::recolour);
  hide();
}

void MessageBar::show(const Message& message) {
  // A note does not push away an error that nobody has closed yet.
  if (isVisible() && message_.kind == MessageKind::Error && message.kind == MessageKind::Note) return;
  message_ = message;
  QString html = "<b>" + message.text.toHtmlEscaped() + "</b>";
  if (message.kind == MessageKind::Note) html = message.text.toHtmlEscaped();
  if (!message.remedy.isEmpty()) html += " " + message.remedy.toHtmlEscaped();
  text_->setText(html);
  QAction* action = actions_.find(message.action);
  action_->setVisible(action);
  if (action) {
    action_->setText(action->iconText());
    action_->setAccessibleName(action->iconText());
    action_->setToolTip(action->toolTip());
  }
  details_->setPlainText(message.details);
  fold_->setVisible(!message.details.isEmpty());
  fold_->setChecked(false);
  copy_->setVisible(message.kind != MessageKind::Note);
  details_->hide();
  recolour();
  setVisible(true);
  if (message.kind == MessageKind::Note && !action)
    timer_->start(kNoteMilliseconds);
  else
    timer_->stop();
}

void MessageBar::recolour() {
  const ThemeColours& c = theme_.colours();
  const bool error = message_.kind == MessageKind::Error, warning = message_.kind == MessageKind::Warning;
  QPalette colours = QApplication::palette();
  colours.setColor(QPalette::Window, error ? c.error_ground : warning ? c.warning_ground : c.note_ground);
  setPalette(colours);
  const int side = fontMetrics().height() + 2;
  sign_->setPixmap(icon(signOf(message_.kind)).pixmap(side, side));
  sign_->setAccessibleName(error ? "Error" : warning ? "Warning" : "Note");
}

void MessageBar::copy() const {
  QString text = message_.text;
  for (const QString& part : {message_.remedy, message_.details})
    if (!part.isEmpty()) text += "\n" + part;
  QApplication::clipboard()->setText(text);
}

}  // namespace tiltmap::ui
