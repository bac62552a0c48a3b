#include "ui/scene/point_layer.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <vtkActor.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLQuadHelper.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLShaderCache.h>
#include <vtkOpenGLState.h>
#include <vtkRenderer.h>
#include <vtkShaderProgram.h>
#include <vtk_glew.h>

#include "ui/scene/point_shaders.h"
#include "ui/scene/scan_points.h"

namespace tiltmap::ui {

using Eigen::Vector2i;
using Eigen::Vector3d;

namespace {

// A piece of the work between two looks at the mouse.
constexpr double kMoment_s = 0.04;
constexpr std::size_t kFirstPiece = 200'000;

std::array<float, 16> columnsOf(const Eigen::Matrix4d& matrix) {
  std::array<float, 16> values;
  Eigen::Map<Eigen::Matrix4f>(values.data()) = matrix.cast<float>();
  return values;
}

void makeTexture(GLuint& texture, GLint format, GLenum layout, GLenum type, const Vector2i& size) {
  if (texture == 0) glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, format, size.x(), size.y(), 0, layout, type, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  glBindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace

// One side as drawn so far.
struct PointLayer::Picture {
  GLuint frame = 0, colour = 0, depth = 0;
  Vector2i size = Vector2i::Zero();
  PointLook look;
  bool begun = false;
  std::vector<std::size_t> drawn;  // by batch
  std::size_t piece = kFirstPiece;

  void release() {
    if (frame) glDeleteFramebuffers(1, &frame);
    if (colour) glDeleteTextures(1, &colour);
    if (depth) glDeleteTextures(1, &depth);
    frame = colour = depth = 0;
    size.setZero();
    begun = false;
  }
  void resize(const Vector2i& wanted) {
    if (frame && size == wanted) return;
    makeTexture(colour, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, wanted);
    makeTexture(depth, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, wanted);
    if (!frame) {
      glGenFramebuffers(1, &frame);
      glBindFramebuffer(GL_FRAMEBUFFER, frame);
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour, 0);
      glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
    }
    size = wanted;
    begun = false;
  }
};

struct PointLayer::Graphics {
  struct Buffers {
    GLuint places = 0;
    std::array<GLuint, 2> colours{};
    std::uint64_t colours_changed = 0;
  };
  std::map<std::uint64_t, Buffers> buffers;  // by batch
  GLuint arrays = 0;
  std::array<Picture, 2> pictures;
  std::unique_ptr<vtkOpenGLQuadHelper> mixer;
  vtkShaderProgram* program = nullptr;
  GLint place_at = -1, colour_at = -1;

