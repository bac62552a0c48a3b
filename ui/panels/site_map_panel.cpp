#include "ui/panels/site_map_panel.h"

#include <QAction>
#include <QHBoxLayout>
#include <QLabel>
#include <QMenu>
#include <QStackedWidget>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/actions/action_registry.h"
#include "ui/look/empty_state.h"
#include "ui/models/site_map_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/marks.h"
#include "ui/panels/site_map_view.h"
#include "ui/window/file_dialogs.h"

namespace tiltmap::ui {

SiteMapPanel::SiteMapPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      context_(context),
      model_(new SiteMapModel(context.workspace, this)),
      view_(new SiteMapView(*model_, context, this)),
      pages_(new QStackedWidget(this)),
      empty_(new EmptyState("There are no stops to show on a map yet.", context.actions.find("op.simulate"),
                            this)),
      stage_(new QLabel(this)),
      banner_(new QLabel(this)) {
  stage_->setObjectName("sitemap-stage");
  stage_->setToolTip("Whose poses place the stops");
  stage_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);
  banner_->setObjectName("sitemap-banner");
  banner_->setWordWrap(true);
  banner_->setContentsMargins(8, 4, 8, 4);
  banner_->setVisible(false);
  QToolButton* fit =
      barButton("sitemap-fit", "zoom-fit-best", "Fit", "Show all stops (F, or a double click)", this);
  QToolButton* legend = barButton("sitemap-legend", "", "Legend", "What the lines and marks mean", this);
  legend->setCheckable(true);
  legend->setChecked(context.workspace.preferences().text("sitemap/legend", "1") == "1");
  view_->setLegendShown(legend->isChecked());
  pages_->addWidget(view_);
  pages_->addWidget(empty_);
  setFocusProxy(view_);

  auto* bar = new QHBoxLayout;
  bar->setContentsMargins(8, 4, 8, 4);
  bar->setSpacing(8);
  bar->addWidget(stage_, 1);
  bar->addWidget(fit);
  bar->addWidget(legend);
  bar->addWidget(makePictureButton());
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->setSpacing(0);
  layout->addLayout(bar);
  layout->addWidget(banner_);
  layout->addWidget(pages_, 1);

  connect(fit, &QToolButton::clicked, view_, &SiteMapView::fit);
  connect(legend, &QToolButton::toggled, this, [this](bool on) {
    view_->setLegendShown(on);
    context_.workspace.preferences().setText("sitemap/legend", on ? "1" : "0");
  });
  connect(model_, &SiteMapModel::changed, this, &SiteMapPanel::refresh);
  connect(view_, &SiteMapView::placingChanged, this, &SiteMapPanel::refresh);
  refresh();
}

QToolButton* SiteMapPanel::makePictureButton() {
  QToolButton* button = barButton("sitemap-picture", "image-x-generic", "Picture",
                                  "A picture of the site from above, under the map", this);
  button->setPopupMode(QToolButton::InstantPopup);
  auto* menu = new QMenu(button);
  menu->setToolTipsVisible(true);
  const auto entry = [&](const QString& name, const QString& text, const QString& help) {
    QAction* action = menu->addAction(text);
    action->setObjectName(name);
    action->setToolTip(help);
    return action;
  };
  add_ = entry("sitemap-picture-add", "&Add…", "Choose a picture from above; it is kept in the project");
  place_ = entry("sitemap-picture-place", "&Place by two points",
                 "Click two points of the picture and where they belong");
  shown_ = entry("sitemap-picture-shown", "&Show", "Show the picture under the map");
  shown_->setCheckable(true);
  shown_->setChecked(true);
  remove_ =
      entry("sitemap-picture-remove", "&Remove", "Take the picture out of the project; undo brings it back");
  button->setMenu(menu);
  connect(add_, &QAction::triggered, this, &SiteMapPanel::askPicture);
  connect(place_, &QAction::triggered, view_, &SiteMapView::startPlacing);
  connect(shown_, &QAction::toggled, view_, &SiteMapView::setPictureShown);
  connect(remove_, &QAction::triggered, this, [this] {
    if (const Status done = model_->removePicture(); !done) context_.workspace.messages().error(done.error());
  });
  return button;
}

void SiteMapPanel::refresh() {
  const bool writable = context_.workspace.session().isWritable() && !context_.workspace.jobs().busy();
  const bool picture = model_->sitePicture().has_value();
  pages_->setCurrentWidget(model_->stops().empty() ? empty_ : static_cast<QWidget*>(view_));
  stage_->setText(model_->stops().empty()
                      ? QString()
                      : QString("%1 stops, %2").arg(model_->stops().size()).arg(model_->stageText()));
  add_->setEnabled(writable && !model_->stops().empty());
  place_->setEnabled(writable && picture && !model_->picture().isNull());
  remove_->setEnabled(writable && picture);
  shown_->setEnabled(picture);
  const QString text = view_->isPlacing() ? view_->placingText() : model_->pictureTrouble();
  banner_->setText(text);
  banner_->setVisible(!text.isEmpty());
}

void SiteMapPanel::askPicture() {
  askForFiles(this, context_.workspace.preferences(),
              {FileQuestion::OpenOne, "Picture of the site",
               "Pictures (*.png *.jpg *.jpeg *.bmp *.webp *.tif)", "", "pictures", ""},
              [this](const QStringList& files) { addPicture(files.front()); });
}

void SiteMapPanel::addPicture(const QString& file) {
  if (const Status added = model_->addPicture(file); !added)
    return context_.workspace.messages().error(added.error());
  shown_->setChecked(true);
  view_->startPlacing();
}

}  // namespace tiltmap::ui
