// The list of the window's panels. A new one is declared in a file of its own and added here; its places are
// in ui/window/perspectives.cpp.
#include "ui/panels/calibration_panel.h"
#include "ui/panels/capture_line_panels.h"
#include "ui/panels/capture_panel.h"
#include "ui/panels/depth_image_panel.h"
#include "ui/panels/details_panel.h"
#include "ui/panels/history_panel.h"
#include "ui/panels/links_panel.h"
#include "ui/panels/localisation_panel.h"
#include "ui/panels/log_panel.h"
#include "ui/panels/panel.h"
#include "ui/panels/photographs_panel.h"
#include "ui/panels/project_tree_panel.h"
#include "ui/panels/relaxation_panel.h"
#include "ui/panels/site_map_panel.h"
#include "ui/panels/stepper_panel.h"
#include "ui/panels/stepper_plots_panel.h"
#include "ui/panels/stepper_view_panel.h"
#include "ui/panels/view3d_panel.h"

namespace tiltmap::ui {

namespace {

template <class Panel>
QWidget* make(const PanelContext& context) {
  return new Panel(context);
}

}  // namespace

const std::vector<PanelInfo>& panels() {
  static const std::vector<PanelInfo> list = {
      {"project-tree", "Project", "view-list-tree", "Scans, links and results of the project",
       make<ProjectTreePanel>},
      {"view3d", "3D view", "draw-cuboid", "The scans in space, with path and headings", make<View3dPanel>},
      {"depth-image", "Depth image", "range-matrix", "The range matrix of a scan, cell by cell",
       make<DepthImagePanel>},
      {"capture", "Capture", "tilt-unit", "Instruments, the tilt, the next stop, and how its sweep goes",
       make<CapturePanel>},
      {"capture-line", "Live line", "office-chart-polar", "What the scanner sees now, from above",
       make<CaptureLinePanel>},
      {"capture-matrix", "Sweep", "range-matrix", "The range matrix of the sweep, filling line by line",
       make<CaptureMatrixPanel>},
      {"calibration", "Calibration", "crosshairs",
       "What the scans tell about their scanner: its errors, and where the machine stands in its view",
       make<CalibrationPanel>},
      {"details", "Details", "documentinfo", "What is known about the selected scan or link",
       make<DetailsPanel>},
      {"localisation", "Localisation", "table", "Where the stops are, by stage", make<LocalisationPanel>},
      {"relax", "Relaxation", "relax", "Run a relaxation, watch it, and accept or discard what it finds",
       make<RelaxationPanel>},
      {"sitemap", "Site map", "map-flat", "Stops and links in plan, coloured by quality", make<SiteMapPanel>},
      {"links", "Links", "link", "Every link with its figures, the worst first", make<LinksPanel>},
      {"stepper", "ICP stepper", "register-pair", "Two scans registered one iteration after the other",
       make<StepperPanel>},
      {"stepper-view", "Registration view", "draw-cuboid", "The stepper's two scans and their pairs in space",
       make<StepperViewPanel>},
      {"stepper-plots", "Registration plots", "office-chart-line",
       "Convergence, pairs and residuals of the stepper", make<StepperPlotsPanel>},
      {"photographs", "Photographs", "camera-photo", "The photographs of a stop: see, add and remove them",
       make<PhotographsPanel>},
      {"history", "History", "view-history", "Every edit of the project, and a way back to it",
       make<HistoryPanel>},
      {"log", "Log", "text-x-log", "What the program did, line by line", make<LogPanel>},
  };
  return list;
}

}  // namespace tiltmap::ui
