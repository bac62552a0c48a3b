// Theme, units, threads; every change takes effect at once.
#pragma once

#include <QDialog>

namespace tiltmap::ui {

class Preferences;

class PreferencesDialog : public QDialog {
  Q_OBJECT

 public:
  explicit PreferencesDialog(Preferences& preferences, QWidget* parent = nullptr);
};

}  // namespace tiltmap::ui
