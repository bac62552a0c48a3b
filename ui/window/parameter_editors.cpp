#include "ui/window/parameter_editors.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QToolButton>
#include <map>

#include "core/project/stage.h"
#include "ui/look/icons.h"
#include "ui/models/strings.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

QHBoxLayout* rowLayout(QWidget* parent) {
  auto* layout = new QHBoxLayout(parent);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(4);
  return layout;
}

void markWrong(QWidget* field, bool wrong) {
  // Fusion draws its frame in the highlight colour for focus; a wrong value has one always.
  field->setStyleSheet(wrong ? "border: 1px solid #d0453c; border-radius: 2px; padding: 2px;" : "");
}

class SwitchEditor : public ParameterEditor {
 public:
  explicit SwitchEditor(QWidget* parent) : ParameterEditor(parent), box_(new QCheckBox("on", this)) {
    rowLayout(this)->addWidget(box_);
    setFocusProxy(box_);
    connect(box_, &QCheckBox::clicked, this, [this](bool on) { Q_EMIT edited(on ? "true" : "false"); });
  }
  void show(const QString& text) override { box_->setChecked(text == "true"); }
  void setWrong(bool) override {}

 private:
  QCheckBox* box_;
};

class ChoiceEditor : public ParameterEditor {
 public:
  ChoiceEditor(const std::vector<std::string>& choices, const QString& empty, QWidget* parent)
      : ParameterEditor(parent), box_(new QComboBox(this)) {
    rowLayout(this)->addWidget(box_);
    setFocusProxy(box_);
    if (!empty.isEmpty()) box_->addItem(empty, QString());
    for (const std::string& choice : choices) box_->addItem(qt(choice), qt(choice));
    // The wheel scrolls the form, not the values that happen to lie under it.
    box_->setFocusPolicy(Qt::StrongFocus);
    connect(box_, qOverload<int>(&QComboBox::activated), this,
            [this](int row) { Q_EMIT edited(box_->itemData(row).toString()); });
  }
  void show(const QString& text) override { box_->setCurrentIndex(box_->findData(text)); }
  void setWrong(bool) override {}

 private:
  QComboBox* box_;
};

class LineEditor : public ParameterEditor {
 public:
  LineEditor(bool number, const QString& placeholder, QWidget* parent)
      : ParameterEditor(parent), line_(new QLineEdit(this)), layout_(rowLayout(this)) {
    layout_->addWidget(line_);
    setFocusProxy(line_);
    if (number) line_->setAlignment(Qt::AlignRight);
    line_->setPlaceholderText(placeholder);
    connect(line_, &QLineEdit::textEdited, this, &ParameterEditor::edited);
  }
  void show(const QString& text) override {
    if (line_->text() != text) line_->setText(text);
  }
  void setWrong(bool wrong) override { markWrong(line_, wrong); }
  // A button behind the line that asks for a file.
  void addBrowse(const FileAsked& asked, Preferences& preferences) {
    auto* button = new QToolButton(this);
    button->setIcon(icon("document-open"));
    button->setToolTip("Choose a file");
    button->setAccessibleName("Choose a file");
    button->setFocusPolicy(Qt::StrongFocus);
    layout_->addWidget(button);
    connect(button, &QToolButton::clicked, this, [this, asked, &preferences] {
      askForFiles(window(), preferences, asked, [this](const QStringList& files) {
        line_->setText(files.front());
        Q_EMIT edited(files.front());
      });
    });
  }

 private:
  QLineEdit* line_;
  QHBoxLayout* layout_;
};

