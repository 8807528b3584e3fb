#include <algorithm>
#include <cmath>
#include <numbers>

#include "offnominal/sim/recorded/recording.hpp"

namespace offnominal::sim::recorded {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using hidden::Draws;

struct Place {
  Recording& recording;
  Index joint;
  Draws& draws;

  [[nodiscard]] Index rows() const { return recording.t_s.size(); }
  [[nodiscard]] double period_s() const {
    return (recording.t_s[rows() - 1] - recording.t_s[0]) / static_cast<double>(rows() - 1);
  }
  [[nodiscard]] Index rows_in(double time_s) const {
    return std::max<Index>(1, std::lround(time_s / period_s()));
  }
  // Not in the first or the last tenth.
  [[nodiscard]] Index row() {
    return rows() / 10 + draws.below(static_cast<int>(rows() - rows() / 5));
  }
  [[nodiscard]] TrueDefect at(Defect kind, Index first, Index last) const {
    return {kind, static_cast<int>(joint), recording.t_s[first], recording.t_s[last]};
  }
};

void erase_rows(Recording& recording, Index first, Index count) {
  const Index rest = recording.t_s.size() - first - count;
  const auto cut = [&](MatrixXd& columns) {
    if (columns.size() == 0) return;
    MatrixXd left(first + rest, columns.cols());
    left << columns.topRows(first), columns.bottomRows(rest);
    columns = std::move(left);
  };
  VectorXd t(first + rest);
  t << recording.t_s.head(first), recording.t_s.tail(rest);
  recording.t_s = std::move(t);
  cut(recording.q);
  cut(recording.dq);
  cut(recording.tau);
}

TrueDefect gap(Place place) {
  const Index count = std::max<Index>(6, place.rows_in(place.draws.log_uniform(0.02, 1)));
  const Index first = std::min(place.row(), place.rows() - count - 5);
  TrueDefect defect = place.at(Defect::kGap, first, first + count - 1);
  defect.joint = -1;
  erase_rows(place.recording, first, count);
  return defect;
}

TrueDefect stuck(Place place, bool position) {
  auto x = position ? place.recording.q.col(place.joint) : place.recording.tau.col(place.joint);
  const Index first = place.row();
  const bool for_good = place.draws.below(2) == 0;
  const Index count =
      for_good ? place.rows() - first
               : std::min(place.rows() - first, place.rows_in(place.draws.log_uniform(0.2, 3)));
  const bool with_velocity = place.draws.below(2) == 0;
  // Of a joint that rests meanwhile nobody could tell: where it moves, then.
  const auto moves = place.recording.q.col(place.joint).segment(first, count);
  const double travel = moves.maxCoeff() - moves.minCoeff();
  const auto all = place.recording.q.col(place.joint);
  const auto before = place.recording.q.col(place.joint).segment(first - 5, 6);
  if (travel < 0.1 * (all.maxCoeff() - all.minCoeff()) ||
      (position && for_good &&
       std::abs(before[5] - before[0]) * static_cast<double>(place.rows_in(1)) / 5 <
           0.2 * (all.maxCoeff() - all.minCoeff()))) {
    return stuck(place, position);
  }
  x.segment(first, count).setConstant(x[first]);
  if (position && with_velocity && place.recording.dq.size() > 0) {
    place.recording.dq.col(place.joint).segment(first, count).setZero();
  }
  return place.at(position ? Defect::kStuckPosition : Defect::kStuckTorque, first,
                  first + count - 1);
}

TrueDefect saturation(Place place) {
  auto tau = place.recording.tau.col(place.joint);
  VectorXd sizes = tau.cwiseAbs();
  std::sort(sizes.begin(), sizes.end());
  const double share = place.draws.uniform(0.9, 0.97);
  const double limit = sizes[static_cast<Index>(share * static_cast<double>(sizes.size()))];
  Index first = -1;
  Index last = 0;
  for (Index i = 0; i < tau.size(); ++i) {
    if (std::abs(tau[i]) <= limit) {
      if (first >= 0) break;
      continue;
    }
    if (first < 0) first = i;
    last = i;
  }
  tau = tau.cwiseMax(-limit).cwiseMin(limit).eval();
  return place.at(Defect::kSaturation, std::max<Index>(first, 0), last);
}

TrueDefect position_step(Place place) {
  const Index first = place.row();
  const double side = place.draws.sign();
  const double by = side * place.draws.log_uniform(0.1, 1);
  place.recording.q.col(place.joint).tail(place.rows() - first).array() += by;
  return place.at(Defect::kPositionStep, first, first);
}

TrueDefect spikes(Place place, bool position) {
  auto x = position ? place.recording.q.col(place.joint) : place.recording.tau.col(place.joint);
  const double size = position ? 1 : x.cwiseAbs().maxCoeff();
  const int count = 1 + place.draws.below(3);
  TrueDefect defect;
  for (int k = 0; k < count; ++k) {
    const Index first = place.row();
    const Index rows = 1 + place.draws.below(2);
    const double by = size * place.draws.either_sign(position ? 0.3 : 1.5, 4);
    x.segment(first, rows).array() += by;
    if (k == 0) {
      defect = place.at(position ? Defect::kPositionSpike : Defect::kTorqueSpike, first,
                        first + rows - 1);
    }
  }
  return defect;
}

// Of a signal that is far from 0 when it starts: of any other nobody could tell.
TrueDefect start(Place place) {
  const bool position = place.draws.below(2) == 0;
  const MatrixXd& of = position ? place.recording.q : place.recording.tau;
  double most = 0;
  for (Index joint = 0; joint < of.cols(); ++joint) {
    const double share = std::abs(of(0, joint)) / of.col(joint).cwiseAbs().maxCoeff();
    const double range = of.col(joint).maxCoeff() - of.col(joint).minCoeff();
    if (!(share > most) || !(range > 0)) continue;
    most = share;
    place.joint = joint;
  }
  auto x = position ? place.recording.q.col(place.joint) : place.recording.tau.col(place.joint);
  const Index rows = place.rows_in(place.draws.log_uniform(0.03, 0.3));
  const bool settles = place.draws.below(2) == 0;
  const double time_constant = static_cast<double>(rows) / 5;
  for (Index i = 0; i < rows; ++i) {
    x[i] *= settles ? 1 - std::exp(-static_cast<double>(i) / time_constant) : 0;
  }
  return place.at(Defect::kStart, 0, rows - 1);
}

}  // namespace

