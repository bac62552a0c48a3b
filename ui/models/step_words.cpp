#include "ui/models/step_words.h"

#include <QStringList>
#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr double kLeast_m = 0.005, kLeast_deg = 0.05, kLeastTilt_deg = 0.5;

QString degrees(double deg) {
  QString text = qt(fixedReal(std::abs(deg), 1));
  if (text.endsWith(".0")) text.chop(2);
  return text + "°";
}

}  // namespace

double headingChange(const Pose& last_from_next) {
  const Eigen::Vector3d heading = last_from_next.heading();
  return std::atan2(-heading.x(), heading.y());
}

QString stepInWords(const Pose& last_from_next) {
  const Eigen::Vector3d& t = last_from_next.translation();
  QStringList parts;
  const auto say = [&parts](double metres, const char* there, const char* back) {
    if (std::abs(metres) >= kLeast_m)
      parts << qt(fixedReal(std::abs(metres), 2)) + " m " + (metres > 0.0 ? there : back);
  };
  say(t.y(), "forward", "back");
  say(t.x(), "to the right", "to the left");
  say(t.z(), "up", "down");
  const double turned = headingChange(last_from_next) / kDegree;
  if (std::abs(turned) >= kLeast_deg)
    parts << "turned " + degrees(turned) + (turned > 0.0 ? " to the left" : " to the right");
  const double upright = (last_from_next.rotation() * Eigen::Vector3d::UnitZ()).z();
  const double tilted = std::acos(std::clamp(upright, -1.0, 1.0)) / kDegree;
  if (tilted >= kLeastTilt_deg) parts << "tilted by " + degrees(tilted);
  return parts.isEmpty() ? "did not move" : parts.join(", ");
}

}  // namespace tiltmap::ui
