#include "ui/window/preferences_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>
#include <QThread>
#include <QVBoxLayout>

#include "ui/models/log.h"
#include "ui/models/preferences.h"

namespace tiltmap::ui {

namespace {

QComboBox* choice(const QString& name, const QStringList& texts, int current, const QString& help,
                  QWidget* parent) {
  auto* box = new QComboBox(parent);
  box->setObjectName(name);
  box->addItems(texts);
  box->setCurrentIndex(current);
  box->setToolTip(help);
  box->setAccessibleDescription(help);
  return box;
}

QLabel* path(const QString& text, QWidget* parent) {
  auto* label = new QLabel(text, parent);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  label->setWordWrap(true);
  return label;
}

}  // namespace

PreferencesDialog::PreferencesDialog(Preferences& preferences, QWidget* parent) : QDialog(parent) {
  setObjectName("preferences");
  setWindowTitle("Preferences");
  auto* theme = choice("theme", {"As the system", "Light", "Dark", "High contrast, large controls"},
                       static_cast<int>(preferences.theme()),
                       "Colours of the window; high contrast is for sunlight and gloves", this);
  auto* unit = choice("length-unit", {"Metres (m)", "Millimetres (mm)", "Feet (ft)"},
                      static_cast<int>(preferences.lengthUnit()),
                      "Unit of lengths in tables and panels; files and the project itself keep metres", this);
  auto* threads = new QSpinBox(this);
  threads->setObjectName("threads");
  threads->setRange(0, 256);
  threads->setValue(preferences.threads());
  threads->setSpecialValueText(QString("all cores (%1)").arg(QThread::idealThreadCount()));
  threads->setToolTip("Threads that work is started with, 0 to 256; results do not depend on it");

  auto* form = new QFormLayout;
  form->setHorizontalSpacing(16);
  form->setVerticalSpacing(8);
  form->addRow("&Theme", theme);
  form->addRow("&Lengths in", unit);
  form->addRow("T&hreads", threads);
  form->addRow("Log file", path(logFilePath().isEmpty() ? "none could be opened" : logFilePath(), this));
  form->addRow("Settings file", path(preferences.file(), this));
  for (int row = 0; row < form->rowCount(); ++row)
    if (QWidget* field = form->itemAt(row, QFormLayout::FieldRole)->widget())
      if (const auto* label = qobject_cast<QLabel*>(form->labelForField(field)))
        field->setAccessibleName(QString(label->text()).remove('&'));

  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  buttons->button(QDialogButtonBox::Close)->setToolTip("Close this form; every choice holds already");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(16, 16, 16, 16);
  layout->setSpacing(16);
  layout->addLayout(form);
  layout->addStretch();
  layout->addWidget(buttons);
  setMinimumWidth(460);

  connect(theme, qOverload<int>(&QComboBox::activated), this,
          [&preferences](int row) { preferences.setTheme(static_cast<ThemeChoice>(row)); });
  connect(unit, qOverload<int>(&QComboBox::activated), this,
          [&preferences](int row) { preferences.setLengthUnit(static_cast<LengthUnit>(row)); });
  connect(threads, qOverload<int>(&QSpinBox::valueChanged), this,
          [&preferences](int count) { preferences.setThreads(count); });
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
}

}  // namespace tiltmap::ui
