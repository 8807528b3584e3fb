#include "calibrate/smallest_fault.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

// On residuals and thresholds that are written down.

namespace offnominal::desk {
namespace {

constexpr double kAlpha = 10;
constexpr double kWindow = 0.5;  // five time constants
const double kPassed = -std::expm1(-kAlpha * kWindow);

RecordedError with_residual(double duration_s, double period_s,
                            const std::function<double(double)>& residual) {
  RecordedError recorded;
  recorded.period_s = period_s;
  const auto samples = static_cast<Eigen::Index>(std::lround(duration_s / period_s)) + 1;
  recorded.t_s = Eigen::VectorXd::LinSpaced(samples, 0, duration_s);
  recorded.error = recorded.t_s.unaryExpr(residual);
  return recorded;
}

SmallestFault found(const std::vector<RecordedError>& recordings, double threshold) {
  std::vector<Eigen::VectorXd> thresholds;
  for (const RecordedError& recorded : recordings) {
    thresholds.push_back(Eigen::VectorXd::Constant(recorded.samples(), threshold));
  }
  return smallest_fault(recordings, thresholds, {{}, {threshold}, 0}, kAlpha);
}

TEST(SmallestFault, WithoutAResidualIsWhatTheFilterLetsPass) {
  const SmallestFault fault = found({with_residual(20, 0.001, [](double) { return 0.0; })}, 2);
  EXPECT_NEAR(fault.usual, 2 / kPassed, 1e-6);
  EXPECT_NEAR(fault.twice_s, std::log(2.0) / kAlpha, 0.002);
}

TEST(SmallestFault, IsCertainOfWhatTheBoundComesToAtSpeedsThatWereNotRecorded) {
  const std::vector<RecordedError> slow{with_residual(20, 0.01, [](double) { return 0.0; })};
  const JointBoundSettings bound{{0, 1, 5}, {1, 2, 7}, 0.1};
  const auto fault = smallest_fault(slow, {Eigen::VectorXd::Constant(2001, 1.5)}, bound, kAlpha);
  EXPECT_DOUBLE_EQ(fault.certain, 2 * (7 + 2 * kAlpha * 0.1));
  EXPECT_DOUBLE_EQ(fault.certain_with, 1.25 * fault.certain);
  EXPECT_NEAR(fault.certain_s, std::log(5.0) / kAlpha + 0.01, 1e-12);
}

// In 8 of 100 beginnings a fault of one sign has to be larger: that is more than 5 of 100,
// whichever its sign.
TEST(SmallestFault, IsSeenInThatManyBeginningsWhicheverItsSign) {
  const auto now_and_then = [](double t_s) { return t_s < 8 ? 0.5 : 0.0; };
  const SmallestFault fault = found({with_residual(100, 0.01, now_and_then)}, 1);
  EXPECT_NEAR(fault.usual, 1.5 / kPassed, 0.01);
}

TEST(SmallestFault, LooksAtEachRecordingAtItsOwnPeriod) {
  const auto wave = [](double t_s) { return std::sin(2 * std::numbers::pi * t_s); };
  const RecordedError slow = with_residual(2, 0.01, wave);
  const RecordedError fast = with_residual(40, 0.001, wave);
  const double alone = found({fast}, 2).usual;
  EXPECT_NEAR(found({slow, fast}, 2).usual, alone, 0.03 * alone);
  EXPECT_NEAR(found({fast, slow}, 2).usual, alone, 0.03 * alone);
}

}  // namespace
}  // namespace offnominal::desk
