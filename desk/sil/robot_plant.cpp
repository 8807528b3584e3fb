#include "sil/robot_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <offnominal/model/effect_memory.hpp>
#include <offnominal/model/forward_dynamics.hpp>
#include <stdexcept>
#include <string>

#include "common/error.hpp"
#include "robot/chain_of.hpp"
#include "robot/effect_text.hpp"
#include "robot/robot_file.hpp"
#include "robot/transmission.hpp"

namespace offnominal::desk::sil {
namespace {

using sim::FaultEvent;
using sim::FaultEventKind;

using Joints = sim::JointVector;
using Inertia = Matrix<kRuntimeJoints, kRuntimeJoints, double>;
using Model = RigidBodyModel<kRuntimeJoints, double>;
using RobotChain = Chain<kRuntimeJoints, double>;

// The drag of advance() is of one joint each: friction of a motor that moves several would be stiff
// in directions that it does not know.
void refuse_shared_motors(const RobotDescription& robot, const std::vector<RobotEffect>& effects) {
  if (!robot.transmission) return;
  const std::vector<std::size_t> groups = coupled_groups(*robot.transmission);
  for (const RobotEffect& effect : effects) {
    const auto others = std::count(groups.begin(), groups.end(), groups[effect.joint]);
    if (!effect.of_motor || others == 1) continue;
    throw InputError({"robot " + robot.name, "effect",
                      fmt::format("{} of {}, which moves several joints",
                                  info_of(effect.kind)->name, place_of(effect)),
                      "effects of joints, and of motors that move one joint each",
                      "for the plant give a copy of the file with the effect at the joints"});
  }
}

RobotChain whole_chain(const RobotPlantSetup& setup) {
  require_carried(setup.robot, "robot " + setup.robot.name, "the simulated plant");
  RobotDescription hidden = setup.robot;
  hidden.effects = setup.hidden;
  require_carried(hidden, "robot " + setup.robot.name + ", hidden", "the simulated plant");
  refuse_shared_motors(setup.robot, setup.robot.effects);
  refuse_shared_motors(setup.robot, setup.hidden);
  RobotChain chain = chain_of<kRuntimeJoints, double>(setup.robot);
  Status status = Status::kOk;
  for (const RobotEffect& effect : setup.hidden) {
    if (!chain.effects.add(effect)) status = Status::kTooManyEffects;
  }
  if (status == Status::kOk) status = validate(chain);
  if (status == Status::kOk) {
    status = EffectMemory<kRuntimeJoints, double>::validate(chain, setup.period_s);
  }
  if (status == Status::kOk) return chain;
  throw InputError({"robot " + setup.robot.name, "plant", std::string("status ") + name_of(status),
                    "", "docs/troubleshooting.md says what each status asks for"});
}

bool changes_a_mass(const FaultEvent& fault) {
  return fault.kind == FaultEventKind::kMassLoss || fault.kind == FaultEventKind::kPayload;
}

class RobotPlant final : public sim::Plant {
 public:
  explicit RobotPlant(const RobotPlantSetup& setup)
      : chain_(whole_chain(setup)),
        healthy_(make_model(chain_)),
        model_(healthy_),
        state_(setup.start) {
    memory_.prepare(chain_, healthy_, setup.period_s);
    size_for(setup.robot.joints.size(), memory_state_.remembered);
    take_faults(setup.faults);
  }

  [[nodiscard]] bool set_faults(const std::vector<FaultEvent>& faults) override {
    take_faults(faults);
    // Until the next step, which develops them.
    if (masses_.empty()) model_ = healthy_;
    return true;
  }

  [[nodiscard]] const sim::JointState& state() const override { return state_; }

  void step(double t_s, const sim::JointVector& tau, double period_s) override {
    const Joints acting = remember(tau);
    constexpr double kMaxSubstepS = 5e-4;
    const int substeps = static_cast<int>(std::ceil(period_s / kMaxSubstepS - 1e-9));
    const double h_s = period_s / substeps;
    for (int i = 0; i < substeps; ++i) advance(t_s + i * h_s, acting, h_s);
    if (!state_.q.allFinite() || !state_.dq.allFinite()) {
      throw std::runtime_error("plant: its motion has run away at t = " + std::to_string(t_s) +
                               " s");
    }
  }

  [[nodiscard]] sim::JointVector fault_function(double t_s,
                                                const sim::JointVector& tau) const override {
    if (masses_.empty() && jumps_.empty()) return sim::JointVector::Zero(tau.size());
    const Joints driving = tau - memory_state_.remembered;
    const auto acceleration = [&](const Model& model, bool with_jumps) {
      Joints ddq = net_torque(model, state_.q, state_.dq, t_s, driving, with_jumps);
      solve_in_place<kRuntimeJoints, double>(factor_of(mass_matrix(model, state_.q)), ddq);
      return ddq;
    };
    return acceleration(faulty_at(t_s), true) - acceleration(healthy_, false);
  }

 private:
  void take_faults(const std::vector<FaultEvent>& faults) {
    masses_.clear();
    jumps_.clear();
    for (const FaultEvent& fault : faults) {
      if (changes_a_mass(fault)) masses_.push_back(fault);
      if (fault.kind == FaultEventKind::kFrictionJump) jumps_.push_back(fault);
    }
    // Of no joint in particular: of the first link.
    for (FaultEvent& fault : masses_) fault.joint = std::max(fault.joint, 0);
  }

