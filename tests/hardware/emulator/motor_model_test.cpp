#include "hardware/emulator/motor_model.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tiltmap {
namespace {

Instant at(double seconds) {
  return Instant{} + durationOf(seconds);
}

TEST(MotorModel, KeepsToSpeedAndAcceleration) {
  MotorModel motor(1000.0);
  EXPECT_EQ(motor.rawPosition(at(0.0)), 1000.0);
  motor.moveTo(at(1.0), 25000.0, 120.0, 2.0);
  EXPECT_NEAR(secondsOf(motor.arrival() - at(1.0)), 0.260, 1e-6);
  double position = 1000.0, speed = 0.0;
  for (int ms = 1; ms <= 300; ++ms) {
    const double next = motor.rawPosition(at(1.0 + 0.001 * ms));
    EXPECT_GE(next, position);
    EXPECT_LE(next - position, 120.0 + 1e-6);
    EXPECT_LE(std::abs(next - position - speed), 2.0 + 0.01) << ms;
    speed = next - position;
    position = next;
  }
  EXPECT_EQ(position, 25000.0);
  EXPECT_EQ(motor.rawPosition(at(0.5)), 1000.0) << "and it knows where it was";
}

TEST(MotorModel, AShortMoveHasNoCruise) {
  MotorModel motor(0.0);
  motor.moveTo(at(0.0), -6945.0, 120.0, 2.0);
  EXPECT_NEAR(secondsOf(motor.arrival() - at(0.0)), 0.002 * std::sqrt(6945.0 / 2.0), 1e-6);
  EXPECT_NEAR(motor.rawPosition(at(0.5 * secondsOf(motor.arrival() - at(0.0)))), -3472.5, 0.01);
  EXPECT_EQ(motor.rawPosition(motor.arrival()), -6945.0);
}

TEST(MotorModel, SwingsUntilItHasSettled) {
  MotorModel motor(0.0);
  motor.moveTo(at(0.0), 6945.0, 120.0, 2.0);
  double swing = 0.0;
  for (int ms = 0; ms < 50; ++ms)
    swing =
        std::max(swing, std::abs(motor.position(motor.arrival() + durationOf(0.001 * ms), 0.05) - 6945.0));
  EXPECT_GT(swing, 100.0);
  EXPECT_EQ(motor.position(motor.arrival() + durationOf(0.05), 0.05), 6945.0);
}

TEST(MotorModel, HaltsWhereItIs) {
  MotorModel motor(0.0);
  motor.moveTo(at(0.0), 24000.0, 120.0, 2.0);
  motor.haltAt(at(0.1));
  const double here = motor.rawPosition(at(0.1));
  EXPECT_GT(here, 3600.0);
  EXPECT_LT(here, 12000.0);
  EXPECT_EQ(motor.rawPosition(at(5.0)), here);
  EXPECT_LT(motor.rawPosition(at(0.05)), here);
  motor.shift(-here);
  EXPECT_EQ(motor.rawPosition(at(5.0)), 0.0);
  motor.moveTo(at(20.0), 10.0, 120.0, 2.0);
  EXPECT_EQ(motor.rawPosition(at(19.0)), 0.0) << "what lies far back may be forgotten, not the place";
}

}  // namespace
}  // namespace tiltmap
