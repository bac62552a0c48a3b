// A judgement as people read it: the one place where its figures become words, for window, commands and
// report.
#pragma once

#include <string>
#include <vector>

#include "core/registration/pair_judgement.h"

namespace tiltmap {

struct JudgementLine {
  std::string name;   // "Overlap"
  std::string value;  // "41 % of the moving scan, 38 % of the fixed one"
  std::string help;   // what it is, in a sentence
};

// Overlap, fit, residual, strength, deviations, pull and distance from the start; always all of them, in this
// order.
std::vector<JudgementLine> judgementLines(const PairJudgement& judgement);

std::string percentWords(double share);                         // "41 %"
std::string differenceWords(const PoseDifference& difference);  // "12 mm and 0.03°"

}  // namespace tiltmap
