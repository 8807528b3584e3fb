#include "analysis/shape_group.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>

#include "analysis/shape_grid.hpp"
#include "signal/quantile.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::string_view kWidth = effects::kSmoothing.name;
constexpr std::size_t kMostGridPoints = 20000;

// Four points per factor of ten, from a thousandth to once the highest speed of the motion. A sign
// narrower than that would follow the velocity's noise, and no recording shows it apart.
std::vector<double> speed_grid(const VectorXd& dq) {
  constexpr int kDecades = 3;
  constexpr int kPerDecade = 4;
  const double highest = quantile(dq.cwiseAbs(), 0.99);
  std::vector<double> grid;
  if (!(highest > 0)) return grid;
  for (int i = -kDecades * kPerDecade; i <= 0; ++i) {
    grid.push_back(highest * std::pow(10.0, static_cast<double>(i) / kPerDecade));
  }
  return grid;
}

std::vector<double> even_grid(double from, double to, double step) {
  std::vector<double> grid;
  for (std::size_t i = 0; i < kMostGridPoints; ++i) {
    const double value = from + static_cast<double>(i) * step;
    if (value > to) break;
    grid.push_back(value);
  }
  return grid;
}

// Periods per turn or per metre: from one over the range moved to what the filter still lets pass
// at a slow quarter of the motion, in quarters of what the range resolves.
std::vector<double> order_grid(const VectorXd& q, const VectorXd& dq, JointType type,
                               double torque_cutoff_hz) {
  const double unit = first_order_period(type);
  const double range = (q.maxCoeff() - q.minCoeff()) / unit;
  const VectorXd speed = dq.cwiseAbs() / unit;
  const double slow = std::max(quantile(speed, 0.25), 0.05 * quantile(speed, 0.99));
  if (!(range > 0) || !(slow > 0)) return {};
  return even_grid(1 / range, torque_cutoff_hz / slow, 0.25 / range);
}

std::vector<double> frequency_grid(const VectorXd& t_s, double torque_cutoff_hz) {
  const double whole = 2 * std::numbers::pi / (t_s[t_s.size() - 1] - t_s[0]);
  return even_grid(2 * whole, 2 * std::numbers::pi * torque_cutoff_hz, 0.25 * whole);
}

// From a twelfth of the recording to one and a half times its length.
std::vector<double> duration_grid(const VectorXd& t_s) {
  constexpr int kPoints = 13;
  const double duration = t_s[t_s.size() - 1] - t_s[0];
  std::vector<double> grid;
  for (int i = 0; i < kPoints; ++i) {
    grid.push_back(duration / 12 * std::pow(18.0, static_cast<double>(i) / (kPoints - 1)));
  }
  return grid;
}

std::vector<double> position_grid(const VectorXd& q) {
  constexpr int kPoints = 41;
  const double low = q.minCoeff();
  const double range = q.maxCoeff() - low;
  if (!(range > 0)) return {};
  return even_grid(low - range / 2, low + 1.5 * range, 2 * range / (kPoints - 1));
}

// Four points per factor of ten, from a thousandth of the range moved to half of it.
std::vector<double> distance_grid(const VectorXd& q) {
  const double range = q.maxCoeff() - q.minCoeff();
  return logarithmic_grid(0.001 * range, 0.5 * range, 4);
}

class GroupMaker {
 public:
  GroupMaker(RobotDescription& robot, const std::vector<std::size_t>& refitted,
             const std::vector<ShapeMember>& given, const Motion& motion, double torque_cutoff_hz)
      : robot_(robot),
        refitted_(refitted),
        given_(given),
        motion_(motion),
        torque_cutoff_hz_(torque_cutoff_hz) {}

