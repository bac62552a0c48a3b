#include "ui/panels/links_panel.h"

#include <QComboBox>
#include <QFrame>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QSortFilterProxyModel>
#include <QStackedWidget>
#include <QStyledItemDelegate>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/models/edits.h"
#include "ui/models/strings.h"
#include "ui/models/workspace.h"
#include "ui/panels/marks.h"
#include "ui/panels/table_view.h"

namespace tiltmap::ui {

namespace {

class QualityDelegate : public QStyledItemDelegate {
 public:
  QualityDelegate(const LinkTableModel& model, const QSortFilterProxyModel& sorted, const Theme& theme,
                  QObject* parent)
      : QStyledItemDelegate(parent), model_(model), sorted_(sorted), theme_(theme) {}

 protected:
  void initStyleOption(QStyleOptionViewItem* option, const QModelIndex& index) const override {
    QStyledItemDelegate::initStyleOption(option, index);
    const QModelIndex source = sorted_.mapToSource(index);
    if (!source.isValid()) return;
    const qreal ratio = option->widget ? option->widget->devicePixelRatioF() : 1.0;
    option->icon = qualityIcon(model_.qualityAt(source.row()), theme_.colours(), ratio);
    option->decorationSize = QSize(16, 16);
    option->features |= QStyleOptionViewItem::HasDecoration;
  }

 private:
  const LinkTableModel& model_;
  const QSortFilterProxyModel& sorted_;
  const Theme& theme_;
};

QFrame* strip(const QString& name, QWidget* parent) {
  auto* frame = new QFrame(parent);
  frame->setObjectName(name);
  frame->setAutoFillBackground(true);
  frame->setBackgroundRole(QPalette::AlternateBase);
  frame->setVisible(false);
  return frame;
}

}  // namespace

LinksPanel::LinksPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new LinkTableModel(context.workspace, this)),
      sorted_(new QSortFilterProxyModel(this)),
      view_(new TableView(this)),
      pages_(new QStackedWidget(this)) {
  sorted_->setSourceModel(model_);
  sorted_->setSortRole(LinkTableModel::kSortRole);
  view_->setObjectName("links-view");
  view_->setAccessibleName("Links");
  view_->setModel(sorted_);
  view_->setSortingEnabled(true);
  view_->sortByColumn(LinkTableModel::Quality, Qt::AscendingOrder);
  view_->setItemDelegateForColumn(LinkTableModel::Quality,
                                  new QualityDelegate(*model_, *sorted_, context.theme, this));
  view_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  view_->horizontalHeader()->setStretchLastSection(true);
  pages_->addWidget(view_);
  auto* empty = new EmptyState("No scans have been linked yet: register pairs, or add a link by hand.",
                               context.actions.find("op.register"), this);
  pages_->addWidget(empty);
  setFocusProxy(view_);

  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addWidget(makeBar());
  layout->addWidget(makeAddRow());
  layout->addWidget(makeWhatIf());
  layout->addWidget(pages_, 1);

  connect(model_, &QAbstractItemModel::modelReset, this, &LinksPanel::refresh);
  connect(model_, &LinkTableModel::whatIfChanged, this, &LinksPanel::refreshButtons);
  connect(view_->selectionModel(), &QItemSelectionModel::selectionChanged, this, &LinksPanel::takeSelection);
  connect(&context.workspace.selection(), &Selection::linksChanged, this, &LinksPanel::showSelection);
  connect(&context.workspace.jobs(), &JobQueue::busyChanged, this, &LinksPanel::refreshButtons);
  connect(&context.theme, &Theme::changed, view_->viewport(), qOverload<>(&QWidget::update));
  refresh();
}

