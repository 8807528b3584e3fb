// offnominal-controller: the joint controller of a robot file on a CAN interface of Linux.
#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <exception>
#include <iostream>
#include <limits>
#include <offnominal/hal/bus/socketcan.hpp>
#include <offnominal/realtime/signals.hpp>
#include <optional>
#include <string>
#include <thread>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/numeric_options.hpp"
#include "common/output_file.hpp"
#include "common/program.hpp"
#include "controller/outcome.hpp"
#include "controller/timers.hpp"
#include "drives/drive_table.hpp"
#include "loop/frame_format.hpp"
#include "loop/joint_program.hpp"
#include "loop/motion_at.hpp"
#include "loop/refusal_words.hpp"
#include "paper/two_link_robot.hpp"
#include "robot/robot_file.hpp"
#include "sil/open_bus.hpp"
#include "sil/open_recorder.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk {
namespace {

using realtime::Microseconds;

constexpr const char* kProgram = "offnominal-controller";

struct Options {
  std::string bus;
  std::optional<std::string> robot;
  std::optional<double> rate_hz;
  double phase = 0;
  std::optional<double> duration_s;
  bool arm = false;
  std::string motion = "hold";
  bool accommodate = false;
  ActOptions act;
  bool end_at_fault = false;
  std::string safe_mode = "off";
  bool fd = false;
  bool classic = false;
  std::optional<double> max_acceleration;
  int encoder_bits_per_turn = 0;
  int priority = 80;
  bool no_lock = false;
  bool no_restart = false;
  std::optional<std::string> candump;
  std::optional<std::string> log;
  bool force = false;
  bool json = false;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--bus", options.bus, "CAN interface: can0, vcan0")->required();
  app.add_option("--robot", options.robot,
                 "Robot file of up to 12 joints, with a bound; by default the paper's arm");
  app.add_option("--rate", options.rate_hz,
                 "Ticks a second, 10 to 10000; by default 1 over the "
                 "robot file's period_s, which is 1000 unless it says "
                 "otherwise")
      ->check(CLI::Range(10.0, 10000.0));
  app.add_option("--phase", options.phase,
                 "Ticks begin so much of a period after its multiples on CLOCK_MONOTONIC")
      ->check(CLI::Range(0.0, 0.999))
      ->capture_default_str();
  app.add_option("--duration", options.duration_s,
                 "End after so many seconds; with --arm they count from arming")
      ->check(above_zero());
  app.add_flag("--arm", options.arm,
               "Arm once, as soon as every joint is heard; end where that is refused");
  app.add_option("--motion", options.motion,
                 "Where the joints should be from arming on: hold, paper, sway, or a CSV as "
                 "offnominal motion writes it")
      ->capture_default_str();
  app.add_flag("--accommodate", options.accommodate, "Add the compensating torque");
  add_act_options(app, options.act);
  app.add_flag("--end-at-fault", options.end_at_fault, "End 0.1 s after a fault");
  app.add_option("--safe-mode", options.safe_mode, "What drives are told in the safe state")
      ->check(CLI::IsMember({"off", "damping"}))
      ->capture_default_str();
  auto* fd = app.add_flag("--fd", options.fd, "CAN FD: one frame for up to 8 joints");
  app.add_flag("--classic", options.classic,
               "Classic CAN; without either what fits into a tick, classic CAN first")
      ->excludes(fd);
  app.add_option("--observe-velocity", options.max_acceleration,
                 "Drives send positions alone; no joint accelerates faster, rad/s^2 or m/s^2")
      ->check(above_zero());
  app.add_option("--encoder-bits", options.encoder_bits_per_turn,
                 "Of the encoders, with --observe-velocity")
      ->check(CLI::Range(1, 32));
  app.add_option("--priority", options.priority, "Of SCHED_FIFO; 0: do not ask for it")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  app.add_flag("--no-lock", options.no_lock, "Do not lock memory");
  app.add_flag("--no-restart", options.no_restart,
               "Never restart the interface to take late frames back from it");
  app.add_option("--candump", options.candump, "Record every frame, as candump -l does")
      ->type_name(kNewFile);
  app.add_option("--log", options.log, "Record every tick with a fresh reading, CSV")
      ->type_name(kNewFile);
  app.add_flag("--force", options.force, "Replace the files of --log and --candump");
  app.add_flag("--json", options.json, "Print one JSON object and nothing else");
  app.footer(
      "SIGUSR1 arms (passive -> armed), SIGUSR2 clears a fault (fault -> init), SIGINT, SIGTERM, "
      "SIGHUP, SIGQUIT, SIGPIPE and SIGTSTP (Ctrl-Z) disarm and end. Times of the recordings are "
      "those of "
      "CLOCK_MONOTONIC. Exit codes: 0 ended "
      "without a fault, 1 there was one, 2 wrong input. docs/controller.md has the rest.");
}

RobotDescription robot_of(const Options& options) {
  RobotDescription robot =
      options.robot ? read_robot_file(*options.robot) : paper::two_link_robot();
  if (options.rate_hz) robot.estimator.period_s = 1 / *options.rate_hz;
  require_bound(robot, options.robot.value_or(robot.name));
  return robot;
}

ControllerSettings settings_of(const Options& options) {
  ControllerSettings settings;
  settings.accommodate = options.accommodate;
  put_act_options(kProgram, options.act, settings);
  settings.safe_mode = options.safe_mode == "off" ? hal::DriveMode::kOff : hal::DriveMode::kDamping;
  settings.max_acceleration = options.max_acceleration;
  settings.encoder_bits_per_turn = options.encoder_bits_per_turn;
  return settings;
}

Microseconds microseconds(double seconds) { return std::llround(1e6 * seconds); }

// Says what changes while the loop runs, and passes on what signals ask for.
void attend(const RobotDescription& robot, const realtime::Signals& signals,
            const realtime::Recorder& recorder, realtime::LoopPanel& panel,
            const std::atomic<bool>& over) {
  constexpr std::chrono::milliseconds kLook{20};
  hal::ControllerState shown = hal::ControllerState::kInit;
  bool recording_failed = false;
  while (!over.load()) {
    switch (signals.wait(kLook)) {
      case SIGINT:
      case SIGTERM:
      case SIGHUP:  // the terminal is gone, or who read what is printed: nobody looks any more
      case SIGQUIT:
      case SIGPIPE:
      case SIGTSTP:  // stopped, it would leave the arm alone with its last torque
        panel.end.store(true);
        break;
      case SIGUSR1:
        panel.arm.store(true);
        break;
      case SIGUSR2:
        panel.clear.store(true);
        break;
      default:
        break;
    }
    const hal::ControllerState state = panel.state.load();
    if (state != shown) {
      std::cerr << kProgram << ": " << sil::name_of(state);
      if (state == hal::ControllerState::kFault) {
        std::cerr << ": " << controller::name_of(panel.fault.load());
      }
      std::cerr << '\n';
      shown = state;
    }
    const controller::Fault refusal = panel.refusal.exchange(controller::Fault::kNone);
    if (refusal != controller::Fault::kNone) {
      std::cerr << kProgram << ": not armed: " << controller::name_of(refusal) << " ("
                << static_cast<int>(refusal) << "); " << mend_of(refusal, robot) << '\n';
    }
    if (!recording_failed && recorder.error_number() != 0) {
      recording_failed = true;
      std::cerr << kProgram << ": " << recorder.failed_file() << ": "
                << std::strerror(recorder.error_number()) << "; the recording ends there\n";
    }
  }
}

int run(const Options& options) {
  const RobotDescription robot = robot_of(options);
  const int joints = static_cast<int>(robot.joints.size());
  const DriveSettings drives = robot.drive_settings();
  if (options.max_acceleration) require_positions_alone(drives);
  // Before there is any other thread.
  const realtime::Signals signals;
  hal::SocketCan socket;
  const auto receive = from_drives(drives);
  const auto transmit = from_controller(drives);
  sil::open_bus(
      options.bus,
      {.receive = receive, .transmit = transmit, .may_restart_interface = !options.no_restart},
      socket);
  BusPortOf<hal::SocketCan&> bus(socket);
  realtime::Recorder recorder;
  sil::open_recorder(
      {.candump = options.candump.value_or(""),
       .interface = options.bus,
       .csv = options.log.value_or(""),
       .columns = realtime::loop_columns(joints, robot.estimator.space == EstimatorSpace::kTorque,
                                         robot.estimator.fast_alpha > 0),
       .replace = options.force},
      recorder);
  const Microseconds period_us = period_us_of(robot.estimator.period_s);
  RealTimeTimer timer(period_us, std::llround(options.phase * static_cast<double>(period_us)));
  realtime::LoopPanel panel;
  const auto program = make_joint_program(
      {.robot = robot,
       .settings = settings_of(options),
       .format = format_for(drives, joints, robot.estimator.period_s,
                            wished_format(options.fd, options.classic)),
       .loop = {.arm_when_passive = options.arm,
                .duration_us = microseconds(options.duration_s.value_or(0)),
                .end_at_fault = options.end_at_fault},
       .wish = {.priority = options.priority, .lock_memory = !options.no_lock},
       .motion = options.motion == "hold" ? MotionAt{} : motion_named(options.motion, robot),
       .bus = bus,
       .timer = timer,
       .recorder = recorder,
       .panel = panel});
  std::atomic<bool> over{false};
  std::exception_ptr refused;
  std::thread loop([&] {
    try {
      program->run();
    } catch (...) {
      refused = std::current_exception();
    }
    over.store(true);
  });
  attend(robot, signals, recorder, panel, over);
  loop.join();
  recorder.close();
  if (refused) std::rethrow_exception(refused);
  const ControllerOutcome outcome{program->report(), joint_names(robot),     options.bus,
                                  socket.state(),    socket.can_take_back(), recorder.lost()};
  std::cout << (options.json ? json_text(to_json(outcome)) : text_of(outcome));
  const realtime::LoopReport& report = outcome.report.loop;
  const bool well =
      report.fault == controller::Fault::kNone && report.refusal == controller::Fault::kNone;
  return well ? 0 : 1;
}

}  // namespace
}  // namespace offnominal::desk

int main(int argc, char** argv) {
  using namespace offnominal::desk;
  return run_program<Options>(kProgram,
                              "The joint controller of a robot on a CAN bus, in real time", argc,
                              argv, add_options, run);
}
