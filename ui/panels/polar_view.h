// The current line of the scanner as a polar plot, seen from above: the scanner below, forward up.
#pragma once

#include <QPointF>
#include <QString>
#include <QWidget>
#include <optional>
#include <span>
#include <vector>

#include "core/scan/range_image.h"

class QPainter;

namespace tiltmap::ui {

class Theme;

// What a beam tells, as it is drawn: with another shape each, not only another colour.
enum class BeamKind {
  Echo,     // a point; beyond the outer ring an arrow at the rim
  NoEcho,   // nothing there to be hit: a short line at the rim
  Trouble,  // dazzled, overflow and other codes of the scanner: a cross at the rim
  Left,     // masked, out of bounds, missing, not scanned: not drawn
};
BeamKind beamKind(CellCode code);

// One line after the other, at any rate: only the latest is drawn, once for each paint of the window.
class PolarView : public QWidget {
  Q_OBJECT

 public:
  explicit PolarView(const Theme& theme, QWidget* parent = nullptr);

  // One value a beam: metres (of beams with a point), radians as ScannerGeometry has them (0 right, pi / 2
  // forward, pi left), codes. Throws std::invalid_argument where their numbers differ.
  void setLine(std::span<const float> ranges_m, std::span<const double> azimuths_rad,
               std::span<const CellCode> codes);
  void clear();
  bool isEmpty() const { return ranges_.empty(); }

  // The outer ring: 5, 10, 20, 40 or 80 m. Grows at once when more than 2 % of the points lie outside, and
  // becomes smaller only when all lines of kSteadyLines have fitted inside of the smaller one.
  double outerRing() const { return outer_m_; }
  static constexpr int kSteadyLines = 50;

  // The beam below the pointer or chosen by the arrow keys.
  std::optional<int> markedBeam() const { return marked_; }
  // What stands below the plot: the marked beam, else how many beams of each kind there are.
  QString readout() const;

  // Widget coordinates.
  QPointF centre() const;
  double scale() const;             // pixels a metre
  QPointF placeOf(int beam) const;  // where its mark is drawn
  QSize sizeHint() const override { return {360, 240}; }
  QSize minimumSizeHint() const override { return {200, 150}; }

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void leaveEvent(QEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  double farthest() const;  // all but 2 % of the points
  void chooseRing(double farthest_m);
  double lowest() const;  // how far the beams reach below the scanner, as a share of the outer ring
  int readoutLines() const;
  QRectF room() const;
  QPointF direction(int beam) const;  // on the screen
  bool isBeyond(int beam) const;
  void mark(std::optional<int> beam);
  void paintRings(QPainter& painter) const;
  void paintBeams(QPainter& painter) const;
  void paintMark(QPainter& painter) const;
  void paintReadout(QPainter& painter) const;

  const Theme& theme_;
  std::vector<float> ranges_;
  std::vector<double> azimuths_;
  std::vector<QPointF> directions_;  // of the azimuths, on the screen
  std::vector<CellCode> codes_;
  double outer_m_ = 0.0;
  int fitting_lines_ = 0;  // lines in a row that a smaller ring would hold
  std::optional<int> marked_;
};

}  // namespace tiltmap::ui
