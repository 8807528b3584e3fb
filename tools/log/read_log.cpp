#include "log/read_log.hpp"

#include <fmt/format.h>

#include <cmath>
#include <new>
#include <set>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/nearest.hpp"
#include "log/hold_map.hpp"
#include "log/log_format.hpp"
#include "log/recording_file.hpp"
#include "log/sampling.hpp"
#include "robot/channels.hpp"

namespace offnominal::tools {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr const char* kMendNames =
    "map the names with [channels] in the robot's file, or with --channels FILE.toml";

// The joint's number when `name` is `prefix` and a number from 1, else 0.
int joint_of(const std::string& name, const std::string& prefix) {
  if (!name.starts_with(prefix) || name.size() == prefix.size() ||
      name.size() > prefix.size() + 3) {
    return 0;
  }
  int joint = 0;
  for (const char digit : name.substr(prefix.size())) {
    if (digit < '0' || digit > '9') return 0;
    joint = 10 * joint + (digit - '0');
  }
  return joint;
}

bool is_common_name(const std::string& name) {
  return name == "t" || joint_of(name, "q") > 0 || joint_of(name, "dq") > 0 ||
         joint_of(name, "tau") > 0;
}

Channel named(std::string source) {
  Channel channel;
  channel.source = std::move(source);
  return channel;
}

class Assembler {
 public:
  Assembler(NamedColumns columns, int joint_count)
      : columns_(std::move(columns)), joints_(joint_count) {
    log_.file = columns_.file;
    log_.remarks = columns_.remarks;
  }

  Log with_common_header() {
    for (const char* prefix : {"q", "tau"}) check_joint_count(prefix);
    ChannelMap map;
    map.time = named("t");
    for (int joint = 1; joint <= joints_; ++joint) {
      const std::string number = std::to_string(joint);
      const std::string velocity = "dq" + number;
      map.position.push_back(named("q" + number));
      map.torque.push_back(named("tau" + number));
      map.velocity.emplace_back();
      if (columns_.columns.contains(velocity)) map.velocity.back() = named(velocity);
    }
    const auto time = columns_.columns.find("t");
    const Index samples = time == columns_.columns.end() ? 0 : time->second.size();
    for (const auto& [name, values] : columns_.columns) {
      if (is_common_name(name) || values.size() != samples) continue;
      if (values.allFinite()) {
        map.extra[name] = named(name);
      } else {
        log_.remarks.push_back("column " + name + " has values that are not finite: left out");
      }
    }
    log_.common_header = true;
    return with(map);
  }

  Log with(const ChannelMap& map) {
    if (map.position.size() != static_cast<std::size_t>(joints_)) {
      fail("channels", fmt::format("positions of {} joints", map.position.size()),
           fmt::format("{}, as many as the robot has", joints_));
    }
    log_.channels = map;
    if (map.at_rest) {
      log_.t_s = values_of(map.position[0], "position of joint 1");
      check_readings();
    } else {
      log_.t_s = values_of(map.time, kTime);
      check_time();
    }
    const Index samples = log_.t_s.size();
    log_.q.resize(samples, joints_);
    log_.dq = Eigen::MatrixXd::Zero(samples, joints_);
    log_.tau.resize(samples, joints_);
    for (Index i = 0; i < joints_; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      log_.q.col(i) = sampled(map.position[joint], fmt::format("position of joint {}", i + 1));
      log_.tau.col(i) = sampled(map.torque[joint], fmt::format("torque of joint {}", i + 1));
      const bool measured = joint < map.velocity.size() && map.velocity[joint].has_value();
      log_.dq_derived.push_back(!measured);
      if (!measured) continue;
      log_.dq.col(i) = sampled(*map.velocity[joint], fmt::format("velocity of joint {}", i + 1));
    }
    if (map.at_rest) {
      make_hold_map(log_);
      remark_constants();
      return std::move(log_);
    }
    for (const auto& [name, channel] : map.extra) log_.extra[name] = sampled(channel, name);
    make_even(log_);
    derive_velocities(log_);
    check_derived();
    remark_constants();
    return std::move(log_);
  }

 private:
  // Finite values can still be too large, or too close in time, to be resampled and differentiated.
  void check_derived() const {
    if (log_.t_s.allFinite() && log_.q.allFinite() && log_.dq.allFinite() && log_.tau.allFinite()) {
      return;
    }
    fail("", "positions or steps of time of which no velocity can be computed",
         "values in SI units", "look for a column in another unit, or one that is no position");
  }

