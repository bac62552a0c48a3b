#include "ui/models/link_table_model.h"

#include <QFont>
#include <algorithm>
#include <array>

#include "core/base/text.h"
#include "ui/models/edits.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

LinkTableModel::LinkTableModel(Workspace& workspace, QObject* parent)
    : QAbstractTableModel(parent), workspace_(workspace), display_(&workspace.display()) {
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &LinkTableModel::readAgain);
  connect(&workspace.display(), &ScanDisplay::stageChanged, this, &LinkTableModel::readAgain);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, &LinkTableModel::readAgain);
  readAgain();
}

LinkTableModel::~LinkTableModel() {
  // Views would go on showing where scans would be, with nobody left to end it.
  if (what_if_ && display_) display_->showWhatIf({}, {});
}

void LinkTableModel::readAgain() {
  const bool asked = what_if_.has_value();
  beginResetModel();
  snapshot_ = workspace_.snapshot();
  links_.clear();
  judged_.clear();
  what_if_.reset();
  if (snapshot_) {
    links_ = snapshot_->links();
    judged_ = workspace_.linkOpinions().of(*snapshot_, workspace_.display().stage());
  }
  endResetModel();
  if (!asked) return;
  workspace_.display().showWhatIf({}, {});
  Q_EMIT whatIfChanged();
}

int LinkTableModel::rowOf(LinkId link) const {
  const auto row = std::ranges::find(links_, link, &Link::id);
  return row == links_.end() ? -1 : static_cast<int>(row - links_.begin());
}

const LinkJudgement* LinkTableModel::judgement(LinkId link) const {
  const int row = rowOf(link);
  return row < 0 ? nullptr : &judged_[static_cast<std::size_t>(row)];
}

QString LinkTableModel::summary() const {
  std::array<int, 6> counts{};
  for (const LinkJudgement& judgement : judged_) ++counts[static_cast<std::size_t>(judgement.quality)];
  QStringList parts;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] > 0)
      parts << QString("%1 %2").arg(counts[i]).arg(qt(linkQualityName(static_cast<LinkQuality>(i))));
  if (parts.isEmpty()) return {};
  return QString("%1 %2: %3").arg(links_.size()).arg(links_.size() == 1 ? "link" : "links", parts.join(", "));
}

Status LinkTableModel::ask(const std::vector<LinkId>& left_out) {
  if (!snapshot_) return fail("no project is open", "", "open one first");
  if (left_out.empty()) return fail("no link is selected", "links", "select the links to leave out");
  auto what_if = whatIfWithout(*snapshot_, left_out);
  if (!what_if) return fail(what_if.error());
  what_if_ = std::move(*what_if);
  std::map<ScanId, Pose> ghosts;
  for (std::size_t i = 0; i < what_if_->after.size(); ++i)
    ghosts[snapshot_->scans()[i].id] = what_if_->after[i];
  workspace_.display().showWhatIf(std::move(ghosts), leftOut());
  if (!links_.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
  Q_EMIT whatIfChanged();
  return {};
}

void LinkTableModel::endAsking() {
  if (!what_if_) return;
  what_if_.reset();
  workspace_.display().showWhatIf({}, {});
  if (!links_.empty()) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
  Q_EMIT whatIfChanged();
}

std::vector<LinkId> LinkTableModel::leftOut() const {
  std::vector<LinkId> links;
  if (what_if_)
    for (const LinkVerdict& verdict : what_if_->links)
      if (verdict.left_out) links.push_back(verdict.link);
  return links;
}

QString LinkTableModel::whatIfSentence() const {
  return what_if_ && snapshot_ ? qt(whatIfText(*snapshot_, *what_if_)) : QString();
}

const LinkVerdict* LinkTableModel::verdict(LinkId link) const {
  if (!what_if_) return nullptr;
  const auto found = std::ranges::find(what_if_->links, link, &LinkVerdict::link);
  return found == what_if_->links.end() ? nullptr : &*found;
}

int LinkTableModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(links_.size());
}
int LinkTableModel::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(kColumns);
}

QVariant LinkTableModel::number(std::size_t row, int column) const {
  const Link& link = links_[row];
  const LinkJudgement& judged = judged_[row];
  const PairJudgement* scans = judged.by_scans.get();
  const LinkVerdict* said = verdict(link.id);
  switch (column) {
    case Pair:
      return static_cast<qlonglong>(snapshot_->indexOf(link.fixed).value_or(0) * 1000000 +
                                    snapshot_->indexOf(link.moving).value_or(0));
    case Quality:
      return -judged.badness;  // ascending: the worst first
    case Overlap:
      return scans ? scans->overlap() : -1.0;
    case Fit:
      return scans ? scans->fit : -1.0;
    case Residual:
      return scans ? scans->residual_m : -1.0;
    case Correspondences:
      return link.correspondences;
    case Weakest:
      return scans ? scans->strength.weakest_m : -1.0;
    case Moved:
      return scans ? scans->moved.translation_m : -1.0;
    case Others:
      return judged.others.supported ? judged.others.off.translation_m : -1.0;
    case Times:
      return judged.others.supported ? judged.others.deviations : -1.0;
    case Loop:
      return judged.others.loop > 0 ? judged.others.misclosure.translation_m : -1.0;
    case Off:
      return judged.off.translation_m;
    case Turned:
      return judged.off.rotation_rad;
    case With:
      return said ? said->before.translation_m : -1.0;
    case Without:
      return said ? said->after.translation_m : -1.0;
    case Origin:
      return qt(linkOriginName(link.origin));
    default:
      return qt(linkStateName(link.state));
  }
}

