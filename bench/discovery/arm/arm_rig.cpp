#include "arm_rig.hpp"

#include <algorithm>
#include <cmath>

namespace offnominal::bench {

using Eigen::Index;
using sim::JointVector;

namespace {

constexpr double kTickS = 0.001;
constexpr int kSubsteps = 2;
constexpr double kSubstepS = kTickS / kSubsteps;

// What acts at a tick's time, in the mean, is so much of the torque of the tick before it: a half
// if it were held over a tick; the semi-implicit Euler method takes each at the beginning of a
// substep.
constexpr double kBefore = 0.5 * (1 - 1.0 / kSubsteps);

double sign_of(double speed) { return speed > 0 ? 1.0 : speed < 0 ? -1.0 : 0.0; }

// Plant and drives, with what is hidden.
class Stand {
 public:
  Stand(const ArmRig& rig, const sim::DesiredMotion& start)
      : rig_(rig),
        plant_(rig.model, {.start = sim::on_trajectory(start), .longest_substep_s = kSubstepS}),
        squares_(rig.effects.size(), 0.0) {
    const auto count = static_cast<Index>(rig.model.joints().size());
    load_ = JointVector::Zero(count);
    for (const ArmEffect& effect : rig.effects) {
      if (is_payload(effect) && effect.from_s <= 0) hang(effect);
    }
  }

  sim::MujocoPlant& plant() { return plant_; }

  // Held over one tick.
  void tick(double t_s, const JointVector& told) {
    for (int i = 0; i < kSubsteps; ++i) substep(t_s + i * kSubstepS, told);
  }

  // Takes what each effect amounts to now.
  void sample(double t_s, const JointVector& told, const JointVector& ddq) {
    ++samples_;
    for (std::size_t i = 0; i < squares_.size(); ++i) {
      const double torque = torque_of(rig_.effects[i], t_s, told, ddq);
      squares_[i] += torque * torque;
    }
  }

  [[nodiscard]] std::vector<double> effect_rms() const {
    std::vector<double> rms(squares_);
    for (double& one : rms) one = std::sqrt(one / std::max(samples_, 1));
    return rms;
  }

 private:
  static bool is_payload(const ArmEffect& effect) { return effect.kind == EffectKind::kTipPayload; }
  static bool has_begun(const ArmEffect& effect, double t_s) { return t_s + 1e-9 >= effect.from_s; }
  void hang(const ArmEffect& effect) {
    plant_.set_payload(effect.joint, effect.number(0),
                       {effect.number(1), effect.number(2), effect.number(3)});
  }

  void substep(double t_s, const JointVector& told) {
    const auto& joints = rig_.model.joints();
    const auto count = static_cast<Index>(joints.size());
    JointVector given = told;
    for (Index j = 0; j < count; ++j) given[j] *= rig_.torque_constant[static_cast<std::size_t>(j)];
    for (const ArmEffect& effect : rig_.effects) {
      const bool scales = effect.kind == EffectKind::kTorqueScale && has_begun(effect, t_s);
      if (scales) given[effect.joint] /= 1 + effect.number(0);
    }
    JointVector loss(count);
    JointVector damping(count);
    for (Index j = 0; j < count; ++j) {
      loss[j] = joints[static_cast<std::size_t>(j)].friction_loss;
      damping[j] = joints[static_cast<std::size_t>(j)].damping;
    }
    for (const ArmEffect& effect : rig_.effects) {
      if (!has_begun(effect, t_s)) continue;
      const bool begins = effect.from_s > 0 && t_s < effect.from_s + kSubstepS - 1e-9;
      if (is_payload(effect) && begins) hang(effect);
      loss[effect.joint] += loss_of(effect, t_s);
      damping[effect.joint] += damping_of(effect, t_s);
      given[effect.joint] -= added_by(effect, t_s);
    }
    for (Index j = 0; j < count; ++j) {
      plant_.set_friction_loss(j, std::max(loss[j], 0.0));
      plant_.set_damping(j, damping[j]);
    }
    // One link may be pushed more than once: only what acts now is told to the plant last.
    for (const ArmPush& push : rig_.pushes) {
      if (!acts(push, t_s)) plant_.push(push.link, Eigen::Vector3d::Zero(), push.at_m);
    }
    for (const ArmPush& push : rig_.pushes) {
      if (acts(push, t_s)) plant_.push(push.link, push.force_n, push.at_m);
    }
    plant_.step(t_s, given, kSubstepS);
    load_ = plant_.gear_torque();
  }

  static bool acts(const ArmPush& push, double t_s) {
    return t_s >= push.from_s && t_s < push.to_s;
  }
  [[nodiscard]] double speed(Index joint) const { return plant_.state().dq[joint]; }

  [[nodiscard]] double loss_of(const ArmEffect& effect, double t_s) const {
    const double v = speed(effect.joint);
    switch (effect.kind) {
      case EffectKind::kCoulombFriction:
        return effect.number(0);
      case EffectKind::kStribeckFriction:
        return effect.number(0) * std::exp(-std::pow(v / effect.number(1), 2));
      case EffectKind::kFrictionAsymmetry:
        return effect.number(0) * sign_of(v);
      case EffectKind::kLoadDependentFriction:
        return effect.number(0) * std::abs(load_[effect.joint]);
      case EffectKind::kTemperatureDrift:
        return effect.number(0) * std::exp(-t_s / effect.number(2));
      default:
        return 0;
    }
  }

