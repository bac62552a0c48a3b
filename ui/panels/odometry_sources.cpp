#include "ui/panels/odometry_sources.h"

#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <cmath>

#include "core/base/text.h"
#include "core/geometry/body_axes.h"
#include "ui/look/text_colour.h"
#include "ui/look/theme.h"
#include "ui/models/preferences.h"
#include "ui/models/strings.h"
#include "ui/panels/controls.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

constexpr const char* kAxesKey = "capture/odometry-axes";
constexpr const char* kFileKey = "capture/odometry-file";
constexpr const char* kFeedKey = "capture/odometry-feed";
constexpr int kPoll_ms = 100;

QComboBox* axesChoice(QWidget* parent, const QString& name, const Preferences& preferences,
                      const QString& key) {
  auto* box = new QComboBox(parent);
  describe(
      box, name, "Axes of the vehicle",
      "Which way the axes of the poses' body point: ROS and most robots have x forward and y left; Tiltmap's "
      "own files have x right and y forward");
  box->addItem("x forward, y left (ROS)", static_cast<int>(BodyAxes::ForwardLeftUp));
  box->addItem("x right, y forward (Tiltmap)", static_cast<int>(BodyAxes::RightForwardUp));
  box->setMinimumHeight(kGloveField_px);
  box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  box->setMinimumContentsLength(10);
  box->setCurrentIndex(preferences.text(key, "0") == "1" ? 1 : 0);
  return box;
}

Pose scanFromBodyOf(const QComboBox* axes) {
  return scanFromBody(static_cast<BodyAxes>(axes->currentData().toInt()));
}

QString poseText(const StampedPose& pose) {
  const Eigen::Vector3d& t = pose.world_from_body.translation();
  return QString("x %1  y %2  z %3 m")
      .arg(qt(fixedReal(t.x(), 2)), qt(fixedReal(t.y(), 2)), qt(fixedReal(t.z(), 2)));
}

}  // namespace

FileOdometryPage::FileOdometryPage(Preferences& preferences, QWidget* parent)
    : OdometryPage(parent), preferences_(preferences) {
  auto* layout = new QGridLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(8);
  layout->setColumnStretch(1, 1);
  path_ = gloveField(this, "odometry-file-path", "TUM file",
                     "A file of poses over time, a line each: stamp x y z qx qy qz qw");
  path_->setPlaceholderText("poses.tum");
  auto* browse = gloveButton(this, "odometry-file-browse", "Choose…", "Choose the file");
  browse->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
  again_ = gloveButton(this, "odometry-file-again", "Read", "Read the file, again where it has grown");
  again_->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
  auto* files = new QHBoxLayout;
  files->setSpacing(8);
  files->addWidget(path_, 1);
  files->addWidget(browse);
  layout->addLayout(files, 0, 0, 1, 2);
  axes_ = axesChoice(this, "odometry-file-axes", preferences, QString(kAxesKey) + "-file");
  layout->addWidget(axes_, 1, 0, 1, 2);
  last_ = gloveField(this, "odometry-stamp-last", "Stamp of the last stop",
                     "When the vehicle stood at the last stop");
  next_ = gloveField(this, "odometry-stamp-next", "Stamp of the new stop",
                     "When the vehicle stood at the new stop");
  last_label_ = new QLabel("Last stop at", this);
  auto* next_label = new QLabel("New stop at", this);
  last_label_->setBuddy(last_);
  next_label->setBuddy(next_);
  layout->addWidget(last_label_, 2, 0);
  layout->addWidget(last_, 2, 1);
  layout->addWidget(next_label, 3, 0);
  layout->addWidget(next_, 3, 1);
  earlier_ = gloveButton(this, "odometry-stamp-earlier", "Earlier", "The new stop at the pose before");
  later_ = gloveButton(this, "odometry-stamp-later", "Later", "The new stop at the pose after");
  auto* steps = new QHBoxLayout;
  steps->setSpacing(8);
  steps->addWidget(earlier_, 1);
  steps->addWidget(later_, 1);
  steps->addWidget(again_);
  layout->addLayout(steps, 4, 0, 1, 2);
  found_ = new SentenceLabel(this, "odometry-file-found", "What the file holds");
  layout->addWidget(found_, 5, 0, 1, 2);

  connect(path_, &QLineEdit::editingFinished, this, [this] {
    if (path_->isModified()) read();
  });
  connect(browse, &QToolButton::clicked, this, [this] {
    askForFiles(this, preferences_,
                {FileQuestion::OpenOne, "Odometry", "Poses (*.tum *.txt);;All files (*)", {}, "odometry", {}},
                [this](const QStringList& files_chosen) { open(files_chosen.front()); });
  });
  connect(again_, &QToolButton::clicked, this, &FileOdometryPage::read);
  connect(axes_, qOverload<int>(&QComboBox::currentIndexChanged), this, [this](int index) {
    preferences_.setText(QString(kAxesKey) + "-file", QString::number(index));
    refresh();
  });
  for (QLineEdit* stamp : {last_, next_})
    connect(stamp, &QLineEdit::textEdited, this, &FileOdometryPage::refresh);
  connect(earlier_, &QToolButton::clicked, this, [this] { moveBy(-1); });
  connect(later_, &QToolButton::clicked, this, [this] { moveBy(1); });
  path_->setText(preferences.text(kFileKey));
  refresh();
}