  [[noreturn]] void fail(const std::string& place, const std::string& found,
                         const std::string& allowed, const std::string& mend = {}) const {
    throw InputError({columns_.file, place, found, allowed, mend});
  }

  std::string names_found() const {
    constexpr std::size_t kMost = 40;
    std::vector<std::string> names = columns_.names;
    if (names.size() > kMost) {
      names.resize(kMost);
      names.push_back("...");
    }
    return list_of(names);
  }

  // "tau1 to tau7", "tau2 only", or each where some are missing.
  static std::string words_of_joints(const std::string& prefix, const std::set<int>& joints) {
    if (joints.size() == 1) return fmt::format("{}{} only", prefix, *joints.begin());
    if (*joints.rbegin() == static_cast<int>(joints.size())) {
      return fmt::format("{0}1 to {0}{1}", prefix, joints.size());
    }
    return list_of(joints, [&](int joint) { return fmt::format("{}{}", prefix, joint); });
  }

  void check_joint_count(const std::string& prefix) const {
    std::set<int> joints;
    for (const std::string& name : columns_.names) {
      if (const int joint = joint_of(name, prefix); joint > 0) joints.insert(joint);
    }
    if (joints.empty()) {
      fail("columns", names_found(), fmt::format("t, q1..q{0}, dq1..dq{0}, tau1..tau{0}", joints_),
           kMendNames);
    }
    if (static_cast<int>(joints.size()) != joints_ || *joints.rbegin() != joints_) {
      fail("columns", words_of_joints(prefix, joints),
           fmt::format("one {} for each of the robot's {} joint{}", prefix, joints_,
                       joints_ == 1 ? "" : "s"),
           "add what is missing, or take the robot file of the robot that was recorded");
    }
  }

  // No measurement is larger; squares and sums of it stay within what numbers can hold.
  static constexpr double kLargest = 1e15;
  static constexpr const char* kTime = "time";

  // Values in SI units; a scalar variable serves where every sample has the same value.
  VectorXd values_of(const Channel& channel, const std::string& what) const {
    const auto column = columns_.columns.find(channel.source);
    if (column == columns_.columns.end()) {
      if (columns_.scalars.contains(channel.source)) {
        fail("variable " + channel.source, "a single number",
             "one value per sample, for the " + what);
      }
      fail("columns", names_found(), "a column \"" + channel.source + "\" for the " + what,
           kMendNames);
    }
    double scale = channel.scale;
    if (!channel.scale_source.empty()) scale *= scalar(channel.scale_source, what);
    VectorXd values = (scale * column->second).array() + channel.offset;
    for (Index row = 0; row < values.size(); ++row) {
      if (std::abs(values[row]) <= kLargest) continue;
      refuse_value(values[row], columns_.place_of(row) + ", " + channel.source, what);
    }
    return values;
  }

  [[noreturn]] void refuse_value(double value, const std::string& place,
                                 const std::string& what) const {
    const std::string allowed = fmt::format("a finite number up to {:g}", kLargest);
    if (!std::isfinite(value)) {
      fail(place, std::isnan(value) ? "NaN" : "an infinite number", allowed,
           "cut the recording, or fill the gap where it is made");
    }
    fail(place, fmt::format("{:g}", value), allowed,
         what == kTime ? "say its unit, scale = 1e-9 under [channels.time] for nanoseconds, 1e-6 "
                         "for microseconds"
                       : "say its unit with scale under [channels], or mend the number where it "
                         "is made");
  }

  double scalar(const std::string& name, const std::string& what) const {
    if (const auto found = columns_.scalars.find(name); found != columns_.scalars.end()) {
      if (std::isfinite(found->second) && found->second != 0) return found->second;
      fail("variable " + name, fmt::format("{}", found->second), "a finite number other than 0");
    }
    const auto column = columns_.columns.find(name);
    if (column == columns_.columns.end()) {
      fail("columns", names_found(), "a number \"" + name + "\" that scales the " + what);
    }
    const VectorXd& values = column->second;
    if (values.size() == 0 || (values.array() != values[0]).any() || !std::isfinite(values[0])) {
      fail("variable " + name, "values that change", "one finite number that scales the " + what);
    }
    return values[0];
  }

