#include "ui/panels/picture_bar.h"

#include <QCheckBox>
#include <QLabel>
#include <QPushButton>
#include <QSpinBox>

#include "ui/look/flow_layout.h"
#include "ui/panels/controls.h"

namespace tiltmap::ui {

PictureBar::PictureBar(QWidget* parent) : QWidget(parent) {
  auto* layout = new FlowLayout(this);
  layout->setContentsMargins(8, 2, 8, 4);
  layout->setSpacing(8);
  const auto side = [&](const QString& name, const QString& accessible) {
    auto* box = new QSpinBox(this);
    describe(box, name, accessible, accessible + ", 16 to 16384");
    box->setRange(16, 16384);
    box->setSuffix(" px");
    box->setAlignment(Qt::AlignRight);
    return box;
  };
  width_ = side("picture-width", "Width of the picture in pixels");
  height_ = side("picture-height", "Height of the picture in pixels");
  white_ = new QCheckBox("On white", this);
  describe(white_, "picture-white", "On white", "A white ground, for print");
  auto* fit = toolButton(this, "picture-view-size", "Size of the view", "As many pixels as the view has now");
  connect(fit, &QToolButton::clicked, this, &PictureBar::viewSizeAsked);
  auto* save = new QPushButton("Save as PNG…", this);
  describe(save, "picture-save", "Save as PNG", "Choose a file; the picture shows what the view shows");
  connect(save, &QPushButton::clicked, this, &PictureBar::saveAsked);
  for (QWidget* widget : std::initializer_list<QWidget*>{new QLabel("Picture", this), width_,
                                                         new QLabel("×", this), height_, fit, white_, save})
    layout->addWidget(widget);
}

QSize PictureBar::wanted() const {
  return {width_->value(), height_->value()};
}

void PictureBar::setWanted(const QSize& size) {
  width_->setValue(size.width());
  height_->setValue(size.height());
}

bool PictureBar::onWhite() const {
  return white_->isChecked();
}

}  // namespace tiltmap::ui
