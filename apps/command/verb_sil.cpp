#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/plant_options.hpp"
#include "command/progress.hpp"
#include "command/read_robot.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/error.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"
#include "log/candump_text.hpp"
#include "log/csv_text.hpp"
#include "paper/recording.hpp"
#include "paper/two_link_robot.hpp"
#include "robot/robot_file.hpp"
#include "sil/mujoco_plant_of.hpp"
#include "sil/open_bus.hpp"
#include "sil/real_time.hpp"
#include "sil/scenario_file.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk {
namespace {

struct SilOptions {
  std::optional<std::string> fault;
  std::optional<std::string> scenario;
  bool accommodate = false;
  ActOptions act;
  std::string bus = sil::kInProcess;
  std::string scalar = "float";
  std::optional<std::string> robot;
  PlantOptions other_end;
  std::optional<double> duration;
  bool real_time = false;
  bool lock_step = false;
  bool fd = false;
  std::optional<std::string> log;
  std::optional<std::string> candump;
  AnswerOptions answer;
};

// A robot with the paper's links has the paper's arm for a plant unless --plant names another.
std::optional<std::string> plant_file(const SilOptions& options, const RobotDescription& robot) {
  if (!options.other_end.plant && paper::is_two_link_arm(robot)) return std::nullopt;
  return plant_file(options.other_end, options.robot);
}

sil::Scenario scenario_of(const SilOptions& options, const RobotDescription& robot) {
  sil::Scenario scenario;
  const auto& plant = options.other_end.plant;
  if (plant && sil::mujoco_file_named(*plant) && !options.robot) {
    refuse_option("sil", "--plant", *plant + " without --robot",
                  "a robot file that says its joints", "give --robot FILE.toml");
  }
  if (const auto file = plant_file(options, robot)) scenario.plant = plant_from(*file, robot);
  if (options.scenario) {
    if (options.fault) {
      refuse_option("sil", "--fault", "together with --scenario", "one of the two",
                    "write the fault into the scenario's file");
    }
    scenario = sil::read_scenario(*options.scenario, scenario.plant, options.duration);
  } else if (options.fault == "mass_loss") {
    // Section 5.1 of the paper.
    scenario.faults.push_back(
        {.kind = sim::FaultEventKind::kMassLoss, .begin_s = 10.0, .size = 0.75, .rate_per_s = 0.5});
  } else if (options.fault == "nonlinear") {
    if (scenario.plant) {
      refuse_option("sil", "--fault", "nonlinear, for robot " + scenario.plant->name,
                    "mass_loss or none: nonlinear is a fault of the paper's arm",
                    "write friction_jump, payload or another fault into a file for --scenario, or "
                    "give --plant paper");
    }
    scenario.faults.push_back(
        {.kind = sim::FaultEventKind::kNonlinear, .begin_s = 10.0, .rate_per_s = 0.5});
  }
  put_plant_options(options.other_end, robot, scenario);
  if (options.accommodate) scenario.accommodate = true;
  put_act_options("offnominal sil", options.act, scenario);
  if (options.fd) scenario.format = hal::FrameFormat::kFd;
  if (options.duration) scenario.duration_s = *options.duration;
  scenario.precision = precision_of(options.scalar);
  scenario.record = options.answer.report.has_value() || options.log.has_value();
  return scenario;
}

std::unique_ptr<sil::Wire> wire_of(const std::string& bus) {
  return bus == sil::kInProcess ? sil::make_in_process_wire() : sil::make_socketcan_wire(bus);
}

// Frames are written by the controller's program as they come.
sil::SilResult real_time(const SilOptions& options, const RobotDescription& robot,
                         const sil::Scenario& scenario) {
  if (options.bus == sil::kInProcess) {
    refuse_option("sil", "--real-time", "on the in-process bus", "a CAN interface of the kernel",
                  "give --bus vcan0; where the kernel has no CAN: ./dev vcan COMMAND");
  }
  return sil::run_in_real_time(
      robot, scenario,
      {.interface = options.bus,
       .robot_file = options.robot,
       .plant_file = plant_file(options, robot),
       .motion = options.other_end.motion.value_or(scenario.plant ? "sway" : kPaper),
       .candump = options.candump,
       .replace_candump = options.answer.force});
}

sil::SilResult lock_step(const SilOptions& options, const RobotDescription& robot,
                         const sil::Scenario& scenario) {
  const std::unique_ptr<sil::Wire> wire = wire_of(options.bus);
  std::string frames;
  TappedPort::OnFrame on_frame;
  if (options.candump) {
    const std::string interface = options.bus == sil::kInProcess ? "vcan0" : options.bus;
    on_frame = [&frames, interface](const hal::Frame& frame, hal::Microseconds time_us) {
      frames += candump_line(frame, time_us, interface);
    };
  }
  sil::SilResult result = sil::run_in_lock_step(robot, scenario, *wire, options.bus, on_frame);
  if (options.candump) {
    write_file_atomically(*options.candump, frames, options.answer.existing());
  }
  return result;
}

ExitCode run(const SilOptions& options, const std::string& command_line) {
  RobotDescription robot = options.robot ? read_robot(*options.robot) : paper::two_link_robot();
  // Both programs of a run in real time read the file itself.
  const bool is_judged = robot.bound.has_value();
  if (!is_judged && !options.real_time) robot = sil::never_judged(std::move(robot));
  if (options.robot) require_bound(robot, *options.robot);
  const sil::Scenario scenario = scenario_of(options, robot);
  hal::VirtualCan made;
  sil::make_if_missing(options.bus, made);
  Progress progress;
  progress.begin("running");
  sil::SilResult result =
      options.real_time ? real_time(options, robot, scenario) : lock_step(options, robot, scenario);
  result.is_judged = is_judged;
  progress.end();
  if (!is_judged) {
    std::cerr << *options.robot
              << ": no [uncertainty_bound], so nothing is judged, and no fault is detected: record "
                 "runs without one with --log, and let `offnominal calibrate` find the bound\n";
  }
  if (options.log) {
    write_file_atomically(*options.log,
                          csv_text(paper::seen_recording_of(robot, result.run.series)),
                          options.answer.existing());
  }
  write_report(options.answer, [&] { return page_of(result, command_line); });
  std::vector<std::string> written;
  for (const auto* output : {&options.log, &options.candump}) {
    if (*output) written.push_back(**output);
  }
  print_answer(
      options.answer, [&] { return to_json(result); }, [&] { return text_of(result); }, written);
  return sil::is_unasked_stop(result) ? ExitCode::kCheckFailed : ExitCode::kDone;
}

std::string footer() {
  return "In lock-step every run repeats exactly; in real time none does, and the table says how "
         "the controller kept its time. The controller knows of the plant what comes over the bus, "
         "the drives know what it sends.\n"
         "Exit code 1 where the controller went to its safe state and nobody had asked for that: "
         "no fault of the scenario had begun, and it was not told to stop at a detection.\n"
         "Faults of a scenario's file (docs/sil.md has its keys; all have begin_s):\n" +
         sil::fault_kinds_text();
}

}  // namespace

