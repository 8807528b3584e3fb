#include "look/data_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/nearest.hpp"
#include "look/relation.hpp"
#include "look/unit_ratios.hpp"
#include "robot/channels.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

using Eigen::VectorXd;

// Of a recording that shows a motion.
constexpr double kLongestPeriodS = 0.2;

bool is_si(const char* unit) { return find_unit(unit)->factor == 1; }

class UnitsFromData {
 public:
  UnitsFromData(Look& look, const RobotDescription* robot)
      : look_(look), map_(look.channels), robot_(robot), decided_(map_.position.size()) {}

  int take() {
    if (!look_.sampling) return 0;
    take_long_time_unit();
    for (std::size_t i = 0; i < map_.position.size(); ++i) {
      agrees_ = false;
      if (has_velocity(i)) check_velocity(i);
      check_range(i);
      if (agrees_) ++agreeing_;
    }
    share();
    return agreeing_;
  }

 private:
  // In the units of the SI: empty.
  struct Units {
    std::string position;
    std::string velocity;
    bool operator==(const Units&) const = default;
  };

  bool has_velocity(std::size_t i) const {
    return i < map_.velocity.size() && map_.velocity[i].has_value();
  }

  const LookedColumn* column(const std::string& name) const {
    const auto at = std::find_if(look_.columns.begin(), look_.columns.end(),
                                 [&](const LookedColumn& one) { return one.name == name; });
    return at == look_.columns.end() ? nullptr : &*at;
  }

  // Whether nobody says in what the channel is.
  bool is_open(const Channel& channel) const {
    const LookedColumn* const of = column(channel.source);
    return channel.unit.empty() && channel.scale == 1 && of != nullptr && of->unit.empty();
  }

  // None of a sum, and of a channel that a scalar of the file scales.
  std::optional<VectorXd> in_si(const Channel& channel) const {
    const auto values = look_.values.find(channel.source);
    if (values == look_.values.end() || !channel.scale_source.empty()) return std::nullopt;
    return channel.scale * unit_factor(channel.unit) * values->second;
  }

  void say(const std::string& note) { look_.notes.push_back(note); }

  void check_velocity(std::size_t i) {
    const Channel& q = map_.position[i];
    const Channel& dq = *map_.velocity[i];
    const auto position = in_si(q);
    const auto velocity = in_si(dq);
    if (!position || !velocity) return;
    const Relation relation = relation_of(*position, *velocity, *look_.t_s);
    const std::string both = fmt::format("{} as the derivative of {}", dq.source, q.source);
    if (!relation.not_judged.empty()) {
      say(fmt::format("{}: could not be judged, {}", both, relation.not_judged));
    } else if (!relation.ratio) {
      say(fmt::format("{}: nothing in common with the derivative of {}", dq.source, q.source));
    } else {
      judge(i, *relation.ratio);
    }
  }

  void judge(std::size_t i, double ratio) {
    Channel& q = map_.position[i];
    Channel& dq = *map_.velocity[i];
    const std::string is =
        fmt::format("{} is {:.4g} times the derivative of {}", dq.source, ratio, q.source);
    if (ratio < 0) return say(is + ": their signs are opposed; scale = -1 turns one of them");
    if (is_near(ratio, 1)) {
      agrees_ = true;
      return say(is + ": their units agree");
    }
    if (take_time_unit(ratio, is)) return;
    const UnitRatio* const known = unit_ratio_of(ratio);
    const bool fits = known != nullptr && (is_si(known->position) || is_open(q)) &&
                      (is_si(known->velocity) || is_open(dq));
    if (!fits) return say(is + ": no units that are known differ so; look at both");
    if (!is_si(known->position)) q.unit = known->position;
    if (!is_si(known->velocity)) dq.unit = known->velocity;
    decided_[i] = Units{q.unit, dq.unit};
    agrees_ = true;
    say(fmt::format("{}: as {} beside {}", is, known->velocity,
                    q.unit.empty() ? known->position : q.unit));
  }

  bool take_time_unit(double ratio, const std::string& is) {
    for (const char* unit : kShortTimeUnits) {
      if (!is_near(ratio * unit_factor(unit), 1) || map_.period_s > 0 || !map_.time.unit.empty() ||
          look_.sampling->median_period_s < kLongestPeriodS) {
        continue;
      }
      map_.time.unit = unit;
      say(fmt::format("{}: as a time in {}", is, unit));
      *look_.t_s *= unit_factor(unit);
      look_.sampling = sampling_of(*look_.t_s);
      agrees_ = true;
      return true;
    }
    return false;
  }

