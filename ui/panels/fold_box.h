// A heading that shows and hides what is under it.
#pragma once

#include <QWidget>

class QToolButton;
class QVBoxLayout;

namespace tiltmap::ui {

class FoldBox : public QWidget {
  Q_OBJECT

 public:
  // The button's object name is `name`.
  FoldBox(const QString& title, const QString& name, QWidget* parent = nullptr, bool open = false);

  QVBoxLayout* content() { return content_; }
  bool isOpen() const;
  void setOpen(bool open);

 Q_SIGNALS:
  void toggled(bool open);

 private:
  QToolButton* button_;
  QWidget* body_;
  QVBoxLayout* content_;
};

}  // namespace tiltmap::ui