void FileOdometryPage::open(const QString& path) {
  path_->setText(path);
  last_->clear();
  next_->clear();
  read();
}

void FileOdometryPage::read() {
  path_->setModified(false);
  const QString path = path_->text().trimmed();
  preferences_.setText(kFileKey, path);
  track_.reset();
  if (!path.isEmpty()) track_ = PoseTrack::read(pathOf(path));
  if (track_ && *track_ && next_->text().isEmpty()) {
    const PoseTrack& track = **track_;
    const bool two = !first_ && track.size() > 1;
    if (last_->text().isEmpty() && two) last_->setText(qt(shortestReal(track.at(0).stamp_s)));
    next_->setText(qt(shortestReal(track.at(two ? 1 : 0).stamp_s)));
  }
  refresh();
}

Result<double> FileOdometryPage::stampOf(const QLineEdit* field, const char* which) const {
  if (!track_) return fail("no file has been read", "", "choose a TUM file with the poses of the vehicle");
  if (!*track_) return fail(track_->error().where + ": " + track_->error().what, "", track_->error().remedy);
  const std::string text(trimmed(utf8(field->text())));
  const auto number = parseReal(text);
  if (number) return *number;
  return fail(text.empty() ? std::string("the stamp of the ") + which + " stop is missing"
                           : printable(text) + " is no stamp",
              "", "type seconds as the file has them");
}

Result<Pose> FileOdometryPage::step() const {
  const auto last = stampOf(last_, "last"), next = stampOf(next_, "new");
  if (!last) return fail(last.error());
  if (!next) return fail(next.error());
  return stepInTrack(**track_, *last, *next, kStampWithin_s, scanFromBodyOf(axes_));
}

std::optional<std::size_t> FileOdometryPage::newStop() const {
  const auto stamp = stampOf(next_, "new");
  if (!stamp) return {};
  const auto index = (*track_)->nearest(*stamp, kStampWithin_s);
  return index ? std::optional(*index) : std::nullopt;
}

void FileOdometryPage::moveBy(int poses) {
  const auto index = newStop();
  if (!index) return;
  const auto to = static_cast<std::ptrdiff_t>(*index) + poses;
  if (to < 0 || to >= static_cast<std::ptrdiff_t>((*track_)->size())) return;
  next_->setText(qt(shortestReal((*track_)->at(static_cast<std::size_t>(to)).stamp_s)));
  refresh();
}

void FileOdometryPage::stopCaptured() {
  const auto index = newStop();
  if (!index) return;
  last_->setText(qt(shortestReal((*track_)->at(*index).stamp_s)));
  next_->clear();
  if (*index + 1 < (*track_)->size()) next_->setText(qt(shortestReal((*track_)->at(*index + 1).stamp_s)));
  refresh();
}

