#include "compare/transmission.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "compare/inverse_model.hpp"
#include "identify/effects/effects.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Regressor of_displacement(const Workspace& at, const VectorXd& along, VectorXd x,
                          double scale = 1) {
  const MatrixXd change =
      torque_of_displacement(at.rigid, at.motion, at.load_torque, along,
                             displacement_of(std::move(x), at.period_s()), scale);
  Regressor regressor;
  for (Index j = 0; j < at.joint_count(); ++j) regressor.push_back({j, change.col(j)});
  return regressor;
}

// Linear in the compliance. The gear transmits the measured torque less rotor and friction of the
// motor; of a motor, what of that torque is its own.
class Elasticity final : public EffectCandidate {
 public:
  Elasticity() : EffectCandidate(EffectKind::kJointElasticity) {}
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& /*at*/,
                                 Index /*joint*/) const override {
    return {};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    const SpringPlace place = place_of_spring(at.rigid, joint, of_motor());
    const VectorXd transmitted =
        (at.torque - (at.stiff_torque - at.load_torque)) * place.from_torques;
    const double noise = at.torque_noise_density.cwiseProduct(place.from_torques).norm();
    return {of_displacement(at, place.along, without_noise(transmitted, noise, at.plan), 1e-5)};
  }
  Parameters found_parameters(const VectorXd& coefficients,
                              std::span<const double> /*shape*/) const override {
    return {1 / coefficients[0]};
  }
  bool shape_is_coefficient(std::size_t parameter) const override { return parameter == 0; }
  bool is_physical(const VectorXd& c) const override { return c[0] > 0; }
  // Linear in the compliance it holds for deflections far below the range moved; what would bend
  // the joint through more of that is no elasticity of a drive.
  bool is_within_reach(const std::vector<Workspace>& at, Index joint, const VectorXd& coefficients,
                       std::span<const double> /*shape*/,
                       const std::vector<ShapeRange>& /*ranges*/) const override {
    constexpr double kOfRange = 0.05;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double deflection = 0;
    for (const Workspace& one : at) {
      const VectorXd q = of_motor() ? VectorXd(motor_motion(one.rigid, one.motion).q.col(joint))
                                    : VectorXd(one.motion.q.col(joint));
      low = std::min(low, q.minCoeff());
      high = std::max(high, q.maxCoeff());
      const SpringPlace place = place_of_spring(one.rigid, joint, of_motor());
      const Eigen::ArrayXd load = (one.load_torque * place.from_torques).array();
      const double spread = std::sqrt((load - load.mean()).square().mean());
      deflection = std::max(deflection, coefficients[0] * spread);
    }
    return deflection <= kOfRange * (high - low);
  }
  bool is_only_screened() const override { return true; }
};

// Its size is in its width: the coefficient is a share of it, near 1.
class Backlash final : public EffectCandidate {
 public:
  Backlash() : EffectCandidate(EffectKind::kBacklash) {}
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    const VectorXd inertia = at.mass[static_cast<std::size_t>(joint)].col(joint);
    return {
        of_displacement(at, VectorXd::Unit(at.joint_count(), joint),
                        play_displacement(at.load_torque.col(joint), inertia, shape[0], at.plan))};
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
