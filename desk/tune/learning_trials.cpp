#include "tune/learning_trials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "log/part_of.hpp"
#include "replay/replay.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kLongestS = 12;
constexpr double kShareBefore = 0.2;  // of the recording: healthy
constexpr double kTimeToLearnS = 1;   // what it misses sooner does not count

enum class Shape : std::uint8_t { kConstant, kFriction };

Log longest_of(const std::vector<Log>& logs) {
  const auto longest = std::max_element(logs.begin(), logs.end(), [](const Log& a, const Log& b) {
    return a.period_s * static_cast<double>(a.sample_count()) <
           b.period_s * static_cast<double>(b.sample_count());
  });
  const auto most = static_cast<Index>(kLongestS / longest->period_s);
  return part_of(*longest, {0, std::min(longest->sample_count() - 1, most)});
}

// What acts on the joint from the first row on, beside the model.
VectorXd acting(const Log& log, Index joint, Shape shape, double torque, Index first) {
  VectorXd extra = VectorXd::Zero(log.sample_count());
  const Index rows = extra.size() - first;
  if (shape == Shape::kConstant) {
    extra.tail(rows).setConstant(torque);
    return extra;
  }
  const VectorXd speed = log.dq.col(joint);
  // Smooth where the joint turns, as a velocity that is measured is.
  const double width = std::max(0.02 * speed.cwiseAbs().maxCoeff(), 1e-6);
  extra.tail(rows) = -torque * (speed.tail(rows) / width).array().tanh();
  return extra;
}

}  // namespace

LearningTrials::LearningTrials(const RobotDescription& robot, const std::vector<Log>& logs,
                               std::vector<VectorXd> torques, std::function<void()> on_step)
    : robot_(robot),
      recording_(longest_of(logs)),
      torques_(std::move(torques)),
      on_step_(std::move(on_step)) {}

// What psi_hat misses of a torque on one joint, rms over rms, and the largest norm of the weights.
std::pair<double, double> LearningTrials::missed_of(const RobotDescription& robot, Index joint,
                                                    const VectorXd& extra, double from_s) const {
  Log log = recording_;
  log.tau.col(joint) -= extra;
  const Replay replayed = replay(robot, log);
  double missed = 0;
  double squares = 0;
  Index row = 0;  // of the recording, of which the monitor may have refused some
  for (Index judged = 0; judged < replayed.t_s.size(); ++judged) {
    while (row < extra.size() - 1 && recording_.t_s[row] < replayed.t_s[judged]) ++row;
    if (replayed.t_s[judged] < from_s) continue;
    const double off = replayed.psi_hat(judged, joint) - extra[row];
    missed += off * off;
    squares += extra[row] * extra[row];
  }
  return {squares > 0 ? std::sqrt(missed / squares) : 1, replayed.max_weight_norm};
}

LearningTrial LearningTrials::run(const EstimatorSettings& settings) const {
  RobotDescription robot = robot_;
  robot.estimator = settings;
  LearningTrial trial;
  trial.learning_rate = settings.learning_rate;
  trial.hidden_units = settings.hidden_units;
  trial.initial_weight_range = settings.initial_weight_range;
  const auto first =
      static_cast<Index>(kShareBefore * static_cast<double>(recording_.sample_count()));
  const double from_s = recording_.t_s[first] + kTimeToLearnS;
  double sum = 0;
  double trials = 0;
  for (const VectorXd& torques : torques_) {
    for (Index joint = 0; joint < torques.size(); ++joint) {
      for (const Shape shape : {Shape::kConstant, Shape::kFriction}) {
        const auto [missed, norm] = missed_of(
            robot, joint, acting(recording_, joint, shape, torques[joint], first), from_s);
        sum += missed;
        trials += 1;
        trial.weight_norm = std::max(trial.weight_norm, norm);
        if (on_step_) on_step_();
      }
    }
  }
  trial.missed = sum / trials;
  return trial;
}

double LearningTrials::weight_range() const {
  const double squares = 1 + (recording_.q.squaredNorm() + recording_.dq.squaredNorm() +
                              recording_.tau.squaredNorm()) /
                                 static_cast<double>(recording_.sample_count());
  return std::sqrt(3 / squares);
}

}  // namespace offnominal::desk
