#include "inertial/base_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "compare/motion.hpp"
#include "identify/inertial_regressor.hpp"

namespace offnominal::desk {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

// States of the joints, a column each; those that stand are where they stand.
Motion random_motion(const RobotDescription& robot, const BaseRequest& request) {
  constexpr Index kStatesPerJoint = 40;
  constexpr std::uint64_t kSeed = 20221;
  const Index joints = robot.joint_count();
  const Index samples = kStatesPerJoint * joints;
  Motion motion;
  motion.t_s = VectorXd::LinSpaced(samples, 0, 1);
  motion.q.resize(samples, joints);
  motion.dq = MatrixXd::Zero(samples, joints);
  motion.ddq = MatrixXd::Zero(samples, joints);
  std::mt19937_64 generator(kSeed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0, 1)(generator);
  };
  for (Index joint = 0; joint < joints; ++joint) {
    const auto at = static_cast<std::size_t>(joint);
    if (request.moves[at] == 0) {
      motion.q.col(joint).setConstant(request.stands_at[at]);
      continue;
    }
    const bool turns = robot.joints[at].joint.type == JointType::kRevolute;
    const double most = turns ? std::numbers::pi : 0.5;
    for (Index i = 0; i < samples; ++i) {
      motion.q(i, joint) = draw(-most, most);
      motion.dq(i, joint) = draw(-2, 2);
      motion.ddq(i, joint) = draw(-6, 6);
    }
  }
  return motion;
}

// Torques of the joints that move, stacked.
VectorXd stacked(const MatrixXd& torque, const std::vector<char>& moves) {
  VectorXd column(torque.size());
  for (Index joint = 0; joint < torque.cols(); ++joint) {
    const bool counts = moves[static_cast<std::size_t>(joint)] != 0;
    column.segment(joint * torque.rows(), torque.rows()) =
        counts ? torque.col(joint).eval() : VectorXd::Zero(torque.rows()).eval();
  }
  return column;
}

struct NumberColumns {
  MatrixXd columns;
  std::vector<std::string> symbols;
  std::vector<std::string> units;
};

NumberColumns numbers_of(const RobotDescription& robot, const BaseRequest& request) {
  const Motion motion = random_motion(robot, request);
  // From the base outwards, moments first: what a link shares with the one before it is then named
  // by the one before it, as is usual.
  NumberColumns all;
  const auto count = static_cast<Index>(request.links.size()) * kInertialNumbers +
                     static_cast<Index>(request.rotors.size());
  all.columns.resize(motion.q.size(), count);
  Index at = 0;
  for (const std::size_t link : request.links) {
    const std::vector<MatrixXd> torques = inertial_regressor(robot, link, motion);
    for (Index number = 0; number < kInertialNumbers; ++number) {
      all.columns.col(at++) = stacked(torques[static_cast<std::size_t>(number)], request.moves);
      all.symbols.push_back(fmt::format("{}{}", symbol_of_inertial_number(number), link + 1));
      all.units.emplace_back(unit_of_inertial_number(number));
    }
  }
  for (const std::size_t joint : request.rotors) {
    MatrixXd torque = MatrixXd::Zero(motion.q.rows(), motion.q.cols());
    torque.col(static_cast<Index>(joint)) = motion.ddq.col(static_cast<Index>(joint));
    all.columns.col(at++) = stacked(torque, request.moves);
    all.symbols.push_back(fmt::format("Ia{}", joint + 1));
    all.units.emplace_back(robot.joints[joint].joint.type == JointType::kRevolute ? "kg m^2"
                                                                                  : "kg");
  }
  return all;
}

// Numbers in the order in which they are taken as leading ones: moments of inertia of a link, its
// first moments, its mass.
std::vector<Index> order_of(Index count, std::size_t links) {
  constexpr std::array<Index, kInertialNumbers> kWithin{4, 7, 8, 5, 9, 6, 1, 2, 3, 0};
  std::vector<Index> order;
  for (Index link = 0; link < static_cast<Index>(links); ++link) {
    for (const Index number : kWithin) order.push_back(link * kInertialNumbers + number);
  }
  for (auto at = static_cast<Index>(order.size()); at < count; ++at) order.push_back(at);
  return order;
}

