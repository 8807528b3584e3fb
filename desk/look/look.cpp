#include "look/look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/error.hpp"
#include "common/nearest.hpp"
#include "log/channel_needs.hpp"
#include "log/log_format.hpp"
#include "log/recording_file.hpp"
#include "log/time_of.hpp"
#include "robot/units.hpp"
#include "signal/differentiate.hpp"
#include "signal/fold.hpp"
#include "signal/zero_phase.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Everything that is numeric; a column of a text that is called a time may hold dates.
Need need_in_text(const std::string& name) {
  if (guess_of(name).role == Role::kTime) return Need::kAscending;
  return is_common_name(name) ? Need::kRequired : Need::kWelcome;
}
Need need_elsewhere(const std::string& name) {
  return is_common_name(name) ? Need::kRequired : Need::kWelcome;
}

ChannelQuantity quantity_of(Role role) {
  switch (role) {
    case Role::kPosition:
      return ChannelQuantity::kPosition;
    case Role::kVelocity:
      return ChannelQuantity::kVelocity;
    case Role::kTime:
      return ChannelQuantity::kTime;
    default:
      return ChannelQuantity::kTorque;
  }
}

struct NamedFactor {
  double factor;
  const char* position;
  const char* velocity;
};
// Velocity over the derivative of the position, by the units of the two.
constexpr double kPerDegree = 180 / std::numbers::pi;
constexpr std::array kRatios{
    NamedFactor{kPerDegree, "rad", "deg/s"},
    NamedFactor{30 / std::numbers::pi, "rad", "rpm"},
    NamedFactor{0.5 / std::numbers::pi, "rad", "turns/s"},
    NamedFactor{1 / kPerDegree, "deg", "rad/s"},
    NamedFactor{1.0 / 6, "deg", "rpm"},
    NamedFactor{1e3, "m", "mm/s"},
};
constexpr double kSameRatio = 1.12;
// Of a recording that shows a motion.
constexpr double kLongestPeriodS = 0.2;

double distance(double ratio, double wanted) { return std::abs(std::log(ratio / wanted)); }

bool is_near(double ratio, double wanted) {
  return ratio > 0 && distance(ratio, wanted) < std::log(kSameRatio);
}

class Looker {
 public:
  Looker(NamedColumns columns, const RobotDescription* robot) : columns_(std::move(columns)) {
    robot_ = robot;
    look_.file = columns_.file;
    look_.has_names = columns_.has_names;
  }

  Look look(std::optional<double> period_s) {
    const int joints = robot_ == nullptr ? 0 : robot_->joint_count();
    roles_ = roles_of(numeric_names(), joints);
    take_columns();
    propose();
    take_time(period_s);
    check_units();
    say_what_is_missing(joints);
    look_.remarks = columns_.remarks;
    return std::move(look_);
  }

 private:
  std::vector<std::string> numeric_names() {
    std::vector<std::string> names;
    for (const std::string& name : columns_.names) {
      if (columns_.columns.contains(name)) {
        names.push_back(name);
      } else if (!columns_.scalars.contains(name)) {
        look_.unread.push_back(name);
      }
    }
    return names;
  }

  void take_columns() {
    for (const std::string& name : columns_.names) {
      const auto found = columns_.columns.find(name);
      if (found == columns_.columns.end()) continue;
      LookedColumn column;
      column.name = name;
      const NameGuess guess = guess_of(name);
      column.role = guess.role;
      column.unit = guess.unit;
      if (const auto said = columns_.units.find(name); said != columns_.units.end()) {
        column.unit = said->second;
        column.file_says = true;
      }
      column.facts = facts_of(found->second);
      look_.columns.push_back(std::move(column));
      look_.values[name] = found->second;
    }
  }

  const LookedColumn* column(const std::string& name) const {
    const auto at = std::find_if(look_.columns.begin(), look_.columns.end(),
                                 [&](const LookedColumn& one) { return one.name == name; });
    return at == look_.columns.end() ? nullptr : &*at;
  }

  // With the unit that is not the SI's own, where it is one of the quantity's.
  Channel channel_of(const std::string& name, Role role) const {
    Channel channel;
    channel.source = name;
    const LookedColumn* const of = column(name);
    const SourceUnit* const unit = of == nullptr ? nullptr : find_unit(of->unit);
    if (unit != nullptr && is_unit_of(*unit, quantity_of(role)) && unit->factor != 1) {
      channel.unit = of->unit;
    }
    return channel;
  }

