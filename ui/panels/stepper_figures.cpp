#include "ui/panels/stepper_figures.h"

#include <QFontDatabase>
#include <QGridLayout>
#include <QLabel>
#include <QVBoxLayout>
#include <cmath>

#include "core/registration/judgement_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/panels/fold_box.h"

namespace tiltmap::ui {

StepperFigures::StepperFigures(const PanelContext& context, QWidget* parent)
    : QWidget(parent), context_(context), model_(context.workspace.stepper()) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(8);
  column->addWidget(buildNumbers());
  column->addWidget(buildJudgement());
  column->addWidget(buildMotion());
  connect(&model_, &StepperModel::positionChanged, this, &StepperFigures::refresh);
  connect(&model_, &StepperModel::stepsChanged, this, &StepperFigures::refresh);
  connect(&context.workspace.preferences(), &Preferences::unitsChanged, this, &StepperFigures::refresh);
  refresh();
}

void StepperFigures::addNumber(QGridLayout* grid, const QString& name, const QString& title,
                               const QString& tip) {
  const int at = static_cast<int>(numbers_.size());
  auto* label = new QLabel(title, this);
  label->setToolTip(tip);
  auto* value = new QLabel(this);
  value->setObjectName("stepper-" + name);
  value->setAccessibleName(title);
  value->setToolTip(tip);
  value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
  value->setTextInteractionFlags(Qt::TextSelectableByMouse);
  grid->addWidget(label, at, 0);
  grid->addWidget(value, at, 1);
  numbers_[name] = value;
}

QWidget* StepperFigures::buildNumbers() {
  auto* box = new QWidget(this);
  auto* grid = new QGridLayout(box);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(4);
  grid->setColumnStretch(1, 1);
  addNumber(grid, "rms", "RMS residual",
            "Root mean square of the kept pairs' residuals before the step, weighted by the loss");
  addNumber(grid, "change", "Change", "Of the mean squared residual against the step before");
  addNumber(grid, "pairs", "Pairs kept", "Pairs used for the motion, of all that were sought");
  addNumber(grid, "overlap", "Matched",
            "Share of the moving scan's elements in reach of the fixed scan that fit it");
  addNumber(grid, "agreement", "Agreement", "Share of the kept pairs within three deviations");
  addNumber(grid, "elements", "Elements", "What is paired: points or plane patches of both scans");
  addNumber(grid, "step", "This step", "How far it moved and turned the moving scan");
  auto* scale = wrappedLabel(box, "stepper-scale");
  scale->setToolTip("How far a residual may be off before the loss takes its weight");
  grid->addWidget(scale, static_cast<int>(numbers_.size()), 0, 1, 2);
  numbers_["scale"] = scale;
  return box;
}

QWidget* StepperFigures::buildMotion() {
  auto* fold = new FoldBox("Motion of this step", "stepper-motion", this, true);
  fold->setToolTip("Rotation (3 x 3) and translation (m) that the step applied, in the fixed scan's frame");
  auto* matrix = new QWidget(fold);
  auto* grid = new QGridLayout(matrix);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setHorizontalSpacing(8);
  grid->setVerticalSpacing(2);
  QFont mono = QFontDatabase::systemFont(QFontDatabase::FixedFont);
  mono.setPointSizeF(font().pointSizeF() - 1.0);
  auto* rotation = new QLabel("Rotation R", matrix);
  auto* translation = new QLabel("t (m)", matrix);
  translation->setAlignment(Qt::AlignRight);
  grid->addWidget(rotation, 0, 0, 1, 3);
  grid->addWidget(translation, 0, 3);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) {
      auto* cell = new QLabel(matrix);
      cell->setObjectName(QString("stepper-motion-%1%2").arg(r).arg(c));
      cell->setFont(mono);
      cell->setAlignment(Qt::AlignRight);
      cell->setTextInteractionFlags(Qt::TextSelectableByMouse);
      grid->addWidget(cell, r + 1, c);
      motion_[r][c] = cell;
    }
  motion_text_ = wrappedLabel(fold, "stepper-pose");
  fold->content()->addWidget(matrix);
  fold->content()->addWidget(motion_text_);
  return fold;
}

