#include "arm_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "arm_recording.hpp"
#include "arm_robot.hpp"
#include "arm_sketch.hpp"
#include "campaign/cad_errors.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::bench {

using Eigen::Index;
using sim::hidden::Draws;
using sim::hidden::Stream;

namespace {

class ArmDrawing {
 public:
  explicit ArmDrawing(const ArmRequest& request)
      : request_(request),
        arm_(request.seed, Stream::kArm),
        knowledge_(request.seed, Stream::kKnowledge),
        hidden_(request.seed, Stream::kEffects),
        contact_(request.seed, Stream::kContact) {}

  ArmCase make() {
    draw_recording();
    truth_robot_ = draw_rigid_arm(arm_);
    rigid_robot_ = truth_robot_;
    draw_motion();
    draw_drives();
    draw_hidden();
    simulate();
    ask();
    case_.robot = known_robot();
    return std::move(case_);
  }

 private:
  [[nodiscard]] std::size_t joints() const { return truth_robot_.joints.size(); }
  [[nodiscard]] bool hides(ArmHides what) const { return request_.hides == what; }
  ArmTruth& truth() { return case_.truth; }

  void draw_recording() {
    constexpr std::array<int, 6> kEvery{10, 8, 5, 4, 2, 1};  // ticks of 1 ms
    style_.every = kEvery[static_cast<std::size_t>(arm_.below(static_cast<int>(kEvery.size())))];
    truth().rate_hz = 1000.0 / style_.every;
    truth().duration_s = std::round(arm_.uniform(20, 40));
    style_.has_five_digits = arm_.uniform(0, 1) < 0.35;
    style_.bits = 14 + arm_.below(7);
    truth().positions = style_.has_five_digits ? "5 digits" : fmt::format("{} bit", style_.bits);
    style_.logs_velocity = arm_.uniform(0, 1) < 0.4;
    noise_share_ = arm_.log_uniform(0.001, 0.005);
  }

  void draw_motion() {
    std::vector<double> middles(joints());
    for (double& one : middles) one = arm_.uniform(-0.7, 0.7);
    stands_.assign(joints(), false);
    const double stands = arm_.uniform(0, 1);
    const int how_many = stands < 0.1 ? 2 : stands < 0.4 ? 1 : 0;
    for (int i = 0; i < how_many; ++i) {
      stands_[static_cast<std::size_t>(arm_.below(static_cast<int>(joints())))] = true;
    }
    Draws draws(request_.seed, Stream::kMotion);
    motion_ = sim::hidden::draw_arm_motion(middles, stands_, truth().duration_s, draws);
    Draws other(request_.seed, Stream::kHoldoutMotion);
    second_motion_ = sim::hidden::draw_arm_motion(middles, stands_, kSecondS, other);
    const bool moves = std::any_of(motion_.joints.begin(), motion_.joints.end(),
                                   [](const auto& joint) { return !joint.moves.empty(); });
    truth().motion = moves ? "moves" : "sines";
    truth().stands = stands_;
  }

  // Rotor inertias and friction, and with them the scale by which effects are drawn.
  void draw_drives() {
    const sim::MujocoModel model = mujoco_model_of(rigid_robot_);
    const sim::MujocoPlant plant = mujoco_plant_of(model);
    const Eigen::VectorXd inertias = joint_inertias(plant, motion_);
    const ArmSketch sketch = arm_sketch_of(plant, motion_, truth().duration_s);
    double largest = 0;
    for (Index j = 0; j < inertias.size(); ++j) {
      largest = std::max(largest, rms_of(sketch.tau.col(j)));
    }
    for (std::size_t i = 0; i < joints(); ++i) {
      const auto j = static_cast<Index>(i);
      const bool wrist = i >= 3;
      rotor_.push_back(inertias[j] * (wrist ? arm_.uniform(0.4, 2) : arm_.uniform(0.1, 0.5)));
      ArmJointScale scale;
      scale.load = rms_of(sketch.tau.col(j));
      const double drive = rms_of(sketch.tau.col(j) + rotor_[i] * sketch.ddq.col(j));
      const double base = std::max(drive, 0.01 * largest);
      scale.speed = rms_of(sketch.dq.col(j));
      scale.speed2 = rms_of(sketch.dq.col(j).square());
      scale.acceleration = rms_of(sketch.ddq.col(j));
      scale.middle = sketch.q.col(j).mean();
      scale.spread = rms_of(sketch.q.col(j) - scale.middle);
      scale.coulomb = base * arm_.uniform(0.06, 0.2);
      const double usual_speed = scale.speed > 0 ? scale.speed : 0.5;
      scale.viscous = base * arm_.uniform(0.05, 0.15) / usual_speed;
      scale.torque = std::hypot(base, scale.coulomb, scale.viscous * scale.speed);
      scales_.push_back(scale);
    }
  }

