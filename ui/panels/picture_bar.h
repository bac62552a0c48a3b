// How large a picture of the 3D view is to be saved.
#pragma once

#include <QSize>
#include <QWidget>

class QCheckBox;
class QSpinBox;

namespace tiltmap::ui {

class PictureBar : public QWidget {
  Q_OBJECT

 public:
  explicit PictureBar(QWidget* parent = nullptr);

  QSize wanted() const;  // pixels
  void setWanted(const QSize& size);
  bool onWhite() const;

 Q_SIGNALS:
  void viewSizeAsked();
  void saveAsked();

 private:
  QSpinBox* width_;
  QSpinBox* height_;
  QCheckBox* white_;
};

}  // namespace tiltmap::ui
