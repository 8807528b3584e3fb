#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "explain/doctor_checks.hpp"
#include "log/part_of.hpp"
#include "signal/norm_about_mean.hpp"

// Columns of a recording that stand at another joint than they are of.

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Per joint of the robot, the joint of the recording whose columns are its own.
using Order = std::vector<Index>;

// Shares of a torque that a joint's model leaves: what no missing effect leaves, and what is left
// at the right joint although effects are missing.
constexpr double kBad = 0.6;
constexpr double kGood = 0.4;

// Share of a measured torque that the model of a joint leaves with any friction, rotor and offset,
// where the link's part may be off by what a tool or a wrong mass makes of it.
double left_by(const TorquePair& pair, Index joint, const VectorXd& torque) {
  constexpr double kMostOff = 3;
  MatrixXd both(torque.size(), 2);
  both << torque, pair.model.col(joint);
  both = beside_drive(pair, joint, both);
  const double size = norm_about_mean(torque);
  if (!(size > 0)) return 0;
  const double model = both.col(1).squaredNorm();
  const double ratio = model > 0 ? both.col(0).dot(both.col(1)) / model : 1;
  const double within = std::clamp(ratio, 1 / kMostOff, kMostOff);
  return (both.col(0) - within * both.col(1)).norm() / size;
}

// Of every joint's own column.
VectorXd left_as_it_is(const TorquePair& pair) {
  VectorXd left(pair.measured.cols());
  for (Index joint = 0; joint < left.size(); ++joint) {
    left[joint] = left_by(pair, joint, pair.measured.col(joint));
  }
  return left;
}

// The same where its sign may be wrong too: a whole arm whose drives measure what acts on them
// looks like another order as soon as two torques are opposed to each other.
VectorXd left_by_either_sign(const TorquePair& pair, const VectorXd& left) {
  VectorXd least = left;
  for (Index joint = 0; joint < left.size(); ++joint) {
    least[joint] = std::min(left[joint], left_by(pair, joint, -pair.measured.col(joint)));
  }
  return least;
}

bool is_moved(const Order& order, Index joint) {
  return order[static_cast<std::size_t>(joint)] != joint;
}

