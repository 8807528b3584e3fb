#include "sil/sil.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <offnominal/hal/bus/wire_time.hpp>

#include "common/error.hpp"
#include "loop/controller_settings.hpp"
#include "paper/run_observer.hpp"
#include "sil/lock_step.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::sil {
namespace {

[[noreturn]] void refuse(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = "") {
  throw InputError(
      {.file = "offnominal sil", .place = place, .found = found, .allowed = allowed, .mend = mend});
}

void check_fault(const sim::FaultEvent& fault, int joints, double duration_s) {
  const sim::FaultEventInfo& info = info_of(fault.kind);
  const std::string name(info.name);
  if (!info.unit.empty() && !(fault.size >= info.least && fault.size <= info.most)) {
    refuse(name + ", size", fmt::format("{:g}", fault.size),
           fmt::format("{:g} to {:g} {}", info.least, info.most, info.unit));
  }
  const bool said = fault.joint >= 0 || info.of_joint == sim::OfJoint::kAlways;
  const bool has_joint = info.of_joint != sim::OfJoint::kNever;
  if (said && has_joint && (fault.joint < 0 || fault.joint >= joints)) {
    refuse(name + ", joint", std::to_string(fault.joint + 1), "1 to " + std::to_string(joints));
  }
  if (!(fault.begin_s >= 0 && fault.begin_s <= duration_s)) {
    refuse(name + ", begin", fmt::format("{:g} s", fault.begin_s),
           fmt::format("0 s to the run's end, {:g} s", duration_s),
           "begin earlier, or lengthen the run by --duration");
  }
  if (!(fault.end_s > fault.begin_s)) {
    refuse(name + ", end", fmt::format("{:g} s", fault.end_s),
           fmt::format("after its begin, {:g} s", fault.begin_s), "end later, or leave it out");
  }
  if (!(fault.rate_per_s > 0)) {
    refuse(name + ", rate", fmt::format("{:g} 1/s", fault.rate_per_s), "above 0");
  }
}

}  // namespace

void check_scenario(const RobotDescription& robot, const Scenario& scenario) {
  paper::check_run(robot, scenario, "sil");
  const int joints = joint_count_of(scenario);
  if (robot.joint_count() != joints) {
    refuse("plant", std::to_string(joints) + " joint(s)",
           std::to_string(robot.joint_count()) + ", as many as robot " + robot.name + " has",
           "give the files of the same arm at both ends");
  }
  if (const auto wanted = motion_of(scenario)(0.0).q.size(); wanted != joints) {
    refuse("motion", std::to_string(wanted) + " joint(s)",
           std::to_string(joints) + ", as many as the arm has",
           "write it with offnominal motion, for this robot");
  }
  if (validate(scenario.slow_down) != Status::kOk) {
    refuse("slowing",
           fmt::format("to {:g} within {:g} s", scenario.slow_down.to, scenario.slow_down.within_s),
           "to a share of 0 to below 1, within a time above 0");
  }
  if (scenario.encoder_bits_per_turn < 0 || scenario.encoder_bits_per_turn > 32) {
    refuse("encoder bits per turn", std::to_string(scenario.encoder_bits_per_turn), "0 to 32");
  }
  if (!(scenario.max_acceleration > 0 && std::isfinite(scenario.max_acceleration))) {
    refuse("largest acceleration", fmt::format("{:g} rad/s^2", scenario.max_acceleration),
           "above 0");
  }
  for (const sim::FaultEvent& fault : scenario.faults) {
    check_fault(fault, joints, scenario.duration_s);
  }
  check_plant(scenario);
  check_drives(scenario, robot.drive_settings(), robot.estimator.period_s);
}

SilResult run_in_lock_step(const RobotDescription& robot, const Scenario& scenario, Wire& wire,
                           const std::string& bus_name, const TappedPort::OnFrame& on_frame) {
  check_scenario(robot, scenario);
  SilResult result;
  result.bus_name = bus_name;
  result.faults = scenario.faults;
  const std::optional<double> first_s = first_begin_s(scenario.faults);
  paper::RunObserver observer(robot, scenario, first_s.value_or(scenario.duration_s));
  const auto observe = [&](const paper::TickRecord& tick) { observer(tick); };
  double busy_s = 0;
  const auto see = [&](const hal::Frame& frame, hal::Microseconds time_us) {
    busy_s += hal::longest_wire_time_s(frame);
    if (on_frame) on_frame(frame, time_us);
  };
  run_loop(robot, scenario, wire, see, observe, result);
  result.run = observer.finish();
  if (result.run_time_s > 0) result.bus.load = busy_s / result.run_time_s;
  result.run.fault_time_s = first_s;
  tell_what_followed(scenario, result);
  if (result.isolated) {
    result.isolated = on_the_runs_clock(*result.isolated, result, robot.estimator.period_s);
  }
  return result;
}

RobotDescription never_judged(RobotDescription robot) {
  constexpr double kBeyondAll = 1e9;  // N m or N, rad/s^2 or m/s^2
  if (robot.bound) return robot;
  BoundSettings& bound = robot.bound.emplace();
  bound.constant.value = kBeyondAll;
  if (robot.estimator.space == EstimatorSpace::kTorque) {
    bound.kind = BoundSettings::Kind::kPerJoint;
    JointBoundSettings joint;
    joint.value = {kBeyondAll};
    bound.joints.assign(robot.joints.size(), joint);
    if (robot.estimator.fast_alpha > 0) bound.fast = bound.joints;
  }
  return robot;
}

void tell_what_followed(const Scenario& scenario, SilResult& result) {
  result.at_detection = scenario.at_detection;
  if (!result.run.slowed_time_s) return;
  const double end_s = result.ended_early_s.value_or(scenario.duration_s);
  const double since_s = *result.run.slowed_time_s;
  result.slowed =
      Slowed{since_s, scenario.slow_down, since_s + scenario.slow_down.within_s <= end_s};
}

IsolatedFault on_the_runs_clock(IsolatedFault fault, const SilResult& result, double period_s) {
  if (!result.run.detection_time_s) return fault;
  // Ticks, whatever a float makes of their time.
  const double later = std::round((fault.time_s - fault.detection_time_s) / period_s) * period_s;
  fault.detection_time_s = *result.run.detection_time_s;
  fault.time_s = fault.detection_time_s + later;
  return fault;
}

bool is_unasked_stop(const SilResult& result) {
  if (result.fault == controller::Fault::kNone || result.fault == controller::Fault::kDetected) {
    return false;
  }
  const std::optional<double>& begin_s = result.run.fault_time_s;
  return !begin_s || (result.ended_early_s && *result.ended_early_s < *begin_s);
}

std::string words_of(const std::vector<sim::FaultEvent>& faults) {
  if (faults.empty()) return "none";
  std::string words;
  for (const sim::FaultEvent& fault : faults) {
    const sim::FaultEventInfo& info = info_of(fault.kind);
    if (!words.empty()) words += ", ";
    words += info.name;
    if (fault.joint >= 0) words += fmt::format(" on joint {}", fault.joint + 1);
    if (!info.unit.empty() && info.unit != "1") {
      words += fmt::format(" of {:g} {}", fault.size, info.unit);
    } else if (!info.unit.empty()) {
      words += fmt::format(" of {:g} %", 100 * fault.size);
    }
    words += fmt::format(" at {:g} s", fault.begin_s);
    if (std::isfinite(fault.end_s)) words += fmt::format(" until {:g} s", fault.end_s);
  }
  return words;
}

}  // namespace offnominal::desk::sil
