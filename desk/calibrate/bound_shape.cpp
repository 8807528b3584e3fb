#include "calibrate/bound_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/model/mass_matrix.hpp>
#include <span>

#include "common/nearest.hpp"
#include "common/number.hpp"
#include "robot/bound_names.hpp"
#include "robot/chain_of.hpp"
#include "robot/monitor_config_of.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Kind = BoundSettings::Kind;

constexpr int kTablePoints = 6;
constexpr double kSmallestStep = 0.02;  // between points, of their range

double round_up(double value, int digits) {
  if (!(value > 0)) return 0;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) + 1 - digits);
  // Through text, so that the file holds 0.4021 and not 0.40210000000000001.
  double rounded = std::stod(fmt::format("{:.{}e}", std::ceil(value / unit) * unit, digits - 1));
  if (rounded < value) {
    rounded = std::stod(fmt::format("{:.{}e}", (std::ceil(value / unit) + 1) * unit, digits - 1));
  }
  return rounded;
}

constexpr int kDigits = 4;

// The bound whose value is phi_k.
BoundSettings unit_bound(const BoundShape& shape, int k) {
  BoundSettings bound = shape.settings;
  bound.velocity_error = 0;
  switch (bound.kind) {
    case Kind::kConstant:
    case Kind::kPerJoint:  // no shape: each joint has one of its own
      bound.constant.value = 1;
      break;
    case Kind::kScaledNorm:
      bound.scaled_norm.scale = 1;
      bound.scaled_norm.offset = k;
      if (k == 1) bound.scaled_norm.matrix.clear();
      break;
    case Kind::kTable:
      bound.table.value.assign(bound.table.at.size(), 0.0);
      bound.table.value[static_cast<std::size_t>(k)] = 1;
      break;
  }
  return bound;
}

bool follows_torque(const BoundShape& shape) {
  return shape.settings.kind == Kind::kTable &&
         shape.settings.table.variable == BoundVariable::kTorque;
}

using Joints = Vector<kRuntimeJoints, double>;

// phi_k at the samples' position and velocity, with the torque `shift` samples later.
Eigen::VectorXd basis_values(const UncertaintyBound<kRuntimeJoints, double>& bound,
                             const RecordedError& recording, Index shift) {
  Eigen::VectorXd values(recording.samples());
  for (Index i = 0; i < recording.samples(); ++i) {
    const Joints q = recording.signals->q.row(i);
    const Joints dq = recording.signals->dq.row(i);
    const Joints tau = recording.signals->tau.row(std::min(i + shift, recording.samples() - 1));
    values[i] = evaluate(bound, q, dq, tau);
  }
  return values;
}

std::string matrix_words(const std::vector<std::vector<double>>& matrix) {
  const auto words = [](const auto& row) { return "[" + list_of(row, shortest) + "]"; };
  return "[" + list_of(matrix, words) + "]";
}

BoundShape scaled_norm(std::vector<std::vector<double>> matrix) {
  BoundShape shape;
  shape.settings.kind = Kind::kScaledNorm;
  shape.size = 2;
  shape.words = "scaled_norm, matrix " + matrix_words(matrix);
  shape.settings.scaled_norm.matrix = std::move(matrix);
  return shape;
}

// M^-1 at the recordings' mean position, in two digits; effects without torque of their own
// (inertia) are in it.
std::vector<std::vector<double>> mean_inverse_inertia(
    const RobotDescription& robot, const std::vector<RecordedError>& recordings) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(robot.joint_count());
  for (const RecordedError& recording : recordings) {
    mean +=
        recording.signals->q.colwise().mean().transpose() / static_cast<double>(recordings.size());
  }
  const auto model = make_model(chain_of<kRuntimeJoints, double>(robot));
  const Joints q = mean;
  const Eigen::MatrixXd inertia = mass_matrix(model, q);
  const Eigen::MatrixXd inverse =
      inertia.ldlt().solve(Eigen::MatrixXd::Identity(inertia.rows(), inertia.cols()));
  std::vector<std::vector<double>> rows;
  for (Index i = 0; i < inverse.rows(); ++i) {
    std::vector<double>& row = rows.emplace_back();
    for (Index j = 0; j < inverse.cols(); ++j) {
      row.push_back(std::stod(fmt::format("{:.2g}", inverse(i, j))));
    }
  }
  return rows;
}

// Points at even shares of the samples, in three digits; none where they would not differ.
std::vector<double> points_over(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double range = values.back() - values.front();
  std::vector<double> points;
  for (int i = 0; i < kTablePoints; ++i) {
    const std::size_t place =
        (values.size() - 1) * static_cast<std::size_t>(i) / (kTablePoints - 1);
    const double point = std::stod(fmt::format("{:.3g}", values[place]));
    if (points.empty() || point > points.back() + kSmallestStep * range) points.push_back(point);
  }
  return points;
}

