#include "ui/panels/capture_stop_page.h"

#include <QLabel>
#include <QVBoxLayout>

#include "ui/models/capture_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/panels/odometry_form.h"
#include "ui/window/parameter_form.h"

namespace tiltmap::ui {

CaptureStopPage::CaptureStopPage(CaptureModel& model, const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      model_(model),
      odometry_(new OdometryForm(context.theme, context.workspace.preferences(), this)),
      own_(wrappedLabel(this, "capture-own-odometry")),
      known_rig_(wrappedLabel(this, "capture-known-rig")) {
  own_->setText("The emulated drive brings its own odometry.");
  auto* form = new ParameterForm(model.parameters(), context.workspace.preferences(), context.theme, this);
  QStringList others;
  for (const ParameterInfo& info : model.parameters().infos()) {
    const QString name = QString::fromStdString(info.name);
    if (!QStringList{"mode", "lines", "step", "start", "patience", "known-rig"}.contains(name))
      others << name;
  }
  form->leaveOut(others);
  if (form->layout()) form->layout()->setContentsMargins(0, 0, 0, 0);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 8, 4, 8);  // room for large letters beside a scroll bar
  column->setSpacing(8);
  column->addWidget(own_);
  column->addWidget(odometry_);
  column->addWidget(form);
  column->addWidget(known_rig_);
  column->addStretch(1);
  connect(odometry_, &OdometryForm::changed, this, &CaptureStopPage::changed);
  connect(&model_.parameters(), &ParameterModel::valueChanged, this, &CaptureStopPage::changed);
  connect(&model_.parameters(), &ParameterModel::valueChanged, this, &CaptureStopPage::refresh);
  connect(&model_, &CaptureModel::changed, this, &CaptureStopPage::refresh);
  refresh();
}

std::optional<Pose> CaptureStopPage::lastFromNext() const {
  return model_.needsOdometry() ? odometry_->lastFromNext() : std::nullopt;
}

QString CaptureStopPage::missing() const {
  return model_.needsOdometry() && !odometry_->lastFromNext() ? odometry_->missing() : QString();
}

void CaptureStopPage::refresh() {
  const bool own = model_.now().source.emulate != CaptureDrive::None;
  own_->setVisible(own);
  odometry_->setVisible(!own);
  const bool first = !own && !model_.needsOdometry();
  if (odometry_->isFirstStop() != first) odometry_->setFirstStop(first);
  const QString rig = model_.knownRigText();
  const bool taken = std::get<bool>(model_.parameters().values().at("known-rig"));
  known_rig_->setVisible(!rig.isEmpty());
  known_rig_->setText((taken ? "Takes over " : "Leaves away ") + rig + ".");
  const StationSweep& sweep = model_.now().sweep;
  if (sweep.complete && sweep.number != captured_) {
    captured_ = sweep.number;
    odometry_->stopCaptured();
  }
}

}  // namespace tiltmap::ui
