// Pictures compared with those that were looked at and found good.
#pragma once

#include <QDir>
#include <QFileInfo>
#include <QImage>
#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>

namespace tiltmap::test {

// How far two pictures of one size lie apart, by squares of 8 x 8 pixels: so that the smoothing of fonts may
// differ a little. In levels of the colour that differs most.
struct PictureDifference {
  double mean = 0.0;   // over all squares
  double share = 0.0;  // of the squares that differ by more than 20 levels: a letter more or less
  double worst = 0.0;
};

inline PictureDifference pictureDifference(const QImage& now, const QImage& then) {
  const QSize squares(std::max(1, now.width() / 8), std::max(1, now.height() / 8));
  const auto coarse = [&](const QImage& image) {
    return image.convertToFormat(QImage::Format_RGB32)
        .scaled(squares, Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
  };
  const QImage a = coarse(now), b = coarse(then);
  PictureDifference difference;
  const double count = squares.width() * squares.height();
  for (int y = 0; y < squares.height(); ++y)
    for (int x = 0; x < squares.width(); ++x) {
      const QRgb p = a.pixel(x, y), q = b.pixel(x, y);
      const int off = std::max({std::abs(qRed(p) - qRed(q)), std::abs(qGreen(p) - qGreen(q)),
                                std::abs(qBlue(p) - qBlue(q))});
      difference.mean += off / count;
      if (off > 20) difference.share += 1.0 / count;
      difference.worst = std::max(difference.worst, static_cast<double>(off));
    }
  return difference;
}

// Compares with tests/ui/baselines/NAME.png. With TILTMAP_WRITE_BASELINES set the picture becomes the baseline.
inline ::testing::AssertionResult looksLike(const QImage& picture, const char* name, double mean_within = 1.5,
                                            double share_within = 0.01) {
  const QString path = QString(TILTMAP_SOURCE_DIR "/tests/ui/baselines/%1.png").arg(name);
  if (std::getenv("TILTMAP_WRITE_BASELINES")) {
    QDir().mkpath(QFileInfo(path).path());
    if (!picture.convertToFormat(QImage::Format_RGB888).save(path))
      return ::testing::AssertionFailure() << "cannot write " << path.toStdString();
    return ::testing::AssertionSuccess();
  }
  const QImage baseline(path);
  if (baseline.isNull()) return ::testing::AssertionFailure() << "there is no " << path.toStdString();
  PictureDifference off;
  const bool same_size = picture.size() == baseline.size();
  if (same_size) off = pictureDifference(picture, baseline);
  if (same_size && off.mean <= mean_within && off.share <= share_within)
    return ::testing::AssertionSuccess();
  const QString seen = QDir::temp().filePath(QString("tiltmap-%1.png").arg(name));
  (void)picture.save(seen);
  if (!same_size)
    return ::testing::AssertionFailure() << name << " has another size; what was drawn is " << seen.toStdString();
  return ::testing::AssertionFailure() << name << " is off by " << off.mean << " levels on average, "
                                       << 100.0 * off.share << " % of it by a lot, " << off.worst
                                       << " at worst; what was drawn is " << seen.toStdString();
}

}  // namespace tiltmap::test
