// Colours in a grabbed widget.
#pragma once

#include <QImage>
#include <QWidget>
#include <cmath>

namespace tiltmap::test {

inline bool isNear(const QColor& a, const QColor& b, int within = 24) {
  return std::abs(a.red() - b.red()) <= within && std::abs(a.green() - b.green()) <= within &&
         std::abs(a.blue() - b.blue()) <= within;
}

// Pixels of about that colour within `radius` of a place, logical coordinates of the grabbed widget.
inline int countNear(const QImage& image, const QPointF& place, double radius, const QColor& colour,
                     int within = 24) {
  const double ratio = image.devicePixelRatioF();
  int count = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (std::hypot((x + 0.5) / ratio - place.x(), (y + 0.5) / ratio - place.y()) <= radius &&
          isNear(image.pixelColor(x, y), colour, within))
        ++count;
  return count;
}

inline QImage pictureOf(QWidget& widget) {
  return widget.grab().toImage();
}

}  // namespace tiltmap::test
