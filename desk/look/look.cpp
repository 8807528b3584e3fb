#include "look/look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/nearest.hpp"
#include "log/column_values.hpp"
#include "log/time_of.hpp"
#include "log/usable_rows.hpp"
#include "look/by_derivative.hpp"
#include "look/by_robot.hpp"
#include "look/data_units.hpp"
#include "look/looked_columns.hpp"
#include "look/looked_files.hpp"
#include "look/nameless.hpp"
#include "look/stamp_in_two.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

class Proposer {
 public:
  Proposer(LookedFiles files, const RobotDescription* robot)
      : files_(std::move(files)), robot_(robot), look_(look_of(files_.columns)) {
    look_.notes = std::move(files_.notes);
  }

  Look propose(std::optional<double> period_s) {
    const ExpectedJoints expected = expected_of(robot_);
    if (look_.has_names) roles_ = roles_of(columns_of(look_), expected);
    if (!period_s && !files_.time) take_time_in_two();
    const bool nameless = are_nameless();
    const std::optional<std::string> named_time = nameless ? roles_.time : std::nullopt;
    if (named_time) take_time(period_s);
    if (nameless) guess_by_numbers(expected.count, period_s.value_or(0));
    if (named_time) {
      roles_.time = named_time;
    } else {
      take_time(period_s);
    }
    if (!look_.guessed && look_.t_s) set_names_right();
    take_roles();
    say_unknown_units();
    take_units_from_data(look_, robot_);
    say_what_is_missing(expected.count);
    return std::move(look_);
  }

 private:
  // Of a file without a header, or whose columns are the columns or rows of one matrix, beside a
  // time that has a name perhaps: "data(:,1)" says no more. Where any name says what it is, they
  // count.
  [[nodiscard]] bool are_nameless() const {
    if (!look_.has_names) return true;
    const bool says_something =
        std::any_of(look_.columns.begin(), look_.columns.end(), [](const LookedColumn& column) {
          return column.role != Role::kNone && column.role != Role::kTime;
        });
    if (says_something) return false;
    std::optional<std::string> matrix;
    int parts = 0;
    for (const LookedColumn& column : look_.columns) {
      if (column.role == Role::kTime) continue;
      const auto stem = column.name.substr(0, column.name.find('('));
      const bool is_part = column.name.find("(:,") != std::string::npos ||
                           column.name.find(",:)") != std::string::npos;
      if (!is_part || stem != matrix.value_or(stem)) return false;
      matrix = stem;
      ++parts;
    }
    return parts > 2;
  }

  void guess_by_numbers(int joints, double period_s) {
    std::vector<std::string> names;
    for (const LookedColumn& column : look_.columns) {
      if (column.role != Role::kTime) names.push_back(column.name);
    }
    NamelessGuess guess = roles_of_nameless(names, look_.values, joints, period_s,
                                            look_.t_s.value_or(Eigen::VectorXd()));
    roles_ = std::move(guess.roles);
    look_.guessed = true;
    if (roles_.time) taken_for(*roles_.time, Role::kTime);
    for (const std::string& name : roles_.position) taken_for(name, Role::kPosition);
    for (const std::string& name : roles_.velocity) taken_for(name, Role::kVelocity);
    for (const std::string& name : roles_.torque) taken_for(name, Role::kTorque);
    look_.notes.emplace_back(
        look_.has_names
            ? "columns of one matrix have no names: they were taken for what their numbers are like"
            : "the file has no header: columns go by their numbers, from 1, as in position = [2]");
    look_.notes.insert(look_.notes.end(), guess.notes.begin(), guess.notes.end());
    if (!roles_.torque.empty()) {
      look_.notes.emplace_back(
          "torque = ... is all that is left; say motor_current where it is a "
          "current");
    } else if (!guess.left.empty() && !roles_.position.empty()) {
      look_.notes.push_back("torques or currents are among the columns " + list_of(guess.left));
    }
    left_ = std::move(guess.left);
  }

  void set_names_right() {
    const auto notes = set_right_by_derivative(roles_, look_.values, *look_.t_s);
    look_.notes.insert(look_.notes.end(), notes.begin(), notes.end());
    if (notes.empty()) return;
    for (const std::string& name : roles_.position) taken_for(name, Role::kPosition);
    for (const std::string& name : roles_.velocity) taken_for(name, Role::kVelocity);
  }

  void taken_for(const std::string& name, Role role) {
    for (LookedColumn& column : look_.columns) {
      if (column.name == name) column.role = role;
    }
  }

