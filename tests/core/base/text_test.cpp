#include "core/base/text.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ParseReal, TakesWholeNumbersFractionsAndExponents) {
  EXPECT_EQ(parseReal("12"), 12.0);
  EXPECT_EQ(parseReal("-0.25"), -0.25);
  EXPECT_EQ(parseReal("+1.5e-3"), 1.5e-3);
  EXPECT_EQ(parseReal(".5"), 0.5);
  EXPECT_TRUE(std::isnan(parseReal("nan").value()));
  EXPECT_TRUE(std::isinf(parseReal("-inf").value()));
}

TEST(ParseReal, RefusesWhatIsNotOneNumber) {
  for (const char* text :
       {"", "+", "-", "+-1", "-+1", "++1", " 1", "1 ", "1,5", "1.5m", "0x10", "1e", "1e999", "word"})
    EXPECT_FALSE(parseReal(text)) << text;
}

TEST(ParseInteger, TakesTheRangeOfLongLongAndNothingElse) {
  EXPECT_EQ(parseInteger("9223372036854775807"), std::numeric_limits<long long>::max());
  EXPECT_EQ(parseInteger("-9223372036854775808"), std::numeric_limits<long long>::min());
  EXPECT_EQ(parseInteger("+7"), 7);
  for (const char* text : {"", "+", "+-7", "9223372036854775808", "1.0", "1e3", "0x1", "7 ", "seven"})
    EXPECT_FALSE(parseInteger(text)) << text;
}

TEST(Text, TrimsAndSplits) {
  EXPECT_EQ(trimmed(" \t a b\r\n"), "a b");
  EXPECT_EQ(trimmed(" \n"), "");
  EXPECT_THAT(splitWords("  one\ttwo  three\r\n"), ElementsAre("one", "two", "three"));
  EXPECT_THAT(splitWords(" \t"), IsEmpty());
  EXPECT_THAT(splitAt("a,,b,", ','), ElementsAre("a", "", "b", ""));
  EXPECT_THAT(splitAt("", ','), ElementsAre(""));
}

TEST(Text, Joins) {
  EXPECT_EQ(joined({"a", "b", "c"}, ", "), "a, b, c");
  EXPECT_EQ(joined({"a"}, ", "), "a");
  EXPECT_EQ(joined({}, ", "), "");
}

TEST(NearestName, FindsATypingErrorAndNothingFarOff) {
  const std::vector<std::string> names{"max-distance", "max-angle", "motion"};
  EXPECT_EQ(nearestName("max-distence", names), "max-distance");
  EXPECT_EQ(nearestName("maxangle", names), "max-angle");
  EXPECT_EQ(nearestName("moton", names), "motion");
  EXPECT_EQ(nearestName("seed", names), std::nullopt);
  EXPECT_EQ(nearestName("motion", {}), std::nullopt);
}

TEST(ShortestReal, ReadsBackAsTheSameNumber) {
  EXPECT_EQ(shortestReal(0.1), "0.1");
  for (const double value :
       {1.0 / 3.0, -2.5e-300, 81.89, 6.02214076e23, std::numeric_limits<double>::denorm_min()})
    EXPECT_EQ(parseReal(shortestReal(value)), value);
}

TEST(Printable, EscapesAndCuts) {
  EXPECT_EQ(printable("abc"), "\"abc\"");
  EXPECT_EQ(printable(std::string_view("a\0\n\xff", 4)), "\"a\\x00\\x0a\\xff\"");
  EXPECT_EQ(printable("abcdef", 3), "\"abc...\"");
}

}  // namespace
}  // namespace tiltmap
