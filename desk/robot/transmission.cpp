#include "robot/transmission.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "common/error.hpp"
#include "common/number.hpp"
#include "robot/channels.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// More than any gear, belt or screw has.
constexpr double kMostRatio = 1e6;
constexpr double kLeastRatio = 1e-6;
constexpr double kMostOffsetRad = 1e6;
constexpr double kMostTorqueConstant = 1e3;

NumberRule within(double most, const char* unit) {
  NumberRule rule;
  rule.min = -most;
  rule.max = most;
  rule.unit = unit;
  return rule;
}

std::string number_of(const char* what, Index i) {
  return std::string(what) + " " + std::to_string(i + 1);
}

// One number per joint or motor, `of`, none of them 0 or smaller in size than `least`.
std::vector<double> read_factors(const TomlTable& table, const std::string& key,
                                 const NumberRule& rule, std::size_t count, const char* of,
                                 double least, const std::string& mend) {
  std::vector<double> values = table.numbers(key, rule, count, count);
  const auto bad = std::find_if(values.begin(), values.end(), [least](double value) {
    return value == 0 || std::abs(value) < least;
  });
  if (bad != values.end()) {
    const std::string size = least > 0 ? " of " + shortest(least) + " or more in size" : "";
    table.refuse(key, shortest(*bad) + " for " + number_of(of, bad - values.begin()),
                 "any other number" + size + ", negative where they turn against each other", mend);
  }
  return values;
}

std::string inverse_missing(const MatrixXd& matrix) {
  for (Index i = 0; i < matrix.rows(); ++i) {
    if (matrix.row(i).isZero(0)) return number_of("motor", i) + " moving no joint: its row is 0";
  }
  for (Index i = 0; i < matrix.cols(); ++i) {
    if (matrix.col(i).isZero(0)) {
      return number_of("joint", i) + " moved by no motor: its column is 0";
    }
  }
  // Ratios of rad per rad and rad per m stand side by side: what counts is whether rows and columns
  // differ, not how large they are.
  MatrixXd scaled = matrix;
  for (int round = 0; round < 3; ++round) {
    for (Index i = 0; i < scaled.rows(); ++i) scaled.row(i).normalize();
    for (Index i = 0; i < scaled.cols(); ++i) scaled.col(i).normalize();
  }
  constexpr double kSingular = 1e-9;
  const VectorXd values = Eigen::JacobiSVD<MatrixXd>(scaled).singularValues();
  if (values.minCoeff() > kSingular * values.maxCoeff()) return {};
  return "a singular matrix: some motors move the joints in the same proportions";
}

void read_matrix(const TomlTable& table, std::size_t joints, TransmissionSettings& into) {
  into.matrix = table.rows("matrix", within(kMostRatio, "rad of the motor per rad or m"), joints,
                           joints, joints);
  const std::string missing = inverse_missing(motor_per_joint(into));
  if (missing.empty()) return;
  table.refuse("matrix", missing, "a matrix with an inverse, a row for every motor",
               "say in each row by how much one rad or m of each joint turns that motor");
}

bool is_of_motors(ChannelOf of) { return of == ChannelOf::kMotor || of == ChannelOf::kCurrent; }

// Each quantity of its own: positions may be the joints' and torques the motors'.
void check_quantity(std::string_view quantity, const std::vector<ChannelOf>& of,
                    const std::vector<bool>& is_there,
                    const std::optional<TransmissionSettings>& transmission,
                    const std::string& file) {
  const auto at_motors = std::find_if(of.begin(), of.end(), is_of_motors);
  if (at_motors == of.end()) return;
  const std::string place = "channels." + channel_key(quantity, *at_motors);
  if (!transmission) {
    throw InputError({file, place, "a channel of a motor",
                      "channels of joints: there is no [transmission]",
                      "add [transmission] to the robot file: the gear ratios, or the matrix"});
  }
  const bool any_current = std::find(of.begin(), of.end(), ChannelOf::kCurrent) != of.end();
  if (any_current && transmission->torque_constant.empty()) {
    throw InputError({file, "channels.motor_current", "a current",
                      "currents beside torque_constant in [transmission]",
                      "add torque_constant to [transmission], N m/A of each motor"});
  }
  const std::vector<std::size_t> group = coupled_groups(*transmission);
  for (std::size_t i = 0; i < of.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (group[i] != group[k] || !is_there[i] || !is_there[k]) continue;
      if (is_of_motors(of[i]) == is_of_motors(of[k])) continue;
      throw InputError({file, "channels." + channel_key(quantity, of[i]),
                        channel_key(quantity, of[i]) + " of joint " + std::to_string(i + 1) +
                            " beside " + channel_key(quantity, of[k]) + " of joint " +
                            std::to_string(k + 1),
                        "one side for joints that share motors",
                        "give both of the motors, or both of the joints"});
    }
  }
}

}  // namespace

