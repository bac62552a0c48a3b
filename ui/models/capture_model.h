// The capture panel's model: the station's state in words, commands, the sweep as a job, where it belongs.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>

#include "hardware/capture/capture_station.h"
#include "ui/models/capture_verdict.h"
#include "ui/models/deliveries.h"
#include "ui/models/parameter_model.h"

namespace tiltmap::ui {

class JobQueue;
class ProjectSession;
class ScanDisplay;

class CaptureModel;
class Workspace;

// The one of the window; made when it is first asked for, and goes with the workspace.
CaptureModel& captureModel(Workspace& workspace);

// "What happened (where). What to do: remedy."
QString errorSentence(const Error& error);
QString stationStateTitle(StationState state);  // "Not connected", "Ready", ...

// Lives on the window's thread and never waits: instruments are talked to on the station's. A sweep is a job
// of the window's queue, so that its lines are stored like every other edit and closing the window ends it in
// order.
class CaptureModel : public QObject {
  Q_OBJECT

 public:
  CaptureModel(ProjectSession& session, JobQueue& jobs, ScanDisplay& display, QObject* parent = nullptr);
  ~CaptureModel() override;

  const StationSnapshot& now() const { return now_; }
  StationState state() const { return now_.state; }
  QString title() const;     // of the state
  QString sentence() const;  // what goes on, or what happened and what to do
  QString trouble() const;   // that an instrument tells of itself: "window: dirty, wipe it"; empty for none
  bool isConnected() const;  // commands to the tilt make sense
  bool isBusy() const;       // connecting, moving, scanning, reconnecting
  bool isSweeping() const;   // a sweep's job is not over

  void connectTo(const CaptureSettings& source);
  // `network`: where a scanner in a network may be; empty: none is looked for there.
  void connectToWhatIsThere(const QString& tilt_options, const QString& network = {});
  void reconnect();
  void disconnectInstruments();
  void jogBy(double angle_rad);
  void jogTo(double angle_rad);
  void home();
  void park();
  void setLive(bool on);
  void order(const QString& fault);  // of the emulator
  QStringList faults() const;
  // Ends whatever goes on; always accepted.
  void stop();
  // Where the lines of the last line's beams point: by the scanner that is connected.
  std::vector<double> azimuths(std::size_t columns) const;

  // Lines, step, start and mode, as the capture operation has them.
  ParameterModel& parameters() { return *parameters_; }
  // The next stop, or with `resume` the rest of the last one. last_from_next: nothing for the first stop and
  // for emulated drives, which bring their own.
  void start(const std::optional<Pose>& last_from_next);
  void resume();
  // What the next stop takes over from those before it where "known-rig" is set: "the calibration of stop 3
  // ..."; empty for nothing, or while no instruments are known.
  QString knownRigText() const;
  QString whyNotStart() const;  // empty where it can
  bool canResume() const;       // the last scan is not whole, and instruments are there
  bool needsOdometry() const;   // there is a stop before, and the instruments are no emulated drive

  CaptureVerdict& verdict() { return *verdict_; }
  const CaptureVerdict& verdict() const { return *verdict_; }

  // The lines of now().sweep, in the order taken.
  const std::vector<StationLinePtr>& rows() const { return rows_; }

  // What the sweep is at, as a person reads it; empty where there is nothing to tell.
  QString linesText() const;      // "34 of 101"
  QString leftText() const;       // "14 s"
  QString deadText() const;       // "3.2 %"
  QString retriesText() const;    // "2", "2; found again once"
  QString tiltErrorText() const;  // "+0.004°, worst 0.006°"
  QString diskText() const;       // "12.0 GB, 48,000 sweeps"
  QString tiltText() const;       // "+12.40°"

 Q_SIGNALS:
  void changed();  // anything but lines
  void lineSeen(const tiltmap::StationLinePtr& line);
  void sweepBegan();  // now().sweep is another one
  void rowTaken(const tiltmap::StationLinePtr& line);

 private:
  // Between the station and this object, which may go first.
  struct Mailbox {
    std::mutex mutex;
    CaptureModel* model = nullptr;
    bool posted = false;
  };

  void read();
  void readDisk();
  void startSweep(bool resume, const std::optional<Pose>& last_from_next);
  ParameterValues values(bool resume) const;
  void jobEnded(int id);
  void showPlace();
  void storePlace();

  Deliveries deliveries_;  // from the station
  ProjectSession& session_;
  JobQueue& jobs_;
  ScanDisplay& display_;
  std::shared_ptr<Mailbox> mailbox_ = std::make_shared<Mailbox>();
  std::shared_ptr<CaptureStation> station_;
  std::unique_ptr<Operation> form_;  // whose parameters the form shows
  ParameterModel* parameters_;
  CaptureVerdict* verdict_;
  StationSnapshot now_;
  std::vector<StationLinePtr> rows_;
  std::optional<int> job_;
  std::optional<Error> refused_;  // of the last start
  bool place_shown_ = false, place_stored_ = false;
  mutable std::tuple<std::string, std::int64_t, std::string, std::string, int, double, double, int>
      known_rig_key_;
  mutable QString known_rig_text_;
  QElapsedTimer disk_read_;
  double disk_free_bytes_ = -1.0;
};

}  // namespace tiltmap::ui
