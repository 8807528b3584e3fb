#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "log/log.hpp"
#include "report/page.hpp"
#include "robot/isolated_fault.hpp"
#include "robot/robot.hpp"

// The on-board monitor over a recording, tick by tick, in double precision.

namespace offnominal::desk {

// A stretch of samples with |e| above the threshold, ends included.
struct Alarm {
  double start_s = 0;
  double end_s = 0;
  double max_error_to_threshold = 0;  // largest |e| / mu in it
  // From 0, in the order in which they crossed; of several in one tick the farthest beyond first.
  // Empty where there is one threshold of all.
  std::vector<int> joints = {};

  // Of a position to which no motion comes, not of a residual.
  [[nodiscard]] bool is_jump() const { return max_error_to_threshold <= 1; }
};

// More samples refused in a row than the monitor bears: it sees nothing from the first of them to
// the sample that it begins afresh with, or to the last of the recording where none is good.
struct BlindStretch {
  double start_s = 0;
  double end_s = 0;
  std::int64_t samples = 0;
};

// Samples that the monitor refused for one reason.
struct Refusals {
  std::int64_t count = 0;
  double first_s = 0;
};

// One joint of a monitor that judges joint by joint (EstimatorSpace::kTorque).
struct JointReplay {
  std::string unit;  // of residual and threshold: "N m" or "N"
  double max_residual = 0;
  double max_threshold = 0;
  double fast_max_residual = 0;  // behind the fast filter, where there is one
  double fast_max_threshold = 0;
  // Of residual to threshold, behind the estimator's own filter and behind the fast one.
  double max_ratio_slow = 0;
  double max_ratio_fast = 0;
  double max_error_to_threshold = 0;       // of either
  std::optional<double> detection_time_s;  // its first alarm, time of the recording
  std::optional<double> act_time_s;        // its first time beyond the second level
  double act_ratio = 1;                    // of that to its threshold, of either filter
  double fast_act_ratio = 1;
  std::vector<Alarm> alarms;

  /// The largest residual of a filter that has seen something: its own where it has.
  [[nodiscard]] double largest_beyond() const {
    return max_ratio_slow > 1 ? max_residual : std::max(max_residual, fast_max_residual);
  }
};

// With EstimatorSpace::kTorque error holds residuals alpha (p - omega) in N m or N, psi_hat too,
// and error_norm and threshold are those of the joint that is nearest to its threshold.
struct Replay {
  std::string robot;
  std::string log;
  EstimatorSpace space = EstimatorSpace::kAcceleration;
  // Of |e|, mu: "rad/s", "m/s", "1" where joints of both types are mixed; "N m", "N", "N m or N".
  std::string unit;
  double period_s = 0;
  int hidden_units = 0;
  std::uint32_t seed = 0;
  double filter_s = 0;  // time constant of the residual's filter, 1 / alpha
  std::vector<std::string> joint_names;
  std::vector<std::string> psi_hat_units;  // per joint

  // One entry per sample that was accepted; times as in the recording.
  Eigen::VectorXd t_s;
  Eigen::MatrixXd error;            // e; rows: samples, columns: joints
  Eigen::VectorXd error_norm;       // |e|
  Eigen::VectorXd threshold;        // mu
  Eigen::MatrixXd thresholds;       // of each joint, as error; empty where there is one of all
  Eigen::MatrixXd fast_error;       // error and thresholds behind the fast filter; empty: there
  Eigen::MatrixXd fast_thresholds;  //   is none
  Eigen::MatrixXd psi_hat;          // rows: samples, columns: joints; rad/s^2 or m/s^2

  std::optional<double> detection_time_s;  // first alarm, time of the recording
  bool has_two_levels = false;             // a joint's act_ratio is above 1
  std::optional<double> act_time_s;        // the first one beyond the second level
  std::vector<Alarm> alarms;
  std::vector<JointReplay> joints;  // empty where there is one threshold of all
  std::optional<int> first_joint;   // from 0, of the first alarm where joints are told apart
  // Of the first alarm, and of the first after each time that the monitor began afresh.
  std::vector<IsolatedFault> faults;
  double max_error_to_threshold = 0;
  double max_weight_norm = 0;
  std::map<std::string, Refusals> refused;  // by the status' name
  std::int64_t longest_refused = 0;         // samples in a row
  std::vector<BlindStretch> blind;

  [[nodiscard]] std::int64_t samples() const;  // accepted and refused
  [[nodiscard]] std::int64_t judged() const { return t_s.size(); }
  // Whether so many samples were refused that no alarm says nothing: more than two in a row, which
  // is as long as a controller bears it, or more than one in a hundred.
  [[nodiscard]] bool is_blind() const;
  [[nodiscard]] double blind_s() const;  // of all stretches together
  // Whether the recording is over before a residual has built up: no alarm then says nothing.
  [[nodiscard]] bool is_too_short() const;
};

// What share of the recording has been played, 0 to 1, for the one who waits.
using OnShare = std::function<void(double share)>;

// Replays `log` through the monitor of `robot`, with the recording's sampling period as the tick.
// The recording's torque is taken as the torque that was really applied. As on the controller, the
// monitor goes on behind one or two samples that it refuses, what it knew kept; behind more of them
// it begins afresh, as at the start of the recording but for its threshold, which stays. Throws
// InputError when the recording has another number of joints, the robot file has no uncertainty
// bound, when a setting does not go with the sampling period, or when no sample is accepted.
[[nodiscard]] Replay replay(const RobotDescription& robot, const Log& log,
                            const OnShare& on_share = {});

[[nodiscard]] nlohmann::json to_json(const Replay& replay);
[[nodiscard]] report::Page page_of(const Replay& replay, const std::string& command_line);

// What the replay says, in one sentence or two.
[[nodiscard]] std::string words_of(const Replay& replay);

// How the largest ratio is called: of |e| and mu, or of residual and threshold, joint by joint.
[[nodiscard]] std::string ratio_name(const Replay& replay);
// Whose alarm it is, "joint 2 (elbow), joint 1 (shoulder)"; empty where there is one threshold of
// all.
[[nodiscard]] std::string joints_of(const Replay& replay, const Alarm& alarm);

}  // namespace offnominal::desk
