// The site in plan: stops with headings, links by quality, the picture under them; seen through a window that
// zooms and pans. No widgets.
#pragma once

#include <QImage>
#include <QObject>
#include <QPointF>
#include <QRectF>
#include <QSizeF>
#include <optional>
#include <vector>

#include "core/project/link_quality.h"
#include "ui/models/scan_display.h"

namespace tiltmap::ui {

class Workspace;

struct MapStop {
  ScanId scan = 0;
  int index = 0;
  QPointF place_m;  // world: x to the right, y forward
  QPointF heading;  // horizontal part, of length 1 or less
  RelaxationRole role = RelaxationRole::None;
  bool pinned = false;
  bool visible = true;
  bool selected = false;
  std::optional<QPointF> ghost_m;  // where it would be without the links that are asked about
};

struct MapLink {
  LinkId link = 0;
  QPointF from_m, to_m;
  LinkQuality quality = LinkQuality::Good;
  bool left_out = false;  // asked about
  bool selected = false;
  bool live = false;  // found by the relaxation that runs, not in the project
};

// World to pixels: y up becomes y down.
struct MapWindow {
  QPointF centre_m;
  double px_per_m = 20.0;
  QSizeF size_px = {100.0, 100.0};

  QPointF pixelOf(const QPointF& world_m) const;
  QPointF worldOf(const QPointF& pixel) const;
  void zoomAt(const QPointF& pixel, double factor);  // what is under the pixel stays there
  void panBy(const QPointF& pixels);
  void fit(const QRectF& world_m);
};

// 1, 2 or 5 times a power of ten, at most so many metres.
double roundLength(double at_most_m);

class SiteMapModel : public QObject {
  Q_OBJECT

 public:
  explicit SiteMapModel(Workspace& workspace, QObject* parent = nullptr);

  const std::vector<MapStop>& stops() const { return stops_; }
  const std::vector<MapLink>& links() const { return links_; }
  QString stageText() const;  // "relaxed", "proposal", "relaxing"
  // Of the stops and, where wanted, the picture; one metre at least.
  QRectF bounds(bool with_picture = false) const;
  std::optional<ScanId> stopAt(const QPointF& world_m, double within_m) const;
  std::optional<LinkId> linkAt(const QPointF& world_m, double within_m) const;

  const QImage& picture() const { return picture_; }
  const std::optional<SitePicturePlacement>& placement() const { return placement_; }
  const std::optional<SitePicture>& sitePicture() const;
  QString pictureTrouble() const { return picture_trouble_; }
  // A file, placed so that it covers the stops; two points then place it well. The error is shown by the
  // caller.
  Status addPicture(const QString& file);
  Status placePicture(const SitePicturePoints& points);
  Status removePicture();

 Q_SIGNALS:
  void changed();
  void placesChanged();  // other stops, or another project: a view may want to fit

 private:
  void readAgain();
  void readPicture();

  Workspace& workspace_;
  SnapshotPtr snapshot_;
  std::vector<MapStop> stops_;
  std::vector<MapLink> links_;
  QImage picture_;
  std::int64_t picture_attachment_ = 0;
  std::string picture_project_;
  std::optional<SitePicturePlacement> placement_;
  QString picture_trouble_;
  std::vector<ScanId> known_;
};

}  // namespace tiltmap::ui
