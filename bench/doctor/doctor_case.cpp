#include "doctor_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "compare/inverse_model.hpp"
#include "compare/motion.hpp"
#include "log/sampling.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::bench {
namespace {

namespace recorded = sim::recorded;
using desk::DataFaultKind;
using Eigen::Index;
using recorded::Defect;
using sim::hidden::Draws;

constexpr int kJoints = 6;

// Six of seven joints: the last left out, or the first, whose place the next one takes.
desk::RobotDescription six_joints(Family family) {
  static const desk::RobotDescription kSeven = desk::read_robot_file(OFFNOMINAL_DOCTOR_ROBOT);
  desk::RobotDescription robot = kSeven;
  const int gone = family == Family::kDeveloped ? kJoints : 0;
  robot.joints.erase(robot.joints.begin() + gone);
  std::erase_if(robot.effects, [gone](const auto& effect) { return effect.joint == gone; });
  for (auto& effect : robot.effects) {
    if (effect.joint > gone) --effect.joint;
  }
  robot.file_text = nullptr;
  return robot;
}

desk::RobotDescription as_it_is(desk::RobotDescription robot, Draws& draws) {
  for (desk::RobotJoint& joint : robot.joints) {
    const double factor = draws.uniform(0.97, 1.03);
    joint.joint.mass_kg *= factor;
    for (double& inertia : joint.joint.inertia_kg_m2) inertia *= factor;
  }
  for (auto& effect : robot.effects) effect.parameters[0] *= draws.uniform(0.7, 1.3);
  return robot;
}

recorded::MotionRequest request_of(Family family, const desk::RobotDescription& robot,
                                   Draws& draws) {
  constexpr std::array kRates{200.0, 250.0, 500.0, 1000.0};
  constexpr std::array kHeldOutRates{125.0, 400.0, 800.0};
  recorded::MotionRequest request;
  request.family = family == Family::kHeldOut ? recorded::MotionFamily::kSweeps
                   : draws.below(2) == 0      ? recorded::MotionFamily::kSines
                                              : recorded::MotionFamily::kMoves;
  request.rate_hz = family == Family::kHeldOut
                        ? kHeldOutRates[static_cast<std::size_t>(draws.below(3))]
                        : kRates[static_cast<std::size_t>(draws.below(4))];
  request.duration_s = draws.uniform(8, 16);
  request.middle.resize(kJoints);
  request.reach.resize(kJoints);
  for (Index joint = 0; joint < kJoints; ++joint) {
    const auto& limits = robot.joints[static_cast<std::size_t>(joint)].joint;
    const double half = (limits.max_position - limits.min_position) / 2;
    request.reach[joint] = std::min(half, 1.2) * draws.uniform(0.4, 0.9);
    request.middle[joint] = (limits.max_position + limits.min_position) / 2 +
                            draws.uniform(-1, 1) * (half - request.reach[joint]) / 2;
    request.locked.push_back(static_cast<char>(draws.below(5) == 0));
  }
  if (std::count(request.locked.begin(), request.locked.end(), 0) == 0) request.locked[1] = 0;
  return request;
}

// A coarse encoder, and a computer that stamps what comes from a drive: a quarter of all cases,
// with draws of their own.
bool is_rough(int number) { return number % 8 == 2 || number % 8 == 5; }

void roughen(recorded::Recording& recording, recorded::Habits& habits, Draws& draws) {
  habits.encoder_bits = 12;
  habits.float_positions = false;
  const double step = 2 * std::numbers::pi / std::exp2(habits.encoder_bits);
  recording.q = step * (recording.q / step).array().round().matrix();
  const double period_s = recording.t_s[1] - recording.t_s[0];
  for (double& t : recording.t_s) t += draws.uniform(-0.03, 0.03) * period_s;
}

desk::Log log_of(const recorded::Recording& recording) {
  desk::Log log;
  log.file = "case";
  log.t_s = recording.t_s;
  log.q = recording.q;
  log.tau = recording.tau;
  const bool measured = recording.dq.size() > 0;
  log.dq = measured ? recording.dq : Eigen::MatrixXd::Zero(log.q.rows(), log.q.cols());
  log.dq_derived.assign(static_cast<std::size_t>(log.q.cols()), !measured);
  desk::make_even(log);
  desk::derive_velocities(log);
  return log;
}

std::vector<DataFaultKind> names_of(const recorded::TrueDefect& truth) {
  switch (truth.kind) {
    case Defect::kGap:
      return {DataFaultKind::kGaps};
    case Defect::kStuckPosition:
    case Defect::kStuckTorque:
      return {DataFaultKind::kStuck};
    case Defect::kSaturation:
      return {DataFaultKind::kSaturation};
    case Defect::kPositionStep:
    case Defect::kPositionSpike:
    case Defect::kTorqueSpike:
      return {DataFaultKind::kJump};
    case Defect::kStart:
      return {DataFaultKind::kStart};
    case Defect::kTorqueSign:
      return {DataFaultKind::kTorqueSign};
    case Defect::kDegrees:
      return {DataFaultKind::kDegrees};
    case Defect::kMilliseconds:
      return {DataFaultKind::kTimeUnit};
    case Defect::kNone:
      break;
  }
  return {};
}

bool is_at(const recorded::TrueDefect& truth, const desk::DataFault& fault, double period_s) {
  if (fault.spans.empty()) return truth.from_s == truth.to_s;
  const double slack_s = 3 * period_s;
  return std::any_of(fault.spans.begin(), fault.spans.end(), [&](const desk::FaultSpan& span) {
    return span.from_s <= truth.to_s + slack_s && span.to_s >= truth.from_s - slack_s;
  });
}

}  // namespace

