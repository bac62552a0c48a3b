// Reads the points of scans off the window's thread and hands them over as they come.
#pragma once

#include <QObject>
#include <functional>
#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "ui/scene/scan_points.h"

namespace tiltmap::ui {

// Lives on the window's thread. What is being read when something else is wanted is read to its end; scans
// that wait are let go. The destructor waits for what is being read.
class PointReader : public QObject {
  Q_OBJECT

 public:
  using Read = std::function<Result<ScanPoints>(const PointsWanted&, const std::stop_token&)>;

  // `read` runs on the reader's threads. threads 0: as many as there are cores.
  explicit PointReader(QObject* parent = nullptr, Read read = readPoints, int threads = 0);
  ~PointReader() override;
  // For what is begun from now on.
  void setRead(Read read);

  // All that is wanted from now on, the first first. What could not be read before is not tried again.
  void want(const std::vector<PointsWanted>& scans);
  // Nothing is wanted any more, and what is being read is not handed over: another project.
  void forget();

  // Those that have come since it was asked last.
  std::vector<ScanPoints> take();

  bool isReading() const { return done_ < total_; }
  // Since the reader last had nothing to do.
  int done() const { return done_; }
  int total() const { return total_; }

  struct Trouble {
    std::string scan;  // its name
    Error error;
  };

 Q_SIGNALS:
  // take() has some more: the more there were already, the more at once, so that showing them costs little in
  // all.
  void arrived();
  void failed(const tiltmap::ui::PointReader::Trouble& trouble);
  void progressed();

 private:
  struct Shared;
  void startThreads();
  void collect();

  std::shared_ptr<Shared> shared_;
  int threads_;
  int done_ = 0, total_ = 0;
  std::size_t handed_over_ = 0;  // points, of the scans of this project
  std::vector<ScanPoints> waiting_, ready_;
  std::set<PointsKey> unreadable_;
};

}  // namespace tiltmap::ui