  void draw_hidden() {
    truth().torque_constant_error.assign(joints(), 0.0);
    if (!hides(ArmHides::kNothing)) {
      for (double& error : truth().torque_constant_error) error = hidden_.uniform(-0.05, 0.05);
    }
    in_file_.assign(joints(), true);
    if (hides(ArmHides::kNoFriction)) in_file_.assign(joints(), false);
    if (hides(ArmHides::kEffects)) draw_effects();
    if (hides(ArmHides::kPayload)) {
      add(drawn_payload());
      if (hidden_.uniform(0, 1) < 0.5) add_one_effect();
    }
    if (hides(ArmHides::kChange)) draw_change();
    if (hides(ArmHides::kPush)) draw_pushes();
    for (const ArmEffect& effect : rig_effects_) {
      auto& constant = truth().torque_constant_error[static_cast<std::size_t>(effect.joint)];
      if (effect.kind == EffectKind::kTorqueScale) constant = 0;
    }
  }

  void draw_effects() {
    const double partly = hidden_.uniform(0, 1);
    const int without = partly < 0.15 ? 2 : partly < 0.35 ? 1 : 0;
    const int count = 1 + hidden_.below(4);
    if (hidden_.uniform(0, 1) < 0.25) add(drawn_payload());
    while (static_cast<int>(rig_effects_.size()) < count) {
      if (!add_one_effect()) break;
    }
    for (int i = 0; i < without; ++i) {
      const auto joint = static_cast<std::size_t>(hidden_.below(static_cast<int>(joints())));
      if (!is_taken(joint)) in_file_[joint] = false;
    }
  }

  [[nodiscard]] bool is_taken(std::size_t joint) const {
    return std::any_of(rig_effects_.begin(), rig_effects_.end(), [&](const ArmEffect& one) {
      return static_cast<std::size_t>(one.joint) == joint;
    });
  }

  void add(const ArmEffect& effect) { rig_effects_.push_back(effect); }

  // On a joint that moves and has none yet; false where there is none left.
  bool add_one_effect() {
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < joints(); ++i) {
      if (!is_taken(i) && scales_[i].speed > 0) free.push_back(i);
    }
    if (free.empty()) return false;
    const std::size_t joint =
        free[static_cast<std::size_t>(hidden_.below(static_cast<int>(free.size())))];
    std::vector<EffectKind> possible;
    const std::size_t neighbour = joint + 1 < joints() ? joint + 1 : joint - 1;
    for (const EffectKind kind : arm_effect_kinds()) {
      const bool couples = kind == EffectKind::kJointCoupling;
      if (couples && (joint + 3 < joints() || scales_[neighbour].speed == 0)) continue;
      if (is_possible(kind, scales_[joint])) possible.push_back(kind);
    }
    const EffectKind kind =
        possible[static_cast<std::size_t>(hidden_.below(static_cast<int>(possible.size())))];
    add(draw_arm_effect(kind, static_cast<Index>(joint), scales_, static_cast<Index>(neighbour),
                        hidden_));
    // A coupled wrist: what turns one joint turns the other's motor too.
    if (kind == EffectKind::kJointCoupling && !is_taken(neighbour)) {
      add(draw_arm_effect(kind, static_cast<Index>(neighbour), scales_, static_cast<Index>(joint),
                          hidden_));
    }
    return true;
  }

  ArmEffect drawn_payload() {
    const auto& at = truth_robot_.joints.back().joint.centre_of_mass_m;
    ArmEffect payload{EffectKind::kTipPayload, static_cast<Index>(joints()) - 1, {}, 0};
    payload.numbers = {{"mass", total_mass_kg(truth_robot_) * hidden_.uniform(0.03, 0.12)}};
    const char* const names[]{"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
      payload.numbers.emplace_back(names[i], at[i] + hidden_.uniform(-0.08, 0.08));
    }
    return payload;
  }

  void draw_change() {
    std::vector<std::size_t> moving;
    for (std::size_t i = 0; i < joints(); ++i) {
      if (scales_[i].speed > 0) moving.push_back(i);
    }
    const std::size_t joint =
        moving[static_cast<std::size_t>(hidden_.below(static_cast<int>(moving.size())))];
    const double torque = scales_[joint].torque;
    ArmEffect change;
    change.joint = static_cast<Index>(joint);
    switch (hidden_.below(4)) {
      case 0:
        change = drawn_payload();
        break;
      case 1:
        change.kind = EffectKind::kCoulombFriction;
        change.numbers = {{"level", torque * hidden_.uniform(0.1, 0.25)}};
        break;
      case 2:
        change.kind = EffectKind::kTorqueOffset;
        change.numbers = {{"level", torque * hidden_.either_sign(0.1, 0.25)}};
        break;
      default:
        change.kind = EffectKind::kTorqueScale;
        change.numbers = {{"error", 1 / (1 + hidden_.either_sign(0.1, 0.25)) - 1}};
    }
    // On a tick of the drive.
    change.from_s = std::round(1000 * truth().duration_s * hidden_.uniform(0.3, 0.7)) / 1000;
    add(change);
    if (hidden_.uniform(0, 1) < 0.5) add_one_effect();
  }