  [[nodiscard]] double damping_of(const ArmEffect& effect, double t_s) const {
    const double v = speed(effect.joint);
    switch (effect.kind) {
      case EffectKind::kViscousFriction:
        return effect.number(0);
      case EffectKind::kQuadraticFriction:
        return effect.number(0) * std::abs(v);
      case EffectKind::kFrictionAsymmetry:
        return effect.number(1) * sign_of(v);
      case EffectKind::kTemperatureDrift:
        return effect.number(1) * std::exp(-t_s / effect.number(2));
      default:
        return 0;
    }
  }

  // What the drive has to supply besides.
  [[nodiscard]] double added_by(const ArmEffect& effect, double t_s) const {
    const double q = plant_.state().q[effect.joint];
    switch (effect.kind) {
      case EffectKind::kTorqueOffset:
        return effect.number(0);
      case EffectKind::kJointStiffness:
        return effect.number(0) * (q - effect.number(1));
      case EffectKind::kCoggingTorque:
        return effect.number(0) * std::sin(effect.number(2) * q) +
               effect.number(1) * std::cos(effect.number(2) * q);
      case EffectKind::kPeriodicDisturbance: {
        const double angle = effect.number(2) * t_s;
        return effect.number(0) * std::sin(angle) + effect.number(1) * std::cos(angle);
      }
      case EffectKind::kJointCoupling:
        return effect.number(0) * speed(static_cast<Index>(effect.number(2)) - 1);
      default:
        return 0;
    }
  }

  [[nodiscard]] double torque_of(const ArmEffect& effect, double t_s, const JointVector& told,
                                 const JointVector& ddq) const {
    if (!has_begun(effect, t_s)) return 0;
    const double v = speed(effect.joint);
    constexpr double kStands = 1e-4;  // rad/s
    const double sign = std::abs(v) > kStands ? sign_of(v) : 0;
    double torque = loss_of(effect, t_s) * sign + damping_of(effect, t_s) * v;
    torque += added_by(effect, t_s);
    if (effect.kind == EffectKind::kRotorInertia) torque += effect.number(0) * ddq[effect.joint];
    if (effect.kind == EffectKind::kTorqueScale) {
      torque += told[effect.joint] * effect.number(0) / (1 + effect.number(0));
    }
    return torque;
  }

  const ArmRig& rig_;
  sim::MujocoPlant plant_;
  JointVector load_;
  std::vector<double> squares_;
  int samples_ = 0;
};

}  // namespace

Eigen::VectorXd joint_inertias(const sim::MujocoPlant& plant,
                               const sim::hidden::ArmMotion& motion) {
  sim::DesiredMotion pose = motion.at(0);
  for (Index j = 0; j < pose.q.size(); ++j) {
    pose.q[j] = motion.joints[static_cast<std::size_t>(j)].middle;
  }
  pose.dq.setZero();
  pose.ddq.setZero();
  const JointVector still = plant.inverse_dynamics(pose);
  Eigen::VectorXd inertias(pose.q.size());
  for (Index j = 0; j < inertias.size(); ++j) {
    pose.ddq.setZero();
    pose.ddq[j] = 1;
    inertias[j] = plant.inverse_dynamics(pose)[j] - still[j];
  }
  return inertias;
}

ArmRun run_arm(const ArmRig& rig, const sim::hidden::ArmMotion& motion, double duration_s,
               int every) {
  constexpr double kBandwidth = 30;  // rad/s
  Stand stand(rig, motion.at(0));
  const JointVector inertias = joint_inertias(stand.plant(), motion);
  const auto ticks = static_cast<Index>(std::llround(duration_s / kTickS));
  const Index samples = ticks / every;
  ArmRun run;
  run.t_s.resize(samples);
  for (auto* columns : {&run.q, &run.dq, &run.tau}) columns->resize(samples, inertias.size());
  JointVector before;
  for (Index tick = 0; tick < samples * every; ++tick) {
    const double t_s = static_cast<double>(tick) * kTickS;
    const sim::DesiredMotion wanted = motion.at(t_s);
    const sim::JointState is = stand.plant().state();
    const JointVector told = stand.plant().inverse_dynamics(wanted) +
                             inertias.cwiseProduct(kBandwidth * kBandwidth * (wanted.q - is.q) +
                                                   2 * kBandwidth * (wanted.dq - is.dq));
    if (tick == 0) before = told;
    if (tick % every == 0) {
      const Index row = tick / every;
      run.t_s[row] = t_s;
      run.q.row(row) = is.q;
      run.dq.row(row) = is.dq;
      run.tau.row(row) = kBefore * before + (1 - kBefore) * told;
      stand.sample(t_s, told, wanted.ddq);
    }
    stand.tick(t_s, told);
    before = told;
  }
  run.effect_rms = stand.effect_rms();
  return run;
}

}  // namespace offnominal::bench
