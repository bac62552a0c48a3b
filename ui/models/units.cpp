#include "ui/models/units.h"

#include <cmath>

#include "core/base/text.h"
#include "ui/models/strings.h"

namespace tiltmap::ui {

namespace {

constexpr double kMetresPerFoot = 0.3048;  // the international foot

}  // namespace

QString unitName(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::Metre:
      return "m";
    case LengthUnit::Millimetre:
      return "mm";
    case LengthUnit::Foot:
      return "ft";
  }
  return {};
}

double inUnit(double metres, LengthUnit unit) {
  switch (unit) {
    case LengthUnit::Metre:
      return metres;
    case LengthUnit::Millimetre:
      return metres * 1000.0;
    case LengthUnit::Foot:
      return metres / kMetresPerFoot;
  }
  return metres;
}

QString lengthNumber(double metres, LengthUnit unit) {
  return qt(fixedReal(inUnit(metres, unit), unit == LengthUnit::Millimetre ? 0 : 3));
}

QString lengthText(double metres, LengthUnit unit) {
  return lengthNumber(metres, unit) + " " + unitName(unit);
}

QString smallLengthText(double metres, LengthUnit unit) {
  if (unit == LengthUnit::Foot) return qt(fixedReal(inUnit(metres, unit), 3)) + " ft";
  if (std::abs(metres) < 1.0) return qt(fixedReal(metres * 1000.0, 1)) + " mm";
  return lengthText(metres, unit);
}

QString groupedNumber(long long number) {
  return qt(groupedInteger(number));
}

QString durationText(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(seconds));
  if (whole < 60) return QString("%1 s").arg(whole);
  if (whole < 3600) return QString("%1 min %2 s").arg(whole / 60).arg(whole % 60);
  return QString("%1 h %2 min").arg(whole / 3600).arg(whole % 3600 / 60);
}

QString sizeText(unsigned long long bytes) {
  const auto size = static_cast<double>(bytes);
  if (size < 1e3) return QString("%1 bytes").arg(bytes);
  if (size < 1e6) return qt(fixedReal(size / 1e3, 1)) + " kB";
  if (size < 1e9) return qt(fixedReal(size / 1e6, 1)) + " MB";
  return qt(fixedReal(size / 1e9, 2)) + " GB";
}

}  // namespace tiltmap::ui
