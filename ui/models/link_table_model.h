// Every link with its figures, how far it is to be trusted, and what the others would say without some.
#pragma once

#include <QAbstractTableModel>
#include <QPointer>
#include <optional>

#include "core/project/link_quality.h"
#include "core/project/link_what_if.h"

namespace tiltmap::ui {

class ScanDisplay;
class Workspace;

class LinkTableModel : public QAbstractTableModel {
  Q_OBJECT

 public:
  // Badness: by which the worst come first.
  enum Column {
    Pair,
    Quality,
    Overlap,
    Fit,
    Residual,
    Correspondences,
    Weakest,
    Moved,
    Others,
    Times,
    Loop,
    Off,
    Turned,
    Origin,
    State,
    With,
    Without,
    kColumns
  };
  static constexpr int kSortRole = Qt::UserRole + 1;  // numbers, or texts that sort as people expect

  explicit LinkTableModel(Workspace& workspace, QObject* parent = nullptr);
  ~LinkTableModel() override;  // ends the question

  LinkId linkAt(int row) const { return links_[static_cast<std::size_t>(row)].id; }
  int rowOf(LinkId link) const;  // -1 where it is not there
  LinkQuality qualityAt(int row) const { return judged_[static_cast<std::size_t>(row)].quality; }
  const LinkJudgement* judgement(LinkId link) const;
  QString summary() const;  // "42 links: 38 good, 3 doubtful, 1 bad"

  // Asks what the others say without these; the project stays as it is. An error is returned and nothing is
  // asked. Any change of the project ends it.
  Status ask(const std::vector<LinkId>& left_out);
  void endAsking();
  const std::optional<LinkWhatIf>& whatIf() const { return what_if_; }
  std::vector<LinkId> leftOut() const;
  QString whatIfSentence() const;

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;

 Q_SIGNALS:
  void whatIfChanged();

 private:
  void readAgain();
  const LinkVerdict* verdict(LinkId link) const;
  QString text(std::size_t row, int column) const;
  QVariant number(std::size_t row, int column) const;

  Workspace& workspace_;
  QPointer<ScanDisplay> display_;  // may go first
  SnapshotPtr snapshot_;
  std::vector<Link> links_;
  std::vector<LinkJudgement> judged_;
  std::optional<LinkWhatIf> what_if_;
};

}  // namespace tiltmap::ui