  void propose() {
    ChannelMap& map = look_.channels;
    map.time.source = "t";
    if (roles_.time) map.time = channel_of(*roles_.time, Role::kTime);
    for (const std::string& name : roles_.position) {
      map.position.push_back(channel_of(name, Role::kPosition));
    }
    for (const std::string& name : roles_.torque) {
      map.torque.push_back(channel_of(name, Role::kTorque));
    }
    map.velocity.assign(map.position.size(), std::nullopt);
    for (std::size_t i = 0; i < roles_.velocity.size() && i < map.velocity.size(); ++i) {
      map.velocity[i] = channel_of(roles_.velocity[i], Role::kVelocity);
    }
    if (!roles_.other_families.empty()) {
      look_.notes.push_back("these would do as well, by their names: " +
                            list_of(roles_.other_families));
    }
  }

  void take_time(std::optional<double> period_s) {
    if (period_s) look_.channels.period_s = *period_s;
    if (!period_s && !roles_.time) return;
    Channel time = look_.channels.time;
    try {
      const FileTime read = time_of(columns_, time, period_s.value_or(0));
      set_time(read.t_s);
    } catch (const InputError& error) {
      propose_epoch(error);
    }
  }

  // A clock that counts from 1970 in no seconds is refused by time_of() with the unit to say.
  void propose_epoch(const InputError& error) {
    const auto origin = columns_.origins.find(*roles_.time);
    const auto found = look_.values.find(*roles_.time);
    if (found == look_.values.end() || found->second.size() < 2) return;
    const double first = origin == columns_.origins.end() ? found->second[0] : origin->second.value;
    for (const char* unit : {"ms", "us", "ns"}) {
      const double seconds = first * unit_factor(unit);
      if (!look_.channels.time.unit.empty() || seconds < 1e9 || seconds >= 3e9) continue;
      look_.channels.time.unit = unit;
      look_.notes.push_back(
          fmt::format("{} counts {} since 1970, by its size", *roles_.time, unit));
      columns_.columns[*roles_.time] = found->second;
      set_time(time_of(columns_, look_.channels.time, 0).t_s);
      return;
    }
    look_.notes.push_back(std::string("the time is none: ") + error.what());
  }

  void set_time(VectorXd t_s) {
    if (t_s.size() < 2) return;
    look_.sampling = sampling_of(t_s);
    look_.t_s = std::move(t_s);
  }

  VectorXd in_si(const Channel& channel) const {
    return channel.scale * unit_factor(channel.unit) * look_.values.at(channel.source);
  }

  // The velocity over the derivative of the position, none where they have nothing in common.
  std::optional<double> ratio_of(std::size_t joint) const {
    constexpr Index kFewest = 200;
    constexpr double kCorrelated = 0.9;
    VectorXd q = in_si(look_.channels.position[joint]);
    const VectorXd dq = in_si(*look_.channels.velocity[joint]);
    const double period_s = look_.sampling->median_period_s;
    if (q.size() < kFewest || q.size() != dq.size() || q.size() != look_.t_s->size() ||
        !q.allFinite() || !dq.allFinite() || look_.sampling->jitter > 1) {
      return std::nullopt;
    }
    for (const double turn : {2 * std::numbers::pi, 360.0}) {
      if (const auto folds = folds_of(q, turn); !folds.empty()) unfold(q, turn, folds);
    }
    const double rate_hz = 1 / period_s;
    const double cutoff_hz = std::min(100.0, rate_hz / 10);
    const VectorXd slope = central_difference(zero_phase_low_pass(q, cutoff_hz, rate_hz), period_s);
    const VectorXd smooth = zero_phase_low_pass(dq, cutoff_hz, rate_hz);
    const double product = slope.dot(smooth);
    const double squares = slope.squaredNorm() * smooth.squaredNorm();
    if (!(squares > 0) || std::abs(product) < kCorrelated * std::sqrt(squares)) return std::nullopt;
    return smooth.squaredNorm() / std::abs(product) * (product < 0 ? -1 : 1);
  }

  void check_units() {
    if (!look_.sampling) return;
    for (std::size_t i = 0; i < look_.channels.position.size(); ++i) {
      if (look_.channels.velocity[i]) check_velocity(i);
      check_range(i);
    }
  }