  void draw_pushes() {
    const int count = 1 + contact_.below(2);
    for (int i = 0; i < count; ++i) {
      const std::size_t link = joints() - 1 - static_cast<std::size_t>(contact_.below(4));
      const auto& at = truth_robot_.joints[link].joint.centre_of_mass_m;
      const double size = total_mass_kg(truth_robot_) * contact_.uniform(0.8, 2.5);
      Eigen::Vector3d direction;
      for (double& one : direction) one = contact_.gaussian();
      const double from_s = (0.2 + 0.4 * i + contact_.uniform(0, 0.3)) * truth().duration_s;
      truth().pushes.push_back({from_s, from_s + contact_.uniform(0.2, 0.8),
                                static_cast<Index>(link), size * direction.normalized(),
                                Eigen::Vector3d(at[0], at[1], at[2])});
    }
  }

  // Whether the file lacks what the joint has of this kind, because it is what is hidden.
  [[nodiscard]] bool is_hidden(EffectKind kind, std::size_t joint) const {
    return std::any_of(rig_effects_.begin(), rig_effects_.end(), [&](const ArmEffect& one) {
      return one.kind == kind && static_cast<std::size_t>(one.joint) == joint && one.from_s == 0;
    });
  }

  // The arm with the friction and the rotors that are not among the hidden effects.
  void put_drives() {
    for (std::size_t i = 0; i < joints(); ++i) {
      const auto j = static_cast<Index>(i);
      const auto put = [&](EffectKind kind, double value, double smoothing) {
        if (!is_hidden(kind, i)) add_effect(truth_robot_, kind, j, {value, smoothing});
      };
      put(EffectKind::kViscousFriction, scales_[i].viscous, 0);
      put(EffectKind::kCoulombFriction, scales_[i].coulomb, kSmoothingRadS);
      put(EffectKind::kRotorInertia, rotor_[i], 0);
    }
  }

  // Of a hidden rotor MuJoCo knows from the start.
  [[nodiscard]] desk::RobotDescription simulated_robot() const {
    desk::RobotDescription robot = truth_robot_;
    for (const ArmEffect& effect : rig_effects_) {
      if (effect.kind != EffectKind::kRotorInertia) continue;
      add_effect(robot, effect.kind, effect.joint, {effect.number(0)});
    }
    return robot;
  }

  void simulate() {
    put_drives();
    ArmRig rig{mujoco_model_of(simulated_robot()), rig_effects_, truth().pushes, {}};
    for (const double error : truth().torque_constant_error) {
      rig.torque_constant.push_back(1 / (1 + error));
    }
    run_ = run_arm(rig, motion_, truth().duration_s, style_.every);
    Draws noise(request_.seed, Stream::kNoise);
    for (Index j = 0; j < run_.tau.cols(); ++j) {
      truth().noise_nm.push_back(noise_share_ * run_.tau.col(j).cwiseAbs().maxCoeff());
    }
    case_.recording = recording_text(run_, style_, truth().noise_nm, noise);
    const bool steady = !hides(ArmHides::kChange) && !hides(ArmHides::kPush);
    if (steady && arm_.uniform(0, 1) < 0.4) {
      case_.holdout = recording_text(run_arm(rig, second_motion_, kSecondS, style_.every), style_,
                                     truth().noise_nm, noise);
    }
  }

  void ask() {
    for (std::size_t i = 0; i < rig_effects_.size(); ++i) {
      ArmTrueEffect one{rig_effects_[i], run_.effect_rms[i], 0, false};
      if (one.effect.kind == EffectKind::kTipPayload) {
        weigh(one);
      } else {
        judge_size(one, one.effect.joint);
      }
      (one.effect.from_s > 0 ? truth().changes : truth().effects).push_back(one);
    }
    for (std::size_t i = 0; i < joints(); ++i) {
      if (!in_file_[i]) ask_for_friction(static_cast<Index>(i));
    }
  }

  void judge_size(ArmTrueEffect& one, Index joint) {
    constexpr double kLeastShare = 0.02;
    const auto index = static_cast<std::size_t>(joint);
    const double share = one.rms_nm / rms_of(run_.tau.col(joint).array());
    one.share = std::max(one.share, share);
    const bool is_large = share >= kLeastShare && one.rms_nm >= truth().noise_nm[index];
    one.is_asked_for =
        one.is_asked_for || (is_large && !stands_[static_cast<std::size_t>(one.effect.joint)]);
  }

