#include "analysis/inverse_model.hpp"
#include "discovery/effects/effects.hpp"

namespace offnominal::tools::discovery {
namespace {

using Eigen::Index;

Regressor of_inertial_effect(const Workspace& at, const Effect<double>& effect) {
  const Eigen::MatrixXd torque = torque_of_inertial_effect(at.rigid, effect, at.motion);
  Regressor regressor;
  for (Index joint = 0; joint <= effect.joint; ++joint) {
    regressor.push_back({joint, torque.col(joint)});
  }
  return regressor;
}

class RotorInertia final : public EffectCandidate {
 public:
  const char* name() const override { return "rotor_inertia"; }
  const char* formula() const override { return "inertia * ddq"; }
  const char* words() const override { return "the inertia of rotor and gear"; }
  const char* motion_hint() const override { return "accelerate hard, link by link"; }
  std::vector<LinearParameter> linear_parameters(JointType type) const override {
    return {{"inertia", offnominal::unit_of(Quantity::kReflectedInertia, type)}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    return {{{joint, at.motion.ddq.col(joint)}}};
  }
  bool is_physical(const Eigen::VectorXd& c) const override { return c[0] > 0; }
};

class LinkMass final : public EffectCandidate {
 public:
  const char* name() const override { return "link_mass"; }
  const char* formula() const override { return "mass at the link's centre of mass"; }
  const char* words() const override { return "a link of another mass"; }
  const char* motion_hint() const override { return "hold several poses under gravity"; }
  std::vector<LinearParameter> linear_parameters(JointType /*type*/) const override {
    return {{"mass", "kg"}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> /*shape*/) const override {
    Effect<double> effect{EffectKind::kLinkMass, static_cast<std::uint8_t>(joint), {1}};
    return {of_inertial_effect(at, effect)};
  }
  bool acts_at_rest(const Workspace& /*at*/, Index /*joint*/) const override { return true; }
};

class TipPayload final : public EffectCandidate {
 public:
  const char* name() const override { return "tip_payload"; }
  const char* formula() const override { return "mass at (x, 0, 0) of the last link's frame"; }
  const char* words() const override { return "a payload at the tip"; }
  const char* motion_hint() const override { return "hold several poses under gravity"; }
  std::vector<LinearParameter> linear_parameters(JointType /*type*/) const override {
    return {{"mass", "kg"}};
  }
  std::vector<ShapeRange> shapes(const std::vector<Workspace>& at, Index joint) const override {
    const double centre =
        at[0].rigid.joints[static_cast<std::size_t>(joint)].joint.centre_of_mass_m[0];
    return {{"x", "m", {1.5 * centre, 1.75 * centre, 2 * centre, 2.5 * centre, 3 * centre}}};
  }
  std::vector<Regressor> regressors(const Workspace& at, Index joint,
                                    std::span<const double> shape) const override {
    Effect<double> effect{
        EffectKind::kTipPayload, static_cast<std::uint8_t>(joint), {1, shape[0], 0, 0}};
    return {of_inertial_effect(at, effect)};
  }
  bool applies(const Workspace& at, Index joint) const override {
    return joint + 1 == at.joint_count();
  }
  bool acts_at_rest(const Workspace& at, Index joint) const override { return applies(at, joint); }
};

}  // namespace

void add_inertia_effects(Candidates& all) {
  all.push_back(std::make_unique<RotorInertia>());
  all.push_back(std::make_unique<LinkMass>());
  all.push_back(std::make_unique<TipPayload>());
}

}  // namespace offnominal::tools::discovery
