// A form made from an operation's parameters: label, editor, unit, reset; errors where the value is.
#pragma once

#include <QStringList>
#include <QWidget>
#include <map>
#include <vector>

class QLabel;
class QToolButton;

namespace tiltmap::ui {

class ParameterModel;
class Preferences;
class Theme;
struct ParameterEditorContext;

class ParameterForm : public QWidget {
  Q_OBJECT

 public:
  ParameterForm(ParameterModel& model, Preferences& preferences, const Theme& theme,
                QWidget* parent = nullptr);

  // Rows that are never shown.
  void leaveOut(const QStringList& parameters);
  // Only rows whose label, help or name hold the text; all for an empty one.
  void filter(const QString& text);
  QWidget* editor(const QString& parameter) const;
  // Everything that takes the focus, from the top to the bottom.
  std::vector<QWidget*> focusOrder() const;

 private:
  struct Row {
    QLabel* label = nullptr;
    QWidget* editor = nullptr;
    QLabel* unit = nullptr;
    QToolButton* reset = nullptr;
    QLabel* error = nullptr;
  };
  void refresh(const QString& parameter);
  void refreshAll();

  ParameterModel& model_;
  const Theme& theme_;
  std::map<QString, Row> rows_;
  QStringList left_out_;
};

}  // namespace tiltmap::ui
