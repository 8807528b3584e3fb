#include <algorithm>
#include <cmath>
#include <numbers>

#include "compare/inverse_model.hpp"
#include "identify/effects/effects.hpp"
#include "signal/differentiate.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Displacement {
  VectorXd x;  // q_motor - q_link
  VectorXd dx;
  VectorXd ddx;
};

// What the displacement times `scale` changes in the torque of every joint, per scale.
Regressor of_displacement(const Workspace& at, Index joint, const Displacement& by,
                          double scale = 1) {
  Motion behind = at.motion;
  behind.q.col(joint) -= scale * by.x;
  behind.dq.col(joint) -= scale * by.dx;
  behind.ddq.col(joint) -= scale * by.ddx;
  const MatrixXd change = (model_torque(at.rigid, behind) - at.load_torque) / scale;
  Regressor regressor;
  for (Index j = 0; j < at.joint_count(); ++j) regressor.push_back({j, change.col(j)});
  return regressor;
}

Displacement derivatives_of(const Workspace& at, VectorXd x) {
  const VectorXd dx = central_difference(x, at.period_s());
  VectorXd ddx = central_difference(dx, at.period_s());
  return {std::move(x), dx, std::move(ddx)};
}

// Torque that the gear transmits: the measured one less rotor and friction of the motor. Its noise
// is in the regression's other side too and would make an elasticity of itself, so the band is as
// wide as the noise allows: twice differentiated it must stay below kNoiseShare of what is really
// there.
VectorXd transmitted_torque(const Workspace& at, Index joint) {
  constexpr double kNoiseShare = 0.1;
  constexpr double kNarrower = 0.85;
  constexpr double kNarrowest = 0.2;
  const VectorXd transmitted =
      at.torque.col(joint) - (at.model_torque.col(joint) - at.load_torque.col(joint));
  double band_hz = at.plan.torque_cutoff_hz;
  while (true) {
    VectorXd smooth = zero_phase_low_pass(transmitted, band_hz, at.plan.sample_rate_hz);
    const VectorXd curved =
        central_difference(central_difference(smooth, at.period_s()), at.period_s());
    const double rms = std::sqrt(curved.squaredNorm() / static_cast<double>(curved.size()));
    // White noise of that density per root hertz, differentiated twice.
    const double noise = at.torque_noise_density[joint] * std::sqrt(band_hz / 5) *
                         std::pow(2 * std::numbers::pi * band_hz, 2);
    const double narrower = kNarrower * band_hz;
    if (noise < kNoiseShare * rms || narrower < kNarrowest * at.plan.torque_cutoff_hz) {
      return smooth;
    }
    band_hz = narrower;
  }
}

// Linear in the compliance.
class Elasticity final : public EffectCandidate {
 public:
  Elasticity() : EffectCandidate(EffectKind::kJointElasticity) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& /*at*/,
                                 Index /*joint*/) const override {
    return {};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {of_displacement(at, joint, derivatives_of(at, transmitted_torque(at, joint)), 1e-5)};
  }
  Parameters found_parameters(const VectorXd& coefficients,
                              std::span<const double> /*shape*/) const override {
    return {1 / coefficients[0]};
  }
  bool shape_is_coefficient(std::size_t parameter) const override { return parameter == 0; }
  bool is_physical(const VectorXd& c) const override { return c[0] > 0; }
  bool is_only_screened() const override { return true; }
};

// Displacement of motor against link while the motor moves as measured: at one side of the play the
// two move together; where the transmitted torque would change its sign they part, and the link
// moves under its own load until the other side is reached, without rebound.
VectorXd play_displacement(const Workspace& at, Index joint, double width) {
  const VectorXd inertia = at.mass[static_cast<std::size_t>(joint)].col(joint);
  const double half = width / 2;
  const double h = at.period_s();
  VectorXd x(at.sample_count());
  double position = at.load_torque(0, joint) >= 0 ? half : -half;
  double velocity = 0;
  for (Index i = 0; i < x.size(); ++i) {
    const double acceleration = at.load_torque(i, joint) / inertia[i];
    velocity += h * acceleration;
    position += h * velocity;
    if (position >= half || position <= -half) {
      position = std::clamp(position, -half, half);
      velocity = 0;
    }
    x[i] = position;
  }
  return x;
}

// Its size is in its width: the coefficient is a share of it, near 1.
class Backlash final : public EffectCandidate {
 public:
  Backlash() : EffectCandidate(EffectKind::kBacklash) {}
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    return {of_displacement(
        at, joint,
        derivatives_of(at,
                       zero_phase_low_pass(play_displacement(at, joint, shape[0]),
                                           at.plan.position_cutoff_hz, at.plan.sample_rate_hz)))};
  }
  bool is_physical(const VectorXd& c) const override { return is_near_one(c[0]); }
  bool is_only_screened() const override { return true; }
};

}  // namespace

Candidate transmission_candidate(EffectKind kind) {
  if (kind == EffectKind::kJointElasticity) return std::make_unique<Elasticity>();
  if (kind == EffectKind::kBacklash) return std::make_unique<Backlash>();
  return nullptr;
}

}  // namespace offnominal::desk