void FileOdometryPage::setFirstStop(bool first) {
  first_ = first;
  refresh();
}

void FileOdometryPage::refresh() {
  last_->setEnabled(!first_);
  last_label_->setEnabled(!first_);
  const auto next = newStop();
  earlier_->setEnabled(next && *next > 0);
  later_->setEnabled(next && *next + 1 < (*track_)->size());
  again_->setEnabled(!path_->text().trimmed().isEmpty());
  QString text;
  if (track_ && *track_) {
    const PoseTrack& track = **track_;
    text =
        QString("%1 poses, stamps %2 to %3.")
            .arg(track.size())
            .arg(qt(shortestReal(track.at(0).stamp_s)), qt(shortestReal(track.at(track.size() - 1).stamp_s)));
    if (next) text += QString(" New stop: pose %1, %2.").arg(*next + 1).arg(poseText(track.at(*next)));
  }
  found_->say(text);
  found_->setVisible(!text.isEmpty());
  Q_EMIT changed();
}

FeedOdometryPage::FeedOdometryPage(const Theme& theme, Preferences& preferences, QWidget* parent)
    : OdometryPage(parent), theme_(theme), preferences_(preferences) {
  auto* layout = new QGridLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(8);
  layout->setColumnStretch(0, 1);
  where_ = gloveField(this, "odometry-feed-address", "Address of the feed",
                      "Who sends lines `stamp x y z qx qy qz qw`: HOST:PORT");
  where_->setPlaceholderText("192.168.0.10:7000");
  where_->setText(preferences.text(kFeedKey));
  connect_ =
      gloveButton(this, "odometry-feed-connect", "Connect", "Connect to the feed, and again when it is lost");
  connect_->setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
  connect_->setCheckable(true);
  connect_->setMinimumWidth(connect_->fontMetrics().horizontalAdvance("Disconnect") + 24);
  axes_ = axesChoice(this, "odometry-feed-axes", preferences, QString(kAxesKey) + "-feed");
  state_ = new SentenceLabel(this, "odometry-feed-state", "State of the feed");
  pose_ = new SentenceLabel(this, "odometry-feed-pose", "Latest pose of the feed");
  take_ = gloveButton(this, "odometry-feed-take", "Take pose",
                      "The vehicle stands at the new stop: take the feed's latest pose");
  here_ = gloveButton(this, "odometry-feed-here", "Last stop here",
                      "The vehicle still stands at the last stop: take the feed's latest pose for it");
  layout->addWidget(where_, 0, 0);
  layout->addWidget(connect_, 0, 1);
  // What is pressed at every stop stands above what is chosen once.
  auto* buttons = new QHBoxLayout;
  buttons->setSpacing(8);
  buttons->addWidget(take_, 1);
  buttons->addWidget(here_, 1);
  layout->addLayout(buttons, 1, 0, 1, 2);
  layout->addWidget(state_, 2, 0, 1, 2);
  layout->addWidget(pose_, 3, 0, 1, 2);
  layout->addWidget(axes_, 4, 0, 1, 2);

  connect(connect_, &QToolButton::toggled, this, &FeedOdometryPage::connectOrNot);
  connect(where_, &QLineEdit::returnPressed, connect_, [this] { connect_->setChecked(true); });
  connect(axes_, qOverload<int>(&QComboBox::currentIndexChanged), this, [this](int index) {
    preferences_.setText(QString(kAxesKey) + "-feed", QString::number(index));
    Q_EMIT changed();
  });
  connect(take_, &QToolButton::clicked, this, [this] {
    poll();
    if (const auto pose = now()) taken_ = pose;
    refresh();
    Q_EMIT changed();
  });
  connect(here_, &QToolButton::clicked, this, [this] {
    poll();
    if (const auto pose = now()) last_ = pose, taken_.reset();
    refresh();
    Q_EMIT changed();
  });
  connect(&theme, &Theme::changed, this, &FeedOdometryPage::refresh);
  timer_.setInterval(kPoll_ms);
  connect(&timer_, &QTimer::timeout, this, [this] {
    poll();
    refresh();
  });
  refresh();
}