  void take_roles() {
    ChannelMap& map = look_.channels;
    for (const std::string& name : roles_.position) {
      map.position.push_back(channel_of(look_, name, Role::kPosition));
    }
    for (const std::string& name : roles_.torque) {
      map.torque.push_back(channel_of(look_, name, roles_.torque_role));
    }
    map.velocity.assign(map.position.size(), std::nullopt);
    for (std::size_t i = 0; i < roles_.velocity.size() && i < map.velocity.size(); ++i) {
      map.velocity[i] = channel_of(look_, roles_.velocity[i], Role::kVelocity);
    }
    take_sides();
    if (!roles_.order.empty()) look_.notes.push_back(roles_.order);
    if (!roles_.other_families.empty()) {
      look_.notes.push_back("these would do as well, by their names: " +
                            list_of(roles_.other_families));
    }
    if (!roles_.may_be_asked_for.empty()) {
      look_.notes.push_back(
          "taken for want of a plainer name, and no measurement where d, r or c in it is of "
          "desired, reference or commanded: " +
          list_of(roles_.may_be_asked_for));
    }
    if (!roles_.not_measured.empty()) {
      look_.notes.push_back(
          "not taken, since by their names they were asked for, act from outside or come from a "
          "model: " +
          list_of(roles_.not_measured) + "; what is meant all the same can be named in [channels]");
    }
  }

  // A current is a motor's, and so is what is called so.
  void take_sides() {
    ChannelMap& map = look_.channels;
    const auto of_motors = [](std::size_t count, ChannelOf side) {
      return std::vector<ChannelOf>(count, side);
    };
    if (roles_.position_of_motor) {
      map.position_of = of_motors(map.position.size(), ChannelOf::kMotor);
    }
    if (roles_.velocity_of_motor && !roles_.velocity.empty()) {
      map.velocity_of = of_motors(map.velocity.size(), ChannelOf::kMotor);
    }
    if (roles_.torque_role == Role::kCurrent) {
      map.torque_of = of_motors(map.torque.size(), ChannelOf::kCurrent);
    } else if (roles_.torque_of_motor && roles_.torque_role == Role::kTorque) {
      map.torque_of = of_motors(map.torque.size(), ChannelOf::kMotor);
    }
  }

  // Where no column alone is the time.
  void take_time_in_two() {
    if (roles_.time && ascends_as_time(look_.values.at(*roles_.time))) return;
    const std::optional<Channel> sum = stamp_in_two(files_.columns);
    if (!sum) return;
    take_for_no_time_but(look_, "");
    for (const Channel& term : sum->sum) taken_for(term.source, Role::kTime);
    look_.channels.time = *sum;
    look_.notes.push_back(
        fmt::format("{} has whole seconds, and {} the {} of each: the time is "
                    "their sum",
                    sum->sum[0].source, sum->sum[1].source, sum->sum[1].unit));
    set_time(look_, time_of(files_.columns, *sum, 0).t_s);
  }

  void take_time(std::optional<double> period_s) {
    if (!look_.channels.time.sum.empty()) return;
    Channel& time = look_.channels.time;
    time.source = "t";
    if (roles_.time) time = channel_of(look_, *roles_.time, Role::kTime);
    if (period_s) look_.channels.period_s = *period_s;
    if (files_.time) {
      look_.channels.time = files_.time_channel;
      look_.channels.more_times = files_.more_times;
      return set_time(look_, files_.time->t_s);
    }
    take_for_no_time_but(look_, roles_.time.value_or(""));
    if (!period_s && !roles_.time) return;
    try {
      set_time(look_, looked_time(files_.columns, time, period_s.value_or(0), look_.notes).t_s);
    } catch (const InputError& error) {
      look_.notes.push_back(std::string("the time is none: ") + error.what());
    }
  }

  // Of the columns that are taken, once for each unit and quantity.
  void say_unknown_units() {
    std::vector<std::pair<std::string, std::vector<std::string>>> unknown;
    const auto look_at = [&](const Channel& channel, ChannelQuantity quantity) {
      const LookedColumn* const column = column_in(look_, channel.source);
      if (column == nullptr) return;
      const std::string unit = column->file_says ? column->unit : unit_in_name(column->name);
      if (unit.empty() || find_unit(unit) != nullptr) return;
      const std::string words = words_of_unknown_unit(unit, quantity);
      const auto same = std::find_if(unknown.begin(), unknown.end(),
                                     [&](const auto& one) { return one.first == words; });
      if (same == unknown.end()) {
        unknown.push_back({words, {channel.source}});
      } else {
        same->second.push_back(channel.source);
      }
    };
    const ChannelMap& map = look_.channels;
    look_at(map.time, ChannelQuantity::kTime);
    for (const Channel& channel : map.position) look_at(channel, ChannelQuantity::kPosition);
    for (const auto& channel : map.velocity) {
      if (channel) look_at(*channel, ChannelQuantity::kVelocity);
    }
    const bool are_currents = roles_.torque_role == Role::kCurrent;
    for (const Channel& channel : map.torque) {
      look_at(channel, are_currents ? ChannelQuantity::kCurrent : ChannelQuantity::kTorque);
    }
    for (const auto& [words, names] : unknown) {
      look_.notes.push_back(list_of(names) + ": " + words);
    }
  }

