#include "core/base/parameter.h"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tiltmap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

enum class Colour { Red, Green };

struct Settings {
  bool loud = false;
  int tries = 3;
  double reach_m = 5.0;
  double noise_m = 0.012;
  double angle_rad = 20.0 * std::numbers::pi / 180.0;
  Colour colour = Colour::Green;
};

ParameterTable<Settings> makeTable() {
  ParameterTable<Settings> table("paint");
  table.boolean("loud", &Settings::loud, "Shouts.", "ours");
  table.integer("tries", &Settings::tries, "", 1, 10, "How often.", "ours");
  table.real("reach", &Settings::reach_m, "m", 0.01, 100, "How far.", "thesis 4.2.4");
  table.real("noise", &Settings::noise_m, "mm", 0, 1000, "How rough.", "ours", 0.001);
  table.angle("angle", &Settings::angle_rad, 0, 180, "How wide.", "ours");
  table.choice("colour", &Settings::colour, {{"red", Colour::Red}, {"green", Colour::Green}}, "Which.",
               "ours");
  Settings far;
  far.reach_m = 80.0;
  table.preset("far", "for wide places", far);
  return table;
}

const ParameterInfo& infoOf(const ParameterTable<Settings>& table, const std::string& name) {
  for (const ParameterInfo& info : table.infos())
    if (info.name == name) return info;
  throw std::logic_error("no " + name);
}

TEST(ParameterTable, TakesDefaultsFromTheSettingsInUnitsOfTheEdge) {
  const auto table = makeTable();
  EXPECT_THAT(table.names(), ElementsAre("loud", "tries", "reach", "noise", "angle", "colour"));
  EXPECT_EQ(infoOf(table, "loud").default_value, ParameterValue(false));
  EXPECT_EQ(infoOf(table, "tries").default_value, ParameterValue(3LL));
  EXPECT_EQ(infoOf(table, "reach").default_value, ParameterValue(5.0));
  EXPECT_DOUBLE_EQ(std::get<double>(infoOf(table, "noise").default_value), 12.0);
  EXPECT_DOUBLE_EQ(std::get<double>(infoOf(table, "angle").default_value), 20.0);
  EXPECT_EQ(infoOf(table, "angle").unit, "deg");
  EXPECT_EQ(infoOf(table, "colour").default_value, ParameterValue(std::string("green")));
  EXPECT_THAT(infoOf(table, "colour").choices, ElementsAre("red", "green"));
}

TEST(ParameterTable, AppliesEveryKind) {
  Settings settings;
  const auto done = makeTable().apply({{"loud", true},
                                       {"tries", 7LL},
                                       {"reach", 2LL},
                                       {"noise", 8.0},
                                       {"angle", 90.0},
                                       {"colour", std::string("red")}},
                                      settings);
  ASSERT_TRUE(done) << done.error().what;
  EXPECT_TRUE(settings.loud);
  EXPECT_EQ(settings.tries, 7);
  EXPECT_EQ(settings.reach_m, 2.0);
  EXPECT_DOUBLE_EQ(settings.noise_m, 0.008);
  EXPECT_DOUBLE_EQ(settings.angle_rad, std::numbers::pi / 2);
  EXPECT_EQ(settings.colour, Colour::Red);
}

TEST(ParameterTable, AppliesAllOrNothing) {
  Settings settings;
  const auto table = makeTable();
  const auto refused = table.apply({{"loud", true}, {"reach", 50.0}, {"tries", 11LL}}, settings);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "--tries");
  EXPECT_THAT(refused.error().remedy, HasSubstr("from 1 to 10"));
  EXPECT_EQ(table.values(settings), table.values(Settings{}));
}

TEST(ParameterTable, NamesTheNearestForAnUnknownName) {
  Settings settings;
  const auto refused = makeTable().apply({{"reech", 1.0}}, settings);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("\"reech\""));
  EXPECT_THAT(refused.error().remedy, HasSubstr("did you mean reach?"));
  const auto hopeless = makeTable().apply({{"zzzzzzzz", 1.0}}, settings);
  ASSERT_FALSE(hopeless);
  EXPECT_THAT(hopeless.error().remedy, ::testing::Not(HasSubstr("did you mean")));
  EXPECT_THAT(hopeless.error().remedy, HasSubstr("tiltmap parameters paint"));
}

TEST(ParameterTable, ValuesGoRoundAlsoAtTheEndsOfARange) {
  const auto table = makeTable();
  for (int degrees = 0; degrees <= 180; ++degrees) {
    Settings settings, copy;
    settings.angle_rad = degrees * std::numbers::pi / 180.0;
    settings.noise_m = degrees == 0 ? 1.0 : 0.001 * degrees;
    ASSERT_TRUE(table.apply(table.values(settings), copy)) << degrees;
    EXPECT_NEAR(copy.angle_rad, settings.angle_rad, 1e-15);
    EXPECT_NEAR(copy.noise_m, settings.noise_m, 1e-15);
    EXPECT_EQ(copy.colour, settings.colour);
  }
}

