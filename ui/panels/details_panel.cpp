#include "ui/panels/details_panel.h"

#include <QEvent>
#include <QLabel>
#include <QPlainTextEdit>
#include <QTextBrowser>
#include <QVBoxLayout>

#include "core/base/text.h"
#include "ui/models/project_words.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"

namespace tiltmap::ui {

namespace {

QString row(const QString& name, const QString& value) {
  return QString("<tr><td style='padding-right:12px'>%1</td><td>%2</td></tr>")
      .arg(name, value.toHtmlEscaped());
}

QString heading(const QString& text) {
  return "<p style='margin:0 0 4px 0'><b>" + text.toHtmlEscaped() + "</b></p>";
}

QString degrees(double radians, int places) {
  return qt(fixedReal(radians / kDegree, places)) + "°";
}

}  // namespace

DetailsPanel::DetailsPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      text_(new QTextBrowser(this)),
      note_label_(new QLabel("&Note", this)),
      note_(new QPlainTextEdit(this)) {
  text_->setObjectName("details-text");
  text_->setAccessibleName("Details of the selection");
  text_->setToolTip("What is known about the selected scan or link; text can be selected and copied");
  text_->setFrameShape(QFrame::NoFrame);
  text_->setOpenLinks(false);
  text_->document()->setDocumentMargin(8);
  note_->setObjectName("details-note");
  note_->setAccessibleName("Note about the scan");
  note_->setToolTip("A note about this scan; stored when you leave the field");
  note_->setPlaceholderText("What was seen at this stop");
  note_->setTabChangesFocus(true);
  note_->setMaximumHeight(fontMetrics().height() * 4);
  note_->installEventFilter(this);
  note_label_->setBuddy(note_);
  note_label_->setContentsMargins(8, 0, 8, 0);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(4);
  layout->addWidget(text_, 1);
  layout->addWidget(note_label_);
  auto* field = new QVBoxLayout;
  field->setContentsMargins(8, 0, 8, 8);
  field->addWidget(note_);
  layout->addLayout(field);

  Workspace& workspace = context.workspace;
  connect(&workspace.selection(), &Selection::scansChanged, this, &DetailsPanel::refresh);
  connect(&workspace.selection(), &Selection::linksChanged, this, &DetailsPanel::refresh);
  connect(&workspace.session(), &ProjectSession::snapshotReplaced, this, &DetailsPanel::refresh);
  connect(&workspace.session(), &ProjectSession::aboutToClose, this, &DetailsPanel::storeNote);
  connect(&workspace.preferences(), &Preferences::unitsChanged, this, &DetailsPanel::refresh);
  refresh();
}

QString DetailsPanel::scanText(const ScanEntry& scan) const {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const LengthUnit unit = context_.workspace.preferences().lengthUnit();
  QString html =
      heading(QString("Scan %1: %2").arg(*snapshot->indexOf(scan.id)).arg(qt(scan.name))) + "<table>";
  html += row("Matrix", QString("%1 × %2 beams").arg(scan.rows).arg(scan.columns));
  if (scan.lines < scan.rows) html += row("Lines so far", QString::number(scan.lines));
  html += row("Points", QString("%1 of %2 cells")
                            .arg(groupedNumber(static_cast<long long>(scan.valid_cells)),
                                 groupedNumber(static_cast<long long>(scan.rows) * scan.columns)));
  const ScannerGeometry& g = scan.geometry;
  html += row("Tilt", degrees(g.tiltOfRow(0), 1) + " to " + degrees(g.tiltOfRow(g.rows - 1), 1));
  html += row("Azimuth",
              degrees(g.azimuthOfColumn(0), 1) + " to " + degrees(g.azimuthOfColumn(g.columns - 1), 1));
  html += row("Source", qt(scan.source));
  html += "</table>";
  html += "<p style='margin:8px 0 4px 0'><b>Poses</b> (" + unitName(unit) + ")</p><table>";
  for (const auto& [stage, pose] : scan.poses) {
    const Eigen::Vector3d h = pose.heading();
    html +=
        row(stageTitle(stage),
            QString("%1, %2, %3;  heading %4")
                .arg(lengthNumber(pose.translation().x(), unit), lengthNumber(pose.translation().y(), unit),
                     lengthNumber(pose.translation().z(), unit), degrees(std::atan2(-h.x(), h.y()), 2)));
  }
  html += "</table>";
  const auto links = snapshot->linksOf(scan.id);
  if (!links.empty()) {
    html += "<p style='margin:8px 0 4px 0'><b>Links</b></p><table>";
    for (const Link& link : links) {
      const bool fixed = link.fixed == scan.id;
      const auto other = snapshot->indexOf(fixed ? link.moving : link.fixed);
      html += row(QString(fixed ? "moving %1 on this" : "this on fixed %1")
                      .arg(other ? static_cast<int>(*other) : -1),
                  linkSummary(link, unit));
    }
    html += "</table>";
  }
  return html;
}

void DetailsPanel::refresh() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const Selection& selection = context_.workspace.selection();
  const auto current = selection.currentScan();
  if (noted_ != current) storeNote();
  const ScanEntry* scan = snapshot && current ? snapshot->find(*current) : nullptr;
  QString html;
  if (snapshot)
    for (const LinkId id : selection.links())
      if (const Link* link = snapshot->findLink(id))
        html += linkTip(*snapshot, *link, context_.workspace.preferences().lengthUnit()) + "<br>";
  if (selection.scans().size() > 1)
    html += QString("<p style='margin:0 0 8px 0'>%1 scans selected; this is the last one.</p>")
                .arg(selection.scans().size());
  if (scan) html += scanText(*scan);
  text_->setHtml(html.isEmpty() ? QString("<p>Select a scan or a link to see what is known about it.</p>")
                                : html);
  // What is being typed stays when something else of the project changes.
  const bool typing = scan && noted_ == scan->id && note_->document()->isModified();
  noted_ = scan ? std::optional(scan->id) : std::nullopt;
  if (const QString note = scan ? qt(scan->note) : QString(); !typing && note != note_->toPlainText()) {
    note_->setPlainText(note);
    note_->document()->setModified(false);
  }
  note_->setVisible(scan);
  note_label_->setVisible(scan);
  note_->setReadOnly(!context_.workspace.session().isWritable());
}

void DetailsPanel::beginNote() {
  note_->setFocus();
  note_->selectAll();
}

void DetailsPanel::storeNote() {
  if (!noted_ || !note_->document()->isModified()) return;
  note_->document()->setModified(false);
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const ScanEntry* scan = snapshot ? snapshot->find(*noted_) : nullptr;
  const std::string text = utf8(note_->toPlainText());
  if (scan && scan->note != text) (void)context_.workspace.session().apply(noteEdit(scan->id, text));
}

bool DetailsPanel::eventFilter(QObject* watched, QEvent* event) {
  if (watched == note_ && event->type() == QEvent::FocusOut) storeNote();
  return QWidget::eventFilter(watched, event);
}

}  // namespace tiltmap::ui