  void check_velocity(std::size_t i) {
    Channel& q = look_.channels.position[i];
    Channel& dq = *look_.channels.velocity[i];
    const auto ratio = ratio_of(i);
    if (!ratio) {
      look_.notes.push_back(
          fmt::format("{}: nothing in common with the derivative of {}, or the joint hardly moves",
                      dq.source, q.source));
      return;
    }
    const std::string is =
        fmt::format("{} is {:.4g} times the derivative of {}", dq.source, *ratio, q.source);
    if (*ratio < 0) {
      look_.notes.push_back(is + ": their signs are opposed; scale = -1 turns one of them");
      return;
    }
    if (is_near(*ratio, 1)) {
      look_.notes.push_back(is + ": their units agree");
      return;
    }
    for (const char* unit : {"ms", "us", "ns"}) {
      if (!is_near(*ratio * unit_factor(unit), 1) || look_.channels.period_s > 0 ||
          !look_.channels.time.unit.empty() || look_.sampling->median_period_s < kLongestPeriodS) {
        continue;
      }
      look_.channels.time.unit = unit;
      look_.notes.push_back(fmt::format("{}: as a time in {}", is, unit));
      *look_.t_s *= unit_factor(unit);
      look_.sampling = sampling_of(*look_.t_s);
      return;
    }
    const auto* const known = std::min_element(
        kRatios.begin(), kRatios.end(), [&](const NamedFactor& a, const NamedFactor& b) {
          return distance(*ratio, a.factor) < distance(*ratio, b.factor);
        });
    if (is_near(*ratio, known->factor) && q.unit.empty() && dq.unit.empty()) {
      q.unit = find_unit(known->position)->factor == 1 ? "" : known->position;
      dq.unit = find_unit(known->velocity)->factor == 1 ? "" : known->velocity;
      look_.notes.push_back(
          fmt::format("{}: as {} beside {}", is, known->velocity, known->position));
      return;
    }
    look_.notes.push_back(is + ": no units that are known differ so; look at both");
  }

  void check_range(std::size_t i) {
    constexpr double kManyTurns = 4 * std::numbers::pi;
    Channel& q = look_.channels.position[i];
    const LookedColumn* const of = column(q.source);
    const double most = std::max(std::abs(of->facts.low), std::abs(of->facts.high));
    const bool revolute = robot_ == nullptr || robot_->joints[i].joint.type == JointType::kRevolute;
    if (!q.unit.empty() || of->file_says || !revolute) return;
    if (robot_ != nullptr) {
      const auto& joint = robot_->joints[i].joint;
      const double limit = std::max(std::abs(joint.min_position), std::abs(joint.max_position));
      if (!(most > limit) || most * std::numbers::pi / 180 > limit) return;
      q.unit = "deg";
      look_.notes.push_back(fmt::format(
          "{} goes up to {:.4g}, beyond the joint's limit of {:.4g} rad: as degrees it is within",
          q.source, most, limit));
    } else if (most > kManyTurns) {
      look_.notes.push_back(fmt::format(
          "{} goes up to {:.4g}: many turns in rad, or degrees; unit = \"deg\" says the latter",
          q.source, most));
    }
  }

  void say_what_is_missing(int joints) {
    const std::string each =
        joints > 0 ? fmt::format("one for each of {} joints", joints) : "one for each joint";
    if (!look_.t_s) {
      look_.missing.push_back(
          "a column of time: name it under [channels], or say period_s, the time between two "
          "samples");
    }
    if (look_.channels.position.empty()) {
      look_.missing.push_back("positions, " + each + ", told by their names");
    }
    if (look_.channels.torque.empty()) {
      look_.missing.push_back("torques or currents, " + each + ", told by their names");
    } else if (look_.channels.torque.size() != look_.channels.position.size()) {
      look_.missing.push_back(
          fmt::format("{} positions and {} torques", roles_.position.size(), roles_.torque.size()));
    }
    const bool is_current =
        roles_.torque_is_current ||
        std::any_of(roles_.torque.begin(), roles_.torque.end(), [&](const std::string& name) {
          const SourceUnit* unit = find_unit(column(name)->unit);
          return unit != nullptr && !is_unit_of(*unit, ChannelQuantity::kTorque);
        });
    if (is_current && !look_.channels.torque.empty()) {
      look_.missing.push_back(
          "the scale of the currents: torque constant times gear ratio, N m per A");
    }
  }

  NamedColumns columns_;
  const RobotDescription* robot_;
  Roles roles_;
  Look look_;
};

}  // namespace

Look look_at(const std::filesystem::path& path, const RobotDescription* robot,
             std::optional<double> period_s) {
  RecordingFile file(path);
  const ChannelMap* const channels =
      robot != nullptr && robot->channels ? &*robot->channels : nullptr;
  const LogFormat& format = log_format_of(file);
  const bool is_text = format.recognises == nullptr;
  return Looker(format.read(file, channels, is_text ? need_in_text : need_elsewhere), robot)
      .look(period_s);
}

}  // namespace offnominal::desk
