// offnominal-wcet: how long one tick of the joint controller takes here, at worst.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/progress.hpp"
#include "common/program.hpp"
#include "paper/two_link_robot.hpp"
#include "robot/robot_file.hpp"
#include "wcet/wcet_report.hpp"

namespace offnominal::desk {
namespace {

struct Options {
  const CLI::App* app = nullptr;
  std::optional<std::string> robot;
  std::string scalar = "float";
  bool fd = false;
  wcet::WcetSettings settings;
  AnswerOptions answer;
};

int run(const Options& options) {
  const RobotDescription robot =
      options.robot ? read_robot_file(*options.robot) : paper::two_link_robot();
  if (options.robot) require_bound(robot, *options.robot);
  wcet::WcetSettings settings = options.settings;
  settings.precision = precision_of(options.scalar);
  settings.format = options.fd ? hal::FrameFormat::kFd : hal::FrameFormat::kClassic;
  Progress progress;
  const wcet::WcetResult result =
      wcet::measure_wcet(robot, settings, [&progress](const std::string& what, std::int64_t done) {
        progress.begin(done > 0 ? fmt::format("{}: {} done", what, done) : what);
      });
  progress.end();
  write_report(options.answer,
               [&] { return wcet::page_of(result, command_line_of(*options.app)); });
  print_answer(
      options.answer, [&] { return wcet::to_json(result); }, [&] { return wcet::text_of(result); });
  return 0;
}

void add_measurement_options(CLI::App& app, wcet::WcetSettings& settings) {
  app.add_option("--ticks", settings.ticks, "Ticks of the worst input, warm cache")
      ->check(CLI::Range(std::int64_t{1}, wcet::kMostTicks))
      ->capture_default_str();
  app.add_option("--cold-ticks", settings.cold_ticks,
                 "Ticks with a cold cache [a thousandth of --ticks, 100 to 10000]")
      ->check(CLI::Range(std::int64_t{1}, wcet::kMostTicks));
  app.add_option("--period", settings.period_s,
                 "Period that a tick must not outlast, s [the robot's]")
      ->check(CLI::Range(1e-6, 10.0));
  app.add_option("--search", settings.search.evaluations, "Inputs that the search tries")
      ->check(CLI::Range(0, 10'000'000))
      ->capture_default_str();
  app.add_option("--seed", settings.search.seed, "Of the search")->capture_default_str();
  app.add_option("--exceedance", settings.exceedance,
                 "Probability per tick of the extrapolated bound")
      ->check(CLI::Range(1e-15, 0.1))
      ->capture_default_str();
}

void add_machine_options(CLI::App& app, wcet::WcetSettings& settings) {
  app.add_option("--priority", settings.machine.priority, "Ask for SCHED_FIFO with this priority")
      ->check(CLI::Range(1, 99));
  app.add_flag(
      "--flush-subnormals", settings.machine.flush_subnormals,
      "Let the processor take 0 for subnormal numbers (FTZ and DAZ of x86), as a controller "
      "on Linux may");
  app.add_option("--cpu", settings.machine.cpu, "Stay on this CPU");
  app.add_flag("--compare-cyclictest", settings.compare_cyclictest,
               "Also wake the tick every period, and run cyclictest (package rt-tests) under the "
               "same settings");
  app.add_option("--cyclic-ticks", settings.cyclic_ticks, "Wake-ups of each of the two")
      ->check(CLI::Range(std::int64_t{1}, wcet::kMostTicks))
      ->capture_default_str();
}

void add_options(CLI::App& app, Options& options) {
  options.app = &app;
  app.add_option("--robot", options.robot, "Robot file; by default the paper's arm");
  app.add_option("--scalar", options.scalar, "Arithmetic of the controller")
      ->check(CLI::IsMember({"float", "double"}))
      ->capture_default_str();
  app.add_flag("--fd", options.fd, "CAN FD: one frame for up to 8 joints");
  add_measurement_options(app, options.settings);
  add_machine_options(app, options.settings);
  add_page_options(app, options.answer, "histograms");
  add_json_option(app, options.answer);
  app.footer(
      "A tick receives and decodes frames, runs the monitor, computes the torque and encodes it. "
      "It "
      "is timed alone, again and again from the same beginning; docs/worst-case.md says what each "
      "number means and what it does not prove.");
}

}  // namespace
}  // namespace offnominal::desk

int main(int argc, char** argv) {
  using namespace offnominal::desk;
  return run_program<Options>("offnominal-wcet",
                              "How long one tick of the joint controller takes here, at worst",
                              argc, argv, add_options, run, report::is_page);
}
