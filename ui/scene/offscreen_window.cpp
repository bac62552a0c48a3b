#include "ui/scene/offscreen_window.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <cstdlib>
#include <string>
#include <vtkGenericOpenGLRenderWindow.h>
#include <vtkNew.h>
#include <vtkObject.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkUnsignedCharArray.h>

namespace tiltmap::ui {

namespace {

// VTK's OpenGL loader looks for X, complains at every picture that there is none, and works all the same.
class QuietWarnings {
 public:
  QuietWarnings() : before_(vtkObject::GetGlobalWarningDisplay()) { vtkObject::GlobalWarningDisplayOff(); }
  ~QuietWarnings() { vtkObject::SetGlobalWarningDisplay(before_); }
  QuietWarnings(const QuietWarnings&) = delete;
  QuietWarnings& operator=(const QuietWarnings&) = delete;

 private:
  int before_;
};

tl::unexpected<Error> noContext(const std::string& step) {
  return fail("pictures cannot be rendered: " + step, "EGL",
              "install Mesa's drivers (libegl1, libgl1-mesa-dri), which render without a graphics card");
}

}  // namespace

struct OffscreenWindow::Parts {
  QuietWarnings quiet;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  EGLSurface surface = EGL_NO_SURFACE;
  vtkSmartPointer<vtkGenericOpenGLRenderWindow> window;

  Parts() = default;
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;
  ~Parts() {
    if (window) {
      if (context != EGL_NO_CONTEXT) eglMakeCurrent(display, surface, surface, context);
      window->Finalize();
      window = nullptr;
    }
    if (display == EGL_NO_DISPLAY) return;
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
    // The display stays initialised: a second window of this process may share it.
  }

  Status makeContext() {
    const auto platform_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (!platform_display) return noContext("EGL here cannot work without a display");
    // A picture needs no shaders kept on disk, and where they cannot be, Mesa complains on the terminal.
    ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
    display = platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
      display = EGL_NO_DISPLAY;
      return noContext("no EGL display without a screen");
    }
    if (!eglBindAPI(EGL_OPENGL_API)) return noContext("EGL has no OpenGL");
    const EGLint wanted[] = {EGL_SURFACE_TYPE,
                             EGL_PBUFFER_BIT,
                             EGL_RENDERABLE_TYPE,
                             EGL_OPENGL_BIT,
                             EGL_RED_SIZE,
                             8,
                             EGL_GREEN_SIZE,
                             8,
                             EGL_BLUE_SIZE,
                             8,
                             EGL_DEPTH_SIZE,
                             24,
                             EGL_NONE};
    EGLConfig config = nullptr;
    EGLint found = 0;
    if (!eglChooseConfig(display, wanted, &config, 1, &found) || found < 1)
      return noContext("EGL offers no suitable picture format");
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION,
                              3,
                              EGL_CONTEXT_MINOR_VERSION,
                              2,
                              EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                              EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
    if (context == EGL_NO_CONTEXT) return noContext("OpenGL 3.2 is not to be had");
    // VTK draws into buffers of its own; the surface is there because a context must have one.
    const EGLint size[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
    surface = eglCreatePbufferSurface(display, config, size);
    if (surface == EGL_NO_SURFACE || !eglMakeCurrent(display, surface, surface, context))
      return noContext("the OpenGL context cannot be used");
    return {};
  }
};

OffscreenWindow::OffscreenWindow(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
OffscreenWindow::~OffscreenWindow() = default;

Status OffscreenWindow::checkSize(int width_px, int height_px) {
  if (width_px >= 16 && height_px >= 16 && width_px <= 16384 && height_px <= 16384) return {};
  return fail("a picture of " + std::to_string(width_px) + " x " + std::to_string(height_px) +
                  " pixels cannot be rendered",
              "size", "choose 16 to 16384 pixels for either side");
}

void OffscreenWindow::makeWindow(Parts& parts, int width_px, int height_px) {
  parts.window = vtkSmartPointer<vtkGenericOpenGLRenderWindow>::New();
  parts.window->SetOwnContext(0);
  parts.window->SetReadyForRendering(true);
  parts.window->SetMultiSamples(0);
  parts.window->SetFrameBlitModeToNoBlit();
  parts.window->OpenGLInitContext();
  parts.window->SetIsCurrent(true);
  parts.window->SetSupportsOpenGL(1);
  parts.window->SetMapped(true);
  parts.window->SetSize(width_px, height_px);
}

Result<std::unique_ptr<OffscreenWindow>> OffscreenWindow::make(int width_px, int height_px) {
  if (Status status = checkSize(width_px, height_px); !status) return fail(status.error());
  auto parts = std::make_unique<Parts>();
  if (Status status = parts->makeContext(); !status) return fail(status.error());
  makeWindow(*parts, width_px, height_px);
  return std::unique_ptr<OffscreenWindow>(new OffscreenWindow(std::move(parts)));
}

Result<std::unique_ptr<OffscreenWindow>> OffscreenWindow::inCurrentContext(int width_px, int height_px) {
  if (Status status = checkSize(width_px, height_px); !status) return fail(status.error());
  auto parts = std::make_unique<Parts>();
  makeWindow(*parts, width_px, height_px);
  return std::unique_ptr<OffscreenWindow>(new OffscreenWindow(std::move(parts)));
}

vtkRenderWindow& OffscreenWindow::window() {
  return *parts_->window;
}

RgbImage OffscreenWindow::picture() {
  const int* size = parts_->window->GetSize();
  RgbImage image(size[0], size[1], Rgb{});
  vtkNew<vtkUnsignedCharArray> pixels;
  parts_->window->GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels, 0);
  if (pixels->GetNumberOfValues() < static_cast<vtkIdType>(3 * image.pixels.size())) return image;
  // OpenGL begins at the bottom.
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const unsigned char* p =
          pixels->GetPointer(3 * static_cast<vtkIdType>(image.index(x, image.height - 1 - y)));
      image.at(x, y) = {p[0], p[1], p[2]};
    }
  return image;
}

}  // namespace tiltmap::ui
