#include "log/read_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <new>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/list_of_joints.hpp"
#include "common/nearest.hpp"
#include "common/time_words.hpp"
#include "log/channel_needs.hpp"
#include "log/column_values.hpp"
#include "log/hold_map.hpp"
#include "log/joined_files.hpp"
#include "log/joint_side.hpp"
#include "log/log_format.hpp"
#include "log/log_of.hpp"
#include "log/recording_file.hpp"
#include "log/sampling.hpp"
#include "log/seen_by_sensor.hpp"
#include "log/time_of.hpp"
#include "log/usable_rows.hpp"
#include "log/zero_based.hpp"
#include "robot/channels.hpp"
#include "robot/joint_units.hpp"
#include "robot/payload.hpp"
#include "robot/transmission.hpp"
#include "robot/units.hpp"
#include "signal/fold.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

Channel named(std::string source) {
  Channel channel;
  channel.source = std::move(source);
  return channel;
}

class Assembler {
 public:
  // `transmission`: of the robot; null: none.
  Assembler(TimedColumns recording, int joint_count, const TransmissionSettings* transmission)
      : transmission_(transmission),
        columns_(std::move(recording.columns)),
        t_s_(std::move(recording.time.t_s)),
        joints_(joint_count) {
    log_.file = columns_.file;
    log_.row_numbers = std::move(recording.time.rows);
    if (recording.time.origin_s != 0) {
      columns_.remarks.push_back(
          fmt::format("t = 0 s is {:.9g} s of the file's own clock", recording.time.origin_s));
    }
  }

  // `period_s`: where no column is the time.
  Log with_common_header(double period_s) {
    count_joints_from_one(columns_, t_s_.size(), static_cast<int>(joints_));
    for (const char* prefix : {"q", "tau"}) check_joint_count(prefix);
    ChannelMap map;
    map.time = named("t");
    map.period_s = period_s;
    for (int joint = 1; joint <= joints_; ++joint) {
      const std::string number = std::to_string(joint);
      const std::string velocity = "dq" + number;
      map.position.push_back(named("q" + number));
      map.torque.push_back(named("tau" + number));
      map.velocity.emplace_back();
      if (columns_.columns.contains(velocity)) map.velocity.back() = named(velocity);
    }
    for (const auto& [name, values] : columns_.columns) {
      if (is_common_name(name) || values.size() != t_s_.size()) continue;
      if (std::find(columns_.names.begin(), columns_.names.end(), name) == columns_.names.end()) {
        continue;
      }
      if (values.allFinite()) {
        map.extra[name] = named(name);
      } else {
        columns_.remarks.push_back("column " + name + " has values that are not finite: left out");
      }
    }
    log_.common_header = true;
    return with(map);
  }

