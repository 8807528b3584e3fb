#include <fmt/format.h>

#include <algorithm>

#include "common/number.hpp"
#include "common/text_table.hpp"
#include "explain/alternatives.hpp"
#include "motion/design_report.hpp"

namespace offnominal::desk::motion {
namespace {

std::string words_of(const Contender& one) {
  return fmt::format("{} on joint {}", one.effect->name(), one.joint + 1);
}

std::string rival_words(const PairReport& pair) {
  return pair.rival ? words_of(*pair.rival) : std::string("what every model may adapt");
}

std::string unit_at(const RobotDescription& robot, Eigen::Index joint) {
  return unit_of(Quantity::kEffort, robot.joints[static_cast<std::size_t>(joint)].joint.type);
}

// "of one slow sine", "of the recordings given"
std::string before_words(const DesignNames& names) {
  if (names.logs.empty()) return "on one slow sine of each joint";
  return names.logs.size() == 1 ? "in " + names.logs[0] : "in the recordings given";
}

std::string purpose_words(const Design& design) {
  const auto& effects = design.request.effects;
  if (effects.empty()) return "excites every effect that the robot may have";
  if (effects.size() == 1) return "excites " + words_of(effects[0]);
  std::string list;
  for (std::size_t i = 0; i < effects.size(); ++i) {
    if (i > 0) list += i + 1 == effects.size() ? " and " : ", ";
    list += words_of(effects[i]);
  }
  return "tells apart " + list;
}

}  // namespace

std::string csv_of(const Motion& motion) {
  std::string text = "t";
  for (const char* name : {"q", "dq", "ddq"}) {
    for (Eigen::Index j = 1; j <= motion.q.cols(); ++j) text += fmt::format(",{}{}", name, j);
  }
  text += '\n';
  for (Eigen::Index row = 0; row < motion.sample_count(); ++row) {
    text += shortest(motion.t_s[row]);
    for (const Eigen::MatrixXd* part : {&motion.q, &motion.dq, &motion.ddq}) {
      for (Eigen::Index j = 0; j < part->cols(); ++j) text += "," + shortest((*part)(row, j));
    }
    text += '\n';
  }
  return text;
}

JointUse use_of(const RobotDescription& robot, const Design& design, std::size_t joint) {
  const JointType type = robot.joints[joint].joint.type;
  const auto j = static_cast<Eigen::Index>(joint);
  const Motion& motion = design.fitted.motion;
  return {unit_of(Quantity::kPosition, type),
          unit_of(Quantity::kVelocity, type),
          unit_of(Quantity::kEffort, type),
          motion.q.col(j).minCoeff(),
          motion.q.col(j).maxCoeff(),
          motion.dq.col(j).cwiseAbs().maxCoeff(),
          design.fitted.torque.col(j).cwiseAbs().maxCoeff()};
}

std::string sentence_of(const RobotDescription& robot, const Design& design,
                        const DesignNames& names) {
  const double duration_s = design.request.duration_s;
  std::string text = fmt::format(
      "A motion of {:g} s that {}: {:.0f} s of oscillation from slow to fast, then {:.0f} s of "
      "constant speeds between poses, within {:.0f} % of the joints' limits.",
      duration_s, purpose_words(design), design.slow_from_s, duration_s - design.slow_from_s,
      100 * (1 - design.request.margin));
  const PairReport* worst = design.worst();
  if (worst == nullptr) {
    return text +
           " No motion that was tried makes a difference between them: within this model "
           "they are the same torque.";
  }
  const std::string unit = unit_at(robot, worst->truth.joint);
  text += fmt::format(
      " Hardest is {} against {}: the sine of the angle between their torques is "
      "{:.2g}",
      words_of(worst->truth), rival_words(*worst), worst->after.sine);
  if (worst->before) {
    text += fmt::format(", {:.2g} {}", worst->before->sine, before_words(names));
  }
  text += fmt::format(
      "; what tells them apart is {:.2g} {} rms, {:.1f} times the noise expected{}.",
      worst->after.torque_rms, unit, worst->after.torque_rms / worst->after.noise_rms,
      worst->before ? fmt::format(", where it was {:.2g} {}", worst->before->torque_rms, unit)
                    : std::string());
  if (worst->after.evidence < kTellApart) {
    text += fmt::format(
        " That is {:.1f} standard deviations where explain asks for {:g}: record it several times, "
        "or allow more of the limits.",
        worst->after.evidence, kTellApart);
  }
  return text;
}

std::string text_of(const RobotDescription& robot, const Design& design, const DesignNames& names) {
  std::string text = sentence_of(robot, design, names) + "\n";
  text += fmt::format("seed {}, {} motions tried, robot {}\n", design.request.seed,
                      design.motions_tried, names.robot_file);
  const TextTable joints({{"joint", -6}, {"position", 26}, {"top speed", 16}, {"top torque", 16}});
  text += "\n" + joints.heading();
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const JointUse use = use_of(robot, design, j);
    text +=
        joints.row(j + 1, fmt::format("{:.3g} .. {:.3g} {}", use.low, use.high, use.position_unit),
                   fmt::format("{:.3g} {}", use.top_speed, use.velocity_unit),
                   fmt::format("{:.3g} {}", use.top_torque, use.torque_unit));
  }
  constexpr std::size_t kMost = 12;
  std::vector<const PairReport*> pairs;
  for (const PairReport& pair : design.pairs) pairs.push_back(&pair);
  std::stable_sort(pairs.begin(), pairs.end(), [](const PairReport* a, const PairReport* b) {
    if (a->possible != b->possible) return a->possible;
    return a->after.evidence < b->after.evidence;
  });
  const TextTable table({{"if it is", -28},
                         {"against", -34},
                         {"sine before", 12},
                         {"sine after", 12},
                         {"evidence", 10}});
  text += "\n" + table.heading();
  for (std::size_t i = 0; i < std::min(kMost, pairs.size()); ++i) {
    const PairReport& pair = *pairs[i];
    text +=
        table.row(text_of(pair.truth), pair.rival ? text_of(*pair.rival) : "adapting numbers alone",
                  pair.before ? fmt::format("{:.3g}", pair.before->sine) : "-",
                  fmt::format("{:.3g}", pair.after.sine),
                  pair.possible ? fmt::format("{:.1f}", pair.after.evidence) : "never");
  }
  if (pairs.size() > kMost) text += fmt::format("and {} easier pairs\n", pairs.size() - kMost);
  return text;
}

}  // namespace offnominal::desk::motion
