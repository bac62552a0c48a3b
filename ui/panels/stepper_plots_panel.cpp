#include "ui/panels/stepper_plots_panel.h"

#include <QHeaderView>
#include <QTabWidget>
#include <QVBoxLayout>

#include "ui/models/step_table_model.h"
#include "ui/models/workspace.h"
#include "ui/panels/slices_tab.h"
#include "ui/panels/stepper_plots.h"
#include "ui/panels/table_view.h"

namespace tiltmap::ui {

StepperPlotsPanel::StepperPlotsPanel(const PanelContext& context, QWidget* parent)
    : QWidget(parent),
      model_(context.workspace.stepper()),
      rows_(new StepTableModel(model_, this)),
      table_(new TableView(this)),
      tabs_(new QTabWidget(this)) {
  tabs_->setObjectName("stepper-tabs");
  tabs_->setAccessibleName("Plots of the stepper");
  tabs_->setDocumentMode(true);
  table_->setObjectName("stepper-table");
  table_->setAccessibleName("Iterations");
  table_->setToolTip("Every iteration with its figures; choose one to go there");
  table_->setModel(rows_);
  table_->setSelectionMode(QAbstractItemView::SingleSelection);
  table_->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  tabs_->addTab(new ConvergencePlot(context, tabs_), "Convergence");
  tabs_->addTab(new PairsPlot(context, tabs_), "Pairs");
  tabs_->addTab(new ResidualPlot(context, tabs_), "Residuals");
  tabs_->addTab(table_, "Iterations");
  auto* headings = new HeadingPlot(context, tabs_);
  tabs_->addTab(headings, "Headings");
  auto* slices = new SlicesTab(context, tabs_);
  tabs_->addTab(slices, "Slices");
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(0, 0, 0, 0);
  layout->addWidget(tabs_);
  setFocusProxy(tabs_);

  connect(&model_, &StepperModel::positionChanged, this, &StepperPlotsPanel::showPosition);
  connect(table_->selectionModel(), &QItemSelectionModel::currentRowChanged, this,
          [this](const QModelIndex& now) {
            if (now.isValid()) model_.goTo(now.row() + 1);
          });
  // What was asked for is to be seen.
  connect(&model_.start(), &StartModel::sweepChanged, this, [this, headings] {
    if (model_.start().sweep()) tabs_->setCurrentWidget(headings);
  });
}

void StepperPlotsPanel::showPosition() {
  const QSignalBlocker quiet(table_->selectionModel());
  const int row = model_.position() - 1;
  if (row >= 0 && row < rows_->rowCount()) {
    table_->selectionModel()->setCurrentIndex(
        rows_->index(row, 0), QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    table_->scrollTo(rows_->index(row, 0));
  } else {
    table_->selectionModel()->clear();
  }
  table_->viewport()->update();
}

}  // namespace tiltmap::ui