void add_table(BoundVariable variable, int joint, const std::vector<RecordedError>& recordings,
               std::vector<BoundShape>& shapes) {
  std::vector<double> values;
  for (const RecordedError& recording : recordings) {
    const RecordedSignals& signals = *recording.signals;
    const Eigen::MatrixXd& source = variable == BoundVariable::kPosition ? signals.q
                                    : variable == BoundVariable::kSpeed  ? signals.dq
                                                                         : signals.tau;
    for (const double value : source.col(joint)) {
      values.push_back(variable == BoundVariable::kPosition ? value : std::abs(value));
    }
  }
  BoundShape shape;
  shape.settings.kind = Kind::kTable;
  shape.settings.table = {variable, joint, points_over(std::move(values)), {}};
  shape.size = static_cast<int>(shape.settings.table.at.size());
  if (shape.size < 3) return;
  shape.words =
      fmt::format("table over {} of joint {}", bound_variable_names(variable).name, joint + 1);
  shapes.push_back(std::move(shape));
}

}  // namespace

BoundSettings bound_with(const BoundShape& shape, const Eigen::VectorXd& coefficients,
                         double velocity_error) {
  BoundSettings bound = shape.settings;
  bound.velocity_error = round_up(velocity_error, kDigits);
  switch (bound.kind) {
    case Kind::kConstant:
    case Kind::kPerJoint:
      bound.constant.value = round_up(coefficients[0], kDigits);
      break;
    case Kind::kScaledNorm:
      bound.scaled_norm.scale = round_up(coefficients[0], kDigits);
      bound.scaled_norm.offset = round_up(coefficients[1] / bound.scaled_norm.scale, kDigits);
      break;
    case Kind::kTable:
      bound.table.value.clear();
      for (const double value : coefficients) {
        bound.table.value.push_back(round_up(value, kDigits));
      }
      break;
  }
  return bound;
}

std::vector<BoundShape> bound_shapes(const RobotDescription& robot,
                                     const std::vector<RecordedError>& recordings) {
  const auto joints = static_cast<std::size_t>(robot.joint_count());
  std::vector<BoundShape> shapes(1);
  shapes[0].words = "constant";
  if (robot.bound && robot.bound->kind == Kind::kScaledNorm) {
    shapes.push_back(scaled_norm(robot.bound->scaled_norm.matrix));
  }
  std::vector<std::vector<double>> identity(joints, std::vector<double>(joints, 0.0));
  for (std::size_t i = 0; i < joints; ++i) {
    identity[i][i] = 1;
    if (joints > 1) shapes.push_back(scaled_norm({identity[i]}));
  }
  shapes.push_back(scaled_norm(identity));
  if (joints > 1) shapes.push_back(scaled_norm(mean_inverse_inertia(robot, recordings)));
  for (int joint = 0; joint < robot.joint_count(); ++joint) {
    add_table(BoundVariable::kPosition, joint, recordings, shapes);
    add_table(BoundVariable::kSpeed, joint, recordings, shapes);
    add_table(BoundVariable::kTorque, joint, recordings, shapes);
  }
  return shapes;
}

std::vector<BoundShape> joint_bound_shapes(const RobotDescription& robot, int joint,
                                           const std::vector<RecordedError>& recordings) {
  std::vector<BoundShape> shapes(1);
  shapes[0].words = "constant";
  add_table(BoundVariable::kSpeed, joint, recordings, shapes);
  const bool acts_later =
      std::any_of(robot.effects.begin(), robot.effects.end(), [joint](const RobotEffect& one) {
        return one.kind == EffectKind::kTimeDelay && one.joint == joint;
      });
  if (!acts_later) add_table(BoundVariable::kTorque, joint, recordings, shapes);
  add_table(BoundVariable::kPosition, joint, recordings, shapes);
  return shapes;
}

Eigen::MatrixXd filtered_basis(const RobotDescription& robot, const BoundShape& shape,
                               const RecordedError& recording) {
  const TickFilter<double> filter = recording.filter();
  const bool held = robot.estimator.torque_signal == TorqueSignal::kHeld;
  // A held torque is over the whole tick what the sample at its end says.
  const Index shift = held && follows_torque(shape) ? 1 : 0;
  Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(recording.samples(), shape.size);
  for (int k = 0; k < shape.size; ++k) {
    const BoundSettings unit = unit_bound(shape, k);
    const auto bound = bound_of<kRuntimeJoints, double>(unit, robot.joints.size());
    const Eigen::VectorXd end = basis_values(bound, recording, 0);
    const Eigen::VectorXd begin = shift == 0 ? end : basis_values(bound, recording, shift);
    for (Index i = 1; i < recording.samples(); ++i) {
      basis(i, k) =
          filter.keep * basis(i - 1, k) + filter.begin * begin[i - 1] + filter.end * end[i];
    }
  }
  basis *= recording.scale;
  return basis;
}

}  // namespace offnominal::desk
