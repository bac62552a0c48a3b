#include "ui/models/study_model.h"

#include <algorithm>
#include <cmath>

#include "ui/models/stepper_model.h"
#include "ui/models/units.h"

namespace tiltmap::ui {

namespace {

constexpr int kDeepest = 12;

QString counted(std::size_t number) {
  return groupedNumber(static_cast<long long>(number));
}

}  // namespace

StudyModel& StudyModel::of(StepperModel& stepper) {
  if (auto* known = stepper.findChild<StudyModel*>(QString(), Qt::FindDirectChildrenOnly)) return *known;
  return *new StudyModel(stepper);
}

StudyModel::StudyModel(StepperModel& stepper) : QObject(&stepper), stepper_(stepper) {
  connect(&stepper, &StepperModel::positionChanged, this, &StudyModel::search);
  connect(&stepper, &StepperModel::pickedChanged, this, &StudyModel::search);
  connect(&stepper.start(), &StartModel::startChanged, this, &StudyModel::forget);
  connect(&stepper, &StepperModel::stateChanged, this, &StudyModel::slicesChanged);
}

void StudyModel::setTreeShown(bool shown) {
  if (shown == tree_shown_) return;
  tree_shown_ = shown;
  search();
}

void StudyModel::setTreeDepth(int depth) {
  depth = std::clamp(depth, 0, kDeepest);
  if (depth == tree_depth_) return;
  tree_depth_ = depth;
  Q_EMIT treeChanged();
}

const KdTree* StudyModel::tree() const {
  const TraceAttempt* attempt = stepper_.attempt();
  if (!attempt || attempt->fixed->elements.empty()) return nullptr;
  if (attempt->fixed->tree) return &*attempt->fixed->tree;
  if (tree_of_ != attempt->fixed) {
    tree_of_ = attempt->fixed;
    own_tree_ = std::make_shared<KdTree>(tree_of_->elements.position);
  }
  return own_tree_.get();
}

void StudyModel::search() {
  visit_.reset();
  const KdTree* searched = tree_shown_ ? tree() : nullptr;
  if (searched) {
    if (const auto picked = stepper_.picked()) {
      const TracedPair& pair = stepper_.pairs()[*picked];
      query_ = stepper_.poseBefore() * pair.moving_point;
      visit_ = kdVisit(*searched, query_);
    }
  }
  Q_EMIT treeChanged();
}

std::vector<KdCell> StudyModel::cells() const {
  const KdTree* shown = tree_shown_ ? tree() : nullptr;
  return shown ? kdCells(*shown, tree_depth_) : std::vector<KdCell>();
}

QString StudyModel::treeSentence() const {
  if (!tree_shown_) return {};
  const TraceAttempt* attempt = stepper_.attempt();
  if (!attempt) return "The tree shows once a step is taken.";
  QString text;
  if (!visit_)
    text = "Click a pair to see which leaves the search for it looks into.";
  else
    text =
        QString(
            "The search went down %1 levels, looked into %2 %3 and compared %4 of %5 elements; the nearest "
            "is %6 away.")
            .arg(visit_->path.size() - 1)
            .arg(visit_->leaves.size())
            .arg(visit_->leaves.size() == 1 ? "leaf" : "leaves")
            .arg(counted(visit_->points_compared), counted(attempt->fixed->elements.size()),
                 smallLengthText(std::sqrt(visit_->nearest.squared_distance), LengthUnit::Metre));
  if (!attempt->fixed->tree)
    text += " (This method finds pairs by direction; the tree is shown for comparison.)";
  return text;
}

void StudyModel::forget() {
  worker_.cancel();
  slices_.reset();
  Q_EMIT slicesChanged();
}

void StudyModel::setSliceHeight(double height_m) {
  if (height_m == slice_settings_.height_m) return;
  slice_settings_.height_m = height_m;
  forget();
}

void StudyModel::matchSlices() {
  const PreparedPairPtr scans = stepper_.scans();
  if (!scans) return;
  slices_.reset();
  worker_.start([this, scans, start = stepper_.start().start(),
                 settings = slice_settings_](const std::stop_token&) -> BackgroundWorker::Done {
    const auto fixed = scans->fixed().scan(), moving = scans->moving().scan();
    auto found = !fixed    ? Result<SliceResult>(fail(fixed.error()))
                 : !moving ? Result<SliceResult>(fail(moving.error()))
                           : registerSlices(*fixed, *moving, start, settings);
    return [this, found = std::move(found)] {
      if (found)
        slices_ = *found;
      else
        Q_EMIT failed(found.error());
      Q_EMIT slicesChanged();
    };
  });
  Q_EMIT slicesChanged();
}

std::optional<SliceComparison> StudyModel::comparison() const {
  if (!slices_ || !slices_->succeeded() || stepper_.count() == 0) return {};
  return compareSlice(slices_->fixed_from_moving,
                      stepper_.isEnded() ? stepper_.result()->fixed_from_moving : stepper_.pose());
}

QString StudyModel::sliceSentence() const {
  if (!slices_)
    return worker_.busy()
               ? QString("Matching the slices…")
               : QString(
                     "Match a horizontal slice of both scans in the plane, as thesis 4.1 tells of, "
                     "and see what it misses.");
  QString text = QString("%1 and %2 points, %3 after %4 steps.")
                     .arg(counted(slices_->fixed.size()), counted(slices_->moving.size()),
                          QString::fromStdString(stopReasonName(slices_->stop_reason)))
                     .arg(slices_->steps.size());
  if (!slices_->succeeded())
    return text + " " + QString::fromStdString(stopReasonSentence(slices_->stop_reason));
  const auto c = comparison();
  if (!c) return text + " Run the whole scans to compare.";
  return text + QString(" %1 and %2° off the whole scans; blind to %3 of height and %4° of tilt.")
                    .arg(smallLengthText(c->shift_m, LengthUnit::Millimetre))
                    .arg(c->heading_rad / kDegree, 0, 'f', 2)
                    .arg(smallLengthText(std::abs(c->height_m), LengthUnit::Millimetre))
                    .arg(c->tilt_rad / kDegree, 0, 'f', 2);
}

}  // namespace tiltmap::ui