  // The payload's torque on every joint, by the arm with and without it.
  void weigh(ArmTrueEffect& one) {
    const sim::MujocoModel model = mujoco_model_of(truth_robot_);
    sim::MujocoPlant plant = mujoco_plant_of(model);
    const ArmSketch without = arm_sketch_of(plant, motion_, truth().duration_s);
    plant.set_payload(one.effect.joint, one.effect.number(0),
                      {one.effect.number(1), one.effect.number(2), one.effect.number(3)});
    const ArmSketch with = arm_sketch_of(plant, motion_, truth().duration_s);
    double largest = 0;
    for (Index j = 0; j < with.tau.cols(); ++j) {
      one.rms_nm = rms_of(with.tau.col(j) - without.tau.col(j));
      const double share = one.rms_nm / rms_of(run_.tau.col(j).array());
      if (share < largest) continue;
      largest = share;
      one.share = share;
    }
    one.is_asked_for = largest >= 0.02;
  }

  void ask_for_friction(Index joint) {
    const ArmJointScale& scale = scales_[static_cast<std::size_t>(joint)];
    const auto speed = run_.dq.col(joint).array();
    const double moving = (speed.abs() > 0.01).cast<double>().mean();
    ArmTrueEffect coulomb{{EffectKind::kCoulombFriction, joint, {{"level", scale.coulomb}}, 0},
                          scale.coulomb * std::sqrt(moving),
                          0,
                          false};
    ArmTrueEffect viscous{
        {EffectKind::kViscousFriction, joint, {{"coefficient", scale.viscous}}, 0},
        scale.viscous * rms_of(speed),
        0,
        false};
    for (ArmTrueEffect* one : {&coulomb, &viscous}) {
      judge_size(*one, joint);
      truth().effects.push_back(*one);
    }
  }

  // What the file says: CAD, friction and rotors as its owner knows them.
  desk::RobotDescription known_robot() {
    truth().cad_error = knowledge_.log_uniform(0.05, 0.4);
    truth().friction_error = 0.2;
    desk::RobotDescription known =
        desk::campaign::with_cad_errors(rigid_robot_, truth().cad_error, knowledge_);
    known.name = "arm-" + std::to_string(request_.seed);
    known.source = "Drawn by ./dev bench discovery --arm; a made arm of " + rigid_robot_.name;
    for (std::size_t i = 0; i < joints(); ++i) {
      truth().link_mass_error_share.push_back(
          rigid_robot_.joints[i].joint.mass_kg / known.joints[i].joint.mass_kg - 1);
    }
    for (const desk::RobotEffect& effect : truth_robot_.effects) {
      const bool friction = effect.kind != EffectKind::kRotorInertia;
      const double error = friction ? truth().friction_error : 0.1;
      const double value = effect.parameters[0] * (1 + knowledge_.uniform(-error, error));
      if (friction && !in_file_[effect.joint]) continue;
      add_effect(known, effect.kind, effect.joint, {value, effect.parameters[1]});
    }
    const bool says_limits = knowledge_.uniform(0, 1) < 0.5;
    const bool says_encoder = knowledge_.uniform(0, 1) < 0.5 && !style_.has_five_digits;
    for (std::size_t i = 0; i < joints(); ++i) {
      const auto j = static_cast<Index>(i);
      desk::RobotJoint& joint = known.joints[i];
      if (says_encoder)
        joint.encoder.counts_per_unit = std::exp2(style_.bits) / (2 * std::numbers::pi);
      if (!says_limits) continue;
      joint.joint.min_position = -std::numbers::pi;
      joint.joint.max_position = std::numbers::pi;
      joint.joint.max_velocity = 4;
      joint.joint.max_torque = std::ceil(2.5 * run_.tau.col(j).cwiseAbs().maxCoeff());
    }
    // As it is read.
    return desk::parse_robot(desk::robot_text(known), "robot.toml");
  }

  static constexpr double kSecondS = 15;
  static constexpr double kSmoothingRadS = 0.01;

  ArmRequest request_;
  Draws arm_, knowledge_, hidden_, contact_;
  ArmCase case_;
  ArmLogStyle style_;
  double noise_share_ = 0;
  desk::RobotDescription rigid_robot_;  // as it is, bodies alone
  desk::RobotDescription truth_robot_;  // with the friction and rotors that are not hidden
  std::vector<bool> stands_;
  sim::hidden::ArmMotion motion_, second_motion_;
  std::vector<double> rotor_;
  std::vector<ArmJointScale> scales_;
  std::vector<bool> in_file_;  // per joint: its friction
  std::vector<ArmEffect> rig_effects_;
  ArmRun run_;
};

}  // namespace

ArmCase make_arm_case(const ArmRequest& request) { return ArmDrawing(request).make(); }

}  // namespace offnominal::bench