const std::vector<std::string>& transmission_keys() {
  static const std::vector<std::string> keys{"ratio", "matrix", "offset_rad", "torque_constant",
                                             "source"};
  return keys;
}

TransmissionSettings read_transmission(const TomlTable& table, int joint_count) {
  const auto joints = static_cast<std::size_t>(joint_count);
  TransmissionSettings settings;
  if (table.has("ratio") == table.has("matrix")) {
    const bool both = table.has("ratio");
    table.refuse(both ? "matrix" : "", both ? "a matrix beside ratio" : "neither ratio nor matrix",
                 "ratio, one number per joint, or matrix, where joints share motors",
                 both ? "leave one of them out" : "add ratio to transmission");
  }
  if (table.has("ratio")) {
    settings.ratio =
        read_factors(table, "ratio", within(kMostRatio, "rad of the motor per rad or m"), joints,
                     "joint", kLeastRatio, "write 1 for a joint that its motor moves directly");
  } else {
    read_matrix(table, joints, settings);
  }
  if (table.has("offset_rad")) {
    settings.offset_rad =
        table.numbers("offset_rad", within(kMostOffsetRad, "rad"), joints, joints);
  }
  if (table.has("torque_constant")) {
    settings.torque_constant =
        read_factors(table, "torque_constant", within(kMostTorqueConstant, "N m/A"), joints,
                     "motor", 0, "give the motor's torque per current, from its data sheet");
  }
  settings.source = table.text_or_empty("source");
  return settings;
}

MatrixXd motor_per_joint(const TransmissionSettings& transmission) {
  if (!transmission.ratio.empty()) {
    return VectorXd::Map(transmission.ratio.data(), static_cast<Index>(transmission.ratio.size()))
        .asDiagonal();
  }
  const auto joints = static_cast<Index>(transmission.matrix.size());
  MatrixXd matrix(joints, joints);
  for (Index motor = 0; motor < joints; ++motor) {
    matrix.row(motor) =
        VectorXd::Map(transmission.matrix[static_cast<std::size_t>(motor)].data(), joints);
  }
  return matrix;
}

VectorXd motor_offset_rad(const TransmissionSettings& transmission) {
  const std::size_t motors = std::max(transmission.ratio.size(), transmission.matrix.size());
  VectorXd offset = VectorXd::Zero(static_cast<Index>(motors));
  for (std::size_t i = 0; i < transmission.offset_rad.size(); ++i) {
    offset[static_cast<Index>(i)] = transmission.offset_rad[i];
  }
  return offset;
}

std::vector<std::size_t> coupled_groups(const TransmissionSettings& transmission) {
  const MatrixXd matrix = motor_per_joint(transmission);
  const auto count = static_cast<std::size_t>(matrix.rows());
  std::vector<std::size_t> group(count);
  for (std::size_t i = 0; i < count; ++i) group[i] = i;
  for (std::size_t motor = 0; motor < count; ++motor) {
    for (std::size_t joint = 0; joint < count; ++joint) {
      if (matrix(static_cast<Index>(motor), static_cast<Index>(joint)) == 0) continue;
      const std::size_t from = std::max(group[motor], group[joint]);
      const std::size_t to = std::min(group[motor], group[joint]);
      std::replace(group.begin(), group.end(), from, to);
    }
  }
  return group;
}

void check_sides(const ChannelMap& channels,
                 const std::optional<TransmissionSettings>& transmission, const std::string& file) {
  const std::vector<bool> all(channels.position.size(), true);
  std::vector<bool> measured;
  for (const auto& channel : channels.velocity) measured.push_back(channel.has_value());
  check_quantity("position", channels.position_of, all, transmission, file);
  check_quantity("velocity", channels.velocity_of, measured, transmission, file);
  check_quantity("torque", channels.torque_of, all, transmission, file);
}

}  // namespace offnominal::desk
