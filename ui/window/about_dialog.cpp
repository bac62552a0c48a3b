#include "ui/window/about_dialog.h"

#include <QDialogButtonBox>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QTableWidget>
#include <QVBoxLayout>

#include "core/base/version.h"
#include "ui/models/log.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

struct Library {
  const char* name;
  const char* use;
  const char* licence;
};

// What the program is linked with or shows. Qt, Qt Advanced Docking System and the icons are LGPL: linked
// dynamically, so that they can be replaced.
constexpr Library kLibraries[] = {
    {"Qt 5", "the window", "LGPL-3"},
    {"Qt Advanced Docking System", "panels that dock", "LGPL-2.1"},
    {"VTK", "3D views", "BSD-3-Clause"},
    {"PCL", "reading point clouds", "BSD-3-Clause"},
    {"Eigen", "linear algebra", "MPL-2.0"},
    {"oneTBB", "threads", "Apache-2.0"},
    {"SQLite", "the project file", "public domain"},
    {"nlohmann-json", "JSON", "MIT"},
    {"tl-expected", "results and errors", "CC0-1.0"},
    {"CLI11", "the command line", "BSD-3-Clause"},
    {"spdlog and {fmt}", "the log", "MIT"},
    {"libpng", "pictures", "libpng"},
    {"Breeze icons", "icons", "LGPL-3"},
};

}  // namespace

AboutDialog::AboutDialog(QWidget* parent) : QDialog(parent) {
  setObjectName("about");
  setWindowTitle("About Tiltmap");
  auto* head = new QLabel(
      "<h2>Tiltmap " + qt(programVersion()) +
          "</h2><p>Mapping with a tilted laser scanner: from the "
          "range matrices of stop-and-scan surveys to one consistent 3D map. The method began as the "
          "one in Emre Sezginalp's master's thesis (Middle East Technical University).</p>"
          "<p>Free software under the BSD 3-Clause licence. It stands on these libraries, whose "
          "licences on a Debian system are in /usr/share/doc/PACKAGE/copyright:</p>",
      this);
  head->setWordWrap(true);
  auto* table = new QTableWidget(static_cast<int>(std::size(kLibraries)), 3, this);
  table->setObjectName("libraries");
  table->setAccessibleName("Libraries and their licences");
  table->setToolTip("What the program is built on, and under which licence");
  table->setHorizontalHeaderLabels({"Library", "Used for", "Licence"});
  table->setEditTriggers(QAbstractItemView::NoEditTriggers);
  table->setSelectionBehavior(QAbstractItemView::SelectRows);
  table->setShowGrid(false);
  table->setAlternatingRowColors(true);
  table->verticalHeader()->hide();
  table->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 6);
  table->horizontalHeader()->setSectionResizeMode(QHeaderView::ResizeToContents);
  table->horizontalHeader()->setStretchLastSection(true);
  int row = 0;
  for (const Library& library : kLibraries) {
    table->setItem(row, 0, new QTableWidgetItem(QString::fromUtf8(library.name)));
    table->setItem(row, 1, new QTableWidgetItem(QString::fromUtf8(library.use)));
    table->setItem(row, 2, new QTableWidgetItem(QString::fromUtf8(library.licence)));
    ++row;
  }
  auto* log = new QLabel("Log file: " + (logFilePath().isEmpty() ? QString("none") : logFilePath()), this);
  log->setTextInteractionFlags(Qt::TextSelectableByMouse);
  log->setWordWrap(true);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close, this);
  buttons->button(QDialogButtonBox::Close)->setToolTip("Close this window");
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::close);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(16, 16, 16, 16);
  layout->setSpacing(8);
  layout->addWidget(head);
  layout->addWidget(table, 1);
  layout->addWidget(log);
  layout->addWidget(buttons);
  resize(560, 560);
}

}  // namespace tiltmap::ui
