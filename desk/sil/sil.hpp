// Software-in-the-loop: the joint controller of a robot and a plant at the two ends of a bus.
#pragma once

#include <cstddef>
#include <cstdint>
#include <offnominal/controller/fault.hpp>
#include <offnominal/hal/drive_description.hpp>
#include <offnominal/hal/messages.hpp>
#include <optional>
#include <string>
#include <vector>

#include "loop/at_detection.hpp"
#include "loop/motion_at.hpp"
#include "offnominal/sim/bus/fault_event.hpp"
#include "paper/run_result.hpp"
#include "robot/isolated_fault.hpp"
#include "robot/robot.hpp"
#include "sil/wire.hpp"

namespace offnominal::desk::sil {

struct Scenario : paper::RunSettings, ActSettings {
  /// What stands at the other end: the rigid body and the effects of a robot file; none: the
  /// paper's arm with its uncertainty.
  std::optional<RobotDescription> plant;
  /// An MJCF or URDF whose dynamics, friction and limits the plant has in place of those of
  /// `plant`, which then says the joints alone.
  std::optional<std::string> mujoco;
  std::vector<RobotEffect> hidden;  // in the plant alone, beside the effects of its file
  MotionAt motion;                  // none: the paper's for its arm, sway_of() for another
  std::vector<sim::FaultEvent> faults;
  std::optional<hal::FrameFormat> format;  // none: classic where it is wide enough, else CAN FD
  int encoder_bits_per_turn = 0;           // on top of what a frame resolves; 0: none
  bool sends_velocity = true;
  double max_acceleration = 20;  // rad/s^2; bounds the velocity observer's error
  std::uint64_t seed = 1;        // of the faults on the bus
};

/// Counted at both ends.
struct BusReport {
  std::uint64_t frames = 0;    // sent
  std::uint64_t lost = 0;      // by the counters of accepted records
  std::uint64_t rejected = 0;  // wrong CRC, value, counter, length or format
  std::uint64_t stale = 0;     // ticks without a fresh reading of every joint
  std::uint64_t late = 0;      // not sent, their deadline had passed
  double load = 0;             // share of the time that the bus is busy at most, at hal::BitRates
};

/// How a run in real time kept its time.
struct RealTimeReport {
  std::uint64_t ticks = 0;         // of the controller
  std::int64_t worst_late_us = 0;  // begin of one of its ticks after its time
  std::int64_t worst_step_us = 0;  // a tick's work
  double mean_step_us = 0;
  int fifo_priority = 0;  // 0: ordinary scheduling
  bool memory_locked = false;
  std::uint64_t plant_overruns = 0;  // late ticks of the plant
  std::uint64_t recording_lost = 0;  // entries, at both ends
};

/// An arm that its controller could not hold before the motion began.
struct NotHeld {
  std::size_t joint = 0;  // that went furthest beyond its window, or was the fastest; from 0
  std::string name;
  std::string unit;                 // of its position
  double moved = 0;                 // since the brakes opened, rad or m
  double window = 0;                // position_window, rad or m
  double speed = 0;                 // when it was let go of, rad/s or m/s
  double speed_limit = 0;           // rad/s or m/s
  std::vector<std::string> causes;  // what it may be and what to change; may be none
};

/// A motion that the controller slowed at its second level.
struct Slowed {
  double time_s = 0;  // of the run, since the arm was free to move
  SlowDownConfig<double> as;
  bool reached = false;  // the pace, before the run ended
};

struct SilResult {
  paper::ExperimentResult run;  // as far as it got
  std::string bus_name;
  std::vector<sim::FaultEvent> faults;
  BusReport bus;
  hal::ControllerState state = hal::ControllerState::kInit;  // at the end
  controller::Fault fault = controller::Fault::kNone;
  /// From the first fault's begin until no drive gives a commanded torque; none where that is not
  /// what happened.
  std::optional<double> time_to_safe_state_s;
  std::optional<double> ended_early_s;  // since arming; none: the run went to its end
  std::optional<NotHeld> not_held;      // of Fault::kArmNotHeld
  controller::AtDetection at_detection = controller::AtDetection::kReport;  // as it was told
  std::optional<Slowed> slowed;
  bool is_judged = true;  // false: of a robot without a bound, never_judged()
  std::uint64_t overruns = 0;
  std::optional<IsolatedFault> isolated;    // the controller's last answer, on the run's clock
  double run_time_s = 0;                    // of the bus, from the first tick to the last
  std::optional<RealTimeReport> real_time;  // none for a run in lock-step
};

/// The same robot, with a bound that nothing comes to, nor is shown, where it has none: its runs
/// are recordings to calibrate on.
[[nodiscard]] RobotDescription never_judged(RobotDescription robot);

/// Refuses, with InputError, a scenario that cannot be run: as paper::check_run() and
/// check_plant(), robots of different joints, and a fault out of its range.
void check_scenario(const RobotDescription& robot, const Scenario& scenario);

/// Runs it tick by tick, both ends in turn. The same scenario gives the same result on any wire. A
/// run ends early 0.1 s after the drives have stopped to give torque. `on_frame` sees every frame.
[[nodiscard]] SilResult run_in_lock_step(const RobotDescription& robot, const Scenario& scenario,
                                         Wire& wire, const std::string& bus_name,
                                         const TappedPort::OnFrame& on_frame = {});

/// Says of a run that has ended what became of the motion beyond the second level.
void tell_what_followed(const Scenario& scenario, SilResult& result);

/// The controller's answer in times of the run, as run.detection_time_s is: since the arm was free
/// to move. The controller counts from when it holds the arm.
[[nodiscard]] IsolatedFault on_the_runs_clock(IsolatedFault fault, const SilResult& result,
                                              double period_s);

/// Whether the controller went to its safe state although nobody asked for that: no detection that
/// it was told to stop at, and no fault of the scenario that had begun.
[[nodiscard]] bool is_unasked_stop(const SilResult& result);

/// "mass_loss at 10 s": every fault of the run; "none".
[[nodiscard]] std::string words_of(const std::vector<sim::FaultEvent>& faults);

}  // namespace offnominal::desk::sil
