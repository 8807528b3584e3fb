// offnominal-plant: a plant with drives and encoders at its end of a CAN bus, with faults.
#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <offnominal/hal/bus/socketcan.hpp>
#include <offnominal/realtime/privileges.hpp>
#include <offnominal/realtime/signals.hpp>
#include <optional>
#include <string>
#include <thread>

#include "common/error.hpp"
#include "common/json_text.hpp"
#include "common/numeric_options.hpp"
#include "common/output_file.hpp"
#include "common/program.hpp"
#include "drives/drive_settings.hpp"
#include "loop/controller_settings.hpp"
#include "loop/frame_format.hpp"
#include "paper/two_link_robot.hpp"
#include "robot/robot_file.hpp"
#include "sil/mujoco_plant_of.hpp"
#include "sil/open_bus.hpp"
#include "sil/open_recorder.hpp"
#include "sil/plant_loop.hpp"
#include "sil/plant_of.hpp"
#include "sil/scenario_file.hpp"

namespace offnominal::desk {
namespace {

constexpr const char* kProgram = "offnominal-plant";

struct Options {
  std::string bus;
  std::optional<std::string> robot;
  std::optional<std::string> plant;
  std::optional<std::string> drives;
  std::optional<std::string> motion;
  std::optional<std::string> scenario;
  double rate_hz = 1000;
  double phase = 0.5;
  std::optional<double> duration_s;
  bool fd = false;
  bool classic = false;
  int priority = 80;
  std::optional<std::string> log;
  bool force = false;
  bool json = false;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("--bus", options.bus, "CAN interface: vcan0")->required();
  app.add_option("--robot", options.robot,
                 "Robot file of the plant: its rigid body and effects; by default the paper's arm");
  app.add_option("--plant", options.plant,
                 "mujoco:FILE, an MJCF or URDF with the joints of --robot, whose dynamics take the "
                 "place of the robot file's");
  app.add_option("--drives", options.drives,
                 "Robot file whose [drives] are here; by default those of --robot");
  app.add_option("--motion", options.motion,
                 "The controller's: where this begins, brakes hold the joints. paper, sway or a "
                 "CSV; by default paper for the paper's arm, sway for a robot file");
  app.add_option("--scenario", options.scenario,
                 "Faults and settings of the run, TOML; without it nothing is wrong");
  app.add_option("--rate", options.rate_hz, "Ticks a second: readings, steps of the plant")
      ->check(CLI::Range(10.0, 10000.0))
      ->capture_default_str();
  app.add_option("--phase", options.phase,
                 "Ticks begin so much of a period after its multiples on CLOCK_MONOTONIC")
      ->check(CLI::Range(0.0, 0.999))
      ->capture_default_str();
  app.add_option("--duration", options.duration_s, "End after so many seconds")
      ->check(above_zero());
  auto* fd = app.add_flag("--fd", options.fd, "CAN FD: one frame for up to 8 joints");
  app.add_flag("--classic", options.classic,
               "Classic CAN; without either what fits into a tick, classic CAN first")
      ->excludes(fd);
  app.add_option("--priority", options.priority, "Of SCHED_FIFO; 0: do not ask for it")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  app.add_option("--log", options.log, "Record the true motion, CSV")->type_name(kNewFile);
  app.add_flag("--force", options.force, "Replace the file of --log");
  app.add_flag("--json", options.json, "Print one JSON object and nothing else");
  app.footer(
      "Until every drive is first told to give torque, brakes hold the joints; the faults' times "
      "count from there. SIGINT and SIGTERM end it. docs/sil.md has the rest.");
}

RobotDescription robot_of(const sil::Scenario& scenario) {
  return scenario.plant ? *scenario.plant : paper::two_link_robot();
}

DriveSettings drives_of(const Options& options, const sil::Scenario& scenario) {
  if (!options.drives) return robot_of(scenario).drive_settings();
  const RobotDescription robot = read_robot_file(*options.drives);
  if (robot.joint_count() == sil::joint_count_of(scenario)) return robot.drive_settings();
  throw InputError({*options.drives, "drives", std::to_string(robot.joint_count()) + " joint(s)",
                    std::to_string(sil::joint_count_of(scenario)) + ", as the plant", ""});
}

// The file of MuJoCo that --plant names.
std::optional<std::string> mujoco_of(const Options& options) {
  if (!options.plant) return std::nullopt;
  auto file = sil::mujoco_file_named(*options.plant);
  if (!file) {
    throw InputError({kProgram, "--plant", "`" + *options.plant + "`", "mujoco:FILE",
                      "name a robot file by --robot"});
  }
  if (!options.robot) {
    throw InputError({kProgram, "--plant", *options.plant + " without --robot",
                      "a robot file that says its joints", "give --robot FILE.toml"});
  }
  return file;
}

sil::Scenario scenario_of(const Options& options) {
  std::optional<RobotDescription> plant;
  if (options.robot) plant = read_robot_file(*options.robot);
  sil::Scenario scenario;
  scenario.plant = plant;
  if (options.scenario) scenario = sil::read_scenario(*options.scenario, plant);
  scenario.mujoco = mujoco_of(options);
  if (options.fd || options.classic) {
    scenario.format = wished_format(options.fd, options.classic);
  }
  if (options.motion) scenario.motion = motion_named(*options.motion, robot_of(scenario));
  sil::check_real_time(scenario);
  sil::check_plant(scenario);
  return scenario;
}

void print(const Options& options, const PlantReport& report, std::uint64_t recording_lost,
           const realtime::Grant& grant) {
  const nlohmann::ordered_json json = {{"ticks", report.ticks},
                                       {"overruns", report.overruns},
                                       {"arm_time_s", report.arm_time_s},
                                       {"in_torque_mode", report.in_torque_mode},
                                       {"bus",
                                        {{"name", options.bus},
                                         {"sent", report.bus.sent},
                                         {"received", report.bus.received},
                                         {"late", report.bus.late},
                                         {"lost", report.counts.lost},
                                         {"rejected", report.counts.rejected}}},
                                       {"recording_lost", recording_lost}};
  if (options.json) {
    std::cout << json_text(json);
    return;
  }
  std::cout << "real time: " << words_of(grant) << '\n';
  const nlohmann::ordered_json flat = json.flatten();
  for (const auto& [name, value] : flat.items()) {
    std::cout << name.substr(1) << ": " << value << '\n';
  }
}

int run(const Options& options) {
  const sil::Scenario scenario = scenario_of(options);
  const double period_s = 1 / options.rate_hz;
  const DriveSettings drives = drives_of(options, scenario);
  sil::check_drives(scenario, drives, period_s);
  const realtime::Signals signals;
  hal::SocketCan socket;
  sil::open_bus(options.bus,
                {.in_kernel = hal::SocketCanConfig::kMostInKernel, .may_restart_interface = false},
                socket);
  BusPortOf<hal::SocketCan&> port(socket);
  realtime::Recorder recorder;
  sil::open_recorder({.csv = options.log.value_or(""),
                      .columns = plant_columns(sil::joint_count_of(scenario)),
                      .replace = options.force},
                     recorder);
  const hal::Microseconds period_us = period_us_of(period_s);
  sim::PlantNode plant = sil::plant_of(scenario, drives, period_s);
  realtime::CycleTimer timer(period_us,
                             std::llround(options.phase * static_cast<double>(period_us)));
  std::atomic<bool> end{false};
  PlantReport report;
  realtime::Grant grant;
  std::thread loop([&] {
    grant = realtime::ask_for({.priority = options.priority});
    report = run_plant(plant, scenario, timer, port, recorder, end);
  });
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto is_over = [&] {
    return options.duration_s &&
           std::chrono::duration<double>(Clock::now() - begin).count() >= *options.duration_s;
  };
  // Signals that are for controllers do not concern it.
  for (int signal = 0; signal != SIGINT && signal != SIGTERM && !is_over();) {
    signal = signals.wait(std::chrono::milliseconds{20});
  }
  end.store(true);
  loop.join();
  recorder.close();
  print(options, report, recorder.lost(), grant);
  return 0;
}

}  // namespace
}  // namespace offnominal::desk

int main(int argc, char** argv) {
  using namespace offnominal::desk;
  return run_program<Options>(kProgram,
                              "A plant, its drives and encoders, on a CAN bus in real time", argc,
                              argv, add_options, run);
}
