#include "look/looked_columns.hpp"

#include <algorithm>
#include <utility>

#include "log/usable_rows.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

bool is_of(const SourceUnit& unit, Role role) {
  switch (role) {
    case Role::kPosition:
      return is_unit_of(unit, ChannelQuantity::kPosition);
    case Role::kVelocity:
      return is_unit_of(unit, ChannelQuantity::kVelocity);
    case Role::kTime:
      return is_unit_of(unit, ChannelQuantity::kTime);
    case Role::kCurrent:
      return is_unit_of(unit, ChannelQuantity::kCurrent);
    case Role::kVoltage:
      return unit.dimension == Dimension::kVoltage;
    default:
      return is_unit_of(unit, ChannelQuantity::kTorque);
  }
}

}  // namespace

Look look_of(const NamedColumns& columns) {
  Look look;
  look.file = columns.file;
  look.has_names = columns.has_names;
  look.remarks = columns.remarks;
  for (const std::string& name : columns.names) {
    const auto found = columns.columns.find(name);
    if (found == columns.columns.end()) {
      const bool was_read = columns.scalars.contains(name) || columns.taken.contains(name);
      if (!was_read) look.unread.push_back(name);
      continue;
    }
    LookedColumn column;
    column.name = name;
    const auto said = columns.units.find(name);
    column.file_says = said != columns.units.end();
    const NameGuess guess = guess_of(name, column.file_says ? said->second : "");
    column.unit = column.file_says ? said->second : guess.unit;
    column.facts = facts_of(found->second);
    if (column.facts.has_numbers()) column.role = guess.role;
    look.columns.push_back(std::move(column));
    look.values[name] = found->second;
  }
  return look;
}

void set_time(Look& look, const Eigen::VectorXd& t_s) {
  if (t_s.size() < 2) return;
  look.sampling = sampling_of(t_s);
  look.t_s = t_s;
}

void take_for_no_time_but(Look& look, const std::string& name) {
  for (LookedColumn& column : look.columns) {
    if (column.role == Role::kTime && column.name != name) column.role = Role::kNone;
  }
}

const LookedColumn* column_in(const Look& look, const std::string& name) {
  const auto at = std::find_if(look.columns.begin(), look.columns.end(),
                               [&](const LookedColumn& one) { return one.name == name; });
  return at == look.columns.end() ? nullptr : &*at;
}

std::vector<NamedColumn> columns_of(const Look& look) {
  std::vector<NamedColumn> columns;
  for (const LookedColumn& column : look.columns) {
    if (!column.facts.has_numbers()) continue;  // read, it would cost every row
    const bool ascends = column.role != Role::kTime || ascends_as_time(look.values.at(column.name));
    columns.push_back(
        {column.name, column.file_says ? column.unit : "", column.facts.is_constant, ascends});
  }
  return columns;
}

ExpectedJoints expected_of(const RobotDescription* robot) {
  ExpectedJoints expected;
  if (robot == nullptr) return expected;
  expected.count = robot->joint_count();
  for (const RobotJoint& joint : robot->joints) expected.names.push_back(joint.name);
  return expected;
}

Channel channel_of(const Look& look, const std::string& name, Role role) {
  Channel channel;
  channel.source = name;
  const LookedColumn* const of = column_in(look, name);
  const SourceUnit* const unit = of == nullptr ? nullptr : find_unit(of->unit);
  const bool always = role == Role::kCurrent || role == Role::kVoltage;
  if (unit != nullptr && is_of(*unit, role) && (always || unit->factor != 1)) {
    channel.unit = of->unit;
  }
  // Refused without a scale, which nobody but the drive's maker knows.
  if (role == Role::kVoltage && channel.unit.empty()) channel.unit = "V";
  return channel;
}

}  // namespace offnominal::desk