  Log with(ChannelMap map) {
    if (map.position.size() != static_cast<std::size_t>(joints_)) {
      fail("channels", fmt::format("positions of {} joints", map.position.size()),
           fmt::format("{}, as many as the robot has", joints_));
    }
    take_units_of_file(map);
    count_uses(map);
    if (map.at_rest) {
      t_s_ = values_of(map.position[0], "position of joint 1");
      check_readings();
    } else {
      check_sample_count(t_s_.size());
    }
    log_.t_s = std::move(t_s_);
    // Written to column by column, while the columns that were read go.
    const Index samples = log_.t_s.size();
    log_.q.resize(samples, joints_);
    log_.dq.resize(samples, joints_);
    log_.tau.resize(samples, joints_);
    for (Index i = 0; i < joints_; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      log_.q.col(i) = sampled(map.position[joint], words_of("position", map.position_of, i));
      log_.tau.col(i) = sampled(map.torque[joint], words_of("torque", map.torque_of, i));
      const bool measured = joint < map.velocity.size() && map.velocity[joint].has_value();
      log_.dq_derived.push_back(!measured);
      if (measured) {
        log_.dq.col(i) = sampled(*map.velocity[joint], words_of("velocity", map.velocity_of, i));
      } else {
        log_.dq.col(i).setZero();
      }
    }
    read_sensors(map);
    for (const auto& [name, channel] : map.extra) log_.extra[name] = sampled(channel, name);
    leave_out_rows_without_number(columns_, log_);
    if (!map.at_rest) {
      check_sample_count(log_.t_s.size());
      unfold_positions(map);
    }
    log_.channels = std::move(map);
    columns_.remarks.insert(columns_.remarks.end(), log_.remarks.begin(), log_.remarks.end());
    log_.remarks = std::move(columns_.remarks);
    if (transmission_ != nullptr) to_joint_side(log_, *transmission_);
    std::string sensors = words_of_sensors(log_);
    if (!sensors.empty()) log_.remarks.push_back(std::move(sensors));
    if (log_.channels.at_rest) {
      make_hold_map(log_);
    } else {
      make_even(log_);
      derive_velocities(log_);
      check_derived();
    }
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
    if (joints.empty() && !columns_.has_names) {
      fail("line 1", fmt::format("numbers in {} columns", columns_.names.size()),
           fmt::format("a header line that names them: t, q1..q{0}, dq1..dq{0}, tau1..tau{0}",
                       joints_),
           "put one before them, or say the columns' numbers: [channels] with time = 1, position = "
           "[2], torque = [3] in the robot's file, or in one for --channels");
    }
    if (joints.empty() && prefix == "tau") {
      fail("columns", names_found(columns_) + ", and no torque",
           fmt::format("tau1..tau{}, or torques or currents by other names", joints_),
           std::string(kMendNames) +
               "; where the drives' torques or currents were not recorded, record them too: "
               "without them a model has nothing to be compared with");
    }
    if (joints.empty()) {
      fail("columns", names_found(columns_),
           fmt::format("t, q1..q{0}, dq1..dq{0}, tau1..tau{0}", joints_), kMendNames);
    }
    if (static_cast<int>(joints.size()) != joints_ || *joints.rbegin() != joints_) {
      fail("columns", words_of_joints(prefix, joints),
           fmt::format("one {} for each of the robot's {} joint{}", prefix, joints_,
                       joints_ == 1 ? "" : "s"),
           *joints.rbegin() > joints_
               ? "take the robot file of the robot that was recorded, or say with [channels] which "
                 "columns are those of its joints"
               : "add what is missing, or take the robot file of the robot that was recorded");
    }
  }

  void take_units_of_file(ChannelMap& map) {
    const auto take = [&](Channel& channel, const char* quantity, const std::vector<ChannelOf>& of,
                          Index i) {
      const ChannelOf side = side_at(of, static_cast<std::size_t>(i));
      take_unit_of_file(columns_, channel, channel_quantity(quantity, side),
                        words_of(quantity, of, i));
    };
    for (Index i = 0; i < joints_; ++i) {
      const auto joint = static_cast<std::size_t>(i);
      take(map.position[joint], "position", map.position_of, i);
      take(map.torque[joint], "torque", map.torque_of, i);
      if (joint < map.velocity.size() && map.velocity[joint]) {
        take(*map.velocity[joint], "velocity", map.velocity_of, i);
      }
      if (joint < map.sensor_torque.size() && map.sensor_torque[joint]) {
        take(*map.sensor_torque[joint], "torque", {}, i);
      }
    }
  }

  // "position of motor 2": what the channel is of.
  static std::string words_of(const char* quantity, const std::vector<ChannelOf>& of, Index i) {
    switch (side_at(of, static_cast<std::size_t>(i))) {
      case ChannelOf::kMotor:
        return fmt::format("{} of motor {}", quantity, i + 1);
      case ChannelOf::kCurrent:
        return fmt::format("current of motor {}", i + 1);
      default:
        return fmt::format("{} of joint {}", quantity, i + 1);
    }
  }

  void read_sensors(const ChannelMap& map) {
    if (map.sensor_torque.empty()) return;
    log_.sensor_tau.setZero(log_.t_s.size(), joints_);
    for (Index i = 0; i < joints_; ++i) {
      const auto& sensor = map.sensor_torque[static_cast<std::size_t>(i)];
      if (!sensor) continue;
      log_.sensor_tau.col(i) = sampled(*sensor, fmt::format("sensor torque of joint {}", i + 1));
    }
  }

  void count_uses(const ChannelMap& map) {
    const auto count = [&](const Channel& channel) {
      const auto one = [&](const Channel& term) {
        ++uses_[term.source];
        if (!term.scale_source.empty()) ++uses_[term.scale_source];
      };
      one(channel);
      for (const Channel& term : channel.sum) one(term);
    };
    for (const Channel& channel : map.position) count(channel);
    for (const Channel& channel : map.torque) count(channel);
    for (const auto& channel : map.velocity) {
      if (channel) count(*channel);
    }
    for (const auto& channel : map.sensor_torque) {
      if (channel) count(*channel);
    }
    for (const auto& [name, channel] : map.extra) count(channel);
    if (map.at_rest) ++uses_[map.position[0].source];  // read for its length as well
  }