  // A minute, an hour or a day, which every velocity shows.
  void take_long_time_unit() {
    if (map_.period_s > 0 || !map_.time.unit.empty() || map_.time.scale != 1) return;
    const std::vector<double> ratios = small_velocity_ratios();
    for (const char* unit : kLongTimeUnits) {
      const double seconds = unit_factor(unit);
      const bool all = std::all_of(ratios.begin(), ratios.end(),
                                   [&](double ratio) { return shows_long_time_unit(ratio, unit); });
      if (!all || ratios.empty() || look_.sampling->median_period_s * seconds > kLongestPeriodS) {
        continue;
      }
      map_.time.unit = unit;
      say(fmt::format("every velocity is 1/{:g} of the derivative of its position: as a time in {}",
                      seconds, unit));
      *look_.t_s *= seconds;
      look_.sampling = sampling_of(*look_.t_s);
      return;
    }
  }

  // Of the joints whose velocity has one; none where one is no share of the derivative.
  std::vector<double> small_velocity_ratios() const {
    constexpr double kSmall = 0.1;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < map_.position.size(); ++i) {
      if (!has_velocity(i)) continue;
      const auto position = in_si(map_.position[i]);
      const auto velocity = in_si(*map_.velocity[i]);
      if (!position || !velocity) continue;
      const Relation relation = relation_of(*position, *velocity, *look_.t_s);
      if (!relation.ratio) continue;
      if (*relation.ratio > kSmall) return {};
      ratios.push_back(*relation.ratio);
    }
    return ratios;
  }

  void check_range(std::size_t i) {
    // A joint that is a little beyond its limit is still one in rad.
    constexpr double kFarBeyond = 2;
    constexpr double kManyTurns = 4 * std::numbers::pi;
    const Channel& q = map_.position[i];
    const LookedColumn* const of = column(q.source);
    if (of == nullptr || !is_open(q) || side_at(map_.position_of, i) != ChannelOf::kJoint) return;
    const double most = std::max(std::abs(of->facts.low), std::abs(of->facts.high));
    if (robot_ == nullptr) {
      if (most <= kManyTurns) return;
      return say(fmt::format(
          "{} goes up to {:.4g}: many turns in rad, or degrees; unit = \"deg\" says the latter{}",
          q.source, most, agrees_ ? ", and unit = \"deg/s\" of the velocity" : ""));
    }
    const Joint<double>& joint = robot_->joints[i].joint;
    const double limit = std::max(std::abs(joint.min_position), std::abs(joint.max_position));
    if (joint.type != JointType::kRevolute || most <= kFarBeyond * limit ||
        most * std::numbers::pi / 180 > limit) {
      return;
    }
    say(fmt::format(
        "{} goes up to {:.4g}, beyond the joint's limit of {:.4g} rad: as degrees it is within",
        q.source, most, limit));
    take_degrees(i);
  }

  void take_degrees(std::size_t i) {
    map_.position[i].unit = "deg";
    // What agreed with it before agrees with it in degrees.
    const bool with_velocity = agrees_ && has_velocity(i) && is_open(*map_.velocity[i]);
    if (with_velocity) map_.velocity[i]->unit = "deg/s";
    if (with_velocity || !has_velocity(i)) {
      decided_[i] = Units{"deg", with_velocity ? "deg/s" : ""};
    }
  }

  // Columns of one family are in one unit.
  void share() {
    const auto first = std::find_if(decided_.begin(), decided_.end(),
                                    [](const auto& units) { return units.has_value(); });
    if (first == decided_.end()) return;
    const bool alike = std::all_of(decided_.begin(), decided_.end(),
                                   [&](const auto& units) { return !units || *units == **first; });
    if (!alike) return;
    std::vector<std::string> taken;
    for (std::size_t i = 0; i < decided_.size(); ++i) {
      Channel& q = map_.position[i];
      if (decided_[i] || !is_revolute(i)) continue;
      if (is_open(q) && !(*first)->position.empty()) {
        q.unit = (*first)->position;
        taken.push_back(q.source);
      }
      if (has_velocity(i) && is_open(*map_.velocity[i]) && !(*first)->velocity.empty()) {
        map_.velocity[i]->unit = (*first)->velocity;
        taken.push_back(map_.velocity[i]->source);
      }
    }
    if (taken.empty()) return;
    say(fmt::format("{}: in the unit of the other joints", list_of(taken)));
  }

  bool is_revolute(std::size_t i) const {
    return robot_ == nullptr || robot_->joints[i].joint.type == JointType::kRevolute;
  }

  Look& look_;
  ChannelMap& map_;
  const RobotDescription* robot_;
  std::vector<std::optional<Units>> decided_;  // per joint
  bool agrees_ = false;                        // the velocity of the joint at hand
  int agreeing_ = 0;
};

}  // namespace

int take_units_from_data(Look& look, const RobotDescription* robot) {
  return UnitsFromData(look, robot).take();
}

}  // namespace offnominal::desk
