#include "ui/panels/capture_connect_page.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSpinBox>
#include <QStackedWidget>
#include <QVBoxLayout>

#include "hardware/capture/replayed_source.h"
#include "ui/models/capture_model.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/controls.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

namespace {

constexpr const char* kKeyPrefix = "capture/";

QFormLayout* formOf(QWidget* page) {
  auto* form = new QFormLayout(page);
  form->setContentsMargins(0, 0, 0, 0);
  form->setSpacing(8);
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  form->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
  form->setLabelAlignment(Qt::AlignLeft | Qt::AlignVCenter);
  return form;
}

QString factsText(const StationInstrument& instrument) {
  if (instrument.name.empty()) return {};
  QString text = "<p><b>" + qt(instrument.name).toHtmlEscaped() + "</b>";
  for (const InstrumentFact& fact : instrument.facts) {
    const QString line = (qt(fact.name) + ": " + qt(fact.value)).toHtmlEscaped();
    text += "<br>" + (fact.trouble ? "<b>! " + line + "</b>" : line);
  }
  return text + "</p>";
}

}  // namespace

CaptureConnectPage::CaptureConnectPage(CaptureModel& model, const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      model_(model),
      context_(context),
      source_(new QComboBox(this)),
      pages_(new QStackedWidget(this)),
      connect_(new QPushButton(this)),
      instruments_(wrappedLabel(this, "capture-instruments")) {
  describe(source_, "capture-source", "Where the instruments are",
           "Where the instruments are: found by asking every port, at ports you name, emulated, or recorded");
  source_->addItem("Find them at the ports");
  source_->addItem("At these addresses");
  source_->addItem("Emulator, to practise");
  source_->addItem("Recorded session");
  describe(connect_, "capture-connect", "Connect",
           "Open the instruments; the tilt switches its motor on and searches home");
  pages_->addWidget(buildFind());
  pages_->addWidget(buildNamed());
  pages_->addWidget(buildEmulator());
  pages_->addWidget(buildRecording());
  faults_ = buildFaults();
  instruments_->setTextFormat(Qt::RichText);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 8, 4, 8);  // room for large letters beside a scroll bar
  column->setSpacing(8);
  column->addWidget(source_);
  column->addWidget(pages_);
  column->addWidget(connect_);
  column->addWidget(faults_);
  column->addWidget(instruments_);
  column->addStretch(1);

  Preferences& preferences = context_.workspace.preferences();
  source_->setCurrentIndex(std::clamp(preferences.text(QString(kKeyPrefix) + "source").toInt(), 0, 3));
  pages_->setCurrentIndex(source_->currentIndex());
  connect(source_, qOverload<int>(&QComboBox::currentIndexChanged), this, [this](int index) {
    pages_->setCurrentIndex(index);
    context_.workspace.preferences().setText(QString(kKeyPrefix) + "source", QString::number(index));
    refresh();
  });
  connect(connect_, &QPushButton::clicked, this, &CaptureConnectPage::press);
  connect(&model_, &CaptureModel::changed, this, &CaptureConnectPage::refresh);
  refresh();
}

QLineEdit* CaptureConnectPage::line(const QString& name, const QString& accessible, const QString& tip,
                                    const QString& placeholder) {
  auto* edit = new QLineEdit(this);
  describe(edit, "capture-" + name, accessible, tip);
  edit->setPlaceholderText(placeholder);
  const QString key = kKeyPrefix + name;
  edit->setText(context_.workspace.preferences().text(key));
  connect(edit, &QLineEdit::textChanged, this,
          [this, key](const QString& text) { context_.workspace.preferences().setText(key, text); });
  return edit;
}

QWidget* CaptureConnectPage::buildFind() {
  auto* page = new QWidget(this);
  auto* form = formOf(page);
  tilt_options_ =
      line("tilt-options", "Options of the tilt unit",
           "What the tilt unit cannot tell: level=COUNTS, where the scanner looks straight ahead; min, max",
           "level=312525");
  form->addRow("Tilt &options", tilt_options_);
  network_ = line("network", "Address of a scanner in the network",
                  "Where an LMS1xx, LMS5xx or Hokuyo may be, beside what is plugged in: HOST or HOST:PORT; "
                  "empty: none in a network",
                  "192.168.0.1");
  form->addRow("&Network", network_);
  return page;
}

