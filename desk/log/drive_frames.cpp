#include "log/drive_frames.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <offnominal/hal/bus/frame.hpp>
#include <offnominal/hal/source.hpp>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "drives/bus_readings.hpp"
#include "drives/drive_table.hpp"
#include "log/candump_log.hpp"

namespace offnominal::desk {
namespace {

using hal::Microseconds;
using hal::SourceState;

Microseconds to_us(double time_s) { return static_cast<Microseconds>(std::llround(1e6 * time_s)); }

class DriveFrames {
 public:
  DriveFrames(std::string file, const RobotBus& bus)
      : file_(std::move(file)),
        bus_(bus),
        filters_(from_drives(bus.drives)),
        readings_(bus.drives, bus.joints,
                  {.period_us = to_us(bus.period_s), .format = hal::FrameFormat::kClassic}),
        values_(3 * bus.joints) {}

  void take(const CandumpFrame& frame, std::size_t line) {
    if (is_of_drives(frame.frame)) check(frame, line);
    if (!first_s_) first_s_ = frame.time_s;
    // Time stamps of the epoch would cost digits.
    const hal::ReceivedFrame received{frame.frame, to_us(frame.time_s - *first_s_)};
    if (const auto* const readings = readings_.take(received)) add(*readings);
    line_ = line;
  }

  NamedColumns columns() {
    if (const auto* const readings = readings_.last()) add(*readings);
    if (t_s_.empty()) refuse_nothing();
    NamedColumns columns;
    columns.file = file_;
    const auto put = [&](const std::string& name, const std::vector<double>& values) {
      columns.names.push_back(name);
      columns.columns[name] = Eigen::Map<const Eigen::VectorXd>(
          values.data(), static_cast<Eigen::Index>(values.size()));
    };
    put("t", t_s_);
    constexpr std::array kQuantities{"q", "dq", "tau"};
    for (std::size_t quantity = 0; quantity < kQuantities.size(); ++quantity) {
      for (std::size_t joint = 0; joint < bus_.joints; ++joint) {
        const std::vector<double>& values = values_[quantity * bus_.joints + joint];
        // A velocity that is not always told is derived.
        if (values.size() == t_s_.size())
          put(fmt::format("{}{}", kQuantities[quantity], joint + 1), values);
      }
    }
    columns.place_of = [lines = lines_](Eigen::Index row) {
      return fmt::format("line {}", lines[static_cast<std::size_t>(row)]);
    };
    return columns;
  }

 private:
  [[nodiscard]] bool is_of_drives(const hal::Frame& frame) const {
    return std::any_of(filters_.begin(), filters_.end(),
                       [&](const hal::IdFilter& filter) { return passes(filter, frame); });
  }

  // Of two buses one would be taken for the other, and of two runs the second would be left out.
  void check(const CandumpFrame& frame, std::size_t line) {
    constexpr double kMostBackS = 0.01;
    if (interface_.empty()) {
      interface_ = frame.interface;
      newest_s_ = frame.time_s;
    }
    if (frame.interface != interface_) {
      throw InputError({file_, fmt::format("line {}", line),
                        "the drives on " + frame.interface + " and, before, on " + interface_,
                        "the drives of one robot on one interface",
                        "keep the lines of one, as grep ' " + interface_ + " ' does"});
    }
    if (frame.time_s < newest_s_ - kMostBackS) {
      throw InputError({file_, fmt::format("line {}", line),
                        fmt::format("a time {:.6g} s before that of the drives' frame before it",
                                    newest_s_ - frame.time_s),
                        "times that ascend", "cut the recording there, into one for each run"});
    }
    newest_s_ = std::max(newest_s_, frame.time_s);
  }

  void add(const BusReadings::Feedback& readings) {
    Microseconds time_us = 0;
    for (const hal::JointFeedback& joint : readings) {
      seen_ = true;
      if (joint.drive != SourceState::kValid) {
        // What was read before any drive gave torque, and is not followed by the rest without a
        // gap.
        if (!driven_) forget();
        return;
      }
      driven_ = driven_ || joint.status.mode == hal::DriveMode::kTorque;
      time_us = std::max(time_us, joint.encoder_time_us);
    }
    const double time_s = 1e-6 * static_cast<double>(time_us);
    if (!t_s_.empty() && time_s <= t_s_.back()) return;
    t_s_.push_back(time_s);
    lines_.push_back(line_);
    for (std::size_t joint = 0; joint < bus_.joints; ++joint) {
      const hal::JointFeedback& one = readings[joint];
      values_[joint].push_back(static_cast<double>(one.reading.position));
      if (one.reading.has_velocity) {
        values_[bus_.joints + joint].push_back(static_cast<double>(one.reading.velocity));
      }
      values_[2 * bus_.joints + joint].push_back(static_cast<double>(one.status.applied_torque));
    }
    const std::size_t most = RecordingFile::kMostNumbers / (values_.size() + 2);
    if (t_s_.size() <= most) return;
    throw InputError({file_, fmt::format("line {}", line_), fmt::format("more than {} rows", most),
                      "a recording that ends", "cut it into parts"});
  }

  void forget() {
    t_s_.clear();
    lines_.clear();
    for (std::vector<double>& values : values_) values.clear();
  }

  [[noreturn]] void refuse_nothing() const {
    const std::string protocol = protocol_of(bus_.drives).name;
    std::string found = seen_ ? "readings of every joint, and no drive that says what it does"
                              : "no reading of every joint";
    for (std::size_t joint = 0; !seen_ && joint < bus_.joints; ++joint) {
      if (readings_.feedback(joint, to_us(0)).encoder != SourceState::kNeverSeen) continue;
      found = fmt::format("no reading of joint {}", joint + 1);
      break;
    }
    throw InputError({file_, "", found + " in frames of " + protocol,
                      "frames of every joint's drive, as [drives] of the robot file has them: "
                      "readings, and status at the intervals that stand there",
                      "look at the identifiers and intervals in [drives]; a log of other drives "
                      "needs [channels] with their DBC file"});
  }

  std::string file_;
  const RobotBus& bus_;
  std::vector<hal::IdFilter> filters_;
  BusReadings readings_;
  std::string interface_;
  std::optional<double> first_s_;
  double newest_s_ = 0;
  bool seen_ = false;
  bool driven_ = false;  // some drive has given torque
  std::size_t line_ = 0;
  std::vector<double> t_s_;
  std::vector<std::size_t> lines_;
  std::vector<std::vector<double>> values_;  // q of every joint, then dq, then tau
};

}  // namespace

std::optional<RobotBus> bus_of(const RobotDescription& robot) {
  const DriveSettings settings = robot.drive_settings();
  if (protocol_of(settings).has_dbc) return std::nullopt;
  return RobotBus{settings, robot.joints.size(), robot.estimator.period_s};
}

NamedColumns read_drive_frames(RecordingFile& file, const RobotBus& bus) {
  DriveFrames frames(file.name(), bus);
  each_candump_frame(
      file, [&](const CandumpFrame& frame, std::size_t line) { frames.take(frame, line); });
  return frames.columns();
}

}  // namespace offnominal::desk