void FeedOdometryPage::connectOrNot(bool on) {
  feed_.reset();
  if (status_) epochs_before_ += status_->epoch;
  status_.reset();
  timer_.stop();
  QString trouble;
  if (on) {
    const auto address = parseFeedAddress(utf8(where_->text()));
    if (address) {
      if (address_ != *address) {
        // Somebody else's poses have another origin.
        last_.reset();
        taken_.reset();
        last_stamp_s_.reset();
      }
      address_ = *address;
      preferences_.setText(kFeedKey, where_->text().trimmed());
      feed_ = std::make_unique<OdometryFeed>(*address);
      timer_.start();
      poll();
    } else {
      trouble = qt(address.error().what + ": " + address.error().remedy + ".");
      const QSignalBlocker quiet(connect_);
      connect_->setChecked(false);
    }
  }
  where_->setEnabled(!feed_);
  connect_->setText(feed_ ? "Disconnect" : "Connect");
  refresh();
  if (!trouble.isEmpty()) {
    trouble[0] = trouble[0].toUpper();
    state_->say(trouble);
  }
  Q_EMIT changed();
}

void FeedOdometryPage::poll() {
  if (!feed_) return;
  const bool had_none = !status_ || !status_->latest;
  status_ = feed_->status();
  if (!status_->latest) return;
  // Begun anew while nobody was connected.
  if (had_none && last_stamp_s_ && status_->latest->stamp_s < *last_stamp_s_) ++epochs_before_;
  last_stamp_s_ = status_->latest->stamp_s;
}

std::optional<FeedOdometryPage::Marked> FeedOdometryPage::now() const {
  if (!status_ || !status_->isFresh()) return {};
  return Marked{*status_->latest, epochs_before_ + status_->epoch};
}

Result<Pose> FeedOdometryPage::step() const {
  if (!last_)
    return feed_
               ? Result<Pose>(fail("the feed's pose at the last stop is not known", "",
                                   "while the vehicle still stands there press \"Last stop here\", else type "
                                   "the step"))
               : Result<Pose>(fail("no feed is connected", "", "give its address and connect"));
  if (!taken_)
    return fail("the pose of the new stop has not been taken", "",
                "drive there, wait until the vehicle stands, and press \"Take pose\"");
  if (last_->epoch != taken_->epoch)
    return fail("the vehicle's odometry was begun anew since the last stop", "",
                "type or nudge this step; from the next stop on the feed serves again");
  return stepBetween(last_->pose.world_from_body, taken_->pose.world_from_body, scanFromBodyOf(axes_));
}

void FeedOdometryPage::stopCaptured() {
  poll();
  last_ = taken_ ? taken_ : now();
  taken_.reset();
  refresh();
}

void FeedOdometryPage::setFirstStop(bool first) {
  first_ = first;
  refresh();
}

void FeedOdometryPage::refresh() {
  const bool fresh = now().has_value();
  take_->setEnabled(fresh && !first_);
  here_->setEnabled(fresh && !first_);
  state_->say(status_ ? qt(feedText(*status_)) : QString("Not connected."));
  const bool wrong =
      status_ && (status_->state == FeedState::Silent || status_->connection_error.has_value());
  setTextColour(state_, wrong ? theme_.colours().error : QColor());
  QString text;
  if (status_ && status_->latest)
    text = "Latest: " + poseText(*status_->latest) + ", stamp " + qt(fixedReal(status_->latest->stamp_s, 2));
  if (taken_) text += (text.isEmpty() ? "" : "\n") + QString("Taken: ") + poseText(taken_->pose);
  pose_->say(text);
  pose_->setVisible(!text.isEmpty());
}

}  // namespace tiltmap::ui
