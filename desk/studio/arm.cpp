#include "studio/arm.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <offnominal/model/cholesky.hpp>
#include <offnominal/model/mass_matrix.hpp>
#include <vector>

#include "common/refused.hpp"
#include "robot/chain_of.hpp"
#include "robot/monitor_config_of.hpp"
#include "studio/charts.hpp"
#include "studio/link_frames.hpp"

namespace offnominal::desk::studio {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using nlohmann::ordered_json;
using JointVector = Vector<kRuntimeJoints, double>;

namespace {

// Six digits behind the first one: a picture and a table show less.
ordered_json digits(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0) return 0;
  const double scale = std::pow(10, 6 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(scale) ? std::round(value * scale) / scale : value;
}

// A place in m, or a part of a quaternion: to the millionth.
double fine(double value) { return std::round(1e6 * value) / 1e6; }

ordered_json numbers(const VectorXd& values) {
  ordered_json all = ordered_json::array();
  for (const double value : values) all.push_back(digits(value));
  return all;
}

// Column by column.
ordered_json per_joint(const MatrixXd& values) {
  ordered_json all = ordered_json::array();
  for (Index joint = 0; joint < values.cols(); ++joint) all.push_back(numbers(values.col(joint)));
  return all;
}

void check(const Workbench& bench, const ArmView& view) {
  const Treated& all = *bench.input().recordings;
  const auto refuse = [](const char* words) { throw Refused(Refused::Why::kBadRequest, words); };
  if (view.recording >= all.logs.size() + all.holdout.size()) refuse("No such recording.");
  check_shown(view.from_s, view.to_s);
}

// Samples `first` to `end`, that one left out.
struct Part {
  Index first = 0;
  Index end = 0;
};

// Those that are shown; where there is none, the one nearest to the middle.
Part shown_part(const VectorXd& t_s, const ArmView& view) {
  const auto at = [&](double time) {
    return static_cast<Index>(std::lower_bound(t_s.begin(), t_s.end(), time) - t_s.begin());
  };
  const Index first = view.from_s ? at(*view.from_s) : 0;
  const Index end = view.to_s ? at(*view.to_s) : t_s.size();
  if (first < end) return {first, end};
  const double middle = (view.from_s.value_or(t_s[0]) + view.to_s.value_or(t_s[0])) / 2;
  Index nearest = 0;
  (t_s.array() - middle).abs().minCoeff(&nearest);
  return {nearest, nearest + 1};
}

// Evenly, the first and the last one with them.
std::vector<Index> picked(const Part& part, std::size_t most) {
  const Index count = part.end - part.first;
  const Index kept = std::min(count, static_cast<Index>(most));
  std::vector<Index> rows;
  for (Index i = 0; i < kept; ++i) {
    rows.push_back(part.first + (kept == 1 ? 0 : (i * (count - 1) + (kept - 1) / 2) / (kept - 1)));
  }
  return rows;
}

double rms(const VectorXd& values, const VectorXd& counts) {
  const double samples = counts.sum();
  if (samples == 0) return std::numeric_limits<double>::quiet_NaN();
  return std::sqrt((values.array().square() * counts.array()).sum() / samples);
}

// Of the whole recording, joint by joint.
VectorXd rms_torques(const Comparison& recording) {
  VectorXd all(recording.measured.cols());
  for (Index joint = 0; joint < all.size(); ++joint) {
    all[joint] = rms(recording.measured.col(joint), recording.moving.col(joint));
  }
  return all;
}

// |error| / mu_bar, joint by joint: of torques where the bound is of torques, otherwise of the
// accelerations M^-1 error. Empty where the robot has no bound.
MatrixXd over_bound(const RobotDescription& robot, const ArmModel& model,
                    const Comparison& recording, const MatrixXd& error,
                    const std::vector<Index>& rows) {
  if (!robot.bound) return {};
  const std::size_t joints = robot.joints.size();
  MatrixXd ratios(static_cast<Index>(rows.size()), error.cols());
  const bool of_torques = robot.bound->kind == BoundSettings::Kind::kPerJoint;
  TorqueBound<kRuntimeJoints, double> torque;
  UncertaintyBound<kRuntimeJoints, double> acceleration;
  if (of_torques) {
    torque =
        torque_bound_of<kRuntimeJoints, double>(*robot.bound, robot.estimator.fast_alpha, joints);
  } else {
    acceleration = bound_of<kRuntimeJoints, double>(*robot.bound, joints);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const JointVector q = recording.q.row(rows[i]).transpose();
    const JointVector dq = recording.dq.row(rows[i]).transpose();
    const JointVector tau = recording.measured.row(rows[i]).transpose();
    JointVector missed = error.row(rows[i]).transpose();
    JointVector bound;
    if (of_torques) {
      bound = evaluate<kRuntimeJoints, double>(torque.joints, q, dq, tau);
    } else {
      Matrix<kRuntimeJoints, kRuntimeJoints, double> factor;
      const bool solved = cholesky<kRuntimeJoints, double>(mass_matrix(model, q), factor);
      if (solved) solve_in_place<kRuntimeJoints, double>(factor, missed);
      if (!solved) missed.setConstant(std::numeric_limits<double>::quiet_NaN());
      bound = JointVector::Constant(missed.size(), evaluate(acceleration, q, dq, tau));
    }
    ratios.row(static_cast<Index>(i)) = missed.cwiseAbs().cwiseQuotient(bound).transpose();
  }
  return ratios;
}

// 100 |error| / rms of the joint's torque, joint by joint.
MatrixXd percent_of(const MatrixXd& error, const VectorXd& rms_torque) {
  return 100 * error.cwiseAbs() * rms_torque.cwiseInverse().asDiagonal();
}

ordered_json place_of(const Vector3d& at) { return {fine(at.x()), fine(at.y()), fine(at.z())}; }

// Every frame at every instant, and the box that holds all joints and ends then.
void put_frames(const ArmModel& model, const ArmShape& shape, const MatrixXd& q,
                ordered_json& arm) {
  const std::size_t joints = shape.links.size();
  std::vector<ordered_json> places(joints, ordered_json::array());
  std::vector<ordered_json> turns(joints, ordered_json::array());
  Eigen::AlignedBox3d box(Vector3d(0, 0, 0));
  for (Index i = 0; i < q.rows(); ++i) {
    const std::vector<Eigen::Isometry3d> frames = link_frames(model, q.row(i).transpose());
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const Vector3d place = frames[joint].translation();
      const Eigen::Quaterniond turn(frames[joint].linear());
      for (const double value : place) places[joint].push_back(fine(value));
      for (const double value : {turn.x(), turn.y(), turn.z(), turn.w()}) {
        turns[joint].push_back(fine(value));
      }
      box.extend(place);
      box.extend(frames[joint] * shape.links[joint].end_m);
    }
  }
  arm["low_m"] = place_of(box.min());
  arm["high_m"] = place_of(box.max());
  arm["place_m"] = std::move(places);
  arm["turn"] = std::move(turns);
}

ordered_json joints_of(const Workbench& bench, const Comparison& recording, const ArmShape& shape,
                       const MatrixXd& error, const VectorXd& rms_torque, const Part& part) {
  ordered_json all = ordered_json::array();
  for (std::size_t i = 0; i < shape.links.size(); ++i) {
    const RobotJoint& named = bench.robot().joints[i];
    const Joint<double>& joint = named.joint;
    const bool turns = joint.type == JointType::kRevolute;
    const auto column = static_cast<Index>(i);
    const VectorXd counts = recording.moving.col(column);
    const Index shown = part.end - part.first;
    const double missed =
        rms(error.col(column).segment(part.first, shown), counts.segment(part.first, shown));
    ordered_json rail = nullptr;
    if (const auto& ends = shape.links[i].rail_m) {
      rail = {place_of(ends->first), place_of(ends->second)};
    }
    all.push_back({{"joint", i + 1},
                   {"name", named.name},
                   {"type", turns ? "revolute" : "prismatic"},
                   {"unit", turns ? "rad" : "m"},
                   {"torque_unit", turns ? "N m" : "N"},
                   {"axis", joint.axis},
                   {"origin_m", joint.origin_m},
                   {"centre_of_mass_m", joint.centre_of_mass_m},
                   {"end_m", place_of(shape.links[i].end_m)},
                   {"rail_m", std::move(rail)},
                   {"rms_torque", digits(rms_torque[column])},
                   {"rms_error", digits(missed)},
                   {"error_percent", digits(100 * missed / rms_torque[column])}});
  }
  return all;
}

}  // namespace

