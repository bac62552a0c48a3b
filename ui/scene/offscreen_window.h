// A window that nobody sees: rendering without a display and without X, through EGL.
#pragma once

#include <memory>

#include "core/base/result.h"
#include "core/products/rgb_image.h"

class vtkRenderWindow;

namespace tiltmap::ui {

// Debian's VTK knows X windows only and aborts without a display, so the OpenGL context is made here by hand
// and VTK draws into it. The context belongs to the thread that made it.
class OffscreenWindow {
 public:
  // Error: no OpenGL 3.2 to be had from EGL, or a size out of 16 to 16384.
  static Result<std::unique_ptr<OffscreenWindow>> make(int width_px, int height_px);
  // The same in the OpenGL context that is current, whosever it is; it must be current again whenever the
  // window is used, and when it goes.
  static Result<std::unique_ptr<OffscreenWindow>> inCurrentContext(int width_px, int height_px);
  ~OffscreenWindow();

  vtkRenderWindow& window();
  // What was rendered last.
  RgbImage picture();

 private:
  struct Parts;
  static Status checkSize(int width_px, int height_px);
  static void makeWindow(Parts& parts, int width_px, int height_px);
  explicit OffscreenWindow(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace tiltmap::ui