void set_up_sil(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<SilOptions>();
  verb.add_option("--fault", options->fault, "The paper's: mass_loss, nonlinear or none")
      ->check(CLI::IsMember({"none", "mass_loss", "nonlinear"}));
  verb.add_option("--scenario", options->scenario, "Faults and settings of the run, TOML");
  verb.add_flag("--accommodate", options->accommodate, "Add the compensating torque");
  add_act_options(verb, options->act);
  verb.add_option("--bus", options->bus,
                  "in-process, or a CAN interface of the kernel; vcan0 and its like are made where "
                  "there are none, and removed at the end")
      ->capture_default_str();
  auto* lock_step = verb.add_flag("--lock-step", options->lock_step,
                                  "Both ends in turn, tick by tick: the default");
  verb.add_flag("--real-time", options->real_time,
                "Both ends as programs of their own, offnominal-plant and offnominal-controller, "
                "on the machine's clock")
      ->excludes(lock_step);
  verb.add_flag("--fd", options->fd,
                "CAN FD: one frame for up to 8 joints; by default where classic CAN is too narrow");
  verb.add_option("--scalar", options->scalar, "Arithmetic of the controller; firmware has float")
      ->check(CLI::IsMember({"float", "double"}))
      ->capture_default_str();
  verb.add_option("--robot", options->robot,
                  "Robot file of the controller; by default the paper's arm");
  add_plant_options(verb, options->other_end,
                    "; or paper. By default the paper's arm for a robot of its links, and else the "
                    "controller's robot",
                    "; by default paper for the paper's arm, and else sway");
  verb.add_option("--duration", options->duration, "Length of the run, s [20]");
  verb.add_option("--log", options->log,
                  "Write the run as the controller saw it, and beside it what was true, CSV")
      ->type_name(kNewFile);
  verb.add_option("--candump", options->candump,
                  "Write every frame as candump -l does; hal/offnominal.dbc says what they mean")
      ->type_name(kNewFile);
  add_force_option(verb, options->answer);
  add_report_option(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(footer());
  verb.callback([&verb, options, &exit_code] { exit_code = run(*options, command_line_of(verb)); });
}

}  // namespace offnominal::desk