  VectorXd values_of(const Channel& channel, const std::string& what) {
    return take_values(columns_, channel, what, --uses_[channel.source] == 0);
  }

  VectorXd sampled(const Channel& channel, const std::string& what) {
    VectorXd values = values_of(channel, what);
    if (values.size() != log_.t_s.size()) {
      fail("variable " + channel.source, fmt::format("{} values", values.size()),
           fmt::format("{}, as many as the other channels have", log_.t_s.size()));
    }
    return values;
  }

  void unfold_positions(const ChannelMap& map) {
    for (Index joint = 0; joint < joints_; ++joint) {
      VectorXd q = log_.q.col(joint);
      const KnownFold fold = known_fold_of(q);
      if (fold.folds.empty()) continue;
      unfold(q, fold.range, fold.folds);
      log_.q.col(joint) = q;
      const bool is_turn = fold.range < 2 * std::numbers::pi + 1;
      columns_.remarks.push_back(fmt::format(
          "the {} is folded into {}: it jumps by {} {} time{}, first at t = {} s, and was "
          "unfolded",
          words_of("position", map.position_of, joint),
          is_turn ? "a turn" : "the 25 rad of the MIT protocol", is_turn ? "2 pi" : "25 rad",
          fold.folds.size(), fold.folds.size() == 1 ? "" : "s",
          words_of_time(log_.t_s[fold.folds.front()])));
    }
  }

  void check_sample_count(Index samples) const {
    if (samples >= kMinSamples) return;
    fail("", counted(static_cast<std::size_t>(samples), "sample"),
         fmt::format("{} samples or more", kMinSamples));
  }

  void check_readings() const {
    if (t_s_.size() >= kMinReadings) return;
    fail("", fmt::format("{} readings", t_s_.size()),
         fmt::format("{} readings or more", kMinReadings), "hold the joint at more positions");
  }

  void remark_constants() {
    const auto remark = [&](const Eigen::MatrixXd& columns, const char* what, bool derived) {
      std::map<double, std::vector<Index>> joints_at;
      for (Index i = 0; i < columns.cols(); ++i) {
        if (derived && log_.dq_derived[static_cast<std::size_t>(i)]) continue;
        if (columns.col(i).maxCoeff() > columns.col(i).minCoeff()) continue;
        joints_at[columns(0, i)].push_back(i);
      }
      for (const auto& [value, joints] : joints_at) {
        log_.remarks.push_back(fmt::format("{} of {} never changes: it is {:.6g} throughout", what,
                                           list_of_joints(joints), value));
      }
    };
    remark(log_.q, "the position", false);
    remark(log_.dq, "the velocity", true);
    remark(log_.tau, "the torque", false);
  }

  const TransmissionSettings* transmission_;
  NamedColumns columns_;
  VectorXd t_s_;
  Index joints_;
  std::map<std::string, int> uses_;  // of each column, that are still to come
  Log log_;
};

// The common header's time by its whole name.
void shorten_time(NamedColumns& columns) {
  constexpr const char* kWhole = "time";
  const bool is_whole =
      !columns.columns.contains("t") && columns.columns.contains(kWhole) &&
      std::any_of(columns.names.begin(), columns.names.end(),
                  [](const std::string& name) { return joint_of(name, "q") > 0; });
  if (!is_whole) return;
  const auto rename = [](auto& named) {
    auto one = named.extract(kWhole);
    if (one.empty()) return;
    one.key() = "t";
    named.insert(std::move(one));
  };
  rename(columns.columns);
  rename(columns.units);
  rename(columns.origins);
  std::replace(columns.names.begin(), columns.names.end(), std::string(kWhole), std::string("t"));
  columns.remarks.emplace_back("column time is the time t");
}

