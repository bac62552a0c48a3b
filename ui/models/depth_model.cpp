#include "ui/models/depth_model.h"

#include <cmath>
#include <utility>

#include "core/base/text.h"
#include "core/scan/beam_tilts.h"
#include "core/scan/normals.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr int kMoment_ms = 300;

QString number(double value, int places) {
  return qt(fixedReal(value, places));
}

QString vectorText(const Eigen::Vector3d& v, int places) {
  return QString("(%1, %2, %3)").arg(number(v.x(), places), number(v.y(), places), number(v.z(), places));
}

}  // namespace

// What the worker takes with it and brings back.
struct DepthModel::Work {
  ScanEntry entry;
  std::shared_ptr<const Matrix> matrix;  // the one that is there, where it is still the right one
  std::array<Side, 2> sides;
  QString trouble;
};

DepthModel::DepthModel(Workspace& workspace, QObject* parent) : QObject(parent), workspace_(workspace) {
  connect(&workspace.selection(), &Selection::scansChanged, this, &DepthModel::refreshScan);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &DepthModel::refreshScan);
  // Numbers of scans and matrices come again in another project.
  connect(&workspace.session(), &ProjectSession::closed, this, &DepthModel::clear);
  connect(&workspace.residuals(), &Residuals::changed, this, &DepthModel::update);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &DepthModel::update);
  long_.setSingleShot(true);
  long_.setInterval(kMoment_ms);
  connect(&long_, &QTimer::timeout, this, [this] {
    is_long_ = true;
    Q_EMIT imagesChanged();
  });
  refreshScan();
}

std::size_t DepthModel::index() const {
  const SnapshotPtr snapshot = workspace_.snapshot();
  return snapshot && matrix_ ? snapshot->indexOf(matrix_->scan).value_or(0) : 0;
}

void DepthModel::setQuantity(std::size_t side, std::optional<DepthQuantity> quantity) {
  if (sides_[side].wanted == quantity) return;
  sides_[side] = {quantity, {}, {}, {}};
  update();
  Q_EMIT imagesChanged();
}

void DepthModel::clear() {
  worker_.cancel();
  worked_on_.reset();
  again_ = is_long_ = false;
  long_.stop();
  matrix_ = nullptr;
  for (Side& side : sides_) side = {side.wanted, {}, {}, {}};
  Q_EMIT scanChanged();
  Q_EMIT imagesChanged();
}

void DepthModel::refreshScan() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  const auto current = workspace_.selection().currentScan();
  const ScanEntry* scan = snapshot && current ? snapshot->find(*current) : nullptr;
  if (!scan && snapshot && !snapshot->scans().empty()) scan = &snapshot->scans().front();
  const bool had = wanted_scan_.has_value();
  wanted_scan_ = scan ? std::optional(scan->id) : std::nullopt;
  if (had != wanted_scan_.has_value()) Q_EMIT wantedChanged();
  if (!scan) return clear();
  update();
}

void DepthModel::update() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  const ScanEntry* scan = snapshot && wanted_scan_ ? snapshot->find(*wanted_scan_) : nullptr;
  if (!scan) return;
  // A scan that comes in line by line is shown now and then, and not only when no more lines come.
  if (worker_.busy() && worked_on_ == scan->id) {
    again_ = true;
    return;
  }
  auto work = std::make_shared<Work>();
  work->entry = *scan;
  const bool same = matrix_ && matrix_->scan == scan->id && matrix_->matrix == scan->matrix &&
                    matrix_->geometry_id == scan->geometry_id && matrix_->lines == scan->lines;
  if (same) work->matrix = matrix_;
  bool complete = same;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    Side& side = work->sides[k] = sides_[k];
    if (!side.wanted) continue;
    if (side.wanted == DepthQuantity::Residual) {
      const Stage stage = workspace_.display().stage();
      const ResidualsPtr residuals = workspace_.residuals().of(scan->id, stage);
      if (!same || residuals != side.residuals) side.image = nullptr;
      side.residuals = residuals;
      side.trouble.clear();
      if (!residuals) {
        const std::string why = workspace_.residuals().trouble(scan->id, stage);
        side.trouble = why.empty() ? "Computing the residuals…" : qt(why);
      }
    } else if (!same) {
      side.image = nullptr;
      side.trouble.clear();
    }
    complete = complete && (side.image || !side.trouble.isEmpty());
  }
  if (complete) {
    if (worker_.busy()) worker_.cancel();  // with another scan
    worked_on_.reset();
    return take(*work);
  }
  worked_on_ = scan->id;
  if (!long_.isActive() && !is_long_) long_.start();
  worker_.start([this, work](const std::stop_token& stop) -> BackgroundWorker::Done {
    perform(*work, stop);
    return [this, work] {
      worked_on_.reset();
      take(*work);
      if (std::exchange(again_, false)) update();
    };
  });
}