  VectorXd sampled(const Channel& channel, const std::string& what) const {
    VectorXd values = values_of(channel, what);
    if (values.size() != log_.t_s.size()) {
      fail("variable " + channel.source, fmt::format("{} values", values.size()),
           fmt::format("{}, as many as the other channels have", log_.t_s.size()));
    }
    return values;
  }

  void check_time() const {
    const VectorXd& t = log_.t_s;
    // First, because nothing is read beyond it.
    for (Index row = 1; row < t.size(); ++row) {
      if (t[row] > t[row - 1]) continue;
      fail(columns_.place_of(row) + ", time",
           fmt::format("{:.9g} s after {:.9g} s", t[row], t[row - 1]),
           "time that ascends from sample to sample");
    }
    if (t.size() < kMinSamples) {
      fail("", fmt::format("{} samples", t.size()), fmt::format("{} samples or more", kMinSamples));
    }
  }

  void check_readings() const {
    if (log_.t_s.size() >= kMinReadings) return;
    fail("", fmt::format("{} readings", log_.t_s.size()),
         fmt::format("{} readings or more", kMinReadings), "hold the joint at more positions");
  }

  void remark_constants() {
    const auto remark = [&](const Eigen::MatrixXd& columns, const char* what, bool derived) {
      for (Index i = 0; i < columns.cols(); ++i) {
        if (derived && log_.dq_derived[static_cast<std::size_t>(i)]) continue;
        if (columns.col(i).maxCoeff() > columns.col(i).minCoeff()) continue;
        log_.remarks.push_back(fmt::format("{} of joint {} never changes: it is {:.6g} throughout",
                                           what, i + 1, columns(0, i)));
      }
    };
    remark(log_.q, "the position", false);
    remark(log_.dq, "the velocity", true);
    remark(log_.tau, "the torque", false);
  }

  NamedColumns columns_;
  Index joints_;
  Log log_;
};

NeedOf needs_of(const std::optional<ChannelMap>& channels) {
  if (!channels) {
    return [](const std::string& name) {
      if (name == "t") return Need::kAscending;
      return is_common_name(name) ? Need::kRequired : Need::kWelcome;
    };
  }
  std::set<std::string> wanted;
  const auto want = [&wanted](const Channel& channel) {
    wanted.insert(channel.source);
    if (!channel.scale_source.empty()) wanted.insert(channel.scale_source);
  };
  if (!channels->at_rest) want(channels->time);
  for (const Channel& channel : channels->position) want(channel);
  for (const auto& channel : channels->velocity) {
    if (channel) want(*channel);
  }
  for (const Channel& channel : channels->torque) want(channel);
  for (const auto& [name, channel] : channels->extra) want(channel);
  // Scaled by a negative number time ascends where its column descends.
  const bool ascends =
      !channels->at_rest && channels->time.scale > 0 && channels->time.scale_source.empty();
  const std::string time = ascends ? channels->time.source : std::string();
  return [wanted = std::move(wanted), time](const std::string& name) {
    if (!wanted.contains(name)) return Need::kNone;
    return name == time ? Need::kAscending : Need::kRequired;
  };
}

}  // namespace

Log read_log(const std::filesystem::path& path, int joint_count,
             const std::optional<ChannelMap>& channels) {
  try {
    const NeedOf need_of = needs_of(channels);
    RecordingFile file(path);
    const ChannelMap* map = channels ? &*channels : nullptr;
    Assembler assembler(log_format_of(file).read(file, map, need_of), joint_count);
    return channels ? assembler.with(*channels) : assembler.with_common_header();
  } catch (const std::bad_alloc&) {
    throw InputError({shown_name(path), "", "more than this machine has memory for",
                      "a recording that fits into it",
                      "cut it into parts, or leave samples or columns out"});
  }
}

Log read_log_or_hold_map(const std::filesystem::path& path, const RobotDescription& robot,
                         const std::optional<std::filesystem::path>& channels_file) {
  if (!channels_file) return read_log(path, robot.joint_count(), robot.channels);
  return read_log(path, robot.joint_count(),
                  read_channels_file(*channels_file, robot.joint_count()));
}

Log read_log(const std::filesystem::path& path, const RobotDescription& robot,
             const std::optional<std::filesystem::path>& channels_file) {
  Log log = read_log_or_hold_map(path, robot, channels_file);
  if (log.at_rest) {
    throw InputError(
        {log.file, "", "a hold map, as the channels' at_rest = true says", "a recording in time",
         "hold maps are for explain and for add --all-found; give another --channels"});
  }
  return log;
}

}  // namespace offnominal::tools
