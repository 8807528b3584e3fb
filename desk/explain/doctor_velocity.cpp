#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "explain/doctor_signal.hpp"
#include "log/sampling.hpp"

// A measured velocity against the derivative of the position, over stretches of samples: how far
// the joint moved in each by either.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Over this they are the same but for a factor, a filter and noise.
constexpr double kCorrelated = 0.9;
constexpr Index kLongestStretch = 4096;
constexpr Index kStretches = 10;  // at least

VectorXd travel_of(const VectorXd& dq, double period_s) {
  VectorXd travel(dq.size());
  travel[0] = 0;
  for (Index i = 1; i < dq.size(); ++i) {
    travel[i] = travel[i - 1] + period_s * (dq[i - 1] + dq[i]) / 2;
  }
  return travel;
}

struct Match {
  double correlation = 0;  // 0 to 1
  double ratio = 0;        // travel over q, negative where they oppose each other
};

// `late`: rows by which the travel comes after the position.
Match match_over(const VectorXd& q, const VectorXd& travel, Index stretch, Index late) {
  double moved = 0;
  double added = 0;
  double both = 0;
  const Index first = std::max<Index>(0, -late);
  const Index end = q.size() - stretch - std::max<Index>(0, late);
  for (Index i = first; i < end; i += std::max<Index>(1, stretch / 4)) {
    const double by_position = q[i + stretch] - q[i];
    const double by_velocity = travel[i + late + stretch] - travel[i + late];
    moved += by_position * by_position;
    added += by_velocity * by_velocity;
    both += by_position * by_velocity;
  }
  const double size = std::sqrt(moved) * std::sqrt(added);
  if (!(size > 0)) return {};
  return {std::abs(both) / size, std::copysign(std::sqrt(added) / std::sqrt(moved), both)};
}

// Over how many samples the two agree best: a coarse encoder asks for many, a fast motion for few.
Match best_match(const VectorXd& q, const VectorXd& travel, Index late = 0) {
  Match best;
  const Index longest = std::min((q.size() - std::abs(late)) / kStretches, kLongestStretch);
  for (Index stretch = 1; stretch <= longest; stretch *= 2) {
    const Match match = match_over(q, travel, stretch, late);
    if (match.correlation > best.correlation) best = match;
  }
  return best;
}

// How fast the joint moves by its position alone (rms); 0 where that cannot be said: noise and
// steps of an encoder do not grow with the stretch, and of a motion that a slow log takes few
// samples of the velocity between them is not known.
double speed_by_position(const VectorXd& q, double period_s) {
  constexpr double kAboveOneSample = 5;
  constexpr double kSteps = 10;  // of the encoder
  const auto moved_over = [&q](Index stretch) {
    double sum = 0;
    Index count = 0;
    for (Index i = 0; i + stretch < q.size(); i += std::max<Index>(1, stretch / 4), ++count) {
      sum += std::pow(q[i + stretch] - q[i], 2);
    }
    return std::sqrt(sum / static_cast<double>(std::max<Index>(1, count)));
  };
  const double least = std::max(kAboveOneSample * moved_over(1), kSteps * smallest_step(q));
  for (Index stretch = 2; stretch <= std::min(q.size() / kStretches, kLongestStretch);
       stretch *= 2) {
    const double moved = moved_over(stretch);
    if (moved >= least) return moved / (static_cast<double>(stretch) * period_s);
  }
  return 0;
}

// What a velocity is that is not that of its position.
struct Stranger {
  enum class Kind { kConstant, kOfAnotherJoint, kLate, kUnrelated };
  Kind kind = Kind::kUnrelated;
  double correlation = 0;
  Index other = -1;   // the joint whose velocity it is
  double late_s = 0;  // after the derivative of the position
};

// The lag at which they agree, where there is one.
std::optional<double> lag_of(const VectorXd& q, const VectorXd& travel, double period_s) {
  constexpr double kAgree = 0.97;
  constexpr double kLongestLagS = 0.5;
  constexpr Index kTries = 50;  // each way
  const Index most = std::min(static_cast<Index>(kLongestLagS / period_s), q.size() / kStretches);
  if (most < 1) return std::nullopt;
  const Index step = std::max<Index>(1, most / kTries);
  double best = kAgree;
  std::optional<double> lag_s;
  for (Index late = -most; late <= most; late += step) {
    const Match match = best_match(q, travel, late);
    if (match.ratio < 0 || !(match.correlation > best)) continue;
    best = match.correlation;
    lag_s = static_cast<double>(late) * period_s;
  }
  return lag_s;
}