QWidget* StepperFigures::buildJudgement() {
  auto* fold = new FoldBox("Can it be trusted?", "stepper-trust", this, true);
  fold->setToolTip("The two scans held against each other at the result, as links are judged");
  verdict_ = wrappedLabel(fold, "stepper-verdict");
  judgement_ = wrappedLabel(fold, "stepper-judgement");
  fold->content()->addWidget(verdict_);
  fold->content()->addWidget(judgement_);
  return fold;
}

void StepperFigures::refreshJudgement() {
  const auto judged = model_.judgement();
  judgement_->setVisible(judged != nullptr);
  if (!judged) {
    verdict_->setText("Judged when the registration has ended.");
    return;
  }
  verdict_->setText(
      QString("<b>%1</b>: %2.").arg(qt(verdictName(judged->verdict)), qt(judged->reason).toHtmlEscaped()));
  QString lines;
  for (const JudgementLine& line : judgementLines(*judged))
    lines += (lines.isEmpty() ? "" : "<br>") + qt(line.name) + ": " + qt(line.value).toHtmlEscaped();
  judgement_->setText(lines);
}

void StepperFigures::showNumber(const QString& name, const QString& text) {
  numbers_.at(name)->setText(text);
}

void StepperFigures::refresh() {
  const TraceStep* step = model_.current();
  refreshJudgement();
  const Pose motion = step ? step->report.motion : Pose();
  const Eigen::Matrix3d rotation = motion.rotation();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) motion_[r][c]->setText(QString::number(rotation(r, c), 'f', 5));
    motion_[r][3]->setText(QString::number(motion.translation()[r], 'f', 4));
  }
  const Pose pose = model_.pose();
  const Eigen::Vector3d h = pose.heading();
  motion_text_->setText(
      QString("The moving scan now stands at x %1, y %2, z %3 m of the fixed one, turned %4°.")
          .arg(pose.translation().x(), 0, 'f', 3)
          .arg(pose.translation().y(), 0, 'f', 3)
          .arg(pose.translation().z(), 0, 'f', 3)
          .arg(std::atan2(-h.x(), h.y()) / kDegree, 0, 'f', 2));
  const QString none = "–";
  for (const auto& [name, label] : numbers_) label->setText(name == "scale" ? QString() : none);
  if (step) {
    const StepReport& report = step->report;
    const PoseDifference moved = difference(report.motion, Pose());
    const auto percent = [](double share) { return QString("%1 %").arg(100.0 * share, 0, 'f', 0); };
    showNumber("rms", smallLengthText(report.rms_m, context_.workspace.preferences().lengthUnit()));
    showNumber("change",
               report.iteration == 1 ? none : QString("%1 %").arg(100.0 * report.change, 0, 'f', 2));
    showNumber("pairs", QString("%1 of %2")
                            .arg(groupedNumber(static_cast<long long>(report.pairs)),
                                 groupedNumber(static_cast<long long>(step->pairs.size()))));
    showNumber("overlap", percent(report.overlap));
    showNumber("agreement", percent(report.agreement));
    const TraceAttempt& attempt = *model_.attempt();
    showNumber("elements", QString("%1 + %2 %3")
                               .arg(groupedNumber(static_cast<long long>(attempt.fixed->elements.size())),
                                    groupedNumber(static_cast<long long>(attempt.moving->elements.size())),
                                    attempt.moving->elements.arePatches() ? "plane patches" : "points"));
    showNumber("step", QString("%1, %2°")
                           .arg(smallLengthText(moved.translation_m, LengthUnit::Millimetre))
                           .arg(moved.rotation_rad / kDegree, 0, 'f', 4));
    showNumber("scale", qt(lossSentence(attempt, report)));
  }
}

}  // namespace tiltmap::ui