ordered_json arm_of(const Workbench& bench, const ArmView& view) {
  check(bench, view);
  const RobotDescription& robot = bench.robot();
  const Comparison& recording = recording_of(bench.now(), view.recording);
  const MatrixXd error = recording.residual();
  const VectorXd rms_torque = rms_torques(recording);
  const Part part = shown_part(recording.t_s, view);
  const std::vector<Index> rows = picked(part, view.instants);
  const ArmModel model = make_model(chain_of<kRuntimeJoints, double>(robot));
  const ArmShape shape = shape_of(robot, recording.q.colwise().minCoeff().transpose(),
                                  recording.q.colwise().maxCoeff().transpose());
  const MatrixXd q = recording.q(rows, Eigen::all);
  const MatrixXd ratios = over_bound(robot, model, recording, error, rows);
  ordered_json arm{{"recording", view.recording + 1},
                   {"gravity_m_s2", robot.gravity_m_s2},
                   {"reach_m", digits(shape.reach_m)},
                   {"knows_lengths", shape.knows_lengths},
                   {"joints", joints_of(bench, recording, shape, error, rms_torque, part)},
                   {"t_s", numbers(recording.t_s(rows))},
                   {"position", per_joint(q)},
                   {"measured", per_joint(recording.measured(rows, Eigen::all))},
                   {"model", per_joint(recording.model(rows, Eigen::all))},
                   {"error", per_joint(error(rows, Eigen::all))},
                   {"percent", per_joint(percent_of(error(rows, Eigen::all), rms_torque))},
                   {"over_bound", nullptr}};
  if (ratios.size() > 0) arm["over_bound"] = per_joint(ratios);
  put_frames(model, shape, q, arm);
  return arm;
}

}  // namespace offnominal::desk::studio
