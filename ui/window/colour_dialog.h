// The colour of the selected scans, chosen from those that are told apart by every eye, or written down.
#pragma once

#include <QDialog>
#include <cstdint>
#include <optional>
#include <vector>

class QLabel;
class QLineEdit;
class QPushButton;

namespace tiltmap::ui {

class Workspace;

// Stays open and follows the selection; each choice is an edit of its own.
class ColourDialog : public QDialog {
  Q_OBJECT

 public:
  explicit ColourDialog(Workspace& workspace, QWidget* parent = nullptr);

 private:
  void give(std::optional<std::uint32_t> colour);
  void refresh();

  Workspace& workspace_;
  QLabel* which_;
  QLineEdit* written_;
  QPushButton* take_;
  QPushButton* by_place_;
  std::vector<QWidget*> choices_;
};

}  // namespace tiltmap::ui
