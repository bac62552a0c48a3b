#include "ui/look/icons.h"

#include <QApplication>
#include <QFile>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QSvgRenderer>

// Outside the namespace, as Qt wants it: a static library's resources are else left out by the linker.
static void initialiseResources() {
  Q_INIT_RESOURCE(resources);
}

namespace tiltmap::ui {

namespace {

class OwnIconEngine : public QIconEngine {
 public:
  explicit OwnIconEngine(QByteArray svg) : svg_(std::move(svg)) {}

  void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override {
    const QPalette palette = QApplication::palette();
    const QColor colour = mode == QIcon::Disabled   ? palette.color(QPalette::Disabled, QPalette::ButtonText)
                          : mode == QIcon::Selected ? palette.color(QPalette::HighlightedText)
                                                    : palette.color(QPalette::ButtonText);
    QByteArray coloured = svg_;
    coloured.replace("currentColor", colour.name().toLatin1());
    QSvgRenderer(coloured).render(painter, rect);
  }
  QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
    QPixmap pixmap(size);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    paint(&painter, QRect(QPoint(), size), mode, state);
    return pixmap;
  }
  QIconEngine* clone() const override { return new OwnIconEngine(*this); }

 private:
  QByteArray svg_;
};

}  // namespace

QIcon icon(const QString& name) {
  if (name.isEmpty()) return {};
  static const bool ready = (initialiseResources(), true);
  Q_UNUSED(ready)
  QFile own(":/tiltmap/icons/" + name + ".svg");
  if (own.open(QIODevice::ReadOnly)) return QIcon(new OwnIconEngine(own.readAll()));
  return QIcon::fromTheme(name);
}

}  // namespace tiltmap::ui
