#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <offnominal/joint_count.hpp>
#include <offnominal/sample.hpp>
#include <offnominal/status.hpp>
#include <offnominal/vector.hpp>
#include <optional>

#include "common/nearer_filter.hpp"
#include "replay/replay.hpp"
#include "robot/robot.hpp"

// The on-board monitor and its isolation, sample by sample, for any number of joints and either
// space behind one face: what replay() plays a recording through, and what listens live.

namespace offnominal::desk {

// Samples refused or missing in a row that the monitor goes on behind, as many as a controller
// bears.
inline constexpr std::int64_t kBorneInARow = 2;

// What the monitor says of the last sample that it accepted; one number per joint in every vector.
struct Watched {
  Vector<kRuntimeJoints, double> error;       // e, rad/s or m/s; in torque space N m or N
  double error_norm = 0;                      // |e|; in torque space of the joint nearest to its
  double threshold = 0;                       //   threshold, as this
  Vector<kRuntimeJoints, double> thresholds;  // of each joint; empty where there is one of all
  // The same behind the fast filter; empty where there is none.
  Vector<kRuntimeJoints, double> fast_error;
  Vector<kRuntimeJoints, double> fast_thresholds;
  Vector<kRuntimeJoints, double> psi_hat;       // rad/s^2 or m/s^2; in torque space N m or N
  Vector<kRuntimeJoints, double> compensation;  // by what is known best, N m or N
  double weight_norm = 0;
  bool level = false;                                               // beyond the threshold now
  std::array<bool, static_cast<std::size_t>(kMaxJoints)> levels{};  // of each, in torque space
  bool latched = false;  // was beyond, ever, or since the detection was taken back
  bool acts = false;     // the same of the second level; of one level as latched
  std::array<bool, static_cast<std::size_t>(kMaxJoints)> joint_acts{};  // of each, in torque space
  int first_joint = -1;  // from 0, that was first; -1: none, or one threshold of all

  /// Of a joint that is judged by itself, of the nearer of its filters.
  [[nodiscard]] ResidualAgainst nearest(Eigen::Index joint) const {
    return nearer_filter(error, thresholds, fast_error, fast_thresholds, joint);
  }
};

class Watch {
 public:
  struct Sample {
    JointSample<kRuntimeJoints, double> joints;
    // Positions as the encoders say them now, where the sample's are late (observed_motion.hpp);
    // else empty.
    Vector<kRuntimeJoints, double> readings;
  };
  // Told each answer of isolation when no more is to come of it: the monitor begins afresh, takes
  // its detection back, or ends.
  using OnFault = std::function<void(const IsolatedFault& fault)>;

  virtual ~Watch() = default;

  // The next sample, at t_s; `missing`: ticks before it that had none. One or two samples that were
  // refused or are missing are borne; behind more of them it begins afresh, as at the start but for
  // its threshold, which stays. Otherwise than kOk: the sample is refused. Throws InputError for a
  // setting that no sample can mend.
  virtual Status take(const Sample& sample, double t_s, std::uint32_t missing) = 0;
  [[nodiscard]] virtual const Watched& said() const = 0;
  // Since the last detection, the best that there is; none without a detection, in its first
  // moments, and where joints are not told apart.
  [[nodiscard]] virtual std::optional<IsolatedFault> answer() const = 0;
  // No sample follows.
  virtual void finish() = 0;
};

// Whether a detection stays until the monitor begins afresh, as on a controller, or is taken back
// when the fault is over or another one begins, so that each is named.
enum class Detections { kFirst, kEach };

// Of a robot with a bound, for samples every period_s. Throws InputError where a setting does not
// go with it.
[[nodiscard]] std::unique_ptr<Watch> make_watch(const RobotDescription& robot, double period_s,
                                                const Watch::OnFault& on_fault,
                                                Detections detections = Detections::kFirst);

}  // namespace offnominal::desk
