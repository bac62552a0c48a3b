// Pictures compared with those that were looked at and found good.
#pragma once

#include <QDir>
#include <QFileInfo>
#include <QImage>
#include <cstdlib>

#include <gtest/gtest.h>

namespace tiltmap::test {

// Compares 16 x 16 averages with tests/ui/baselines/NAME.png, so that fonts and smoothing may differ a little
// but nothing may be missing or elsewhere. With TILTMAP_WRITE_BASELINES set the picture becomes the baseline.
inline ::testing::AssertionResult looksLike(const QImage& picture, const char* name, double mean_within = 6.0,
                                            double worst_within = 70.0) {
  const QString path = QString(TILTMAP_SOURCE_DIR "/tests/ui/baselines/%1.png").arg(name);
  if (std::getenv("TILTMAP_WRITE_BASELINES")) {
    QDir().mkpath(QFileInfo(path).path());
    if (!picture.convertToFormat(QImage::Format_RGB888).save(path))
      return ::testing::AssertionFailure() << "cannot write " << path.toStdString();
    return ::testing::AssertionSuccess();
  }
  QImage baseline(path);
  if (baseline.isNull()) return ::testing::AssertionFailure() << "there is no " << path.toStdString();
  const QSize cells(picture.width() / 16, picture.height() / 16);
  const auto coarse = [&](const QImage& image) {
    return image.convertToFormat(QImage::Format_RGB32)
        .scaled(cells, Qt::IgnoreAspectRatio, Qt::SmoothTransformation);
  };
  const QImage now = coarse(picture), then = coarse(baseline);
  double sum = 0.0, worst = 0.0;
  for (int y = 0; y < cells.height(); ++y)
    for (int x = 0; x < cells.width(); ++x) {
      const double off = std::abs(qGray(now.pixel(x, y)) - qGray(then.pixel(x, y)));
      sum += off;
      worst = std::max(worst, off);
    }
  const double mean = sum / (cells.width() * cells.height());
  if (mean <= mean_within && worst <= worst_within) return ::testing::AssertionSuccess();
  const QString seen = QDir::temp().filePath(QString("tiltmap-%1.png").arg(name));
  (void)picture.save(seen);
  return ::testing::AssertionFailure() << name << " is off by " << mean << " grey levels on average and "
                                       << worst << " at worst; what was drawn is " << seen.toStdString();
}

}  // namespace tiltmap::test
