#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "compare/body_torque.hpp"
#include "compare/filter_plan.hpp"
#include "compare/motion.hpp"
#include "log/log.hpp"
#include "robot/payload.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {

// One recording with everything that regressors are made from, at a sampling rate that the low-pass
// of the plan leaves room for. Rows: samples, columns: joints.
struct Workspace {
  std::string file;                // of the recording
  std::optional<Payload> payload;  // the recording's
  RobotDescription rigid;          // the robot with the payload, without effects
  std::vector<RobotEffect> known_effects;
  FilterPlan plan;               // as of these samples
  Motion motion;                 // low-passed position and its derivatives
  Eigen::MatrixXd torque;        // measured, N m or N
  Eigen::MatrixXd load_torque;   // rigid-body torque of the model without any effect
  Eigen::MatrixXd stiff_torque;  // of the model with its effects, transmissions taken for rigid
  Eigen::MatrixXd model_torque;  // of the model with all its effects
  BodyTorque bodies;             // what the next model may have in common with this one
  // Column k of the mass matrix over time: what 1 rad/s^2 or m/s^2 of joint k asks of every joint.
  std::vector<Eigen::MatrixXd> mass;
  Eigen::VectorXd torque_noise_density;  // per joint, of the recording, N m or N per root hertz
  Eigen::VectorXd sign_width;            // per joint: width of the smoothed sign, rad/s or m/s
  Eigen::VectorXd top_speed;             // per joint: 99 % quantile of |dq|
  Eigen::MatrixXd moving;                // standstill.hpp: 1 or 0; empty: 1 throughout
  Eigen::MatrixXd usable;                // usable.hpp: 1 or 0; empty: 1 throughout
  double skew_s = 0;                     // sampling period of the recording itself
  double start_s = 0;                    // time stamp that effects in time count from
  bool at_rest = false;                  // a hold map: log/hold_map.hpp
  Eigen::MatrixXd approach;              // where at_rest: direction of approach, 1 or -1
  std::vector<char> came_both_ways;      // where at_rest, per joint: both_ways()
  // Per joint: its torque is that of a sensor behind the gear; empty: of none.
  std::vector<char> of_sensor;

  [[nodiscard]] Eigen::Index sample_count() const { return motion.sample_count(); }
  [[nodiscard]] Eigen::Index joint_count() const { return motion.q.cols(); }
  [[nodiscard]] JointType joint_type(Eigen::Index joint) const {
    return rigid.joints[static_cast<std::size_t>(joint)].joint.type;
  }
  [[nodiscard]] double period_s() const { return 1 / plan.sample_rate_hz; }
  // A robot as it was in this recording, with its payload.
  [[nodiscard]] RobotDescription as_recorded(const RobotDescription& robot) const {
    return carrying(robot, payload);
  }
  // Another model of the same robot: everything that follows from it.
  void set_model(const RobotDescription& robot);
  // Per joint, 0 where nothing is known: then a hundredth of the top speed.
  void set_sign_width(const Eigen::VectorXd& widths);
  // Whether the model has an effect on a joint: the joint's, or that of a motor that moves it
  // alone.
  [[nodiscard]] bool knows(EffectKind kind, Eigen::Index joint) const;
  // Whether the model has dry friction of one level on a joint.
  [[nodiscard]] bool knows_dry_friction(Eigen::Index joint) const;
  // Whether a joint came to rest from both sides, in the recordings that are fitted.
  [[nodiscard]] bool both_ways(Eigen::Index joint) const {
    return at_rest && came_both_ways[static_cast<std::size_t>(joint)] != 0;
  }
  [[nodiscard]] bool sees_drive(Eigen::Index joint) const {
    return of_sensor.empty() || of_sensor[static_cast<std::size_t>(joint)] == 0;
  }
  // tanh(dq / sign_width) of a joint.
  [[nodiscard]] Eigen::ArrayXd sign(Eigen::Index joint) const;
  // What core's hysteresis of level 1 makes of a joint's way.
  [[nodiscard]] Eigen::VectorXd dahl_state(Eigen::Index joint, double width) const;
};

// sign_width: per joint, 0 where nothing is known yet: then a hundredth of the top speed.
Workspace make_workspace(const Log& log, const RobotDescription& robot, const FilterPlan& plan,
                         const Eigen::VectorXd& sign_width);

// The same of several recordings, each at its own sampling rate.
std::vector<Workspace> make_workspaces(const std::vector<Log>& logs, const RobotDescription& robot,
                                       const FilterPlan& plan, const Eigen::VectorXd& sign_width);

// Per joint: 1 where some of the hold maps' readings came from below and some from above.
std::vector<char> came_both_ways(const std::vector<Log>& logs);

// Whether a joint moves in one of the recordings.
bool moves_in_any(const std::vector<Workspace>& recordings, Eigen::Index joint);

// Largest range of positions that one recording covers, rad or m.
double range_moved(const std::vector<Workspace>& recordings, Eigen::Index joint);
Eigen::VectorXd ranges_moved(const std::vector<Workspace>& recordings);

// The positions that the recordings cover together, rad or m.
struct PositionSpan {
  double low = 0;
  double high = 0;
};
PositionSpan positions_seen(const std::vector<Workspace>& recordings, Eigen::Index joint);

double longest_duration_s(const std::vector<Workspace>& recordings);

}  // namespace offnominal::desk