QWidget* LinksPanel::makeBar() {
  auto* bar = new QWidget(this);
  auto* rows = new QVBoxLayout(bar);
  rows->setContentsMargins(8, 4, 8, 4);
  rows->setSpacing(0);
  auto* layout = new QHBoxLayout;
  layout->setSpacing(4);
  summary_ = new QLabel(bar);
  summary_->setObjectName("links-summary");
  summary_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  add_ = barButton("links-add", "list-add", "Add", "Link two scans that you choose", bar);
  add_->setCheckable(true);
  state_ = barButton("links-state", "remove-link", "Disable",
                     "Keep the selected links but compute nothing from them; or use them again", bar);
  delete_ = barButton("links-delete", "edit-delete", "Delete",
                      "Delete the selected links; undo brings them back", bar);
  again_ = barButton("links-again", "view-refresh", "Register",
                     "Register the scans of the selected links once more, from where they stand", bar);
  show_ =
      barButton("links-show", "view-visible", "Show both", "Show the scans of the selected links alone", bar);
  what_if_ =
      barButton("links-what-if", "help-hint", "What if…",
                "Leave the selected links out and see what the others then say; changes nothing yet", bar);
  judge_ = barButton(
      "links-judge", "dialog-ok-apply", "Judge",
      "Hold the scans of the selected links (of all, where none is selected) against each other: can "
      "they be trusted?",
      bar);
  for (QToolButton* button : {add_, what_if_, state_, judge_, again_, show_, delete_})
    layout->addWidget(button);
  // A narrow column has room for the words of the first three only.
  for (QToolButton* button : {judge_, again_, show_, delete_})
    button->setToolButtonStyle(Qt::ToolButtonIconOnly);
  layout->addStretch();
  rows->addLayout(layout);
  rows->addWidget(summary_);
  connect(add_, &QToolButton::toggled, this, [this](bool on) {
    add_row_->setVisible(on);
    if (on) fillScans();
    if (on) fixed_->setFocus();
  });
  connect(state_, &QToolButton::clicked, this,
          [this] { setState(state_->text() == "Enable" ? LinkState::Active : LinkState::Disabled); });
  connect(delete_, &QToolButton::clicked, this, &LinksPanel::deleteSelected);
  connect(again_, &QToolButton::clicked, this, &LinksPanel::registerAgain);
  connect(judge_, &QToolButton::clicked, this, &LinksPanel::judge);
  connect(show_, &QToolButton::clicked, this, &LinksPanel::showBoth);
  connect(what_if_, &QToolButton::clicked, this, &LinksPanel::askWhatIf);
  return bar;
}

QWidget* LinksPanel::makeAddRow() {
  add_row_ = strip("links-add-row", this);
  auto* layout = new QHBoxLayout(add_row_);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(8);
  const auto box = [&](const QString& name, const QString& label, const QString& help) {
    auto* text = new QLabel(label, add_row_);
    auto* combo = new QComboBox(add_row_);
    combo->setObjectName(name);
    combo->setAccessibleName(QString(label).remove('&'));
    combo->setToolTip(help);
    text->setBuddy(combo);
    layout->addWidget(text);
    layout->addWidget(combo);
    connect(combo, qOverload<int>(&QComboBox::currentIndexChanged), this, &LinksPanel::refreshButtons);
    return combo;
  };
  fixed_ = box("links-add-fixed", "&Fixed scan", "The scan that stays where it is");
  moving_ = box("links-add-moving", "&Moving scan", "The scan that is fitted to the fixed one");
  add_register_ = barButton("links-add-register", "register-pair", "Register",
                            "Fit the moving scan to the fixed one, from where they stand now", add_row_);
  add_placed_ = barButton("links-add-placed", "link", "As placed",
                          "Take it from how the two scans stand now, as a link set by hand", add_row_);
  layout->addWidget(add_register_);
  layout->addWidget(add_placed_);
  layout->addStretch();
  connect(add_register_, &QToolButton::clicked, this, [this] { add("register"); });
  connect(add_placed_, &QToolButton::clicked, this, [this] { add("as-placed"); });
  return add_row_;
}