DoctorCase make_doctor_case(Family family, std::uint64_t seed, int number) {
  const auto stream = sim::hidden::Stream::kDataFault;
  Draws draws(seed + (family == Family::kHeldOut ? 1000003U : 0U), stream,
              static_cast<std::uint64_t>(number));
  DoctorCase made;
  made.robot = six_joints(family);
  const desk::RobotDescription real = as_it_is(made.robot, draws);
  const recorded::MotionRequest request = request_of(family, made.robot, draws);
  const recorded::Motion motion = recorded::draw_motion(request, draws);
  recorded::Habits habits = recorded::draw_habits(draws);
  const Eigen::MatrixXd tau =
      desk::model_torque(real, desk::Motion{motion.t_s, motion.q, motion.dq, motion.ddq});
  recorded::Recording recording = recorded::record(motion, tau, habits, draws);
  if (is_rough(number)) {
    Draws own(seed + 7919U, stream, static_cast<std::uint64_t>(number));
    roughen(recording, habits, own);
  }
  const bool faulty = number % 2 == 1;
  if (faulty) {
    const auto defect = static_cast<Defect>(1 + (number / 2) % (recorded::kDefects - 1));
    made.truth = recorded::add_defect(defect, request.locked, recording, draws);
  }
  for (desk::RobotJoint& joint : made.robot.joints) {
    joint.encoder.counts_per_unit =
        habits.float_positions ? 0 : std::exp2(habits.encoder_bits) / (2 * 3.141592653589793);
  }
  made.robot.estimator.period_s = 1 / request.rate_hz;
  made.log = log_of(recording);
  made.words = fmt::format(
      "motion {} at {:g} Hz, noise {:.3g}, step {:.3g}, {} bits{}{}{}{}{}",
      static_cast<int>(request.family), request.rate_hz, habits.torque_noise, habits.torque_step,
      habits.encoder_bits, habits.float_positions ? ", float" : "",
      habits.five_digits ? ", five digits" : "", habits.with_velocity ? ", velocity" : "",
      habits.late_stamps > 0 ? ", late stamps" : "", is_rough(number) ? ", uneven" : "");
  return made;
}

Judgement judge(const DoctorCase& made, const std::vector<desk::DataFault>& faults) {
  Judgement judgement;
  const auto names = names_of(made.truth);
  bool named = false;
  bool other = false;
  for (const desk::DataFault& fault : faults) {
    if (fault.kind == DataFaultKind::kNothingLeft) continue;  // follows from the others
    // The longer side of a step may be the one that is off: then it has another zero indeed.
    if (fault.kind == DataFaultKind::kJointZero && made.truth.kind == Defect::kPositionStep &&
        fault.joint == made.truth.joint) {
      continue;
    }
    judgement.said +=
        fmt::format("{}{}@{}{}", judgement.said.empty() ? "" : " ", name_of(fault.kind),
                    fault.joint + 1, fault.at_s ? fmt::format(" {:.3f} s", *fault.at_s) : "");
    judgement.said += " [" + fault.words + "]";
    const bool kind = std::find(names.begin(), names.end(), fault.kind) != names.end();
    const bool mine = kind && fault.certain && fault.joint == made.truth.joint &&
                      is_at(made.truth, fault, made.log.period_s);
    named = named || mine;
    other = other || !mine;
  }
  judgement.right = made.truth.kind == Defect::kNone ? faults.empty() : named && !other;
  return judgement;
}

}  // namespace offnominal::bench
