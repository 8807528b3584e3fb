#include "scale.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <system_error>

#include "common/error.hpp"
#include "common/file.hpp"
#include "compare/inverse_model.hpp"
#include "explain/explain.hpp"
#include "explain/explain_report.hpp"
#include "log/csv_text.hpp"
#include "log/sampling.hpp"
#include "robot/robot_file.hpp"
#include "wall_clock.hpp"

namespace offnominal::bench {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kPeriodS = 0.001;
constexpr double kNoiseShare = 0.002;

desk::RobotDescription with_hidden(desk::RobotDescription robot) {
  desk::RobotEffect coulomb;
  coulomb.kind = EffectKind::kCoulombFriction;
  coulomb.joint = 3;
  coulomb.parameters = {3.0, 0.01};
  desk::RobotEffect ripple;
  ripple.kind = EffectKind::kCoggingTorque;
  ripple.joint = 1;
  ripple.parameters = {1.2, 0.4, 11.0};
  robot.effects.push_back(coulomb);
  robot.effects.push_back(ripple);
  return robot;
}

struct MotionWave {
  double size, rad_s, phase;
};

// Peaks stay within 80 % of the range and of the speed limit.
std::array<MotionWave, 6> waves_of(const Joint<double>& joint, std::mt19937_64& generator) {
  constexpr double kShare = 0.8;
  constexpr double kSlowestHz = 0.05;
  constexpr double kFastestHz = 1.5;
  std::uniform_real_distribution<double> unit(0, 1);
  std::array<MotionWave, 6> waves{};
  double range = 0;
  double speed = 0;
  for (std::size_t i = 0; i < waves.size(); ++i) {
    const double part = (static_cast<double>(i) + unit(generator)) / 6;
    const double hz = kSlowestHz * std::pow(kFastestHz / kSlowestHz, part);
    waves[i] = {(0.5 + unit(generator)) / std::sqrt(hz), 2 * std::numbers::pi * hz,
                2 * std::numbers::pi * unit(generator)};
    range += waves[i].size;
    speed += waves[i].size * waves[i].rad_s;
  }
  const double scale = kShare * std::min((joint.max_position - joint.min_position) / 2 / range,
                                         joint.max_velocity / speed);
  for (MotionWave& wave : waves) wave.size *= scale;
  return waves;
}

desk::Motion motion_of(const desk::RobotDescription& robot, Index samples,
                       std::mt19937_64& generator) {
  const Index joints = robot.joint_count();
  desk::Motion motion;
  motion.t_s = VectorXd::LinSpaced(samples, 0, kPeriodS * static_cast<double>(samples - 1));
  motion.q.resize(samples, joints);
  motion.dq.setZero(samples, joints);
  motion.ddq.setZero(samples, joints);
  for (Index j = 0; j < joints; ++j) {
    const Joint<double>& joint = robot.joints[static_cast<std::size_t>(j)].joint;
    motion.q.col(j).setConstant((joint.max_position + joint.min_position) / 2);
    for (const MotionWave& wave : waves_of(joint, generator)) {
      const Eigen::ArrayXd angle = wave.rad_s * motion.t_s.array() + wave.phase;
      motion.q.col(j).array() += wave.size * angle.sin();
      motion.dq.col(j).array() += wave.size * wave.rad_s * angle.cos();
      motion.ddq.col(j).array() -= wave.size * wave.rad_s * wave.rad_s * angle.sin();
    }
  }
  return motion;
}

double cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& at) {
    return static_cast<double>(at.tv_sec) + 1e-6 * static_cast<double>(at.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

double peak_gib() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / (1024.0 * 1024.0);
}

}  // namespace

desk::RobotDescription scale_robot() { return desk::read_robot_file(OFFNOMINAL_SCALE_ROBOT); }

desk::Log scale_recording(const desk::RobotDescription& robot, const ScaleRequest& request) {
  std::mt19937_64 generator(request.seed);
  desk::Motion motion = motion_of(robot, request.samples, generator);
  desk::Log log;
  log.file = "simulated";
  log.period_s = kPeriodS;
  log.tau = desk::model_torque(with_hidden(robot), motion);
  log.t_s = std::move(motion.t_s);
  log.q = std::move(motion.q);
  log.dq = std::move(motion.dq);
  log.dq_derived.assign(robot.joints.size(), true);
  for (Index j = 0; j < log.q.cols(); ++j) {
    const desk::RobotJoint& joint = robot.joints[static_cast<std::size_t>(j)];
    const double counts = joint.encoder.counts_per_unit;
    log.q.col(j) = (log.q.col(j).array() * counts).round() / counts;
    std::normal_distribution<double> noise(0, kNoiseShare * joint.joint.max_torque);
    for (double& torque : log.tau.col(j)) torque += noise(generator);
  }
  return log;
}

ScaleOutcome run_scale(const ScaleRequest& request) {
  const desk::RobotDescription robot = scale_robot();
  const std::vector<desk::Log> logs{scale_recording(robot, request)};
  desk::ExplainOptions options;
  options.threads = request.threads;
  const double start_s = now_s();
  const double start_cpu_s = cpu_s();
  const desk::Explanation told = desk::explain(robot, logs, {}, options, {});
  ScaleOutcome outcome;
  outcome.wall_s = now_s() - start_s;
  outcome.cpu_s = cpu_s() - start_cpu_s;
  outcome.peak_gib = peak_gib();
  const nlohmann::ordered_json json =
      to_json(told, desk::ExplainNames{{"simulated"}, {}, "seven_joint_arm.toml", ""});
  outcome.verdict = json.at("verdict").get<std::string>();
  for (const nlohmann::ordered_json& one : json.at("found")) {
    outcome.found.push_back(fmt::format("{} of joint {}", one.at("effect").get<std::string>(),
                                        one.at("joint").get<int>()));
  }
  outcome.explanation = json.dump(2);
  return outcome;
}

std::string text_of(const ScaleRequest& request, const ScaleOutcome& outcome) {
  return fmt::format(
      "{} samples x 7 joints, seed {}, {} thread(s)\n"
      "verdict {}: {}\nexplain: {:.1f} s, {:.1f} s of processor time\n"
      "largest memory of the program, recording included: {:.2f} GiB\n",
      request.samples, request.seed, request.threads, outcome.verdict,
      fmt::join(outcome.found, ", "), outcome.wall_s, outcome.cpu_s, outcome.peak_gib);
}

nlohmann::ordered_json json_of(const ScaleRequest& request, const ScaleOutcome& outcome) {
  return {{"samples", request.samples},
          {"joints", 7},
          {"seed", request.seed},
          {"threads", request.threads},
          {"wall_s", outcome.wall_s},
          {"cpu_s", outcome.cpu_s},
          {"peak_gib", outcome.peak_gib},
          {"explanation", nlohmann::ordered_json::parse(outcome.explanation)}};
}

void write_scale(const ScaleRequest& request, const std::filesystem::path& folder) {
  std::error_code failed;
  if (!std::filesystem::create_directories(folder, failed) || failed) {
    throw desk::InputError({folder.string(), "",
                            failed ? failed.message() : "a folder that is there already",
                            "a new folder", "name another one with --write"});
  }
  const desk::RobotDescription robot = scale_robot();
  desk::Log log = scale_recording(robot, request);
  desk::write_robot_file(robot, folder / "robot.toml");
  desk::derive_velocities(log);
  desk::write_file_atomically(folder / "recording.csv", csv_text(log));
}

}  // namespace offnominal::bench