  void say_what_is_missing(int joints) {
    const ChannelMap& map = look_.channels;
    const std::string each =
        joints > 0 ? fmt::format("one for each of {} joints", joints) : "one for each joint";
    const auto told = [&](const char* key, std::size_t count,
                          const std::vector<std::string>& of_other_count) {
      if (look_.guessed) return ": " + line_to_write(key, count);
      if (of_other_count.empty()) return std::string(", told by their names");
      return fmt::format(
          ", told by their names: {} {}; name those of the joints", list_of(of_other_count),
          of_other_count.size() == 1 ? "is one" : "are " + std::to_string(of_other_count.size()));
    };
    const auto wanted = static_cast<std::size_t>(std::max(joints, 0));
    const LookedColumn* const time =
        roles_.time && look_.t_s == std::nullopt ? column_in(look_, *roles_.time) : nullptr;
    if (time != nullptr && look_.values.at(time->name).size() < 2) {
      look_.missing.push_back("more samples: the file has one row of numbers");
    } else if (!look_.t_s) {
      look_.missing.emplace_back(
          "a column of time: name it under [channels], or say period_s, the time between two "
          "samples");
    }
    if (map.position.empty()) {
      look_.missing.push_back("positions, " + each +
                              told("position", wanted, roles_.positions_of_other_count));
    }
    if (map.torque.empty()) {
      look_.missing.push_back(
          "torques or currents, " + each +
          told("torque", std::max(wanted, map.position.size()), roles_.torques_of_other_count) +
          "; without them a model has nothing to be compared with");
    } else if (!map.position.empty() && map.torque.size() != map.position.size()) {
      look_.missing.push_back(
          fmt::format("{} positions and {} torques", map.position.size(), map.torque.size()));
    }
    if (roles_.torque_role == Role::kVoltage) {
      look_.missing.emplace_back("the scale of the voltages, N m per V: scale or scale_source");
    }
    say_transmission();
  }

  // Of a file without names, where the numbers do not tell: with all that is left, or some of it.
  std::string line_to_write(const char* key, std::size_t count) const {
    if (left_.empty()) return "the file has no columns left";
    std::vector<std::string> all = left_;
    if (look_.has_names) {
      for (std::string& one : all) one = fmt::format("\"{}\"", one);
    }
    if (all.size() == count) {
      return fmt::format("{} = [{}] says so", key, fmt::join(all, ", "));
    }
    return fmt::format("{} = [...] with the {}{} of {} of the columns {}", key,
                       look_.has_names ? "name" : "number", count == 1 ? "" : "s",
                       count == 0 ? "some" : std::to_string(count), list_of(all));
  }

  // What channels of motors are refused without.
  void say_transmission() {
    const ChannelMap& map = look_.channels;
    const bool any_current = !map.torque_of.empty() && map.torque_of[0] == ChannelOf::kCurrent;
    const bool any_motor =
        !map.position_of.empty() || !map.velocity_of.empty() || !map.torque_of.empty();
    const auto& known = robot_ == nullptr ? std::nullopt : robot_->transmission;
    if (any_motor && !known) {
      look_.transmission.emplace_back(
          "ratio = [...]            # of each joint: turns of its motor per its own");
      look_.missing.emplace_back("the gear ratios: [transmission] of the robot file");
    }
    if (any_current && (!known || known->torque_constant.empty())) {
      look_.transmission.emplace_back("torque_constant = [...]  # of each motor, N m/A");
      look_.missing.emplace_back(
          "the torque constants of the motors: [transmission] of the robot file");
    }
  }

  LookedFiles files_;
  const RobotDescription* robot_;
  Roles roles_;
  std::vector<std::string> left_;  // columns of a file without names that are nothing
  Look look_;
};

}  // namespace

Look look_at(const std::filesystem::path& path, const RobotDescription* robot,
             std::optional<double> period_s) {
  std::string refused;
  if (robot != nullptr && robot->channels) {
    try {
      return look_by_channels(path, *robot, period_s);
    } catch (const InputError& error) {
      // What is gone cannot be looked at without them.
      if (is_stream(path.string())) throw;
      refused = error.what();
    }
  }
  Look look = Proposer(read_looked_files(path, robot, period_s), robot).propose(period_s);
  if (!refused.empty()) {
    look.notes.insert(look.notes.begin(),
                      "the robot file's own [channels] do not read this recording: " + refused);
  }
  return look;
}

}  // namespace offnominal::desk
