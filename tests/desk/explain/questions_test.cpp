// What is asked of every effect that is found, on errors that are made up.
#include "explain/questions.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "explain/friction_family.hpp"
#include "explain/link_share.hpp"
#include "identify/workspace.hpp"
#include "serial_arm.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

class MadeUpErrors : public ::testing::Test {
 protected:
  explicit MadeUpErrors(std::size_t joints) : robot_(test::serial_arm(joints)) {
    const std::vector<Log> logs{test::record(robot_, {.duration_s = 12})};
    const FilterPlan plan = plan_filter(logs, robot_);
    const auto widths = VectorXd::Zero(robot_.joint_count());
    data_ = std::make_unique<Data>(make_workspaces(logs, robot_, plan, widths), robot_,
                                   NuisanceOptions{});
    regression_ = std::make_unique<Regression>(*data_);
    hold_out_ = std::make_unique<HoldOut>(*regression_, nullptr);
  }

  [[nodiscard]] VectorXd independent() const {
    return VectorXd::Constant(robot_.joint_count(), 200.0);
  }

  RobotDescription robot_;
  std::unique_ptr<Data> data_;
  std::unique_ptr<Regression> regression_;
  std::unique_ptr<HoldOut> hold_out_;
};

class Weights : public MadeUpErrors {
 protected:
  Weights() : MadeUpErrors(2) {}
};

TEST_F(Weights, OfTheSameModelGiveTheSameFit) {
  const ModelFit own = regression_->fit({});
  const ModelFit again = regression_->fit_weighted_as(own, {});
  EXPECT_EQ(again.joint_weights, own.joint_weights);
  EXPECT_EQ(again.prior_weight, own.prior_weight);
  EXPECT_TRUE(again.nuisance.isApprox(own.nuisance, 1e-9));
  EXPECT_TRUE(again.remainder.energy.isApprox(own.remainder.energy, 1e-9));
  ModelFit other = own;
  other.prior_weight *= 10;
  EXPECT_FALSE(regression_->fit_weighted_as(other, {}).nuisance.isApprox(own.nuisance, 1e-3));
}

class AnySpeed : public MadeUpErrors {
 protected:
  AnySpeed() : MadeUpErrors(1) {}

  // Errors of one size next to a reversal, and of another where the joint moves.
  [[nodiscard]] ModelFit errors(double at_reversal, double moving) const {
    const Workspace& at = data_->recordings[0];
    const VectorXd speed = kept_samples(at.plan, at.motion.dq.col(0)).cwiseAbs();
    ModelFit fit;
    fit.residual = (speed.array() < 0.1 * at.top_speed[0])
                       .select(at_reversal, VectorXd::Constant(speed.size(), moving));
    fit.remainder.independent_samples = independent();
    return fit;
  }
};

TEST_F(AnySpeed, GIVEN_less_next_to_reversals_and_more_elsewhere_THEN_nothing_speaks_for_it) {
  const ModelFit without = errors(1, 0.05);
  const ModelFit with = errors(0.9, 0.055);
  EXPECT_LT(data_->layout.rms(with.residual)[0], 0.95 * data_->layout.rms(without.residual)[0])
      << "as a whole it must look better";
  EXPECT_FALSE(is_more_likely_at_any_speed(*data_, without, with, 0));
}

TEST_F(AnySpeed, GIVEN_less_next_to_reversals_alone_THEN_that_speaks_for_it) {
  EXPECT_TRUE(is_more_likely_at_any_speed(*data_, errors(1, 0.05), errors(0.9, 0.05), 0));
}

TEST_F(AnySpeed, GIVEN_less_where_the_joint_moves_THEN_that_speaks_for_it) {
  EXPECT_TRUE(is_more_likely_at_any_speed(*data_, errors(1, 0.05), errors(1, 0.04), 0));
}

class WiderLinks : public MadeUpErrors {
 protected:
  WiderLinks() : MadeUpErrors(4) {}

  // What has these names and leaves so much of each joint's torque.
  [[nodiscard]] FoundModel found(const std::vector<EffectAt>& names,
                                 const std::vector<double>& shares) const {
    FoundModel model;
    for (const EffectAt& name : names) {
      model.accepted.push_back({first_on_grid(*data_, name.kind, name.joint)});
      model.fit.coefficients.emplace_back(VectorXd::Ones(1));
    }
    model.fit.remainder.independent_samples = independent();
    const RowLayout& layout = data_->layout;
    const VectorXd torque = layout.rms(data_->torque);
    model.held_out_after = VectorXd::Zero(layout.rows());
    for (Index joint = 0; joint < layout.joint_count(); ++joint) {
      model.held_out_after.segment(layout.begin(0, joint), layout.samples(0))
          .setConstant(shares[static_cast<std::size_t>(joint)] * torque[joint]);
    }
    return model;
  }

  [[nodiscard]] bool widens(const FoundModel& wide, const FoundModel& usual) const {
    return is_clearly_better(*hold_out_, wide, usual, true);
  }

  const EffectAt payload_{EffectKind::kTipPayload, 3};
  const EffectAt friction_{EffectKind::kQuadraticFriction, 1};
  const FoundModel usual_ = found({payload_, friction_}, {0.004, 0.004, 0.004, 0.009});
};

TEST_F(WiderLinks, GIVEN_little_on_one_joint_and_the_same_names_THEN_they_are_not_taken) {
  EXPECT_FALSE(widens(found({payload_, friction_}, {0.004, 0.004, 0.004, 0.004}), usual_));
}

TEST_F(WiderLinks, GIVEN_a_payload_that_vanishes_at_the_price_of_a_joint_THEN_they_are_not_taken) {
  EXPECT_FALSE(widens(found({friction_}, {0.004, 0.004, 0.006, 0.002}), usual_));
}

TEST_F(WiderLinks, GIVEN_a_payload_that_nothing_misses_THEN_they_are_taken) {
  EXPECT_TRUE(widens(found({friction_}, {0.004, 0.004, 0.004, 0.002}), usual_));
}

TEST_F(WiderLinks, GIVEN_little_on_most_joints_THEN_they_are_taken) {
  EXPECT_TRUE(widens(found({payload_, friction_}, {0.002, 0.002, 0.002, 0.004}), usual_));
}

TEST_F(WiderLinks, GIVEN_another_name_in_place_of_a_payload_THEN_they_are_taken) {
  const EffectAt scale{EffectKind::kTorqueScale, 0};
  EXPECT_TRUE(widens(found({friction_, scale}, {0.004, 0.004, 0.004, 0.004}), usual_));
}

TEST_F(WiderLinks, GIVEN_much_on_one_joint_THEN_they_are_taken) {
  const FoundModel usual = found({payload_}, {0.004, 0.004, 0.004, 0.03});
  EXPECT_TRUE(widens(found({payload_}, {0.004, 0.004, 0.004, 0.004}), usual));
}

}  // namespace
}  // namespace offnominal::desk