std::optional<Stranger> stranger_in(const Log& log, Index joint) {
  // Slower, a coarse velocity may honestly be 0.
  constexpr double kSlow = 0.05;  // rad/s or m/s
  constexpr double kVelocitySteps = 5;
  constexpr double kUnrelated = 0.5;  // correlation
  constexpr double kAnothers = 0.97;
  constexpr Index kFewestRows = 100;
  if (log.dq_derived[static_cast<std::size_t>(joint)] || log.sample_count() < kFewestRows) {
    return std::nullopt;
  }
  const VectorXd q = log.q.col(joint);
  const VectorXd dq = log.dq.col(joint);
  const double speed = speed_by_position(q, log.period_s);
  if (speed < kSlow) return std::nullopt;
  Stranger stranger;
  if ((dq.array() == dq[0]).all()) {
    stranger.kind = Stranger::Kind::kConstant;
    return stranger;
  }
  if (speed < kVelocitySteps * smallest_step(dq)) return std::nullopt;
  const VectorXd travel = travel_of(dq, log.period_s);
  stranger.correlation = best_match(q, travel).correlation;
  if (stranger.correlation >= kCorrelated) return std::nullopt;
  for (Index other = 0; other < log.q.cols(); ++other) {
    if (other == joint || speed_by_position(log.q.col(other), log.period_s) < kSlow) continue;
    const Match match = best_match(log.q.col(other), travel);
    if (match.correlation < kAnothers || std::abs(std::log(match.ratio)) > std::log(kNearUnit)) {
      continue;
    }
    stranger.kind = Stranger::Kind::kOfAnotherJoint;
    stranger.other = other;
    return stranger;
  }
  if (const auto lag_s = lag_of(q, travel, log.period_s)) {
    stranger.kind = Stranger::Kind::kLate;
    stranger.late_s = *lag_s;
    return stranger;
  }
  if (stranger.correlation >= kUnrelated) return std::nullopt;
  return stranger;
}

// `unit`: of the joint's positions.
std::string words_of(const Stranger& stranger, const Log& log, Index joint,
                     const std::string& unit) {
  const std::string of = joint_words(joint);
  switch (stranger.kind) {
    case Stranger::Kind::kConstant:
      return fmt::format(
          "the velocity of {} never changes, it is {:.4g} throughout, while its "
          "position moves by {:.3g} {}",
          of, log.dq(0, joint), log.q.col(joint).maxCoeff() - log.q.col(joint).minCoeff(), unit);
    case Stranger::Kind::kOfAnotherJoint:
      return fmt::format(
          "the velocity of {} is not that of its position (correlation {:.2f}), but "
          "that of {}",
          of, stranger.correlation, joint_words(stranger.other));
    case Stranger::Kind::kLate:
      return fmt::format("the velocity of {} comes {:.3g} s {} the derivative of its position", of,
                         std::abs(stranger.late_s), stranger.late_s > 0 ? "after" : "before");
    default:
      return fmt::format(
          "the velocity of {} has nothing in common with the derivative of its "
          "position (correlation {:.2f})",
          of, stranger.correlation);
  }
}

}  // namespace

std::optional<double> velocity_ratio(const Log& log, Index joint) {
  if (log.dq_derived[static_cast<std::size_t>(joint)]) return std::nullopt;
  return velocity_ratio(log.q.col(joint), log.dq.col(joint), log.period_s);
}

std::vector<std::optional<double>> velocity_ratios(const Log& log) {
  return of_every_joint(log, [&](Index joint) { return velocity_ratio(log, joint); });
}

std::optional<double> velocity_ratio(const VectorXd& q, const VectorXd& dq, double period_s) {
  if (q.size() == 0) return std::nullopt;
  const Match best = best_match(q, travel_of(dq, period_s));
  if (best.correlation < kCorrelated || !std::isfinite(best.ratio) || best.ratio == 0) {
    return std::nullopt;
  }
  return best.ratio;
}

void mend_strange_velocities(Log& log, const RobotDescription& robot,
                             std::vector<DataFault>& faults) {
  struct Found {
    Index joint;
    Stranger stranger;
  };
  std::vector<Found> found;
  const std::vector<char> held = held_joints(log, robot);
  const auto strangers = of_every_joint(log, [&](Index joint) {
    return held[static_cast<std::size_t>(joint)] != 0 ? std::nullopt : stranger_in(log, joint);
  });
  for (Index joint = 0; joint < log.q.cols(); ++joint) {
    const auto& stranger = strangers[static_cast<std::size_t>(joint)];
    if (stranger) found.push_back({joint, *stranger});
  }
  if (found.empty()) return;
  const Log before = log;
  ChannelMap mended = log.channels;
  for (const Found& one : found) {
    // Joints that have each other's velocity; what else is no velocity is better left out.
    const bool swapped = std::any_of(found.begin(), found.end(), [&](const Found& other) {
      return other.joint == one.stranger.other && other.stranger.other == one.joint;
    });
    const auto joint = static_cast<std::size_t>(one.joint);
    if (swapped) log.dq.col(one.joint) = before.dq.col(one.stranger.other);
    if (!swapped) log.dq_derived[joint] = true;
    if (joint < mended.velocity.size()) {
      mended.velocity[joint].reset();
      if (swapped) {
        mended.velocity[joint] =
            before.channels.velocity[static_cast<std::size_t>(one.stranger.other)];
      }
    }
  }
  derive_velocities(log);
  for (const Found& one : found) {
    DataFault fault;
    fault.kind = DataFaultKind::kVelocity;
    fault.joint = one.joint;
    fault.size = 0;
    const JointType type = robot.joints[static_cast<std::size_t>(one.joint)].joint.type;
    fault.words = words_of(one.stranger, before, one.joint, unit_of(Quantity::kPosition, type));
    fault.mend = one.stranger.kind == Stranger::Kind::kOfAnotherJoint
                     ? "exchange the columns"
                     : "look at what was logged, or leave the velocity out: it is then derived "
                       "from the position";
    propose_channels(before, mended, {"velocity"}, fault);
    faults.push_back(std::move(fault));
  }
  log.channels = std::move(mended);
}

}  // namespace offnominal::desk