TrueDefect add_defect(Defect defect, const std::vector<char>& locked, Recording& recording,
                      Draws& draws) {
  std::vector<Index> moving;
  for (std::size_t joint = 0; joint < locked.size(); ++joint) {
    if (locked[joint] == 0) moving.push_back(static_cast<Index>(joint));
  }
  const auto joint = moving[static_cast<std::size_t>(draws.below(static_cast<int>(moving.size())))];
  const Place place{recording, joint, draws};
  switch (defect) {
    case Defect::kNone:
      return {};
    case Defect::kGap:
      return gap(place);
    case Defect::kStuckPosition:
    case Defect::kStuckTorque:
      return stuck(place, defect == Defect::kStuckPosition);
    case Defect::kSaturation:
      return saturation(place);
    case Defect::kPositionStep:
      return position_step(place);
    case Defect::kPositionSpike:
    case Defect::kTorqueSpike:
      return spikes(place, defect == Defect::kPositionSpike);
    case Defect::kStart:
      return start(place);
    case Defect::kTorqueSign:
      recording.tau.col(joint) *= -1;
      return {defect, static_cast<int>(joint), 0, 0};
    case Defect::kDegrees: {
      const bool all = draws.below(2) == 0;
      constexpr double kDegrees = 180 / std::numbers::pi;
      if (all) recording.q *= kDegrees;
      if (!all) recording.q.col(joint) *= kDegrees;
      return {defect, all ? -1 : static_cast<int>(joint), 0, 0};
    }
    case Defect::kMilliseconds:
      recording.t_s *= 1e3;
      return {defect, -1, 0, 0};
  }
  return {};
}

}  // namespace offnominal::sim::recorded