QWidget* LinksPanel::makeWhatIf() {
  said_ = strip("links-said", this);
  auto* layout = new QHBoxLayout(said_);
  layout->setContentsMargins(8, 4, 8, 4);
  layout->setSpacing(8);
  said_text_ = new QLabel(said_);
  said_text_->setObjectName("links-said-text");
  said_text_->setWordWrap(true);
  said_text_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  said_disable_ = barButton("links-said-disable", "remove-link", "Disable them",
                            "Disable these links in the project", said_);
  QToolButton* back =
      barButton("links-said-back", "close", "Leave all in", "End the question; nothing has changed", said_);
  layout->addWidget(said_text_, 1);
  layout->addWidget(said_disable_, 0, Qt::AlignTop);
  layout->addWidget(back, 0, Qt::AlignTop);
  connect(said_disable_, &QToolButton::clicked, this, [this] {
    const SnapshotPtr snapshot = context_.workspace.snapshot();
    const ProjectEdit edit = linkStatesEdit(*snapshot, model_->leftOut(), LinkState::Disabled);
    if (!edit.empty()) (void)context_.workspace.session().apply(edit);
    model_->endAsking();
  });
  connect(back, &QToolButton::clicked, model_, &LinkTableModel::endAsking);
  return said_;
}

QModelIndex LinksPanel::indexOf(LinkId link) const {
  const int row = model_->rowOf(link);
  return row < 0 ? QModelIndex() : sorted_->mapFromSource(model_->index(row, 0));
}

void LinksPanel::refresh() {
  pages_->setCurrentIndex(model_->rowCount() > 0 ? 0 : 1);
  summary_->setText(model_->summary());
  if (add_row_->isVisibleTo(this)) fillScans();
  showSelection();
  refreshButtons();
}

void LinksPanel::refreshButtons() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  const bool writable = context_.workspace.session().isWritable();
  const bool free = writable && !context_.workspace.jobs().busy();
  const auto& chosen = context_.workspace.selection().links();
  const bool any = snapshot && !chosen.empty();
  bool all_disabled = any, all_found = any;
  for (const LinkId id : chosen)
    if (const Link* link = snapshot ? snapshot->findLink(id) : nullptr) {
      all_disabled = all_disabled && link->state == LinkState::Disabled;
      all_found = all_found && link->usable();
    }
  state_->setText(all_disabled ? "Enable" : "Disable");
  state_->setAccessibleName(state_->text());
  state_->setEnabled(any && free);
  delete_->setEnabled(any && free);
  again_->setEnabled(any && writable);
  judge_->setEnabled(writable && snapshot && !snapshot->links().empty());
  show_->setEnabled(any);
  what_if_->setEnabled(any && all_found);
  add_->setEnabled(free && snapshot && snapshot->scans().size() > 1);
  if (!add_->isEnabled() && !context_.workspace.jobs().busy()) add_->setChecked(false);
  const bool pair = free && fixed_->currentIndex() >= 0 && fixed_->currentIndex() != moving_->currentIndex();
  add_register_->setEnabled(pair);
  add_placed_->setEnabled(pair);
  const bool asked = model_->whatIf().has_value();
  view_->setColumnHidden(LinkTableModel::With, !asked);
  view_->setColumnHidden(LinkTableModel::Without, !asked);
  said_->setVisible(asked);
  said_text_->setText(model_->whatIfSentence());
  said_disable_->setEnabled(free);
}

void LinksPanel::fillScans() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  if (!snapshot) return;
  const auto& chosen = context_.workspace.selection().scans();
  for (QComboBox* box : {fixed_, moving_}) {
    const int before = box->currentIndex();
    const QSignalBlocker quiet(box);
    box->clear();
    for (std::size_t i = 0; i < snapshot->scans().size(); ++i)
      box->addItem(QString("%1  %2").arg(i).arg(qt(snapshot->scans()[i].name)));
    box->setCurrentIndex(before);
  }
  // The two that are selected, the lower index fixed.
  std::vector<int> places;
  for (const ScanId scan : chosen)
    if (const auto index = snapshot->indexOf(scan)) places.push_back(static_cast<int>(*index));
  std::ranges::sort(places);
  if (places.size() == 2) {
    fixed_->setCurrentIndex(places[0]);
    moving_->setCurrentIndex(places[1]);
  } else if (fixed_->currentIndex() < 0 && fixed_->count() > 1) {
    fixed_->setCurrentIndex(0);
    moving_->setCurrentIndex(fixed_->count() - 1);
  }
  refreshButtons();
}

