#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <offnominal/hal/protocols/protected/protected_drives.hpp>
#include <span>
#include <vector>

#include "common/precision.hpp"
#include "robot/robot.hpp"

// One tick of the joint controller, the code that a controller runs, as an object that can be put
// into any state that a tick may begin with, and run from there again and again.

namespace offnominal::desk::wcet {

/// Where a tick begins, and what it receives. One number per joint in q, dq and tau.
struct TickInput {
  // The sample at both ends of the tick, before frames round it.
  std::vector<double> q;    // rad or m
  std::vector<double> dq;   // rad/s or m/s
  std::vector<double> tau;  // N m or N
  // mu at the tick's beginning, rad/s or m/s, > 0; of every joint, N m s or N s, in TorqueSpace.
  double threshold = 0.1;
  double error_to_threshold = 0.5;  // |e| / mu there
  double input_weights = 0.05;      // root mean square of W1
  double output_weights = 0.05;     // of W2
  // Other than 0: every row of W1 lies along z, so that W1 z is this for every hidden unit, as far
  // as the ball of radius M allows.
  double pre_activation = 0;
  bool on_ball = false;     // W1 and W2 are scaled to |theta| = M
  std::uint32_t ticks = 1;  // since the monitor's reset
  int foreign_frames = 0;   // beside the joints' own: old ones again, whose CRC has to be checked
};

/// What the tick's beginning really was, as the controller saw it, and what the tick did.
struct TickFacts {
  bool watched = false;  // the monitor took the sample, nothing was refused
  bool learned = false;  // some weight moved
  bool began_on_ball = false;
  bool gradient_outwards = false;  // at the beginning: projection had to act
  double error_to_threshold = 0;   // |e| / mu at the beginning
  double weight_norm = 0;          // |theta| afterwards
  double weight_radius = 0;        // M
  double smallest_sigmoid = 0;     // magnitude, of the hidden units in use
  double share_subnormal = 0;      // of the output weights in use
  std::vector<double> q, dq, tau;  // as they came out of the frames
  std::size_t frames = 0;          // received
};

/// The parts of a tick, in order.
enum class Phase : std::uint8_t { kReceive, kDiagnose, kControl, kSend };
inline constexpr std::size_t kPhases = 4;
inline constexpr std::array<const char*, kPhases> kPhaseNames{
    "receive, check, decode", "model, estimate, detect, accommodate", "computed torque",
    "encode, send"};

/// Parts of kDiagnose that are measured on their own, from the same beginning.
enum class Part : std::uint8_t { kModel, kEstimator };
inline constexpr std::size_t kParts = 2;
inline constexpr std::array<const char*, kParts> kPartNames{"of it: forward dynamics",
                                                            "of it: estimator and learning"};

class Tick {
 public:
  Tick() = default;
  Tick(const Tick&) = delete;
  Tick& operator=(const Tick&) = delete;
  virtual ~Tick() = default;

  /// Makes the state. Throws std::runtime_error where the core refuses it.
  virtual void prepare(const TickInput& input) = 0;
  /// Back to the prepared state.
  virtual void restore() = 0;
  /// The tick. Neither allocates nor reads a clock.
  virtual void run() = 0;
  /// The tick, with the time of each phase in ns; the clock's own cost is in it.
  virtual void run_phases(std::array<std::int64_t, kPhases>& duration_ns) = 0;
  /// One part alone, from the prepared state.
  virtual void run_part(Part part) = 0;
  /// Restores, runs, and looks.
  [[nodiscard]] virtual TickFacts facts() = 0;
  /// What a tick reads and writes, apart from its code and its stack.
  [[nodiscard]] virtual std::span<const std::byte> memory() const = 0;
  /// Hidden units that are computed, at least those in use.
  [[nodiscard]] virtual int hidden_capacity() const = 0;
};

/// Throws InputError where this build has no controller of the robot's size, the robot has no
/// uncertainty bound, or the core refuses it.
[[nodiscard]] std::unique_ptr<Tick> make_tick(const RobotDescription& robot, Precision precision,
                                              hal::FrameFormat format);

/// Largest magnitude that a frame carries of a position (rad or m) and of a velocity (rad/s, m/s).
inline constexpr double kMaxFramePosition = 31.9;
inline constexpr double kMaxFrameVelocity = 31.9;

}  // namespace offnominal::desk::wcet