  // What is left for the dynamics of a torque that is told now: late drives, friction with a
  // memory.
  Joints remember(const Joints& tau) {
    const JointSample<kRuntimeJoints, double> sample{state_.q, state_.dq, tau};
    const auto now = started_ ? memory_.next(sample, 0, memory_state_) : memory_.begin(sample);
    if (started_) {
      memory_.keep(sample, 0, now, memory_state_);
    } else {
      memory_.keep_begin(sample, now, memory_state_);
    }
    started_ = true;
    return now.driving(now.tau);
  }

  [[nodiscard]] Model faulty_at(double t_s) const {
    Model model = healthy_;
    for (const FaultEvent& fault : masses_) {
      const double size = fault.size * fault.developed(t_s);
      if (fault.kind == FaultEventKind::kPayload) {
        const std::size_t last = static_cast<std::size_t>(state_.q.size()) - 1;
        const auto& at = chain_.joints[last].centre_of_mass_m;
        model.bodies[last].link.add_point_mass(size, Vector<3, double>(at[0], at[1], at[2]));
        continue;
      }
      SpatialInertia<double>& link = model.bodies[static_cast<std::size_t>(fault.joint)].link;
      link.mass *= 1 - size;
      link.first_moment *= 1 - size;
      link.inertia *= 1 - size;
    }
    return model;
  }

  [[nodiscard]] static Inertia factor_of(const Inertia& inertia) {
    Inertia factor;
    if (cholesky<kRuntimeJoints, double>(inertia, factor)) return factor;
    throw std::runtime_error("plant: its motion has run away");
  }

  // The drives' torque less friction and all other effects, N m or N.
  [[nodiscard]] Joints load_at(const Model& model, const Joints& q, const Joints& dq, double t_s,
                               const Joints& tau, bool with_jumps) const {
    Joints load = load_torque(model, joint_effects(model, q, dq, t_s), tau);
    for (const FaultEvent& jump : jumps_) {
      constexpr double kSignWidth = 0.01;  // rad/s or m/s
      if (!with_jumps || !jump.is_active(t_s)) continue;
      load[jump.joint] -= jump.size * std::tanh(dq[jump.joint] / kSignWidth);
    }
    return load;
  }
  [[nodiscard]] Joints net_torque(const Model& model, const Joints& q, const Joints& dq, double t_s,
                                  const Joints& tau, bool with_jumps) const {
    return load_at(model, q, dq, t_s, tau, with_jumps) -
           rigid_body_bias(model, joint_transforms(model, q), dq);
  }

  // Slope of what holds each joint back from rest to its velocity: a chord, which no friction that
  // saturates is above, so that no step goes beyond rest because of it.
  [[nodiscard]] Joints drag(const Joints& q, const Joints& dq, double t_s,
                            const Joints& tau) const {
    static constexpr double kLeastSpeed = 1e-4;  // rad/s or m/s
    const Joints moving =
        dq.unaryExpr([](double v) { return std::copysign(std::max(std::abs(v), kLeastSpeed), v); });
    const Joints lost = load_at(model_, q, Joints::Zero(q.size()), t_s, tau, true) -
                        load_at(model_, q, moving, t_s, tau, true);
    return lost.cwiseQuotient(moving).cwiseMax(0.0);
  }

  // ROS2 (J. G. Verwer et al., SIAM J. Sci. Comput. 20(4), 1999), of second order whatever stands
  // for the Jacobian, here the drag alone.
  void advance(double t_s, const Joints& tau, double h_s) {
    constexpr double kGamma = 1 + std::numbers::sqrt2 / 2;
    if (!masses_.empty()) model_ = faulty_at(t_s + h_s / 2);
    const Inertia inertia = mass_matrix(model_, state_.q);
    Inertia implicit = inertia;
    implicit.diagonal() += kGamma * h_s * drag(state_.q, state_.dq, t_s, tau);
    const Inertia factor = factor_of(implicit);
    Joints first = net_torque(model_, state_.q, state_.dq, t_s, tau, true);
    solve_in_place<kRuntimeJoints, double>(factor, first);

    const Joints q = state_.q + h_s * state_.dq;
    const Joints dq = state_.dq + h_s * first;
    Joints there = net_torque(model_, q, dq, t_s + h_s, tau, true);
    solve_in_place<kRuntimeJoints, double>(factor_of(mass_matrix(model_, q)), there);
    Joints second = product<kRuntimeJoints, double>(inertia, Joints(there - 2 * first));
    solve_in_place<kRuntimeJoints, double>(factor, second);

    state_.q += h_s * (state_.dq + 0.5 * h_s * first);
    state_.dq += h_s * (1.5 * first + 0.5 * second);
  }

  RobotChain chain_;
  Model healthy_;
  Model model_;  // with the faults of now
  EffectMemory<kRuntimeJoints, double> memory_;
  EffectMemory<kRuntimeJoints, double>::State memory_state_;
  std::vector<FaultEvent> masses_, jumps_;
  sim::JointState state_;
  bool started_ = false;
};

}  // namespace

std::unique_ptr<sim::Plant> make_robot_plant(const RobotPlantSetup& setup) {
  return std::make_unique<RobotPlant>(setup);
}

}  // namespace offnominal::desk::sil