class FilesEditor : public ParameterEditor {
 public:
  FilesEditor(Preferences& preferences, QWidget* parent)
      : ParameterEditor(parent), text_(new QPlainTextEdit(this)) {
    auto* layout = rowLayout(this);
    layout->addWidget(text_);
    setFocusProxy(text_);
    text_->setTabChangesFocus(true);
    text_->setLineWrapMode(QPlainTextEdit::NoWrap);
    text_->setPlaceholderText("One file a line, in the order the scans were taken");
    text_->setMaximumHeight(fontMetrics().height() * 6);
    auto* button = new QToolButton(this);
    button->setObjectName("browse-files");
    button->setText("Add…");
    button->setToolTip("Choose scan files; they are added in the order of their names");
    button->setFocusPolicy(Qt::StrongFocus);
    layout->addWidget(button, 0, Qt::AlignTop);
    connect(text_, &QPlainTextEdit::textChanged, this, [this] { Q_EMIT edited(text_->toPlainText()); });
    connect(button, &QToolButton::clicked, this, [this, &preferences] {
      askForFiles(window(), preferences, {FileQuestion::OpenMany, "Scan files", kScanFilter, {}, "scans", {}},
                  [this](QStringList files) {
                    files.sort();
                    QString all = text_->toPlainText();
                    if (!all.isEmpty() && !all.endsWith('\n')) all += '\n';
                    text_->setPlainText(all + files.join('\n'));
                  });
    });
  }
  void show(const QString& text) override {
    if (text_->toPlainText() == text) return;
    const QSignalBlocker blocker(text_);
    text_->setPlainText(text);
  }
  void setWrong(bool wrong) override { markWrong(text_, wrong); }

 private:
  QPlainTextEdit* text_;
};

// What a text parameter names. Core tells kinds of values, not what a picker would offer.
ParameterEditor* textEditor(const Operation& operation, const ParameterInfo& info, Preferences& preferences,
                            QWidget* parent) {
  if (info.name == "files") return new FilesEditor(preferences, parent);
  if (info.name == "stage") {
    std::vector<std::string> stages;
    for (const Stage stage : kStages) stages.push_back(stageName(stage));
    return new ChoiceEditor(stages, "latest", parent);
  }
  static const std::map<std::string, QString> kEmpty = {{"at", "as known from the frame of both"},
                                                        {"pairs", "every scan with the one before it"},
                                                        {"scans", "all"},
                                                        {"pin", "none"}};
  const auto empty = kEmpty.find(info.name);
  auto* line = new LineEditor(false, empty == kEmpty.end() ? QString() : empty->second, parent);
  if (info.name == "file" && operation.id() == "merge")
    line->addBrowse({FileQuestion::OpenOne, "Project to merge", kProjectFilter, {}, "projects", {}},
                    preferences);
  else if (info.name == "file")
    line->addBrowse(
        {FileQuestion::Save,
         qt(operation.title()),
         operation.id() == "export" ? "Point clouds (*.ply *.pcd *.xyz *.csv *.ptx *.vtk);;All files (*)"
                                    : "All files (*)",
         operation.id() == "export" ? "ply" : "",
         "exports",
         {}},
        preferences);
  if (info.name == "odometry")
    line->addBrowse(
        {FileQuestion::OpenOne, "Odometry (TUM)", "TUM poses (*.tum *.txt);;All files (*)", {}, "scans", {}},
        preferences);
  return line;
}

}  // namespace

ParameterEditor* makeParameterEditor(const Operation& operation, const ParameterInfo& info,
                                     Preferences& preferences, QWidget* parent) {
  ParameterEditor* editor = nullptr;
  switch (info.kind) {
    case ParameterKind::Boolean:
      editor = new SwitchEditor(parent);
      break;
    case ParameterKind::Choice:
      editor = new ChoiceEditor(info.choices, {}, parent);
      break;
    case ParameterKind::Integer:
    case ParameterKind::Real:
      editor = new LineEditor(true, {}, parent);
      break;
    case ParameterKind::Text:
      editor = textEditor(operation, info, preferences, parent);
      break;
  }
  editor->setObjectName("parameter:" + qt(info.name));
  QWidget* field = editor->focusProxy();
  field->setObjectName("field:" + qt(info.name));
  field->setToolTip(parameterTip(info));
  const QString unit = info.unit.empty() ? QString() : ", in " + qt(info.unit);
  field->setAccessibleName(parameterLabel(info) + unit);
  field->setAccessibleDescription(qt(info.help));
  return editor;
}

}  // namespace tiltmap::ui