void LinksPanel::takeSelection() {
  if (following_) return;
  following_ = true;
  std::vector<LinkId> links;
  for (const QModelIndex& index : view_->selectionModel()->selectedRows())
    links.push_back(model_->linkAt(sorted_->mapToSource(index).row()));
  context_.workspace.selection().setLinks(std::move(links));
  following_ = false;
  refreshButtons();
}

void LinksPanel::showSelection() {
  if (!following_) {
    following_ = true;
    QItemSelection rows;
    for (const LinkId link : context_.workspace.selection().links())
      if (const QModelIndex index = indexOf(link); index.isValid())
        rows.select(index, index.siblingAtColumn(LinkTableModel::kColumns - 1));
    view_->selectionModel()->select(rows, QItemSelectionModel::ClearAndSelect);
    if (!rows.isEmpty()) view_->scrollTo(rows.indexes().front());
    following_ = false;
  }
  refreshButtons();
}

void LinksPanel::setState(LinkState state) {
  const ProjectEdit edit =
      linkStatesEdit(*context_.workspace.snapshot(), context_.workspace.selection().links(), state);
  if (!edit.empty()) (void)context_.workspace.session().apply(edit);
}

void LinksPanel::deleteSelected() {
  const ProjectEdit edit =
      deleteLinksEdit(*context_.workspace.snapshot(), context_.workspace.selection().links());
  if (!edit.empty()) (void)context_.workspace.session().apply(edit);
}

void LinksPanel::registerAgain() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  std::vector<JobRequest> requests;
  for (const LinkId id : context_.workspace.selection().links()) {
    const Link* link = snapshot->findLink(id);
    if (!link) continue;
    JobRequest request;
    request.operation = operations().find("link");
    request.title = "Register " + qt(linkName(*snapshot, *link)) + " again";
    request.values = {{"fixed", static_cast<long long>(*snapshot->indexOf(link->fixed))},
                      {"moving", static_cast<long long>(*snapshot->indexOf(link->moving))}};
    requests.push_back(std::move(request));
  }
  if (!requests.empty()) (void)context_.workspace.startAll(std::move(requests));
}

void LinksPanel::showBoth() {
  const SnapshotPtr snapshot = context_.workspace.snapshot();
  std::vector<ScanId> scans;
  for (const LinkId id : context_.workspace.selection().links())
    if (const Link* link = snapshot->findLink(id)) {
      scans.push_back(link->fixed);
      scans.push_back(link->moving);
    }
  context_.workspace.display().showOnly(scans);
}

void LinksPanel::askWhatIf() {
  if (const Status asked = model_->ask(context_.workspace.selection().links()); !asked)
    context_.workspace.messages().error(asked.error());
}

void LinksPanel::judge() {
  JobRequest request;
  request.operation = operations().find("judge");
  QStringList chosen;
  for (const LinkId id : context_.workspace.selection().links()) chosen << QString::number(id);
  request.title = chosen.isEmpty() ? QString("Judge all links") : "Judge links " + chosen.join(", ");
  request.values = {{"links", utf8(chosen.join(","))}};
  (void)context_.workspace.start(request);
}

void LinksPanel::add(const char* method) {
  JobRequest request;
  request.operation = operations().find("link");
  request.title = QString("Link %1 to %2").arg(moving_->currentIndex()).arg(fixed_->currentIndex());
  request.values = {{"fixed", static_cast<long long>(fixed_->currentIndex())},
                    {"moving", static_cast<long long>(moving_->currentIndex())},
                    {"method", std::string(method)}};
  (void)context_.workspace.start(request);
}

}  // namespace tiltmap::ui
