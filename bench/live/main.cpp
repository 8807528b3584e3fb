// Hours of the live view, simulated at speed: whether its memory grows and its numbers stay what
// they are. docs/studio.md tells what was measured.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "live/live.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::bench {
namespace {

using Clock = std::chrono::steady_clock;
using desk::live::Live;
using desk::live::Moment;

constexpr double kHourS = 3600;
constexpr double kMebibyte = 1024.0 * 1024.0;
// What a process may take back and forth without growing.
constexpr double kMostGrowthMib = 2;

struct Options {
  double hours = 8;
  std::string robot = OFFNOMINAL_LIVE_ROBOT;
  double bound_nm = 1;
};

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t whole = 0;
  std::int64_t resident = 0;
  statm >> whole >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / kMebibyte;
}

// The file's arm, watched joint by joint with as large a network as there is, whatever its own
// settings are, and with gains where it has none.
desk::RobotDescription robot_of(const Options& options) {
  desk::RobotDescription robot = desk::read_robot_file(options.robot);
  robot.estimator.space = desk::EstimatorSpace::kTorque;
  robot.estimator.hidden_units = 64;
  for (desk::RobotJoint& joint : robot.joints) {
    if (joint.kp > 0) continue;
    joint.kp = 100;
    joint.kd = 20;
  }
  desk::BoundSettings bound;
  bound.kind = desk::BoundSettings::Kind::kPerJoint;
  bound.joints.assign(robot.joints.size(), desk::JointBoundSettings{{}, {options.bound_nm}, 0});
  robot.bound = bound;
  return robot;
}

struct Hour {
  double t_s = 0;
  double mib = 0;
  double largest_share = 0;  // of the threshold, since the hour before
  Moment moment;
};

// Asks as a page does, some thirty times for every simulated second or as often as there is time
// for.
Hour next_hour(const Live& live, double until_s, std::uint64_t& next) {
  Hour hour;
  do {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    hour.moment = live.moment(next);
    next = hour.moment.steps.next;
    for (std::size_t i = 0; i < hour.moment.residual.size(); ++i) {
      const double share = hour.moment.residual[i] / hour.moment.threshold[i];
      if (std::isfinite(share)) hour.largest_share = std::max(hour.largest_share, share);
    }
    hour.t_s = hour.moment.t_s;
  } while (hour.t_s < until_s && hour.moment.ended.empty());
  hour.mib = resident_mib();
  return hour;
}

int run(const Options& options) {
  const desk::RobotDescription robot = robot_of(options);
  desk::sil::Scenario scenario;
  scenario.plant = robot;
  desk::live::LiveInput input;
  input.robot = robot;
  input.robot_file = options.robot;
  input.bus = "at speed";
  Live live(std::move(input), desk::live::make_bench(robot, scenario, desk::live::Pace::kAtSpeed));
  fmt::print("{} joints in torque space, 64 hidden units, {:g} ms a tick\n\n", robot.joints.size(),
             1e3 * robot.estimator.period_s);
  fmt::print("{:>10} {:>12} {:>13} {:>9} {:>9} {:>22}\n", "simulated", "memory, MiB", "frames",
             "missing", "refused", "residual / threshold");
  const auto begin = Clock::now();
  std::uint64_t next = 0;
  double first_mib = 0;
  double last_mib = 0;
  double hour = 0;
  while (hour < options.hours) {
    hour = std::min(hour == 0 ? 0.25 : std::floor(hour) + 1, options.hours);
    const Hour one = next_hour(live, hour * kHourS, next);
    if (first_mib == 0) first_mib = one.mib;  // every ring has been round by then
    last_mib = one.mib;
    fmt::print("{:>8g} h {:>12.1f} {:>13} {:>9} {:>9} {:>22.2g}\n", hour, one.mib,
               one.moment.frames, one.moment.missing, one.moment.refused, one.largest_share);
    std::fflush(stdout);
    if (!one.moment.ended.empty()) {
      fmt::print(stderr, "ended after {:.1f} s: {}\n", one.t_s, one.moment.ended);
      return 1;
    }
    if (one.moment.detection) {
      fmt::print(stderr, "a false alarm at {:.3f} s\n", one.moment.detection->t_s);
      return 1;
    }
  }
  const std::chrono::duration<double> took = Clock::now() - begin;
  fmt::print("\n{:.0f} s, {:.0f} times real time; memory {:+.1f} MiB\n", took.count(),
             options.hours * kHourS / took.count(), last_mib - first_mib);
  return last_mib - first_mib > kMostGrowthMib ? 1 : 0;
}

int main_of(int argc, char** argv) {
  Options options;
  CLI::App app("Hours of the live view, simulated at speed: its memory, and its residuals",
               "./dev bench live");
  app.add_option("--hours", options.hours, "simulated, h")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--robot", options.robot, "robot file; its arm is its own plant");
  app.add_option("--bound", options.bound_nm, "threshold of every joint, N m or N")
      ->check(CLI::Range(1e-6, 1e6))
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return run(options);
}

}  // namespace
}  // namespace offnominal::bench

// 0: no growth and no alarm. 1: one of both. 2: it could not be run.
int main(int argc, char** argv) {
  try {
    return offnominal::bench::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "offnominal_bench_live: %s\n", error.what());
    return 2;
  }
}