TimedColumns read_file(RecordingFile& recording, const std::optional<ChannelMap>& channels,
                       const std::optional<RobotBus>& bus, double period_s, std::size_t file,
                       std::size_t files) {
  NeedOf need_of = needs_of(channels, file, files);
  if (!channels && period_s > 0) {
    // Its step is said: what the file has of a clock is nobody's business.
    need_of = [of_names = std::move(need_of)](const std::string& name) {
      return name == "t" ? Need::kNone : of_names(name);
    };
  }
  TimedColumns read;
  read.columns =
      read_in(log_format_of(recording), recording, channels ? &*channels : nullptr, bus, need_of);
  if (channels && channels->at_rest) return read;
  if (!channels && period_s == 0) shorten_time(read.columns);
  // Without any of the names this would be the least of what is wrong.
  if (!channels && !read.columns.columns.contains("t") && period_s == 0 && files == 1) {
    const auto is_common = [](const std::string& name) { return is_common_name(name); };
    const auto& names = read.columns.names;
    if (std::none_of(names.begin(), names.end(), is_common)) return read;
  }
  const Channel time = channels ? time_channel(*channels, file) : named("t");
  read.time = time_of(read.columns, time, period_s);
  return read;
}

TimedColumns read_files(const std::filesystem::path& path,
                        const std::optional<ChannelMap>& channels,
                        const std::optional<RobotBus>& bus, double period_s) {
  const std::vector<std::filesystem::path> paths = recording_files(path);
  if (paths.size() == 1) {
    RecordingFile recording(path);
    return read_file(recording, channels, bus, period_s, 0, 1);
  }
  if (channels && channels->at_rest) {
    throw InputError({path.string(), "", fmt::format("{} files", paths.size()),
                      "one, as the channels' at_rest = true says", "join them before"});
  }
  std::vector<TimedColumns> files;
  for (std::size_t file = 0; file < paths.size(); ++file) {
    RecordingFile recording(paths[file], path);
    files.push_back(read_file(recording, channels, bus, period_s, file, paths.size()));
    if (files.back().time.t_s.size() >= 2) continue;
    throw InputError({files.back().columns.file, "",
                      fmt::format("{} samples", files.back().time.t_s.size()),
                      "2 samples or more in each file of a recording", ""});
  }
  return joined_files(std::move(files), kMinSamples, kMaxGap);
}

Log read(const std::filesystem::path& path, int joint_count,
         const std::optional<ChannelMap>& channels, std::optional<double> period_s,
         const TransmissionSettings* transmission, const std::optional<RobotBus>& bus) {
  try {
    std::optional<ChannelMap> map = channels;
    if (map && period_s && !map->at_rest) map->period_s = *period_s;
    const double period = map ? map->period_s : period_s.value_or(0);
    Assembler assembler(read_files(path, map, bus, period), joint_count, transmission);
    return map ? assembler.with(*std::move(map)) : assembler.with_common_header(period);
  } catch (const std::bad_alloc&) {
    throw InputError({shown_name(path), "", "more than this machine has memory for",
                      "a recording that fits into it",
                      "cut it into parts, or leave samples or columns out"});
  }
}

}  // namespace

Log read_log(const std::filesystem::path& path, int joint_count,
             const std::optional<ChannelMap>& channels, std::optional<double> period_s) {
  if (channels) check_sides(*channels, std::nullopt, shown_name(path));
  return read(path, joint_count, channels, period_s, nullptr, std::nullopt);
}

Log log_of(TimedColumns recording, const RobotDescription& robot, const ChannelMap& channels) {
  const TransmissionSettings* const transmission =
      robot.transmission ? &*robot.transmission : nullptr;
  Log log = Assembler(std::move(recording), robot.joint_count(), transmission).with(channels);
  check_units_of_joints(log.channels, robot, log.file);
  return log;
}

Log read_log_or_hold_map(const std::filesystem::path& path, const RobotDescription& robot,
                         const ChannelOptions& options) {
  std::optional<ChannelMap> channels = robot.channels;
  if (options.file) {
    channels = read_channels_file(*options.file, robot.joint_count());
    check_sides(*channels, robot.transmission, options.file->string());
  }
  const auto said = payload_of(options.payloads, path.string());
  Log log = read(path, robot.joint_count(), channels, options.period_s,
                 robot.transmission ? &*robot.transmission : nullptr, bus_of(robot));
  check_units_of_joints(log.channels, robot, log.file);
  log.payload = said || !channels ? said : payload_of(channels->payloads, path.string());
  if (log.payload) log.remarks.push_back("with a payload of " + words_of(*log.payload));
  return log;
}

Log read_log(const std::filesystem::path& path, const RobotDescription& robot,
             const ChannelOptions& options) {
  Log log = read_log_or_hold_map(path, robot, options);
  if (log.at_rest) {
    throw InputError(
        {log.file, "", "a hold map, as the channels' at_rest = true says", "a recording in time",
         "hold maps are for explain and for add --all-found; give another --channels"});
  }
  return log;
}

}  // namespace offnominal::desk
