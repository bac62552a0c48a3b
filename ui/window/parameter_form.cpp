#include "ui/window/parameter_form.h"

#include <QGridLayout>
#include <QLabel>
#include <QToolButton>

#include "ui/look/icons.h"
#include "ui/look/text_colour.h"
#include "ui/look/theme.h"
#include "ui/models/parameter_model.h"
#include "ui/models/strings.h"
#include "ui/window/parameter_editors.h"

namespace tiltmap::ui {

ParameterForm::ParameterForm(ParameterModel& model, Preferences& preferences, const Theme& theme,
                             QWidget* parent)
    : QWidget(parent), model_(model), theme_(theme) {
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(12, 8, 12, 8);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(4);
  grid->setColumnStretch(1, 1);
  int line = 0;
  for (const ParameterInfo& info : model.infos()) {
    const QString name = qt(info.name);
    Row row;
    ParameterEditor* editor = makeParameterEditor(model.operation(), info, preferences, this);
    row.editor = editor;
    row.label = new QLabel(parameterLabel(info), this);
    row.label->setToolTip(parameterTip(info));
    row.label->setBuddy(editor);
    row.unit = new QLabel(qt(info.unit), this);
    row.reset = new QToolButton(this);
    row.reset->setToolTip("Back to what the preset says");
    row.reset->setIcon(icon("edit-reset"));
    row.reset->setAutoRaise(true);
    row.reset->setObjectName("reset:" + name);
    row.reset->setFocusPolicy(Qt::StrongFocus);
    row.reset->setAccessibleName("Reset " + parameterLabel(info));
    row.error = new QLabel(this);
    row.error->setObjectName("error:" + name);
    row.error->setWordWrap(true);
    // Beside a field of several lines the label stands at its first.
    const bool tall = editor->sizeHint().height() > 3 * row.label->sizeHint().height();
    const Qt::Alignment level = tall ? Qt::AlignTop : Qt::AlignVCenter;
    grid->addWidget(row.label, line, 0, level | Qt::AlignLeft);
    grid->addWidget(editor, line, 1);
    grid->addWidget(row.unit, line, 2);
    grid->addWidget(row.reset, line, 3, level);
    grid->addWidget(row.error, line + 1, 1, 1, 3);
    line += 2;
    connect(editor, &ParameterEditor::edited, this,
            [this, name](const QString& text) { model_.setValueText(name, text); });
    connect(row.reset, &QToolButton::clicked, this, [this, name] { model_.reset(name); });
    rows_[name] = row;
  }
  grid->setRowStretch(line, 1);
  connect(&model, &ParameterModel::valueChanged, this, &ParameterForm::refresh);
  connect(&model, &ParameterModel::presetChanged, this, &ParameterForm::refreshAll);
  connect(&theme, &Theme::changed, this, &ParameterForm::refreshAll);
  refreshAll();
}

void ParameterForm::refresh(const QString& parameter) {
  const Row& row = rows_.at(parameter);
  auto* editor = static_cast<ParameterEditor*>(row.editor);
  editor->show(model_.valueText(parameter));
  const auto error = model_.error(parameter);
  editor->setWrong(error.has_value());
  if (error) setTextColour(row.error, theme_.colours().error);
  row.error->setText(error ? QString("%1: %2").arg(qt(error->what), qt(error->remedy)) : QString());
  row.error->setVisible(error.has_value() && row.editor->isVisibleTo(this));
  const bool changed = model_.isChanged(parameter);
  row.reset->setVisible(changed && row.editor->isVisibleTo(this));
  row.reset->setToolTip("Back to what the preset says");
  QFont font = row.label->font();
  font.setBold(changed);
  row.label->setFont(font);
}

void ParameterForm::refreshAll() {
  for (const auto& [name, row] : rows_) refresh(name);
}

void ParameterForm::leaveOut(const QStringList& parameters) {
  left_out_ = parameters;
  filter({});
}

void ParameterForm::filter(const QString& text) {
  for (const auto& [name, row] : rows_) {
    const ParameterInfo& info = model_.info(name);
    const bool wanted =
        !left_out_.contains(name) && (text.isEmpty() || name.contains(text, Qt::CaseInsensitive) ||
                                      parameterLabel(info).contains(text, Qt::CaseInsensitive) ||
                                      qt(info.help).contains(text, Qt::CaseInsensitive));
    for (QWidget* widget : {static_cast<QWidget*>(row.label), row.editor, static_cast<QWidget*>(row.unit)})
      widget->setVisible(wanted);
    refresh(name);
  }
}

QWidget* ParameterForm::editor(const QString& parameter) const {
  const auto found = rows_.find(parameter);
  return found == rows_.end() ? nullptr : found->second.editor->focusProxy();
}

std::vector<QWidget*> ParameterForm::focusOrder() const {
  std::vector<QWidget*> order;
  for (const ParameterInfo& info : model_.infos()) {
    const Row& row = rows_.at(qt(info.name));
    for (QWidget* part : row.editor->findChildren<QWidget*>(QString(), Qt::FindDirectChildrenOnly))
      if (part->focusPolicy() & Qt::TabFocus) order.push_back(part);
    order.push_back(row.reset);
  }
  return order;
}

}  // namespace tiltmap::ui