// Which columns are no combination of those before them, and how the others are made of these.
struct Split {
  std::vector<Index> leading;
  MatrixXd factors;  // rows: leading columns, columns: all
};

Split split(const MatrixXd& columns, const std::vector<Index>& order) {
  constexpr double kNothing = 1e-8;
  const double largest = columns.size() > 0 ? columns.colwise().norm().maxCoeff() : 0;
  Split found{{}, MatrixXd::Zero(columns.cols(), columns.cols())};
  MatrixXd basis(columns.rows(), 0);
  MatrixXd upper(0, 0);  // leading columns = basis * upper
  for (const Index column : order) {
    const double length = columns.col(column).norm();
    if (!(length > kNothing * largest)) continue;
    VectorXd rest = columns.col(column);
    VectorXd along = VectorXd::Zero(basis.cols());
    for (int pass = 0; pass < 2; ++pass) {
      const VectorXd more = basis.transpose() * rest;
      rest -= basis * more;
      along += more;
    }
    const Index rank = basis.cols();
    if (rest.norm() <= kNothing * length * 10) {
      const VectorXd factors = upper.triangularView<Eigen::Upper>().solve(along);
      found.factors.col(column).head(rank) = factors;
      continue;
    }
    basis.conservativeResize(Eigen::NoChange, rank + 1);
    basis.col(rank) = rest / rest.norm();
    upper.conservativeResizeLike(MatrixXd::Zero(rank + 1, rank + 1));
    upper.col(rank).head(rank) = along;
    upper(rank, rank) = rest.norm();
    found.factors(rank, column) = 1;
    found.leading.push_back(column);
  }
  found.factors.conservativeResize(static_cast<Index>(found.leading.size()), Eigen::NoChange);
  return found;
}

std::string name_of_combination(const VectorXd& factors, Index leading,
                                const std::vector<std::string>& symbols) {
  std::string name = symbols[static_cast<std::size_t>(leading)];
  for (Index i = 0; i < factors.size(); ++i) {
    if (i == leading || factors[i] == 0) continue;
    const double size = std::abs(factors[i]);
    const std::string& symbol = symbols[static_cast<std::size_t>(i)];
    name += factors[i] < 0 ? " - " : " + ";
    name += std::abs(size - 1) < 1e-6 ? symbol : fmt::format("{:.4g} {}", size, symbol);
  }
  return name;
}

}  // namespace

BaseParameters base_parameters(const RobotDescription& robot, const BaseRequest& request) {
  const NumberColumns numbers = numbers_of(robot, request);
  const Split found =
      split(numbers.columns, order_of(numbers.columns.cols(), request.links.size()));
  BaseParameters base;
  base.symbols = numbers.symbols;
  base.leading = found.leading;
  base.combinations = found.factors;
  for (Index row = 0; row < base.combinations.rows(); ++row) {
    const Index leading = base.leading[static_cast<std::size_t>(row)];
    for (Index i = 0; i < base.combinations.cols(); ++i) {
      double& factor = base.combinations(row, i);
      if (std::abs(factor) < 1e-7) factor = 0;  // rounding
    }
    base.names.push_back(
        name_of_combination(base.combinations.row(row).transpose(), leading, base.symbols));
    base.units.push_back(numbers.units[static_cast<std::size_t>(leading)]);
  }
  return base;
}

std::vector<std::size_t> rotors_apart(const RobotDescription& robot, const BaseRequest& request) {
  const BaseParameters base = base_parameters(robot, request);
  const auto of_links = static_cast<Index>(request.links.size()) * kInertialNumbers;
  std::vector<std::size_t> apart;
  for (std::size_t i = 0; i < request.rotors.size(); ++i) {
    const Index number = of_links + static_cast<Index>(i);
    if (std::find(base.leading.begin(), base.leading.end(), number) != base.leading.end()) {
      apart.push_back(request.rotors[i]);
    }
  }
  return apart;
}

}  // namespace offnominal::desk
