#include "sil/gather.hpp"

#include <map>
#include <offnominal/hal/bus/wire_time.hpp>
#include <string>
#include <vector>

#include "drives/drive_table.hpp"
#include "log/csv_log.hpp"
#include "paper/run_observer.hpp"
#include "sil/not_held.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::sil {
namespace {

using Eigen::Index;

// A table of which every column is there, by name.
class Table {
 public:
  Table(const std::filesystem::path& file, int joints)
      : columns_(read_csv(file, [](const std::string&) { return Need::kRequired; }).columns),
        joints_(joints) {}
  [[nodiscard]] double at(const std::string& column, Index row) const {
    return columns_.at(column)[row];
  }
  [[nodiscard]] sim::JointVector all(const std::string& quantity, Index row) const {
    sim::JointVector values(joints_);
    for (Index i = 0; i < joints_; ++i) values[i] = at(quantity + std::to_string(i + 1), row);
    return values;
  }
  [[nodiscard]] Index rows() const { return columns_.at("t").size(); }

 private:
  std::map<std::string, Eigen::VectorXd> columns_;
  Index joints_;
};

// The controller's tick that used the readings of a tick of the plant: the first one after it.
class Partner {
 public:
  Partner(const Table& controller, double period_s)
      : controller_(controller), period_s_(period_s) {}
  // In the order of time. False where it had none, or was not armed, but for the tick in which it
  // stopped for what it had detected.
  bool find(double plant_t_s) {
    while (row_ < controller_.rows() && controller_.at("t", row_) <= plant_t_s) ++row_;
    if (row_ == controller_.rows()) return false;
    const bool in_time = controller_.at("t", row_) < plant_t_s + 1.5 * period_s_;
    return in_time && (is_armed(row_) || (row_ > 0 && is_armed(row_ - 1) &&
                                          controller_.at("fault", row_) ==
                                              static_cast<double>(controller::Fault::kDetected)));
  }
  [[nodiscard]] Index row() const { return row_; }

 private:
  [[nodiscard]] bool is_armed(Index row) const {
    return controller_.at("state", row) == static_cast<double>(hal::ControllerState::kArmed);
  }

  const Table& controller_;
  double period_s_;
  Index row_ = 0;
};

paper::TickRecord record_of(const Table& plant, Index row, const Table& controller, Index partner,
                            const Scenario& scenario, const RobotDescription& robot) {
  const double period_s = robot.estimator.period_s;
  paper::TickRecord record;
  record.time_s = plant.at("arm_t", row);
  record.tick = std::llround(record.time_s / period_s);
  record.state.q = plant.all("q", row);
  record.state.dq = plant.all("dq", row);
  record.q_desired =
      motion_of(scenario)(judging_time_s(scenario, record.time_s - controller.at("behind", partner),
                                         controller.at("motion_t", partner)))
          .q;
  record.tau = plant.all("tau", row);
  record.psi = plant.all("psi", row);
  record.psi_hat = controller.all("psi_hat", partner);
  record.error_norm = controller.at("error", partner);
  record.threshold = controller.at("threshold", partner);
  record.weight_norm = controller.at("weights", partner);
  record.detected = controller.at("detected", partner) != 0;
  record.slows = controller.at("slows", partner) != 0;
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    record.error = controller.all("error", partner);
    record.thresholds = controller.all("threshold", partner);
    if (robot.estimator.fast_alpha > 0) {
      record.fast_error = controller.all("fast_error", partner);
      record.fast_thresholds = controller.all("fast_threshold", partner);
    }
    record.first_joint = static_cast<int>(controller.at("first_joint", partner)) - 1;
    record.acts = controller.at("acts", partner) != 0;
  } else {
    record.acts = record.detected;
  }
  // The controller's rows are those of its fresh ticks.
  record.bus = {true,
                {controller.all("q", partner), controller.all("dq", partner)},
                controller.all("tau", partner),
                plant.all("acting", row),
                controller.all("compensation", partner)};
  return record;
}

// When the drives first gave no torque, time of the arm; none where they always did.
std::optional<double> safe_since_s(const Table& plant) {
  for (Index row = 0; row < plant.rows(); ++row) {
    if (plant.at("torque_mode", row) == 0) return plant.at("arm_t", row);
  }
  return std::nullopt;
}

// The plant's rows are those since its brakes opened.
std::optional<NotHeld> not_held_in(const Table& plant, const RobotDescription& robot,
                                   const Scenario& scenario) {
  if (plant.rows() == 0) return std::nullopt;
  Index last = 0;
  while (last + 1 < plant.rows() && plant.at("torque_mode", last) != 0) ++last;
  const auto state = [&](Index row) {
    return sim::JointState{plant.all("q", row), plant.all("dq", row)};
  };
  return not_held(robot, scenario, state(0), state(last));
}

