#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/motion.hpp"
#include "explain/data_fault.hpp"
#include "explain/expected_torque.hpp"
#include "log/log.hpp"
#include "robot/payload.hpp"
#include "robot/robot.hpp"

// The doctor's checks one by one; doctor.hpp puts them in order.

namespace offnominal::desk {

// Measured and model torque of a recording, low-passed alike and thinned out. Rows: samples,
// columns: joints.
struct TorquePair {
  double period_s = 0;
  double cutoff_hz = 0;
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q;
  Eigen::MatrixXd dq;
  Eigen::MatrixXd ddq;
  Eigen::MatrixXd measured;
  Eigen::MatrixXd model;               // of the robot with its effects
  Eigen::MatrixXd load;                // of the robot without effects
  std::vector<Eigen::MatrixXd> links;  // share of each link in `load`
};

// Motion and measured torque of a recording in a band of twice that cut-off, thinned out: all that
// a pair needs of it. A recording is long, and whoever asks for pairs in other units asks for many.
struct SlowSignals {
  double period_s = 0;
  double cutoff_hz = 0;
  Eigen::Index edge = 0;  // rows at either end that the filter spoils
  Motion motion;
  Eigen::MatrixXd torque;
  std::optional<Payload> payload;
};
// Low-passed at that share of the sampling rate, or for 0 at 5 Hz or what a slow log has. None
// where the recording is too short for a low-pass.
std::optional<SlowSignals> slow_signals(const Log& log, double cutoff_of_rate = 0);

// None where the model torque is not finite. The links take as much time as all the rest, each.
enum class WithLinks { kNo, kYes };
std::optional<TorquePair> torque_pair(const SlowSignals& slow, const RobotDescription& robot,
                                      WithLinks links);
// Of both; none where either has none.
std::optional<TorquePair> torque_pair(const Log& log, const RobotDescription& robot);

// Of a long one some two hundred rows of what was measured and of the model, without links and
// load: for fits that would take much of each.
TorquePair thinned(const TorquePair& pair);

// What viscous and dry friction of a joint look like over time, two columns: rad/s or m/s, and 1.
Eigen::MatrixXd friction_columns(const Eigen::VectorXd& dq);

// Each column of `torques` less what the others take of it by least squares.
Eigen::MatrixXd beside(const Eigen::MatrixXd& others, const Eigen::MatrixXd& torques);

// What no dry or viscous friction of the joint has a part in: the file's is often a guess.
Eigen::VectorXd beside_friction(const Eigen::VectorXd& torque, const Eigen::VectorXd& dq);

// Torques of a joint, one per column, in which its friction, rotor and offset have no part: a file
// may lack them, or guess.
Eigen::MatrixXd beside_drive(const TorquePair& pair, Eigen::Index joint,
                             const Eigen::MatrixXd& torques);

// Whether the torques follow the model at a scale that no link, tool or counterweight makes, on
// every joint that tells.
bool is_of_another_torque_unit(const TorquePair& pair);

// Whether the model fits the torque better with the time in s or in a unit of which a second has
// `per_second`; angles may be in degrees and torques of the wrong sign either way.
enum class TimeByTorque { kSeconds, kUnit, kUnknown };
TimeByTorque time_by_torque(const Log& log, const RobotDescription& robot, double per_second);

void find_gaps(const Log& log, std::vector<DataFault>& faults);
void find_stale_samples(const Log& log, std::vector<DataFault>& faults);
// `expected`, `model`: what the model says of the same recording, evenly sampled.
void find_stuck_values(const Log& log, const ExpectedTorque& expected,
                       std::vector<DataFault>& faults);
// One value in every row of a joint that moves as no constant torque has it move: kStuck
// throughout. A joint that rests, or that its drive lets swing or run out freely, has none.
void find_unrecorded_torques(const Log& log, const Log& even, const RobotDescription& robot,
                             std::vector<DataFault>& faults);
// Needs the spans of what was found before, as the next one does.
void find_torque_excursions(const Log& log, const Log& even, const RobotDescription& robot,
                            std::vector<DataFault>& faults);
void find_jumps(const Log& log, std::vector<DataFault>& faults);
// Torques that come up from nothing, where the model asks for them from the start.
void find_unsettled_torques(const Log& log, const ExpectedTorque& model,
                            std::vector<DataFault>& faults);
void find_stuck_encoders(const Log& log, const RobotDescription& robot,
                         std::vector<DataFault>& faults);
// Torques at a limit time and again, and those that a drive at its limit holds, within its noise,
// all the time that the joint moves.
void find_saturation(const Log& log, const RobotDescription& robot, const ExpectedTorque& model,
                     std::vector<DataFault>& faults);
// Torques, or all columns, that stand at another joint than they are of. Returns whether they do.
bool find_joint_order(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                      std::vector<DataFault>& faults);
// Gravity that points another way than the robot file says: the arm is mounted otherwise. All that
// else is held against the model's torque would follow from it. Returns whether it does.
bool find_gravity(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                  std::vector<DataFault>& faults);
// Single joints whose torque has none of the gravity that the model has, as if a spring or a part
// of the controller that is not recorded carried it.
void find_joint_gravity(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                        std::vector<DataFault>& faults);
// Positions that are counted from another zero than the file's, or the other way round, of one
// joint or several. Returns whether they are.
bool find_joint_zero(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                     std::vector<DataFault>& faults);
// Torques in another unit, before a gear, or currents: many times what the model says, or a small
// part of it. On every joint that tells, and nothing else is then held against them; or of some
// joints while the others follow the model, where no mass asks for so much.
enum class OfAnotherUnit { kNone, kSomeJoints, kAllJoints };
OfAnotherUnit find_torque_unit(const Log& log, const RobotDescription& robot,
                               const TorquePair& pair, std::vector<DataFault>& faults);
void find_torque_sign(const Log& log, const RobotDescription& robot, const TorquePair& pair,
                      std::vector<DataFault>& faults);
void find_clock_skew(const Log& log, const TorquePair& pair, std::vector<DataFault>& faults);

// The rows as they were recorded as a log of their own, each a sample, uneven in time; its gaps are
// the rows on either side. Needs log.recorded.
Log rows_as_recorded(const Log& log);
// Faults of that log as faults of `log`.
void to_samples(const Log& log, std::vector<DataFault>& faults);
// Changes `log.recorded`, where there is any, which others may share.
template <typename Change>
void change_recorded(Log& log, Change&& change) {
  if (!log.recorded) return;
  auto rows = std::make_shared<RecordedRows>(*log.recorded);
  std::forward<Change>(change)(*rows);
  log.recorded = std::move(rows);
}

// These mend what they name in `log`, so that what is looked at after them is seen.
void mend_wrapped(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults);
void mend_time(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults);
void mend_degrees(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults);
// Velocities of another joint, of another time, or none at all.
void mend_strange_velocities(Log& log, const RobotDescription& robot,
                             std::vector<DataFault>& faults);
void mend_velocities(Log& log, const RobotDescription& robot, std::vector<DataFault>& faults);

// Drives filter the velocity and print it coarsely: real ones differ from the derivative of the
// position by a factor of up to 1.09. Another unit, or another shaft, is further off than the
// second.
inline constexpr double kNearUnit = 1.12;
inline constexpr double kSameUnit = 1.5;

// The measured velocity over the derivative of the position, negative where they oppose each other;
// none where the velocity was derived, where the joint stands, or where they have nothing in
// common.
std::optional<double> velocity_ratio(const Log& log, Eigen::Index joint);
// Of every joint.
std::vector<std::optional<double>> velocity_ratios(const Log& log);
// The same of a part of one joint, sampled evenly.
std::optional<double> velocity_ratio(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                     double period_s);

// Adds the lines of [channels] that `mended` has to the fault and to its advice; those of `keys`,
// or all that must be there where the recording was read by its common header.
void propose_channels(const Log& log, const ChannelMap& mended, std::vector<std::string> keys,
                      DataFault& fault);

// The smallest change from one sample to the next, an encoder's step; infinity where there is none.
// Rounding of a log that was scaled or printed does not pass for one.
double smallest_step(const Eigen::VectorXd& x);

// How to record one whose start has not settled.
std::string mend_of_start();

// "joint 2", or "all joints" for -1.
std::string joint_words(Eigen::Index joint);

// Lag of the torque behind the positions on some rows of one joint.
struct LagEstimate {
  double lag_s = 0;         // torque late where positive
  double likelihood = 0;    // log-likelihood gained over the best lag within honest_s
  double independence = 0;  // share of the torque's rate that nothing else beside it can be
  bool at_end = false;      // best at the end of the range that was looked at
};
// Everything that the model may lack and that does not depend on time is fitted beside it. The
// model is right within a few percent.
LagEstimate estimate_lag(const TorquePair& pair, Eigen::Index joint, Eigen::Index first,
                         Eigen::Index count, double honest_s);

}  // namespace offnominal::desk
