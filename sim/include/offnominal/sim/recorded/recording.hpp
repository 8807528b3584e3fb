// Recordings of arms with any number of joints as real loggers write them, and what goes wrong with
// them: motions, habits of loggers that are no faults, defects that are. Nothing here knows of
// dynamics; torques come from outside.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "offnominal/sim/hidden/draws.hpp"

namespace offnominal::sim::recorded {

/// kSines: a sum of sines per joint, from the first sample on. kMoves: from pose to pose with
/// rests. kSweeps: sines whose frequency rises, then short moves to and fro.
enum class MotionFamily { kSines, kMoves, kSweeps };

/// Columns: joints. rad, rad/s, rad/s^2.
struct Motion {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q, dq, ddq;
};
struct MotionRequest {
  MotionFamily family = MotionFamily::kSines;
  double rate_hz = 500;
  double duration_s = 15;
  Eigen::VectorXd middle;    ///< rad, per joint
  Eigen::VectorXd reach;     ///< rad either way, per joint
  std::vector<char> locked;  ///< per joint, whether it stays where it is
};
Motion draw_motion(const MotionRequest& request, hidden::Draws& draws);

/// rad, N m. `dq` is empty where no velocity is logged.
struct Recording {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd q, dq, tau;
};

/// What loggers do that is no fault.
struct Habits {
  double torque_noise = 0;       ///< standard deviation, share of each joint's largest torque
  double torque_step = 0;        ///< share of each joint's largest torque; 0: none
  int encoder_bits = 19;         ///< per turn; 0: none
  bool float_positions = false;  ///< 32 bit, not rounded to an encoder's step
  bool five_digits = false;      ///< everything but the time is printed with five digits
  int late_stamps = 0;           ///< of the whole recording, by 0.2 to 0.9 of a period
  bool with_velocity = false;    ///< from the same encoder, with noise
};
Habits draw_habits(hidden::Draws& draws);
/// The recording of a motion with these torques.
Recording record(const Motion& motion, const Eigen::MatrixXd& tau, const Habits& habits,
                 hidden::Draws& draws);

enum class Defect {
  kNone,
  kGap,
  kStuckPosition,
  kStuckTorque,
  kSaturation,
  kPositionStep,
  kPositionSpike,
  kTorqueSpike,
  kStart,
  kTorqueSign,
  kDegrees,
  kMilliseconds,
};
inline constexpr int kDefects = 12;
std::string_view name_of(Defect defect);

struct TrueDefect {
  Defect kind = Defect::kNone;
  int joint = -1;               ///< from 0; -1: all
  double from_s = 0, to_s = 0;  ///< of the first stretch, in the time of the clean recording
};

/// Puts a defect into a recording: of one of the joints that move, at a place that is drawn.
TrueDefect add_defect(Defect defect, const std::vector<char>& locked, Recording& recording,
                      hidden::Draws& draws);

}  // namespace offnominal::sim::recorded
