#include "calibrate/shape_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "desk/compare/recorded_arm.hpp"

// What a table of thresholds says of a speed that a joint only passed through.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kPeriodS = 0.001;

// Joint 1 at these speeds, so many ticks each, and the residual that its monitor has there.
struct Stay {
  double speed = 0;
  Index ticks = 0;
  double residual = 0;
};
RecordedError recorded(const std::vector<Stay>& stays) {
  Index ticks = 1;
  for (const Stay& one : stays) ticks += one.ticks;
  auto signals = std::make_shared<RecordedSignals>();
  for (MatrixXd* of : {&signals->q, &signals->dq, &signals->tau}) *of = MatrixXd::Zero(ticks, 2);
  RecordedError of;
  of.file = "a.csv";
  of.unit = "N m";
  of.period_s = kPeriodS;
  of.t_s = VectorXd::LinSpaced(ticks, 0, kPeriodS * static_cast<double>(ticks - 1));
  of.error = MatrixXd::Zero(ticks, 1);
  of.alpha_per_s = test::arm_description().estimator.alpha;
  of.scale = of.alpha_per_s;
  of.of_one_joint = true;
  Index at = 0;
  for (const Stay& one : stays) {
    for (Index i = 0; i < one.ticks; ++i) {
      ++at;
      signals->dq(at, 0) = one.speed;
      of.error(at, 0) = one.residual;
    }
  }
  of.error_norm = of.error.col(0).cwiseAbs();
  of.loudest_joint = Eigen::VectorXi::Zero(ticks);
  of.signals = signals;
  return of;
}

BoundShape table_over_speed() {
  BoundShape shape;
  shape.settings.kind = BoundSettings::Kind::kTable;
  shape.settings.table.variable = BoundVariable::kSpeed;
  shape.settings.table.joint = 0;
  shape.settings.table.at = {0, 0.5, 1};
  shape.settings.table.value = {1, 1, 1};
  shape.size = 3;
  return shape;
}

// All of what two recordings ask for, each of which has its turn at being unseen.
VectorXd fitted(const RecordedError& recording) {
  RobotDescription robot = test::arm_description();
  robot.estimator.space = EstimatorSpace::kTorque;
  Split split;
  split.folds = {{0, 1, recording.samples()}, {1, 1, recording.samples()}};
  return fit_shape(robot, table_over_speed(), {recording, recording}, split, {1e-3, 0}, 0.0)
      .coefficients;
}

// Slow and fast, where the residual is large, with quick passes between.
std::vector<Stay> to_and_fro(Index passing) {
  std::vector<Stay> stays;
  for (int i = 0; i < 4; ++i) {
    stays.push_back({0, 1000, 2});
    stays.push_back({0.5, passing, 0.2});
    stays.push_back({1, 1000, 2});
    stays.push_back({0.5, passing, 0.2});
  }
  return stays;
}

TEST(ShapeFit, GivenASpeedThatIsOnlyPassedThenItsThresholdIsThatOfItsNeighbours) {
  const VectorXd c = fitted(recorded(to_and_fro(20)));
  EXPECT_GT(c[0], 1.9);
  EXPECT_GT(c[2], 1.9);
  EXPECT_GE(c[1], std::min(c[0], c[2]));
}

TEST(ShapeFit, GivenAStayAtASpeedThenItsThresholdIsItsOwn) {
  std::vector<Stay> stays = to_and_fro(20);
  // The residual follows the filter down from what it was.
  stays.push_back({0.5, 500, 2});
  stays.push_back({0.5, 2000, 0.2});
  VectorXd c = fitted(recorded(stays));
  EXPECT_GT(c[1], 1.9) << "for half a second it was as large there";
  stays = to_and_fro(20);
  stays.push_back({1, 1000, 2});
  for (int i = 0; i < 60; ++i) {
    stays.push_back({0.5, 10, 2 * std::exp(-0.1 * i)});
  }
  stays.push_back({0.5, 2000, 0.2});
  c = fitted(recorded(stays));
  EXPECT_LT(c[1], 1);
}

}  // namespace
}  // namespace offnominal::desk