void DepthModel::perform(Work& work, const std::stop_token& stop) {
  if (!work.matrix) {
    auto image = work.entry.image();
    if (!image) {
      work.trouble = qt(image.error().what) + ": " + qt(image.error().remedy);
      return;
    }
    auto matrix = std::make_shared<Matrix>();
    matrix->scan = work.entry.id;
    matrix->matrix = work.entry.matrix;
    matrix->geometry_id = work.entry.geometry_id;
    matrix->lines = work.entry.lines;
    matrix->geometry = work.entry.geometry;
    matrix->image = *image;
    matrix->points = cellPoints(*matrix->image, matrix->geometry);
    if (stop.stop_requested()) return;
    matrix->normals = matrixNormals(*matrix->image, matrix->points);
    work.matrix = std::move(matrix);
  }
  for (Side& side : work.sides) {
    if (!side.wanted || side.image || !side.trouble.isEmpty() || stop.stop_requested()) continue;
    auto depth = depthImageOf(work.matrix->image, work.matrix->geometry, *side.wanted,
                              side.residuals ? *side.residuals : std::vector<float>());
    if (depth)
      side.image = std::make_shared<const DepthImage>(std::move(*depth));
    else
      side.trouble = qt(depth.error().what) + ": " + qt(depth.error().remedy);
  }
}

void DepthModel::take(const Work& work) {
  long_.stop();
  is_long_ = false;
  const bool other = matrix_ != work.matrix;
  matrix_ = work.matrix;
  for (std::size_t k = 0; k < sides_.size(); ++k) {
    if (sides_[k].wanted != work.sides[k].wanted) continue;  // chosen meanwhile: update() comes again
    sides_[k] = work.sides[k];
    if (!work.trouble.isEmpty()) sides_[k].trouble = work.trouble;
  }
  if (other) Q_EMIT scanChanged();
  Q_EMIT imagesChanged();
}

QString DepthModel::trouble(std::size_t side) const {
  if (!sides_[side].trouble.isEmpty()) return sides_[side].trouble;
  return is_long_ ? QString("Reading the scan…") : QString();
}

bool DepthModel::hasCell(const CellPlace& cell) const {
  return matrix_ && cell.scan == matrix_->scan && cell.row >= 0 && cell.column >= 0 &&
         cell.row < matrix_->image->rows() && cell.column < matrix_->image->columns();
}

QString DepthModel::readout(const CellPlace& cell) const {
  if (!hasCell(cell)) return {};
  const RangeImage& image = *matrix_->image;
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  QString text = QString("Row %1, column %2").arg(cell.row).arg(cell.column);
  if (image.isRegular())
    text += QString("   tilt %1°, azimuth %2°")
                .arg(number(beamTilt(image, matrix_->geometry, cell.row, cell.column) / kDegree, 2),
                     number(matrix_->geometry.azimuthOfColumn(cell.column) / kDegree, 2));
  const std::size_t k = image.index(cell.row, cell.column);
  if (!image.hasPoint(k)) return text + "   " + qt(cellCodeText(image.code(k)));
  const Eigen::Vector3d& point = matrix_->points[k];
  const Eigen::Vector3d& normal = matrix_->normals[k];
  text += "   range " + lengthText(image.range(k), unit);
  text += QString("   point (%1, %2, %3) %4")
              .arg(lengthNumber(point.x(), unit), lengthNumber(point.y(), unit),
                   lengthNumber(point.z(), unit), unitName(unit));
  for (const Side& side : sides_)
    if (side.image && side.image->quantity == DepthQuantity::Residual &&
        std::isfinite(side.image->value[k])) {
      text += "   residual " + smallLengthText(side.image->value[k], unit);
      break;
    }
  text += normal.isZero() ? "   no normal" : "   normal " + vectorText(normal, 2);
  if (image.hasIntensity()) text += "   intensity " + number(image.intensity(k), 0);
  return text;
}

QString DepthModel::summary() const {
  if (is_long_) return "Reading the scan…";
  QString text;
  for (const Side& side : sides_) {
    const DepthImage* image = side.image.get();
    if (image && image->quantity == DepthQuantity::Changed)
      text = QString("Changed by the 3 × 3 median: %1 cells, mean change %2 m")
                 .arg(qt(groupedInteger(static_cast<long long>(image->changed))),
                      number(image->mean_change_m, 2));
    if (!image || image->quantity != DepthQuantity::Residual) continue;
    const QString stage = stageTitle(workspace_.display().stage());
    text = image->overlapping == 0
               ? QString("Residual, %1: no cell overlaps another scan").arg(stage)
               : QString("Residual, %1: median %2 mm over %3 cells that overlap other scans")
                     .arg(stage, number(1e3 * image->median_residual_m, 1),
                          qt(groupedInteger(static_cast<long long>(image->overlapping))));
  }
  return text;
}

}  // namespace tiltmap::ui