Order as_it_is(Index joints) {
  Order order(static_cast<std::size_t>(joints));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// Joints that move, and whose own columns their model does not explain.
std::vector<char> are_bad(const TorquePair& pair, const VectorXd& left) {
  constexpr double kMoves = 1e-3;  // rad or m, rms
  std::vector<char> bad;
  for (Index joint = 0; joint < left.size(); ++joint) {
    const auto q = pair.q.col(joint).array();
    const double moved = std::sqrt((q - q.mean()).square().mean());
    bad.push_back(static_cast<char>(moved > kMoves && left[joint] > kBad));
  }
  return bad;
}

bool are_several_bad(const std::vector<char>& bad) {
  return std::count(bad.begin(), bad.end(), 1) > 1;
}

// The order of the torques alone: every column that its own joint does not explain, of whatever
// sign, is explained by another, and those have changed places.
std::optional<Order> order_of_torques(const TorquePair& pair, const VectorXd& left) {
  const std::vector<char> bad = are_bad(pair, left);
  const auto is_bad = [&](Index joint) { return bad[static_cast<std::size_t>(joint)] != 0; };
  const VectorXd least = left_by_either_sign(pair, left);
  Order order = as_it_is(left.size());
  for (Index joint = 0; joint < left.size(); ++joint) {
    if (!is_bad(joint)) continue;
    double best = std::min(kGood, least[joint] / 2);
    for (Index column = 0; column < left.size(); ++column) {
      if (column == joint || !is_bad(column)) continue;
      const double there = left_by(pair, joint, pair.measured.col(column));
      if (!(there < best)) continue;
      best = there;
      order[static_cast<std::size_t>(joint)] = column;
    }
  }
  Order sorted = order;
  std::sort(sorted.begin(), sorted.end());
  if (order == sorted || sorted != as_it_is(left.size())) return std::nullopt;
  return order;
}

template <typename T>
void reorder(const Order& order, std::vector<T>& of_joints) {
  if (of_joints.size() != order.size()) return;
  const std::vector<T> was = of_joints;
  for (std::size_t joint = 0; joint < order.size(); ++joint) {
    of_joints[joint] = was[static_cast<std::size_t>(order[joint])];
  }
}

MatrixXd reordered(const Order& order, const MatrixXd& columns) {
  MatrixXd of_joints(columns.rows(), columns.cols());
  for (Index joint = 0; joint < columns.cols(); ++joint) {
    of_joints.col(joint) = columns.col(order[static_cast<std::size_t>(joint)]);
  }
  return of_joints;
}

// Of positions, velocities and torques alike.
Log reordered(const Order& order, Log log) {
  log.q = reordered(order, log.q);
  log.dq = reordered(order, log.dq);
  log.tau = reordered(order, log.tau);
  reorder(order, log.dq_derived);
  return log;
}

// Any two joints, the whole arm from its tip, and counted from the second or the last.
std::vector<Order> usual_orders(Index joints) {
  std::vector<Order> orders;
  for (Index one = 0; one < joints; ++one) {
    for (Index other = one + 1; other < joints; ++other) {
      orders.push_back(as_it_is(joints));
      std::swap(orders.back()[static_cast<std::size_t>(one)],
                orders.back()[static_cast<std::size_t>(other)]);
    }
  }
  if (joints < 3) return orders;
  Order order = as_it_is(joints);
  std::reverse(order.begin(), order.end());
  orders.push_back(order);
  for (const Index by : {Index{1}, joints - 1}) {
    order = as_it_is(joints);
    std::rotate(order.begin(), order.begin() + by, order.end());
    orders.push_back(order);
  }
  return orders;
}

// The order of all columns, where more than one joint moves as its model never asks for: with it
// every joint fits that has moved, and no other fits worse, and half as much is left as with every
// torque of the sign that fits.
std::optional<Order> order_of_joints(const Log& log, const RobotDescription& robot) {
  constexpr Index kMostSamples = 20000;
  constexpr double kWorse = 1.2;
  const Log part =
      log.sample_count() > kMostSamples ? part_of(log, RowSpan{0, kMostSamples - 1}) : log;
  const auto as_is = torque_pair(part, robot);
  if (!as_is) return std::nullopt;
  const VectorXd before = left_as_it_is(*as_is);
  if (!are_several_bad(are_bad(*as_is, before))) return std::nullopt;
  std::optional<Order> found;
  double best = left_by_either_sign(*as_is, before).norm() / 2;
  for (const Order& order : usual_orders(log.q.cols())) {
    const auto pair = torque_pair(reordered(order, part), robot);
    if (!pair) continue;
    const VectorXd left = left_as_it_is(*pair);
    bool fits = true;
    for (Index joint = 0; joint < left.size(); ++joint) {
      const double most = is_moved(order, joint) ? kGood : std::max(kGood, kWorse * before[joint]);
      fits = fits && left[joint] < most;
    }
    if (!fits || !(left.norm() < best)) continue;
    best = left.norm();
    found = order;
  }
  return found;
}

// "joint 1 has that of joint 2, joint 2 that of joint 1"
std::string words_of(const Order& order) {
  std::vector<std::string> words;
  for (Index joint = 0; joint < static_cast<Index>(order.size()); ++joint) {
    if (!is_moved(order, joint)) continue;
    words.push_back(fmt::format("what belongs to joint {} stands at joint {}", joint + 1,
                                order[static_cast<std::size_t>(joint)] + 1));
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

bool find_joint_order(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                      std::vector<DataFault>& faults) {
  const VectorXd left = left_as_it_is(pair);
  if (!are_several_bad(are_bad(pair, left))) return false;
  DataFault fault;
  fault.kind = DataFaultKind::kJointOrder;
  ChannelMap mended = log.channels;
  std::vector<std::string> keys{"torque"};
  auto order = order_of_torques(pair, left);
  if (order) {
    fault.signal = FaultySignal::kTorque;
  } else {
    order = order_of_joints(log, robot);
    if (!order) return false;
    keys = {"position", "velocity", "torque"};
    reorder(*order, mended.position);
    reorder(*order, mended.velocity);
  }
  reorder(*order, mended.torque);
  const bool torques = fault.signal == FaultySignal::kTorque;
  double largest = 0;
  for (Index joint = 0; joint < left.size(); ++joint) {
    if (is_moved(*order, joint)) largest = std::max(largest, left[joint]);
  }
  fault.size = largest;
  fault.words = fmt::format(
      "{} in another order than the robot file's joints: {}; as they stand the model leaves up to "
      "{:.0f} % of a torque, in that order less than {:.0f} %",
      torques ? "the torques are" : "positions and torques are", words_of(*order), 100 * largest,
      100 * kGood);
  fault.mend = fmt::format("put the columns of the {} in the order of the joints",
                           torques ? "torques" : "positions, velocities and torques");
  propose_channels(log, mended, std::move(keys), fault);
  faults.push_back(std::move(fault));
  return true;
}

}  // namespace offnominal::desk