QWidget* CaptureConnectPage::buildNamed() {
  auto* page = new QWidget(this);
  auto* form = formOf(page);
  scanner_ =
      line("scanner", "Address of the scanner",
           "lms2xx:PORT, lms1xx:HOST or urg:PORT, options behind a question mark; ?log=FILE records the "
           "session",
           "lms2xx:/dev/ttyUSB0");
  tilt_ = line("tilt", "Address of the tilt unit",
               "mip50:PORT or epos:PORT, options behind a question mark; ?log=FILE records the session",
               "mip50:/dev/ttyUSB1?level=312525");
  form->addRow("&Scanner", scanner_);
  form->addRow("&Tilt", tilt_);
  return page;
}

QWidget* CaptureConnectPage::buildEmulator() {
  auto* page = new QWidget(this);
  auto* form = formOf(page);
  drive_ = new QComboBox(page);
  describe(drive_, "capture-drive", "Emulated drive",
           "The simulated site and the stops of the drive through it");
  const std::pair<const char*, CaptureDrive> drives[] = {{"Thesis, experiment 1", CaptureDrive::Exp1},
                                                         {"Thesis, experiment 2", CaptureDrive::Exp2},
                                                         {"Experiment 2, mended", CaptureDrive::Exp2Fixed},
                                                         {"Loop round a block", CaptureDrive::Loop},
                                                         {"Survey", CaptureDrive::Survey}};
  for (const auto& [name, drive] : drives) drive_->addItem(name, static_cast<int>(drive));
  seed_ = new QSpinBox(page);
  describe(seed_, "capture-seed", "Seed of the emulated drive", "Another seed, another site: 0 to 9999");
  seed_->setRange(0, 9999);
  seed_->setValue(1);
  speed_ = new QDoubleSpinBox(page);
  describe(speed_, "capture-speed", "Speed of the emulator",
           "So many times as fast as real instruments are, 1 to 20; 0: as fast as the machine can");
  speed_->setRange(0.0, 20.0);
  speed_->setDecimals(1);
  speed_->setValue(1.0);
  speed_->setSuffix(" ×");
  // Narrower than their largest numbers ask for, where letters are large.
  seed_->setMinimumWidth(70);
  speed_->setMinimumWidth(80);
  form->addRow("&Drive", drive_);
  auto* row = new QHBoxLayout;
  row->setSpacing(8);
  auto* speed_label = new QLabel("Sp&eed", page);
  speed_label->setBuddy(speed_);
  row->addWidget(seed_, 1);
  row->addWidget(speed_label);
  row->addWidget(speed_, 1);
  auto* seed_label = new QLabel("S&eed", page);
  seed_label->setBuddy(seed_);
  form->addRow(seed_label, row);
  return page;
}

// Of emulated instruments that are there.
QWidget* CaptureConnectPage::buildFaults() {
  auto* page = new QWidget(this);
  fault_ = new QComboBox(page);
  describe(fault_, "capture-fault", "Fault", "What is to go wrong with the emulated instruments");
  fault_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  fault_->setMinimumContentsLength(8);
  order_ = new QPushButton("Order", page);
  describe(order_, "capture-order-fault", "Make the fault happen",
           "Order the fault of the emulated instruments, to see what happens and what helps");
  connect(order_, &QPushButton::clicked, this, &CaptureConnectPage::order);
  auto* row = new QHBoxLayout(page);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(8);
  auto* label = new QLabel("&Fault", page);
  label->setBuddy(fault_);
  row->addWidget(label);
  row->addWidget(fault_, 1);
  row->addWidget(order_);
  return page;
}