controller::Fault fault_of(const nlohmann::json& controller) {
  return static_cast<controller::Fault>(controller.at("fault_number").get<int>());
}

hal::ControllerState state_named(const std::string& name) {
  if (name == "passive") return hal::ControllerState::kPassive;
  if (name == "armed") return hal::ControllerState::kArmed;
  return name == "fault" ? hal::ControllerState::kFault : hal::ControllerState::kInit;
}

BusReport bus_of(const nlohmann::json& controller, const nlohmann::json& plant,
                 const hal::Frame& frame, double run_time_s) {
  const auto sum = [&](const char* key) {
    return controller.at(key).get<std::uint64_t>() + plant.at(key).get<std::uint64_t>();
  };
  BusReport bus;
  bus.frames = sum("sent");
  bus.lost = sum("lost");
  bus.rejected = sum("rejected");
  bus.late = sum("late");
  bus.stale = controller.at("stale").get<std::uint64_t>();
  bus.load = static_cast<double>(bus.frames) * hal::longest_wire_time_s(frame) / run_time_s;
  return bus;
}

RealTimeReport time_of(const nlohmann::json& controller, const nlohmann::json& plant) {
  RealTimeReport time;
  time.ticks = controller.at("ticks");
  time.worst_late_us = controller.at("worst_late_us");
  time.worst_step_us = controller.at("worst_step_us");
  time.mean_step_us = controller.at("mean_step_us");
  time.fifo_priority = controller.at("real_time").at("fifo_priority");
  time.memory_locked = controller.at("real_time").at("memory_locked");
  time.plant_overruns = plant.at("overruns");
  time.recording_lost = controller.at("recording_lost").get<std::uint64_t>() +
                        plant.at("recording_lost").get<std::uint64_t>();
  return time;
}

}  // namespace

SilResult gather(const RobotDescription& robot, const Scenario& scenario,
                 const std::string& bus_name, const Recordings& recordings) {
  const double period_s = robot.estimator.period_s;
  const double duration_s = scenario.duration_s;
  const std::optional<double> first_s = first_begin_s(scenario.faults);
  const Table plant(recordings.plant_csv, robot.joint_count());
  const Table controller(recordings.controller_csv, robot.joint_count());
  paper::RunObserver observer(robot, scenario, first_s.value_or(duration_s));
  Partner partner(controller, period_s);
  for (Index row = 0; row < plant.rows(); ++row) {
    if (plant.at("arm_t", row) > duration_s + 0.5 * period_s) break;
    if (!partner.find(plant.at("t", row))) continue;
    observer(record_of(plant, row, controller, partner.row(), scenario, robot));
  }
  SilResult result;
  result.run = observer.finish();
  result.run.fault_time_s = first_s;
  result.bus_name = bus_name;
  result.faults = scenario.faults;
  result.state = state_named(recordings.controller.at("state"));
  result.fault = fault_of(recordings.controller);
  if (result.fault == controller::Fault::kArmNotHeld) {
    result.not_held = not_held_in(plant, robot, scenario);
  }
  const nlohmann::json& isolated = recordings.controller.at("isolated");
  if (!isolated.is_null()) {
    result.isolated = on_the_runs_clock(isolated_fault_of(isolated), result, period_s);
  }
  result.overruns = recordings.controller.at("overruns");
  result.real_time = time_of(recordings.controller, recordings.plant);
  result.run_time_s = static_cast<double>(result.real_time->ticks) * period_s;
  const DriveSettings drives = robot.drive_settings();
  // Most frames are as long.
  const hal::Frame frame = protocol_of(drives).reading_frame(
      static_cast<std::size_t>(robot.joint_count()), format_of(scenario, drives, period_s));
  result.bus =
      bus_of(recordings.controller.at("bus"), recordings.plant.at("bus"), frame, result.run_time_s);
  // At the motion's end the controller lets go of its own accord.
  if (result.fault != controller::Fault::kNone) {
    result.ended_early_s = safe_since_s(plant);
    // What came before the first fault was not its doing.
    if (result.ended_early_s && first_s && *result.ended_early_s >= *first_s) {
      result.time_to_safe_state_s = *result.ended_early_s - *first_s;
    }
  }
  tell_what_followed(scenario, result);
  return result;
}

}  // namespace offnominal::desk::sil