TEST(ParameterTable, GivesPresets) {
  const auto table = makeTable();
  ASSERT_EQ(table.presets().size(), 2U);
  EXPECT_EQ(table.presets()[0].name, "default");
  EXPECT_EQ(table.presets()[1].name, "far");
  EXPECT_EQ(table.presetSettings("default").value().reach_m, 5.0);
  EXPECT_EQ(table.presetSettings("far").value().reach_m, 80.0);
  const auto none = table.presetSettings("near");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().remedy, HasSubstr("default, far"));
}

TEST(ParameterTable, RefusesADescriptionThatContradictsItself) {
  ParameterTable<Settings> table("paint");
  table.integer("tries", &Settings::tries, "", 1, 10, "", "");
  EXPECT_THROW(table.integer("tries", &Settings::tries, "", 1, 10, "", ""), std::logic_error);
  EXPECT_THROW(table.real("reach", &Settings::reach_m, "m", 0, 4, "", ""), std::logic_error);
  EXPECT_THROW(table.integer("more-tries", &Settings::tries, "", 1, 1e12, "", ""), std::logic_error);
  EXPECT_THROW(table.choice("colour", &Settings::colour, {{"red", Colour::Red}}, "", ""), std::logic_error);
}

TEST(ParseParameter, ReadsTextByKind) {
  const auto table = makeTable();
  EXPECT_EQ(parseParameter(infoOf(table, "loud"), "on").value(), ParameterValue(true));
  EXPECT_EQ(parseParameter(infoOf(table, "loud"), "0").value(), ParameterValue(false));
  EXPECT_EQ(parseParameter(infoOf(table, "tries"), "10").value(), ParameterValue(10LL));
  EXPECT_EQ(parseParameter(infoOf(table, "reach"), "1e1").value(), ParameterValue(10.0));
  EXPECT_EQ(parseParameter(infoOf(table, "colour"), "red").value(), ParameterValue(std::string("red")));
}

TEST(ParseParameter, RefusesWhatDoesNotFitAndSaysWhatWould) {
  const auto table = makeTable();
  const std::vector<std::pair<std::string, std::string>> bad{
      {"loud", "maybe"}, {"tries", "0"},     {"tries", "2.5"}, {"tries", "99999999999999999999"},
      {"reach", "0"},    {"reach", "nan"},   {"reach", "inf"}, {"reach", "1m"},
      {"reach", ""},     {"angle", "180.1"}, {"angle", "-1"},  {"colour", "Red"},
      {"colour", ""}};
  for (const auto& [name, text] : bad) {
    const auto value = parseParameter(infoOf(table, name), text);
    ASSERT_FALSE(value) << name << " " << text;
    EXPECT_THAT(value.error().what, HasSubstr("\"" + text + "\""));
    EXPECT_EQ(value.error().where, "--" + name);
    EXPECT_FALSE(value.error().remedy.empty());
  }
  EXPECT_THAT(parseParameter(infoOf(table, "reach"), "0").error().remedy, HasSubstr("from 0.01 to 100 m"));
  EXPECT_THAT(parseParameter(infoOf(table, "colour"), "x").error().remedy, HasSubstr("red, green"));
}

TEST(CheckParameter, RefusesTheWrongKind) {
  const auto table = makeTable();
  EXPECT_FALSE(checkParameter(infoOf(table, "tries"), ParameterValue(3.0)));
  EXPECT_FALSE(checkParameter(infoOf(table, "loud"), ParameterValue(1LL)));
  EXPECT_FALSE(checkParameter(infoOf(table, "reach"), ParameterValue(std::string("1"))));
  EXPECT_FALSE(checkParameter(infoOf(table, "colour"), ParameterValue(true)));
}

TEST(ParameterText, SaysWhatWasMeant) {
  EXPECT_EQ(parameterText(19.999999999999996), "20");
  EXPECT_EQ(parameterText(0.5), "0.5");
  EXPECT_EQ(parameterText(-3LL), "-3");
  EXPECT_EQ(parameterText(true), "true");
  EXPECT_EQ(parameterText(std::string("red")), "red");
}

TEST(ParameterKindName, NamesEveryKind) {
  EXPECT_EQ(parameterKindName(ParameterKind::Boolean), "boolean");
  EXPECT_EQ(parameterKindName(ParameterKind::Text), "text");
  EXPECT_THROW(parameterKindName(static_cast<ParameterKind>(99)), std::logic_error);
}

}  // namespace
}  // namespace tiltmap
