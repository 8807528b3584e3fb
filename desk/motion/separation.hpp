#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion/contender.hpp"
#include "motion/limits.hpp"

namespace offnominal::desk::motion {

// What is expected of a recording; all shares are of the rms torque that the joint needs on the
// reference motion.
struct Expectation {
  double effect_share = 0.05;  // rms torque of an effect there
  double noise_share = 0.01;   // rms error of the torque behind the low-pass
  double log_rate_hz = 1000;   // of the recording to come: the time skew that may be in it
};

// How well a recording of a motion tells one effect, the true one, from a rival that takes its
// place together with all that every model may adapt. The worst of the true effect's shapes against
// the rival's best.
struct Separation {
  // Of the angle between the true effect's torque and the rival's, both without what the adapting
  // numbers explain; against no rival, between the true effect's and what these explain.
  double sine = 0;
  double torque_rms = 0;  // N m or N on the true effect's joint: what the rival cannot explain
  double noise_rms = 0;   // N m or N, expected
  // How many standard deviations the true effect would fit better by, block by block of time; what
  // `explain` calls ambiguous is below kTellApart.
  double evidence = 0;
};

// A motion against every pair.
struct SeparationTable {
  // [true effect][rival]; where both are the same, against no rival but the adapting numbers alone.
  std::vector<std::vector<Separation>> of;
  std::vector<bool> excited;  // per joint: whether it moves in more than one pattern
};

// Judges motions of one robot. Sizes and shapes of the effects are set once, on a reference motion,
// so that a motion on which an effect is larger counts for more.
class MotionJudge {
 public:
  // `truths` come first among `contenders`; every contender is a rival of every truth.
  MotionJudge(const RobotDescription& robot, const FittedMotion& reference, double design_rate_hz,
              std::vector<Contender> contenders, std::size_t truths,
              const Expectation& expectation);

  // The motion is sampled at the design's rate.
  [[nodiscard]] SeparationTable judge(const FittedMotion& motion) const;
  // Recordings that there are, together.
  [[nodiscard]] SeparationTable judge(const std::vector<Log>& recordings) const;
  [[nodiscard]] const std::vector<Contender>& contenders() const { return contenders_; }
  [[nodiscard]] std::size_t truth_count() const { return truths_; }

  struct Role {
    std::vector<ShapePoint> shapes;      // as a rival
    std::vector<std::size_t> as_truth;   // which of them, as the true effect
    std::vector<Eigen::VectorXd> sizes;  // per shape: coefficients
  };

 private:
  RobotDescription robot_;
  double rate_hz_;
  std::vector<Contender> contenders_;
  std::size_t truths_;
  Expectation expectation_;
  FilterPlan plan_;
  std::vector<Role> roles_;
  Eigen::VectorXd noise_rms_;
};

}  // namespace offnominal::desk::motion