QString LinkTableModel::text(std::size_t row, int column) const {
  const Link& link = links_[row];
  const LengthUnit unit = workspace_.preferences().lengthUnit();
  const auto small = [unit](double metres) {
    return unit == LengthUnit::Foot ? qt(fixedReal(inUnit(metres, unit), 4))
                                    : qt(fixedReal(1000.0 * metres, 1));
  };
  const auto percent = [](double share) { return qt(fixedReal(100.0 * share, 0)); };
  const QString none = "–";
  const PairJudgement* scans = judged_[row].by_scans.get();
  const LinkAgreement& others = judged_[row].others;
  const LinkVerdict* said = verdict(link.id);
  switch (column) {
    case Pair:
      return qt(linkName(*snapshot_, link));
    case Quality:
      return qt(linkQualityName(judged_[row].quality));
    case Overlap:
      return scans ? percent(scans->overlap()) : none;
    case Fit:
      return scans ? percent(scans->fit) : none;
    case Residual:
      return scans ? small(scans->residual_m) : none;
    case Correspondences:
      return link.correspondences > 0 ? QString::number(link.correspondences) : none;
    case Weakest:
      return scans ? small(2.0 * scans->strength.weakest_m) : none;
    case Moved:
      return scans ? small(scans->moved.translation_m) : none;
    case Others:
      return others.supported ? small(others.off.translation_m) : none;
    case Times:
      return others.supported ? qt(fixedReal(others.deviations, 1)) : none;
    case Loop:
      return others.loop > 0 ? small(others.misclosure.translation_m) : none;
    case Off:
      return small(judged_[row].off.translation_m);
    case Turned:
      return qt(fixedReal(judged_[row].off.rotation_rad / kDegree, 3));
    case Origin:
      return link.origin == LinkOrigin::ByHand ? "by hand" : qt(linkOriginName(link.origin));
    case State:
      return said && said->left_out ? "left out" : qt(linkStateName(link.state));
    case With:
      return said ? small(said->before.translation_m) : QString();
    case Without:
      if (!said) return {};
      return said->supported ? small(said->after.translation_m) : "no other says";
    default:
      return {};
  }
}

QVariant LinkTableModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const auto row = static_cast<std::size_t>(index.row());
  const int column = index.column();
  switch (role) {
    case Qt::DisplayRole:
      return text(row, column);
    case kSortRole:
      return number(row, column);
    case Qt::TextAlignmentRole: {
      const bool words = column == Pair || column == Quality || column == Origin || column == State;
      return static_cast<int>((words ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
    }
    case Qt::FontRole: {
      const LinkVerdict* said = verdict(links_[row].id);
      QFont font;
      font.setStrikeOut(links_[row].state == LinkState::Disabled || (said && said->left_out));
      return font;
    }
    case Qt::ToolTipRole: {
      QString tip =
          QString("Link %1 is %2").arg(qt(linkName(*snapshot_, links_[row])), qt(linkText(judged_[row])));
      if (!links_[row].stop_reason.empty()) tip += "\nEnded with: " + qt(links_[row].stop_reason);
      return tip;
    }
    default:
      return {};
  }
}

QVariant LinkTableModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal) return {};
  if (role == Qt::TextAlignmentRole) {
    const bool words = section == Pair || section == Quality || section == Origin || section == State;
    return static_cast<int>((words ? Qt::AlignLeft : Qt::AlignRight) | Qt::AlignVCenter);
  }
  const QString small =
      workspace_.preferences().lengthUnit() == LengthUnit::Foot ? QString("ft") : QString("mm");
  const QStringList titles = {"Link",
                              "Verdict",
                              "Overlap (%)",
                              "Fit (%)",
                              "Residual (" + small + ")",
                              "Correspondences",
                              "Held (" + small + ")",
                              "Moved (" + small + ")",
                              "Others (" + small + ")",
                              "Times",
                              "Loop (" + small + ")",
                              "Off (" + small + ")",
                              "Turned (°)",
                              "Origin",
                              "State",
                              "With (" + small + ")",
                              "Without (" + small + ")"};
  static const QStringList kTips = {
      "The fixed scan and the moving one, by index",
      "Good: build on it. Doubtful: its scans or the other links do not prove it. Bad: do not use it. Not "
      "judged: "
      "choose Judge. The tip of a row tells the reason",
      "Share of one scan's surfaces that lie on the other's, by the scan that shows more",
      "Of the surfaces that both scans could see, the share that lies on the other",
      "Median distance of the surfaces that fit",
      "Correspondences that the registration ended with, after rejection: of patches, cells or points, by its "
      "preset",
      "Two deviations of the place in the direction that the surfaces hold least",
      "How far the pose lies from where its registration began",
      "How far from the link's pose the other links together put its scans",
      "That distance over what the link and the others are uncertain by: about 1 where all is well",
      "How far the shortest loop of links through this one is from closing",
      "How far the link's own pose is from where the poses shown put the two scans",
      "Angle between the link's own pose and how the poses shown turn the two scans",
      "Who found it: odometry, registration (automatic) or a person (by hand)",
      "A disabled link is kept, but nothing is computed from it",
      "What if: how far the link is off when all links are fitted together",
      "What if: how far the link is off from where the others put its scans"};
  if (role == Qt::DisplayRole) return titles.value(section);
  if (role == Qt::ToolTipRole) return kTips.value(section);
  return {};
}

}  // namespace tiltmap::ui