  std::vector<ShapeGroup> make(const std::vector<std::size_t>& added) {
    for (const std::size_t effect : added) set_only_source(effect);
    for (const std::size_t effect : added) {
      const auto parameters = info_of(robot_.effects[effect].kind)->parameters;
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (parameters[i].role != ParameterRole::kShape || is_given(effect, i)) continue;
        if (parameters[i].name == kWidth) {
          add_width(added, {effect, i});
        } else {
          add_group({effect, i}, parameters[i]);
        }
      }
    }
    return std::move(groups_);
  }

 private:
  bool is_given(std::size_t effect, std::size_t parameter) const {
    return std::any_of(given_.begin(), given_.end(), [&](const ShapeMember& member) {
      return member.effect == effect && member.parameter == parameter;
    });
  }

  std::optional<std::size_t> width_of(std::size_t effect) const {
    const auto parameters = info_of(robot_.effects[effect].kind)->parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].name == kWidth) return i;
    }
    return std::nullopt;
  }

  // The joint whose velocity an effect follows: its own, or the one that it names.
  std::size_t velocity_joint(std::size_t effect) const {
    const RobotEffect& of = robot_.effects[effect];
    const auto parameters = info_of(of.kind)->parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const bool names_one = parameters[i].quantity == Quantity::kJointNumber &&
                             source_joint_valid(of, robot_.joint_count());
      if (names_one) return static_cast<std::size_t>(of.parameters[i]) - 1;
    }
    return of.joint;
  }

  std::vector<double> source_grid(std::size_t own) const {
    std::vector<double> grid;
    for (std::size_t joint = 0; joint < robot_.joints.size(); ++joint) {
      if (joint != own) grid.push_back(static_cast<double>(joint + 1));
    }
    return grid;
  }

  void set_only_source(std::size_t effect) {
    const auto parameters = info_of(robot_.effects[effect].kind)->parameters;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      if (parameters[i].quantity != Quantity::kJointNumber || is_given(effect, i)) continue;
      const std::vector<double> grid = source_grid(robot_.effects[effect].joint);
      if (grid.size() == 1) value({effect, i}) = grid.front();
    }
  }

  double& value(const ShapeMember& member) {
    return robot_.effects[member.effect].parameters[member.parameter];
  }

  void add_width(const std::vector<std::size_t>& added, const ShapeMember& member) {
    const std::size_t joint = velocity_joint(member.effect);
    const auto is_listed = [](const std::vector<std::size_t>& list, std::size_t effect) {
      return std::find(list.begin(), list.end(), effect) != list.end();
    };
    for (ShapeGroup& group : groups_) {
      if (group.name != kWidth || velocity_joint(group.members[0].effect) != joint) continue;
      value(member) = group.start;
      group.members.push_back(member);
      return;
    }
    ShapeGroup group{{member}, std::string(kWidth), ShapeGroup::Search::kGrid, true, {}, 0};
    for (std::size_t effect = 0; effect < robot_.effects.size(); ++effect) {
      const auto width = width_of(effect);
      if (!width || velocity_joint(effect) != joint || is_listed(added, effect)) continue;
      value(member) = value({effect, *width});
      if (!is_listed(refitted_, effect)) return;
      group.members.push_back({effect, *width});
    }
    group.start = value(member);
    group.grid = speed_grid(motion_.dq.col(static_cast<Index>(joint)));
    if (!group.grid.empty()) groups_.push_back(std::move(group));
  }

  void add_group(const ShapeMember& member, const ParameterInfo& info) {
    const std::size_t joint = robot_.effects[member.effect].joint;
    const auto column = static_cast<Index>(joint);
    const JointType type = robot_.joints[joint].joint.type;
    ShapeGroup group{{member}, info.name, ShapeGroup::Search::kGrid, false, {}, value(member)};
    switch (info.quantity) {
      case Quantity::kVelocity:
        group.logarithmic = true;
        group.grid = speed_grid(motion_.dq.col(column));
        break;
      case Quantity::kPosition:
        group.grid = position_grid(motion_.q.col(column));
        break;
      case Quantity::kDistance:
        group.logarithmic = true;
        group.grid = distance_grid(motion_.q.col(column));
        break;
      case Quantity::kTime:
        group.logarithmic = true;
        group.grid = duration_grid(motion_.t_s);
        break;
      case Quantity::kJointNumber:
        group.grid = source_grid(joint);
        if (group.grid.size() < 2) return;
        group.search = ShapeGroup::Search::kDiscrete;
        break;
      case Quantity::kCyclesPerPosition:
        group.search = ShapeGroup::Search::kPeriodicQ;
        group.grid =
            order_grid(motion_.q.col(column), motion_.dq.col(column), type, torque_cutoff_hz_);
        break;
      case Quantity::kAngularFrequency:
        group.search = ShapeGroup::Search::kPeriodicTime;
        group.grid = frequency_grid(motion_.t_s, torque_cutoff_hz_);
        break;
      default:
        return;
    }
    if (group.grid.empty()) return;
    if (info.required) group.start = group.grid[group.grid.size() / 2];
    value(member) = group.start;
    groups_.push_back(std::move(group));
  }

  RobotDescription& robot_;
  const std::vector<std::size_t>& refitted_;
  const std::vector<ShapeMember>& given_;
  const Motion& motion_;
  double torque_cutoff_hz_;
  std::vector<ShapeGroup> groups_;
};

}  // namespace

std::vector<ShapeGroup> make_shape_groups(RobotDescription& robot,
                                          const std::vector<std::size_t>& added,
                                          const std::vector<std::size_t>& refitted,
                                          const std::vector<ShapeMember>& given,
                                          const Motion& motion, double torque_cutoff_hz) {
  return GroupMaker(robot, refitted, given, motion, torque_cutoff_hz).make(added);
}

RobotDescription with_shapes(RobotDescription robot, const std::vector<ShapeGroup>& groups,
                             const std::vector<double>& values) {
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const ShapeMember& member : groups[i].members) {
      robot.effects[member.effect].parameters[member.parameter] = values[i];
    }
  }
  return robot;
}

}  // namespace offnominal::tools
