#include "ui/window/colour_dialog.h"

#include <QDialogButtonBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPainter>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>

#include "core/products/scan_colours.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

constexpr int kColumns = 6;
constexpr std::size_t kChoices = 2 * kFixedScanColours;

std::uint32_t numberOf(Rgb colour) {
  return static_cast<std::uint32_t>(colour.r) << 16 | static_cast<std::uint32_t>(colour.g) << 8 | colour.b;
}

QIcon filled(const QColor& colour) {
  QPixmap pixmap(48, 48);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(colour);
  painter.drawRoundedRect(QRectF(2, 2, 44, 44), 8, 8);
  painter.end();
  pixmap.setDevicePixelRatio(2.0);
  return pixmap;
}

}  // namespace

ColourDialog::ColourDialog(Workspace& workspace, QWidget* parent)
    : QDialog(parent),
      workspace_(workspace),
      which_(new QLabel(this)),
      written_(new QLineEdit(this)),
      take_(new QPushButton("Use", this)),
      by_place_(new QPushButton("By place", this)) {
  setObjectName("colours");
  setWindowTitle("Colour of scans");
  which_->setWordWrap(true);
  auto* grid = new QGridLayout;
  grid->setSpacing(4);
  for (std::size_t k = 0; k < kChoices; ++k) {
    const Rgb colour = scanColour(k);
    auto* button = new QToolButton(this);
    button->setObjectName(QString("colour:%1").arg(k));
    button->setIcon(filled(QColor(colour.r, colour.g, colour.b)));
    button->setIconSize(QSize(24, 24));
    button->setAutoRaise(true);
    button->setFocusPolicy(Qt::StrongFocus);
    button->setToolTip(QString("Give the selected scans %1").arg(qt(hexOf(colour))));
    button->setAccessibleName("Colour " + qt(hexOf(colour)));
    connect(button, &QToolButton::clicked, this, [this, colour] { give(numberOf(colour)); });
    grid->addWidget(button, static_cast<int>(k) / kColumns, static_cast<int>(k) % kColumns);
    choices_.push_back(button);
  }
  written_->setObjectName("colour-written");
  written_->setPlaceholderText("#ff8800");
  written_->setAccessibleName("Colour in hexadecimal digits");
  written_->setToolTip("Red, green and blue, two hexadecimal digits each: #000000 to #ffffff");
  take_->setObjectName("colour-use");
  take_->setToolTip("Give the selected scans the colour that is written here");
  take_->setAutoDefault(false);
  by_place_->setObjectName("colour-by-place");
  by_place_->setToolTip("The colour of the scan's place in the survey again");
  by_place_->setAutoDefault(false);
  auto* line = new QHBoxLayout;
  line->setSpacing(8);
  line->addWidget(written_, 1);
  line->addWidget(take_);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  buttons->addButton(by_place_, QDialogButtonBox::ResetRole);
  buttons->button(QDialogButtonBox::Close)->setToolTip("Close this window; what was chosen stays");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(16, 16, 16, 16);
  layout->setSpacing(8);
  layout->addWidget(which_);
  layout->addLayout(grid);
  layout->addLayout(line);
  layout->addStretch();
  layout->addWidget(buttons);

  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
  connect(by_place_, &QPushButton::clicked, this, [this] { give({}); });
  const auto use = [this] {
    if (const auto rgb = rgbOfHex(utf8(written_->text().trimmed()))) give(numberOf(*rgb));
  };
  connect(take_, &QPushButton::clicked, this, use);
  connect(written_, &QLineEdit::returnPressed, this, use);
  connect(written_, &QLineEdit::textChanged, this, &ColourDialog::refresh);
  connect(&workspace.selection(), &Selection::scansChanged, this, &ColourDialog::refresh);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &ColourDialog::refresh);
  connect(&workspace.jobs(), &JobQueue::busyChanged, this, &ColourDialog::refresh);
  connect(&workspace.session(), &ProjectSession::closed, this, &QDialog::close);
  refresh();
}

void ColourDialog::give(std::optional<std::uint32_t> colour) {
  const SnapshotPtr snapshot = workspace_.snapshot();
  if (!snapshot) return;
  const ProjectEdit edit = colourEdit(*snapshot, workspace_.selection().scans(), colour);
  if (!edit.empty()) (void)workspace_.session().apply(edit);
}

void ColourDialog::refresh() {
  const SnapshotPtr snapshot = workspace_.snapshot();
  const std::vector<ScanId>& scans = workspace_.selection().scans();
  const bool some =
      snapshot && !scans.empty() && workspace_.session().isWritable() && !workspace_.jobs().busy();
  bool chosen = false;
  for (const ScanId id : scans)
    if (const ScanEntry* scan = snapshot ? snapshot->find(id) : nullptr) chosen |= scan->colour.has_value();
  if (!snapshot || scans.empty())
    which_->setText("Select the scans that shall have another colour.");
  else if (const ScanEntry* only = scans.size() == 1 ? snapshot->find(scans.front()) : nullptr)
    which_->setText(QString("Scan %1: %2").arg(*snapshot->indexOf(only->id)).arg(qt(only->name)));
  else
    which_->setText(QString("%1 scans").arg(scans.size()));
  for (QWidget* choice : choices_) choice->setEnabled(some);
  by_place_->setEnabled(some && chosen);
  take_->setEnabled(some && rgbOfHex(utf8(written_->text().trimmed())));
}

}  // namespace tiltmap::ui