  static void release(Buffers& b) {
    if (b.places) glDeleteBuffers(1, &b.places);
    for (GLuint& colours : b.colours)
      if (colours) glDeleteBuffers(1, &colours);
    b = {};
  }
};

std::uint64_t PointBatch::nextId() {
  static std::atomic<std::uint64_t> next = 0;
  return ++next;
}

vtkStandardNewMacro(PointLayer);

PointLayer::PointLayer() : graphics_(std::make_unique<Graphics>()) {}
PointLayer::~PointLayer() = default;

void PointLayer::setBatches(std::vector<PointBatch*> batches) {
  batches_ = std::move(batches);
  for (Picture& picture : graphics_->pictures) picture.begun = false;
}

bool PointLayer::shows(int side) const {
  return mix_.divider || (side == 1) == mix_.only_before;
}

bool PointLayer::isComplete() const {
  for (const int side : {0, 1}) {
    if (!shows(side)) continue;
    const Picture& picture = graphics_->pictures[static_cast<std::size_t>(side)];
    if (!picture.begun || picture.look != look_) return false;
    for (std::size_t i = 0; i < batches_.size(); ++i)
      if (batches_[i]->visible && picture.drawn[i] < batches_[i]->points->size()) return false;
  }
  return true;
}

std::size_t PointLayer::drawn(int side) const {
  std::size_t sum = 0;
  const Picture& picture = graphics_->pictures[static_cast<std::size_t>(side)];
  if (picture.begun)
    for (const std::size_t count : picture.drawn) sum += count;
  return sum;
}

void PointLayer::drawRange(const PointBatch& batch, int side, std::size_t from, std::size_t to) {
  if (from >= to) return;
  auto& buffers = graphics_->buffers[batch.id];
  if (buffers.places == 0) {
    glGenBuffers(1, &buffers.places);
    glBindBuffer(GL_ARRAY_BUFFER, buffers.places);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(batch.points->xyz.size() * sizeof(float)),
                 batch.points->xyz.data(), GL_STATIC_DRAW);
  }
  if (buffers.colours_changed != batch.colours_changed) {
    buffers.colours_changed = batch.colours_changed;
    for (std::size_t k = 0; k < 2; ++k) {
      if (buffers.colours[k]) glDeleteBuffers(1, &buffers.colours[k]);
      buffers.colours[k] = 0;
      if (batch.colours[k].empty()) continue;
      glGenBuffers(1, &buffers.colours[k]);
      glBindBuffer(GL_ARRAY_BUFFER, buffers.colours[k]);
      glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(3 * batch.colours[k].size()),
                   batch.colours[k].data(), GL_STATIC_DRAW);
    }
  }
  vtkShaderProgram& program = *graphics_->program;
  const Pose& world_from_scan = batch.world_from_scan[static_cast<std::size_t>(side)];
  auto world = columnsOf(world_from_scan.matrix());
  auto clip = columnsOf(look_.clip_from_world * world_from_scan.matrix());
  program.SetUniformMatrix4x4("clipFromScan", clip.data());
  if (look_.box) program.SetUniformMatrix4x4("worldFromScan", world.data());
  glBindBuffer(GL_ARRAY_BUFFER, buffers.places);
  glEnableVertexAttribArray(static_cast<GLuint>(graphics_->place_at));
  glVertexAttribPointer(static_cast<GLuint>(graphics_->place_at), 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  const GLuint colours = side == 1 && buffers.colours[1] ? buffers.colours[1] : buffers.colours[0];
  const auto colour_at = static_cast<GLuint>(graphics_->colour_at);
  if (colours) {
    glBindBuffer(GL_ARRAY_BUFFER, colours);
    glEnableVertexAttribArray(colour_at);
    glVertexAttribPointer(colour_at, 3, GL_UNSIGNED_BYTE, GL_TRUE, 0, nullptr);
  } else {
    glDisableVertexAttribArray(colour_at);
    glVertexAttrib3f(colour_at, static_cast<float>(batch.ink.r) / 255.0F,
                     static_cast<float>(batch.ink.g) / 255.0F, static_cast<float>(batch.ink.b) / 255.0F);
  }
  glDrawArrays(GL_POINTS, static_cast<GLint>(from), static_cast<GLsizei>(to - from));
}

// Before any points: their shader, their size, and that nothing of the state is left from others.
bool PointLayer::beginPoints(vtkOpenGLRenderWindow& window, const Vector2i& size) {
  vtkOpenGLState& state = *window.GetState();
  graphics_->program = window.GetShaderCache()->ReadyShaderProgram(kPointVertices, kPointFragments, "");
  if (!graphics_->program) return false;
  vtkShaderProgram& program = *graphics_->program;
  const auto handle = static_cast<GLuint>(program.GetHandle());
  graphics_->place_at = glGetAttribLocation(handle, "place");
  graphics_->colour_at = glGetAttribLocation(handle, "colour");
  program.SetUniformi("boxed", look_.box ? 1 : 0);
  if (look_.box) {
    program.SetUniform3f("boxLow", look_.box->low.data());
    program.SetUniform3f("boxHigh", look_.box->high.data());
  }
  if (graphics_->arrays == 0) glGenVertexArrays(1, &graphics_->arrays);
  glBindVertexArray(graphics_->arrays);
  state.vtkglEnable(GL_DEPTH_TEST);
  state.vtkglDepthMask(1);
  state.vtkglDepthFunc(GL_LEQUAL);
  state.vtkglDisable(GL_BLEND);
  state.vtkglViewport(0, 0, size.x(), size.y());
  state.vtkglPointSize(static_cast<float>(look_.point_px));
  glDisable(GL_PROGRAM_POINT_SIZE);
  return true;
}

void PointLayer::endPoints() {
  glBindVertexArray(0);
  glBindBuffer(GL_ARRAY_BUFFER, 0);
}

// Straight into the window's picture: a frame while moving is not needed again.
void PointLayer::drawPassing(int side, vtkOpenGLRenderWindow& window, const Vector2i& size) {
  graphics_->pictures[static_cast<std::size_t>(side)].begun = false;
  if (!beginPoints(window, size)) return;
  const std::vector<std::size_t> counts = fewOf(side);
  for (std::size_t i = 0; i < batches_.size(); ++i)
    if (batches_[i]->visible)
      drawRange(*batches_[i], side, 0, std::min(counts[i], batches_[i]->points->size()));
  endPoints();
}

// Where each batch is to end after this piece: the same share of what is missing everywhere, so that the
// picture fills up evenly.
std::vector<std::size_t> PointLayer::nextEnds(const Picture& picture) const {
  std::size_t missing = 0;
  for (std::size_t i = 0; i < batches_.size(); ++i)
    if (batches_[i]->visible) missing += batches_[i]->points->size() - picture.drawn[i];
  const double share =
      missing == 0 ? 1.0 : std::min(1.0, static_cast<double>(picture.piece) / static_cast<double>(missing));
  std::vector<std::size_t> ends = picture.drawn;
  for (std::size_t i = 0; i < batches_.size(); ++i)
    if (batches_[i]->visible)
      ends[i] += static_cast<std::size_t>(
          std::ceil(share * static_cast<double>(batches_[i]->points->size() - picture.drawn[i])));
  return ends;
}

void PointLayer::drawSide(int side, vtkOpenGLRenderWindow& window, const Vector2i& size) {
  Picture& picture = graphics_->pictures[static_cast<std::size_t>(side)];
  vtkOpenGLState& state = *window.GetState();
  state.PushFramebufferBindings();
  picture.resize(size);
  state.vtkglBindFramebuffer(GL_FRAMEBUFFER, picture.frame);
  const GLenum target = GL_COLOR_ATTACHMENT0;
  glDrawBuffers(1, &target);
  const bool anew = !picture.begun || picture.look != look_;
  if (anew) {
    picture.begun = true;
    picture.look = look_;
    picture.drawn.assign(batches_.size(), 0);
    state.vtkglClearColor(0.0F, 0.0F, 0.0F, 0.0F);
    state.vtkglClearDepth(1.0);
    state.vtkglColorMask(1, 1, 1, 1);
    state.vtkglDepthMask(1);
    state.vtkglClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  }
  if (beginPoints(window, size)) {
    const auto draw = [&](const std::vector<std::size_t>& ends) {
      for (std::size_t i = 0; i < batches_.size(); ++i) {
        if (!batches_[i]->visible) continue;
        const std::size_t end = std::min(ends[i], batches_[i]->points->size());
        drawRange(*batches_[i], side, picture.drawn[i], end);
        picture.drawn[i] = std::max(picture.drawn[i], end);
      }
    };
    if (!gradual_ && !moving_) {
      draw(std::vector<std::size_t>(batches_.size(), std::numeric_limits<std::size_t>::max()));
    } else if (anew) {
      draw(fewOf(side));
    } else if (!moving_) {
      const auto before = std::chrono::steady_clock::now();
      draw(nextEnds(picture));
      glFinish();
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
      const double factor = std::clamp(kMoment_s / std::max(seconds, 1e-4), 0.5, 2.0);
      picture.piece = static_cast<std::size_t>(
          std::clamp(factor * static_cast<double>(picture.piece), 20'000.0, 20'000'000.0));
    }
    endPoints();
  }
  state.PopFramebufferBindings();
}

void PointLayer::compose(vtkOpenGLRenderWindow& window) {
  vtkOpenGLState& state = *window.GetState();
  if (!graphics_->mixer)
    graphics_->mixer = std::make_unique<vtkOpenGLQuadHelper>(&window, nullptr, kMixFragments, "");
  else
    window.GetShaderCache()->ReadyShaderProgram(graphics_->mixer->Program);
  vtkShaderProgram* program = graphics_->mixer->Program;
  if (!program) return;
  const auto& pictures = graphics_->pictures;
  // A side that is not shown may have no picture; the other one stands in, unread.
  const Picture& now = shows(0) ? pictures[0] : pictures[1];
  const Picture& before = shows(1) ? pictures[1] : pictures[0];
  const GLuint textures[] = {now.colour, now.depth, before.colour, before.depth};
  const char* names[] = {"nowColour", "nowDepth", "beforeColour", "beforeDepth"};
  for (int unit = 0; unit < 4; ++unit) {
    state.vtkglActiveTexture(GL_TEXTURE0 + static_cast<unsigned>(unit));
    glBindTexture(GL_TEXTURE_2D, textures[unit]);
    program->SetUniformi(names[unit], unit);
  }
  const Vector2i size = now.size;
  program->SetUniformf("divider", static_cast<float>(mix_.divider       ? *mix_.divider * size.x()
                                                     : mix_.only_before ? size.x() + 1.0
                                                                        : -1.0));
  program->SetUniformi("shaded", mix_.shaded ? 1 : 0);
  program->SetUniformi("parallel", mix_.orthographic ? 1 : 0);
  const float ends[2] = {static_cast<float>(mix_.near_m), static_cast<float>(mix_.far_m)};
  program->SetUniform2f("ends", ends);
  program->SetUniformi("radius", std::max(1, static_cast<int>(std::lround(mix_.shade_radius_px))));
  const int last[2] = {size.x() - 1, size.y() - 1};
  program->SetUniform2i("last", last);
  state.vtkglEnable(GL_DEPTH_TEST);
  state.vtkglDepthMask(1);
  state.vtkglDepthFunc(GL_LEQUAL);
  state.vtkglDisable(GL_BLEND);
  graphics_->mixer->Render();
  for (int unit = 3; unit >= 0; --unit) {
    state.vtkglActiveTexture(GL_TEXTURE0 + static_cast<unsigned>(unit));
    glBindTexture(GL_TEXTURE_2D, 0);
  }
  state.vtkglEnable(GL_BLEND);
}

void PointLayer::drawSideActors(vtkRenderer& renderer, const Vector2i& size) {
  auto& window = *static_cast<vtkOpenGLRenderWindow*>(renderer.GetRenderWindow());
  vtkOpenGLState& state = *window.GetState();
  const vtkOpenGLState::ScopedglEnableDisable kept(&state, GL_SCISSOR_TEST);
  const vtkOpenGLState::ScopedglScissor area(&state);
  for (const int side : {0, 1}) {
    vtkActor* actor = side_actors_[static_cast<std::size_t>(side)];
    if (!shows(side) || !actor || !actor->GetVisibility()) continue;
    if (mix_.divider) {
      const int at = static_cast<int>(std::lround(*mix_.divider * size.x()));
      state.vtkglEnable(GL_SCISSOR_TEST);
      state.vtkglScissor(side == 1 ? 0 : at, 0, side == 1 ? at : size.x() - at, size.y());
    }
    actor->RenderOpaqueGeometry(&renderer);
  }
}

int PointLayer::RenderOpaqueGeometry(vtkViewport* viewport) {
  auto* renderer = vtkRenderer::SafeDownCast(viewport);
  auto* window = renderer ? vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()) : nullptr;
  if (!window) return 0;
  const int* pixels = window->GetSize();
  const Vector2i size(pixels[0], pixels[1]);
  if (size.minCoeff() < 1) return 0;
  // Buffers of scans that are gone.
  for (auto entry = graphics_->buffers.begin(); entry != graphics_->buffers.end();) {
    const bool there = std::any_of(batches_.begin(), batches_.end(),
                                   [&](const PointBatch* b) { return b->id == entry->first; });
    if (!there) Graphics::release(entry->second);
    entry = there ? std::next(entry) : graphics_->buffers.erase(entry);
  }
  {
    vtkOpenGLState& state = *window->GetState();
    const vtkOpenGLState::ScopedglEnableDisable blending(&state, GL_BLEND);
    const vtkOpenGLState::ScopedglEnableDisable cut(&state, GL_SCISSOR_TEST);
    const vtkOpenGLState::ScopedglViewport area(&state);
    const vtkOpenGLState::ScopedglClearColor colour(&state);
    state.vtkglDisable(GL_SCISSOR_TEST);
    if (passes())
      drawPassing(mix_.only_before ? 1 : 0, *window, size);
    else
      for (const int side : {0, 1})
        if (shows(side)) drawSide(side, *window, size);
  }
  if (!passes()) compose(*window);
  drawSideActors(*renderer, size);
  return 1;
}

void PointLayer::ReleaseGraphicsResources(vtkWindow* window) {
  if (auto* drawn = vtkOpenGLRenderWindow::SafeDownCast(window)) drawn->MakeCurrent();
  for (auto& [id, buffers] : graphics_->buffers) Graphics::release(buffers);
  graphics_->buffers.clear();
  for (Picture& picture : graphics_->pictures) picture.release();
  if (graphics_->arrays) glDeleteVertexArrays(1, &graphics_->arrays);
  graphics_->arrays = 0;
  if (graphics_->mixer) graphics_->mixer->ReleaseGraphicsResources(window);
  graphics_->mixer = nullptr;
  graphics_->program = nullptr;
  for (vtkActor* actor : side_actors_)
    if (actor) actor->ReleaseGraphicsResources(window);
  vtkProp::ReleaseGraphicsResources(window);
}

}  // namespace tiltmap::ui
