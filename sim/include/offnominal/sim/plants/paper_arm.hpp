// The paper's arm as a plant.
#pragma once

#include "offnominal/sim/plant.hpp"
#include "offnominal/sim/trajectory.hpp"
#include "offnominal/sim/two_link_plant.hpp"

namespace offnominal::sim {

class PaperArm final : public Plant {
 public:
  /// substeps >= 1: Runge-Kutta steps in one step of the plant.
  explicit PaperArm(const TwoLinkPlant& equations,
                    const JointState& start = on_trajectory(paper_trajectory(0.0)),
                    int substeps = 1)
      : equations_(equations), state_(start), substeps_(substeps) {}

  [[nodiscard]] const JointState& state() const override { return state_; }
  void step(double t_s, const JointVector& tau, double period_s) override {
    const TwoLinkState next = equations_.step(t_s, {state_.q, state_.dq}, tau, period_s, substeps_);
    state_ = {next.q, next.dq};
  }
  [[nodiscard]] JointVector fault_function(double t_s, const JointVector& tau) const override {
    return equations_.fault_function(t_s, {state_.q, state_.dq}, tau);
  }

 private:
  TwoLinkPlant equations_;
  JointState state_;
  int substeps_;
};

}  // namespace offnominal::sim