QWidget* CaptureConnectPage::buildRecording() {
  auto* page = new QWidget(this);
  auto* form = formOf(page);
  const auto file = [&](QLineEdit*& edit, const QString& name, const QString& what, const QString& label) {
    edit = line(name, "Recording of the " + what, "The file that ?log= of the " + what + "'s address wrote",
                "session.wire");
    auto* browse = iconButton(page, "capture-" + name + "-browse", "document-open", "Choose the recording",
                              "Choose the recording of the " + what);
    connect(browse, &QToolButton::clicked, this, [this, edit, what] {
      askForFiles(this, context_.workspace.preferences(),
                  {FileQuestion::OpenOne,
                   "Recording of the " + what,
                   "Recordings (*.wire);;All files (*)",
                   {},
                   "recordings",
                   {}},
                  [edit](const QStringList& files) { edit->setText(files.front()); });
    });
    auto* row = new QHBoxLayout;
    row->setSpacing(8);
    row->addWidget(edit, 1);
    row->addWidget(browse);
    auto* text = new QLabel(label, page);
    text->setBuddy(edit);
    form->addRow(text, row);
  };
  file(scanner_file_, "scanner-file", "scanner", "&Scanner");
  file(tilt_file_, "tilt-file", "tilt unit", "&Tilt");
  return page;
}

CaptureConnectPage::Source CaptureConnectPage::source() const {
  return static_cast<Source>(source_->currentIndex());
}

void CaptureConnectPage::press() {
  if (model_.state() == StationState::Idle || model_.state() == StationState::Fault)
    connectNow();
  else
    model_.disconnectInstruments();
}

void CaptureConnectPage::connectNow() {
  CaptureSettings settings;
  switch (source()) {
    case Source::Find:
      return model_.connectToWhatIsThere(tilt_options_->text().trimmed(), network_->text().trimmed());
    case Source::Named:
      settings.scanner = utf8(scanner_->text().trimmed());
      settings.tilt = utf8(tilt_->text().trimmed());
      break;
    case Source::Emulator:
      settings.emulate = static_cast<CaptureDrive>(drive_->currentData().toInt());
      settings.seed = seed_->value();
      settings.speed = speed_->value();
      break;
    case Source::Recording: {
      const auto replayed =
          replayedSource(pathOf(scanner_file_->text().trimmed()), pathOf(tilt_file_->text().trimmed()));
      if (!replayed) return context_.workspace.messages().error(replayed.error());
      settings = *replayed;
      break;
    }
  }
  model_.connectTo(settings);
}

void CaptureConnectPage::order() {
  QString word = fault_->currentText();
  // Those of a probability or a time, as strong as they are worth seeing.
  if (word.endsWith("=P")) word.replace("=P", "=0.01");
  if (word.endsWith("=S")) word.replace("=S", "=3");
  model_.order(word);
}

void CaptureConnectPage::refresh() {
  const StationState state = model_.state();
  const bool apart = state == StationState::Idle || state == StationState::Fault;
  connect_->setText(state == StationState::Fault ? "Connect again" : apart ? "Connect" : "Disconnect");
  connect_->setAccessibleName(connect_->text());
  connect_->setEnabled(apart || model_.isConnected());
  source_->setEnabled(apart);
  // Where they are is settled then; who they are and how they are needs the room.
  source_->setVisible(apart);
  pages_->setVisible(apart);
  for (QWidget* widget :
       {static_cast<QWidget*>(tilt_options_), static_cast<QWidget*>(network_),
        static_cast<QWidget*>(scanner_), static_cast<QWidget*>(tilt_), static_cast<QWidget*>(drive_),
        static_cast<QWidget*>(seed_), static_cast<QWidget*>(speed_), static_cast<QWidget*>(scanner_file_),
        static_cast<QWidget*>(tilt_file_)})
    widget->setEnabled(apart);
  const QStringList faults = model_.faults();
  if (fault_->count() != faults.size()) {
    fault_->clear();
    fault_->addItems(faults);
  }
  faults_->setVisible(!faults.isEmpty());
  const StationSnapshot& now = model_.now();
  QString text = factsText(now.scanner) + factsText(now.tilt);
  for (const std::string& warning : now.warnings) text += "<p>! " + qt(warning).toHtmlEscaped() + "</p>";
  if (instruments_->text() != text) instruments_->setText(text);
}

}  // namespace tiltmap::ui
