// What lies flat over the 3D picture: triad, scale bar, colour bar, the grid's size.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <Eigen/Core>

#include "core/products/colour.h"

class vtkActor2D;
class vtkRenderer;
class vtkTextActor;

namespace tiltmap::ui {

// A text with its ground, the middle of its lower edge at a pixel.
struct OverlayLabel {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  std::string text;
  Rgb colour{255, 255, 255};
};

// A mark of constant size: a disc or a square, full or not, with rings around it.
struct OverlayMark {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Rgb fill, ring;
  bool full = true;
  bool square = false;
  int rings = 0;
  double radius_px = 5.5;  // logical
};

struct OverlayLine {
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  Rgb colour;
};

struct OverlayContents {
  Rgb text{255, 255, 255};
  Rgb ground{0, 0, 0};  // shines through behind text
  double pixel_ratio = 1.0;
  int width = 0, height = 0;  // device pixels
  bool axes = true;
  Eigen::Vector3d right, up;    // of the camera, world frame
  double scale_m_per_px = 0.0;  // 0: no scale bar (perspective)
  std::string bar_title;        // empty: no colour bar
  std::string bar_low, bar_high;
  double low_lightness = 0.38, high_lightness = 0.92;  // of evenColour
  bool bar_is_signed = false;                          // signedColour, zero in the middle
  double middle_lightness = 0.86;                      // of signedColour
  std::string grid;                                    // "Grid 2 m"
  std::vector<OverlayLabel> labels;
  std::optional<double> divider;  // share of the width
  Rgb divider_colour{255, 255, 255};
  std::string left_of_divider, right_of_divider;
  std::string corner;  // top right: what is being shown in turn
  std::vector<std::pair<Eigen::Vector2d, Rgb>> handles;
  std::vector<OverlayMark> marks;
  std::vector<OverlayLine> lines;
  std::vector<std::pair<OverlayMark, std::string>> legend;  // top right, from the top down
};

class SceneOverlay {
 public:
  explicit SceneOverlay(vtkRenderer& renderer);
  ~SceneOverlay();
  SceneOverlay(const SceneOverlay&) = delete;
  SceneOverlay& operator=(const SceneOverlay&) = delete;

  void show(const OverlayContents& contents);

 private:
  void begin();
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Rgb colour);
  void box(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Rgb colour);
  void write(const std::string& text, const Eigen::Vector2d& at, int anchor, Rgb colour, double size_px);
  void finish(double line_px);
  void drawTriad(const OverlayContents& contents);
  void drawScale(const OverlayContents& contents);
  void drawBar(const OverlayContents& contents);
  void drawDivider(const OverlayContents& contents);
  void drawHandles(const OverlayContents& contents);
  void drawMark(const OverlayMark& mark, double scale);
  void drawLegend(const OverlayContents& contents);
  void polygon(const std::vector<Eigen::Vector2d>& corners, Rgb colour, bool full);

  struct Shapes;
  vtkRenderer& renderer_;
  std::unique_ptr<Shapes> shapes_;
  std::vector<vtkSmartPointer<vtkTextActor>> texts_;
  std::size_t texts_used_ = 0;
  Rgb ground_;
};

}  // namespace tiltmap::ui
