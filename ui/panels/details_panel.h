// What is known about the selected scan or link, and the scan's note.
#pragma once

#include <QWidget>
#include <optional>

#include "core/project/project_snapshot.h"
#include "ui/panels/panel.h"

class QLabel;
class QPlainTextEdit;
class QTextBrowser;

namespace tiltmap::ui {

class DetailsPanel : public QWidget {
  Q_OBJECT

 public:
  explicit DetailsPanel(const PanelContext& context, QWidget* parent = nullptr);

  void beginNote();
  // Stores what was typed; also done when the field is left.
  void storeNote();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void refresh();
  QString scanText(const ScanEntry& scan) const;

  PanelContext context_;
  QTextBrowser* text_;
  QLabel* note_label_;
  QPlainTextEdit* note_;
  std::optional<ScanId> noted_;  // whose note is in the field
};

}  // namespace tiltmap::ui
