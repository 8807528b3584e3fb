#include "sil/plant_of.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "drives/drive_table.hpp"
#include "loop/controller_settings.hpp"
#include "loop/frame_format.hpp"
#include "offnominal/sim/plants/paper_arm.hpp"
#include "offnominal/sim/uncertainty.hpp"
#include "sil/mujoco_plant_of.hpp"
#include "sil/robot_plant.hpp"

namespace offnominal::desk::sil {
namespace {

constexpr int kPaperJoints = 2;

// The paper's arm has one fault of its own at most.
sim::Fault arm_fault(const std::vector<sim::FaultEvent>& faults) {
  sim::Fault arm;
  for (const sim::FaultEvent& fault : faults) {
    if (!info_of(fault.kind).develops) continue;
    if (arm.kind != sim::FaultKind::kNone) {
      throw InputError(
          {"sil", "faults", "two of mass_loss, nonlinear and payload", "one of them", ""});
    }
    arm.time_s = fault.begin_s;
    arm.rate_per_s = fault.rate_per_s;
    if (fault.kind == sim::FaultEventKind::kMassLoss) {
      if (fault.joint > 0) {
        throw InputError({"sil", "mass_loss, joint", std::to_string(fault.joint + 1),
                          "1: of the paper's arm that mass falls off", ""});
      }
      arm.kind = sim::FaultKind::kMassLoss;
      arm.mass_loss = fault.size;
    } else if (fault.kind == sim::FaultEventKind::kPayload) {
      arm.kind = sim::FaultKind::kPayload;
      arm.payload_kg = fault.size;
    } else {
      arm.kind = sim::FaultKind::kNonlinear;
    }
  }
  return arm;
}

// What the paper's arm does that its model does not know, with friction that comes and goes.
sim::Uncertainty with_friction(sim::Uncertainty base, const std::vector<sim::FaultEvent>& faults) {
  std::vector<sim::FaultEvent> jumps;
  std::copy_if(faults.begin(), faults.end(), std::back_inserter(jumps),
               [](const auto& fault) { return fault.kind == sim::FaultEventKind::kFrictionJump; });
  if (jumps.empty()) return base;
  return [base = std::move(base), jumps](double time_s, const sim::TwoLinkState& state) {
    constexpr double kSignWidth = 0.01;  // rad/s
    Eigen::Vector2d torque = base(time_s, state);
    for (const sim::FaultEvent& jump : jumps) {
      const double speed = state.dq[jump.joint];
      if (jump.is_active(time_s)) torque[jump.joint] += jump.size * std::tanh(speed / kSignWidth);
    }
    return torque;
  };
}

std::unique_ptr<sim::Plant> paper_arm(const std::vector<sim::FaultEvent>& faults,
                                      const sim::JointState& start) {
  try {
    return std::make_unique<sim::PaperArm>(
        sim::TwoLinkPlant({}, arm_fault(faults), with_friction(sim::paper_uncertainty(), faults)),
        start);
  } catch (const std::invalid_argument& error) {
    throw InputError(
        {.file = "arm", .place = error.what(), .found = "", .allowed = "", .mend = ""});
  }
}

std::unique_ptr<sim::Plant> robot_plant(const Scenario& scenario, const sim::JointState& start,
                                        double period_s) {
  if (scenario.mujoco) return make_mujoco_plant(scenario, start);
  return make_robot_plant({*scenario.plant, scenario.hidden, scenario.faults, start, period_s});
}

bool turns_on(const Joint<double>& joint) {
  constexpr double kNone = std::numeric_limits<double>::max();
  return joint.type == JointType::kRevolute && joint.min_position == -kNone &&
         joint.max_position == kNone;
}

}  // namespace

void check_plant(const Scenario& scenario) {
  if (!scenario.plant) {
    if (!scenario.hidden.empty()) {
      throw InputError({"sil", "hidden", "an effect hidden in the paper's arm",
                        "none: its friction and disturbance are the paper's",
                        "hide it in the plant of a robot file: --plant FILE"});
    }
    static_cast<void>(arm_fault(scenario.faults));
    return;
  }
  for (const sim::FaultEvent& fault : scenario.faults) {
    if (fault.kind != sim::FaultEventKind::kNonlinear) continue;
    throw InputError({"sil", "nonlinear",
                      "a fault of the paper's arm, on robot " + scenario.plant->name,
                      "every other kind", ""});
  }
  if (scenario.mujoco) check_mujoco_plant(scenario);
  for (const RobotJoint& joint : scenario.plant->joints) {
    if (joint.joint.type == JointType::kRevolute || scenario.encoder_bits_per_turn == 0) continue;
    throw InputError({"sil", "encoder_bits_per_turn", "joint " + joint.name + ", which slides",
                      "joints that turn", "leave it out: its frames resolve 4 um"});
  }
}

void check_real_time(const Scenario& scenario) {
  for (const sim::FaultEvent& fault : scenario.faults) {
    if (fault.kind != sim::FaultEventKind::kBlockedBus &&
        fault.kind != sim::FaultEventKind::kBusOff) {
      continue;
    }
    throw InputError({"sil", std::string(info_of(fault.kind).name), "a run in real time",
                      "faults of the plant's end of the bus",
                      "this one is the controller's own: run it in lock-step"});
  }
}

void check_drives(const Scenario& scenario, const DriveSettings& drives, double period_s) {
  if (!scenario.sends_velocity) require_positions_alone(drives);
  static_cast<void>(format_of(scenario, drives, period_s));
}

sim::PlantNode plant_of(const Scenario& scenario, const DriveSettings& drives, double period_s) {
  sim::PlantNodeConfig config;
  config.period_s = period_s;
  config.encoders.bits_per_turn = scenario.encoder_bits_per_turn;
  config.sends_velocity = scenario.sends_velocity;
  config.faults = scenario.faults;
  sim::JointState start = sim::on_trajectory(motion_of(scenario)(0.0));
  // The brakes hold it where it is until the drives come. Released on the move it would have an
  // acceleration that no bound of an observer covers.
  if (!scenario.sends_velocity) start.dq.setZero();
  sim::DriveSetup setup;
  setup.joints = static_cast<std::size_t>(joint_count_of(scenario));
  setup.link = {period_us_of(period_s), format_of(scenario, drives, period_s)};
  if (!scenario.plant) {
    return {paper_arm(scenario.faults, start), emulated_drives(drives, setup), config};
  }
  // Nobody commands more than the file allows.
  setup.max_torque_nm = std::numeric_limits<double>::infinity();
  for (const RobotJoint& joint : scenario.plant->joints) {
    config.turns_on.push_back(turns_on(joint.joint));
  }
  return {robot_plant(scenario, start, period_s), emulated_drives(drives, setup), config};
}

int joint_count_of(const Scenario& scenario) {
  return scenario.plant ? scenario.plant->joint_count() : kPaperJoints;
}

MotionAt motion_of(const Scenario& scenario) {
  if (scenario.motion) return scenario.motion;
  return scenario.plant ? sway_of(*scenario.plant) : paper_motion();
}

double judging_time_s(const Scenario& scenario, double plants_s, double controllers_s) {
  return scenario.plant ? controllers_s : plants_s;
}

hal::FrameFormat format_of(const Scenario& scenario, const DriveSettings& drives, double period_s) {
  return format_for(drives, joint_count_of(scenario), period_s, scenario.format);
}

std::optional<double> first_begin_s(const std::vector<sim::FaultEvent>& faults) {
  std::optional<double> first_s;
  for (const sim::FaultEvent& fault : faults) {
    first_s = std::min(first_s.value_or(fault.begin_s), fault.begin_s);
  }
  return first_s;
}

}  // namespace offnominal::desk::sil
