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

// Compiled once, for the most joints there are: those behind the robot's last one have no mass,
// turn an inertia of 1 kg m^2 each, and stay at rest. They neither feel the others nor are felt.
constexpr int kJoints = kMaxJoints;
using Joints = Vector<kJoints, double>;
using Inertia = Matrix<kJoints, kJoints, double>;
using Model = RigidBodyModel<kJoints, double>;
using RobotChain = Chain<kJoints, double>;

// The drag of advance() is of one joint each: friction of a motor that moves several would be stiff
// in directions that it does not know.
void refuse_shared_motors(const RobotDescription& robot) {
  if (!robot.transmission) return;
  const std::vector<std::size_t> groups = coupled_groups(*robot.transmission);
  for (const RobotEffect& effect : robot.effects) {
    const auto others = std::count(groups.begin(), groups.end(), groups[effect.joint]);
    if (!effect.of_motor || others == 1) continue;
    throw InputError({"robot " + robot.name, "effect",
                      fmt::format("{} of {}, which moves several joints",
                                  info_of(effect.kind)->name, place_of(effect)),
                      "effects of joints, and of motors that move one joint each",
                      "for the plant give a copy of the file with the effect at the joints"});
  }
}

RobotChain filled_chain(const RobotPlantSetup& setup) {
  require_carried(setup.robot, "robot " + setup.robot.name, "the simulated plant");
  refuse_shared_motors(setup.robot);
  RobotDescription robot = setup.robot;
  robot.effects.insert(robot.effects.end(), setup.hidden.begin(), setup.hidden.end());
  robot.joints.resize(static_cast<std::size_t>(kJoints));
  const RobotChain chain = chain_of<kJoints, double>(robot);
  Status status = validate(chain);
  if (status == Status::kOk) {
    status = EffectMemory<kJoints, double>::validate(chain, setup.period_s);
  }
  if (status == Status::kOk) return chain;
  throw InputError({"robot " + setup.robot.name, "plant", std::string("status ") + name_of(status),
                    "", "docs/troubleshooting.md says what each status asks for"});
}

Model filled_model(const RobotChain& chain, std::size_t joints) {
  Model model = make_model(chain);
  for (std::size_t i = joints; i < static_cast<std::size_t>(kJoints); ++i) {
    model.bodies[i].link = {};
    model.bodies[i].reflected_inertia = 1;
  }
  return model;
}

Joints filled(const sim::JointVector& values) {
  Joints all = Joints::Zero();
  all.head(values.size()) = values;
  return all;
}

bool changes_a_mass(const FaultEvent& fault) {
  return fault.kind == FaultEventKind::kMassLoss || fault.kind == FaultEventKind::kPayload;
}

class RobotPlant final : public sim::Plant {
 public:
  explicit RobotPlant(const RobotPlantSetup& setup)
      : chain_(filled_chain(setup)),
        healthy_(filled_model(chain_, setup.robot.joints.size())),
        model_(healthy_),
        state_(setup.start),
        q_(filled(setup.start.q)),
        dq_(filled(setup.start.dq)) {
    memory_.prepare(chain_, healthy_, setup.period_s);
    for (const FaultEvent& fault : setup.faults) {
      if (changes_a_mass(fault)) masses_.push_back(fault);
      if (fault.kind == FaultEventKind::kFrictionJump) jumps_.push_back(fault);
    }
  }

  [[nodiscard]] const sim::JointState& state() const override { return state_; }

  void step(double t_s, const sim::JointVector& tau, double period_s) override {
    const Joints acting = remember(filled(tau));
    constexpr double kMaxSubstepS = 5e-4;
    const int substeps = static_cast<int>(std::ceil(period_s / kMaxSubstepS - 1e-9));
    const double h_s = period_s / substeps;
    for (int i = 0; i < substeps; ++i) advance(t_s + i * h_s, acting, h_s);
    const Eigen::Index joints = state_.q.size();
    if (!q_.allFinite() || !dq_.allFinite()) {
      throw std::runtime_error("plant: its motion has run away at t = " + std::to_string(t_s) +
                               " s");
    }
    state_ = {q_.head(joints), dq_.head(joints)};
  }

  [[nodiscard]] sim::JointVector fault_function(double t_s,
                                                const sim::JointVector& tau) const override {
    const Eigen::Index joints = state_.q.size();
    if (masses_.empty() && jumps_.empty()) return sim::JointVector::Zero(joints);
    const Joints driving = filled(tau) - memory_state_.remembered;
    const auto acceleration = [&](const Model& model, bool with_jumps) {
      Joints ddq = net_torque(model, q_, dq_, t_s, driving, with_jumps);
      solve_in_place<kJoints, double>(factor_of(mass_matrix(model, q_)), ddq);
      return ddq;
    };
    const Joints difference = acceleration(faulty_at(t_s), true) - acceleration(healthy_, false);
    return difference.head(joints);
  }

 private:
  // What is left for the dynamics of a torque that is told now: late drives, friction with a
  // memory.
  Joints remember(const Joints& tau) {
    const JointSample<kJoints, double> sample{q_, dq_, tau};
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
    if (cholesky<kJoints, double>(inertia, factor)) return factor;
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
    const Joints lost = load_at(model_, q, Joints::Zero(), t_s, tau, true) -
                        load_at(model_, q, moving, t_s, tau, true);
    return lost.cwiseQuotient(moving).cwiseMax(0.0);
  }

  // ROS2 (J. G. Verwer et al., SIAM J. Sci. Comput. 20(4), 1999), of second order whatever stands
  // for the Jacobian, here the drag alone.
  void advance(double t_s, const Joints& tau, double h_s) {
    constexpr double kGamma = 1 + std::numbers::sqrt2 / 2;
    if (!masses_.empty()) model_ = faulty_at(t_s + h_s / 2);
    const Inertia inertia = mass_matrix(model_, q_);
    Inertia implicit = inertia;
    implicit.diagonal() += kGamma * h_s * drag(q_, dq_, t_s, tau);
    const Inertia factor = factor_of(implicit);
    Joints first = net_torque(model_, q_, dq_, t_s, tau, true);
    solve_in_place<kJoints, double>(factor, first);

    const Joints q = q_ + h_s * dq_;
    const Joints dq = dq_ + h_s * first;
    Joints there = net_torque(model_, q, dq, t_s + h_s, tau, true);
    solve_in_place<kJoints, double>(factor_of(mass_matrix(model_, q)), there);
    Joints second = product<kJoints, double>(inertia, Joints(there - 2 * first));
    solve_in_place<kJoints, double>(factor, second);

    q_ += h_s * (dq_ + 0.5 * h_s * first);
    dq_ += h_s * (1.5 * first + 0.5 * second);
  }

  RobotChain chain_;
  Model healthy_;
  Model model_;  // with the faults of now
  EffectMemory<kJoints, double> memory_;
  EffectMemory<kJoints, double>::State memory_state_;
  std::vector<FaultEvent> masses_, jumps_;
  sim::JointState state_;
  Joints q_, dq_;
  bool started_ = false;
};

}  // namespace

std::unique_ptr<sim::Plant> make_robot_plant(const RobotPlantSetup& setup) {
  return std::make_unique<RobotPlant>(setup);
}

}  // namespace offnominal::desk::sil
