// Lengths as a person reads them. Core has metres; only here do they become anything else.
#pragma once

#include <QString>

namespace tiltmap::ui {

enum class LengthUnit { Metre, Millimetre, Foot };

QString unitName(LengthUnit unit);  // "m", "mm", "ft"
double inUnit(double metres, LengthUnit unit);
// To the millimetre or finer, without the unit: for columns whose header has it.
QString lengthNumber(double metres, LengthUnit unit);
QString lengthText(double metres, LengthUnit unit);  // with it
// A residual or error: millimetres below 1 m whatever the unit, since "0.012 m" is hard to compare.
QString smallLengthText(double metres, LengthUnit unit);
QString groupedNumber(long long number);     // "350,000"
QString durationText(double seconds);        // "4 s", "2 min 10 s"
QString sizeText(unsigned long long bytes);  // "3.2 MB"

}  // namespace tiltmap::ui
