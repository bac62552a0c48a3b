// A pairwise registration that a person steps through: choice, iterations, position, acceptance.
#pragma once

#include <QObject>
#include <QTimer>
#include <optional>
#include <vector>

#include "core/registration/pair_judgement.h"
#include "core/registration/registration_trace.h"
#include "ui/models/background_worker.h"
#include "ui/models/parameter_model.h"
#include "ui/models/prepared_pair.h"
#include "ui/models/start_model.h"

namespace tiltmap::ui {

class ProjectSession;

// Lives on the window's thread and computes on another. Nothing is stored before accept(); discarding,
// another pair, other parameters or another start throw the iterations away. No widgets.
class StepperModel : public QObject {
  Q_OBJECT

 public:
  StepperModel(ProjectSession& session, Preferences& preferences, QObject* parent = nullptr);

  // The choice.
  std::optional<ScanId> fixed() const { return fixed_; }
  std::optional<ScanId> moving() const { return moving_; }
  void choose(std::optional<ScanId> fixed, std::optional<ScanId> moving);
  void swapScans() { choose(moving_, fixed_); }
  QString scanName(bool of_fixed) const;  // "scan 5, stop 5"; empty without one
  ParameterModel& parameters() { return parameters_; }
  const ParameterModel& parameters() const { return parameters_; }
  StartModel& start() { return start_; }
  const StartModel& start() const { return start_; }
  // Why nothing can be stepped; empty where it can.
  QString problem() const { return problem_; }
  bool isReady() const { return problem_.isEmpty(); }
  PreparedPairPtr scans() const { return scans_; }

  // The iterations. Position 0 is the start, k is after the k-th iteration.
  int count() const { return static_cast<int>(steps_.size()); }
  int position() const { return position_; }
  void goTo(int position);
  void step();  // forward: to one that is kept, else a new one is computed
  void back();
  void run();  // step after step, until the end or pause()
  void pause();
  bool canStep() const { return isReady() && !(isEnded() && position_ == count()); }
  bool canGoBack() const { return position_ > 0; }
  bool isRunning() const { return running_; }
  bool isWorking() const { return worker_.busy(); }
  bool isEnded() const { return result_.has_value(); }
  // Waits between two iterations of run(), so that they can be seen.
  void setPace(int milliseconds) { pace_.setInterval(milliseconds); }

  // What is kept; the attempts are those of RegistrationTrace.
  const std::vector<TraceStepPtr>& steps() const { return steps_; }
  const std::vector<TraceAttempt>& attempts() const { return attempts_; }
  const std::optional<PairResult>& result() const { return result_; }
  std::optional<std::size_t> chosenAttempt() const { return chosen_; }
  // Whether the result can be trusted, by the two scans; null until there is one. The link will carry it.
  std::shared_ptr<const PairJudgement> judgement() const { return judgement_; }

  // At the position. Nothing at the start, where no pairs have been found yet.
  const TraceStep* current() const;
  const TraceAttempt* attempt() const;
  const std::vector<TracedPair>& pairs() const { return pairs_; }  // of the current step
  Pose pose() const;                                               // of the moving scan, after the step
  Pose poseBefore() const;                                         // at which the step's pairs were found
  // One of pairs(), or nothing; another position forgets it.
  std::optional<std::size_t> picked() const { return picked_; }
  void pick(std::optional<std::size_t> pair);
  QString pickedSentence() const;
  // Where things stand, in words: "Iteration 3 of 9", "Ended after 12 iterations: converged. The error ..."
  QString stateSentence() const;

  // Stores the result as a link (see steppedPairEdit), whatever iteration is shown.
  bool canAccept() const;
  // While other work goes on the project must not change under it.
  void setProjectBusy(bool busy);
  QString acceptHint() const;  // why not, or what it does
  bool isStored() const;       // the project has this very link
  Status accept();
  void discard();

 Q_SIGNALS:
  void choiceChanged();    // pair, its scans or problem()
  void stepsChanged();     // an iteration was added, or all went
  void positionChanged();  // what current() gives
  void pickedChanged();
  void stateChanged();  // running, working, ended, stored
  void failed(const tiltmap::Error& error);

 private:
  void refreshScans();
  void refreshProblem();
  std::optional<RegistrationSettings> settings(QString* problem) const;
  void parametersChanged();
  void startOver();
  void setPosition(int position);
  void compute();
  void take(const TraceStepPtr& step, const RegistrationTrace& trace,
            std::shared_ptr<const PairJudgement> judgement);
  void tick();

  ProjectSession& session_;
  Preferences& preferences_;
  ParameterModel parameters_;
  StartModel start_;
  std::optional<ScanId> fixed_, moving_;
  QString problem_;
  PreparedPairPtr scans_;
  std::vector<std::int64_t> identity_;  // of matrices, geometries and poses the scans were taken with
  Pose odometry_;

  // Touched by the worker alone while it is busy; what is shown are copies.
  std::shared_ptr<std::optional<RegistrationTrace>> trace_;
  std::string started_;
  std::vector<TraceStepPtr> steps_;
  std::vector<TraceAttempt> attempts_;
  std::optional<PairResult> result_;
  std::optional<std::size_t> chosen_;
  std::shared_ptr<const PairJudgement> judgement_;
  std::vector<TracedPair> pairs_;
  std::optional<std::size_t> picked_;
  int position_ = 0;
  int wanted_ = 0;  // steps asked for while one is computed
  bool running_ = false;
  bool project_busy_ = false;
  QTimer pace_;
  BackgroundWorker worker_;
};

}  // namespace tiltmap::ui
