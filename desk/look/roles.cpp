#include "look/roles.hpp"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "look/families.hpp"
#include "robot/robot.hpp"

namespace offnominal::desk {
namespace {

// What a name stands in: "rec." of "rec.pos(1,:)".
std::string holder_of(const std::string& name) {
  const auto dot = name.find_last_of('.');
  return dot == std::string::npos ? std::string() : name.substr(0, dot + 1);
}

// As many joints as the most families of positions and torques have.
std::size_t joints_of(const std::vector<Family>& families) {
  std::map<std::size_t, int> votes;
  for (const Family& family : families) {
    if (family.role != Role::kVelocity) ++votes[family.members.size()];
  }
  std::size_t best = 0;
  for (const auto& [joints, count] : votes) {
    if (joints <= static_cast<std::size_t>(kMaxJoints) && (best == 0 || count >= votes[best])) {
      best = joints;
    }
  }
  return best;
}

std::vector<std::string> joints_in(const Family& family) {
  std::vector<std::string> joints;
  for (const FamilyMember& member : family.members) joints.push_back(member.joint);
  std::sort(joints.begin(), joints.end());
  return joints;
}

// Two or more columns whose joints another quantity has by the same names.
bool is_told_by_another(const Family& family, const std::vector<Family>& by_name) {
  if (family.members.size() < 2 || family.members.size() > static_cast<std::size_t>(kMaxJoints)) {
    return false;
  }
  const std::vector<std::string> joints = joints_in(family);
  if (std::adjacent_find(joints.begin(), joints.end()) != joints.end()) return false;
  return std::any_of(by_name.begin(), by_name.end(), [&](const Family& other) {
    return other.role != family.role && joints_in(other) == joints;
  });
}

// Whether numbers alone part no two joints of it from the others: "torso" and "arm_1" to "arm_7".
bool is_more_than_numbers(const Family& family, const std::vector<Family>& numbered) {
  int larger = 0;
  for (const Family& one : numbered) {
    const bool is_part = std::any_of(one.members.begin(), one.members.end(), [&](const auto& a) {
      return std::any_of(family.members.begin(), family.members.end(),
                         [&](const auto& b) { return a.column == b.column; });
    });
    if (is_part && one.members.size() > 1) ++larger;
  }
  return larger <= 1;
}

// Families by the names of joints that may be taken, and whether they stand in the robot's order.
struct ByName {
  std::vector<Family> families;
  std::vector<Family> not_measured;
  bool in_robots_order = false;
};

ByName usable_by_name(const std::vector<NamedColumn>& columns, const std::vector<Family>& numbered,
                      const ExpectedJoints& expected) {
  std::vector<Family> all = families_by_name(columns);
  ByName usable;
  usable.not_measured = take_not_measured(all);
  for (const Family& family : all) {
    Family ordered = in_order_of(family, expected.names);
    if (!ordered.members.empty()) usable.families.push_back(std::move(ordered));
  }
  usable.in_robots_order = !usable.families.empty();
  if (usable.in_robots_order) return usable;
  for (const Family& family : all) {
    const bool fits = expected.count > 0
                          ? family.members.size() == static_cast<std::size_t>(expected.count)
                          : is_told_by_another(family, all);
    if (fits && is_more_than_numbers(family, numbered)) usable.families.push_back(family);
  }
  return usable;
}

// How far a name is from "measured": below 0 where it says so, above where it was estimated.
int doubt_of(const std::vector<std::string>& words) {
  static const std::set<std::string> kMeasured{"meas", "measured", "act", "actual", "ist"};
  static const std::set<std::string> kEstimated{"est",      "estimate", "estimated", "hat",
                                                "observer", "sim",      "simulated"};
  int doubt = 0;
  for (const std::string& word : words) {
    doubt += (kEstimated.contains(word) ? 1 : 0) - (kMeasured.contains(word) ? 1 : 0);
  }
  return doubt;
}

std::vector<std::string> member_columns(const Family& family) {
  std::vector<std::string> columns;
  for (const FamilyMember& member : family.members) columns.push_back(member.column);
  return columns;
}

class Chooser {
 public:
  Chooser(const std::vector<Family>& families, std::size_t joints)
      : families_(families), joints_(joints) {}

  Roles choose() {
    roles_.position = best_of(Role::kPosition, roles_.position_of_motor);
    if (!roles_.position.empty()) {
      holder_ = holder_of(roles_.position[0]);
      words_ = other_words(roles_.position[0]);
    }
    roles_.velocity = best_of(Role::kVelocity, roles_.velocity_of_motor);
    for (const Role role : {Role::kTorque, Role::kCurrent, Role::kVoltage}) {
      if (!roles_.torque.empty()) break;
      roles_.torque = best_of(role, roles_.torque_of_motor);
      roles_.torque_role = roles_.torque.empty() ? Role::kTorque : role;
    }
    if (roles_.position.empty()) roles_.positions_of_other_count = largest_of({Role::kPosition});
    if (roles_.torque.empty()) {
      roles_.torques_of_other_count = largest_of({Role::kTorque, Role::kCurrent, Role::kVoltage});
    }
    return std::move(roles_);
  }

 private:
  // The better, the smaller.
  auto rank_of(const Family& family) const {
    const auto constants = std::count_if(family.members.begin(), family.members.end(),
                                         [](const auto& member) { return member.is_constant; });
    const bool elsewhere = holder_of(family.members[0].column) != holder_;
    const std::vector<std::string> words = other_words(family.members[0].column);
    const auto shared = std::count_if(words.begin(), words.end(), [&](const auto& word) {
      return std::find(words_.begin(), words_.end(), word) != words_.end();
    });
    return std::tuple(roles_.position.empty() ? false : elsewhere, constants, -shared,
                      doubt_of(words), words.size());
  }

  std::vector<std::string> best_of(Role role, bool& of_motor) {
    const Family* best = nullptr;
    const auto fits = [&](const Family& family) {
      return family.role == role && !family.members.empty() && family.members.size() == joints_;
    };
    for (const Family& family : families_) {
      if (fits(family) && (best == nullptr || rank_of(family) < rank_of(*best))) best = &family;
    }
    if (best == nullptr) return {};
    of_motor = best->of_motor;
    if (may_be_asked_for(*best)) roles_.may_be_asked_for.push_back(best->name);
    for (const Family& family : families_) {
      if (&family == best || !fits(family)) continue;
      roles_.other_families.push_back(family.name);
      const bool position = role == Role::kPosition;
      if (!position && role != Role::kVelocity) continue;
      (position ? roles_.other_positions : roles_.other_velocities)
          .push_back({family.name, member_columns(family), family.of_motor});
    }
    return member_columns(*best);
  }

  std::vector<std::string> largest_of(std::initializer_list<Role> roles) const {
    const Family* largest = nullptr;
    for (const Family& family : families_) {
      if (std::find(roles.begin(), roles.end(), family.role) == roles.end()) continue;
      if (largest == nullptr || family.members.size() > largest->members.size()) largest = &family;
    }
    return largest == nullptr ? std::vector<std::string>() : member_columns(*largest);
  }

  const std::vector<Family>& families_;
  std::size_t joints_;
  Roles roles_;
  std::string holder_;  // of the positions
  std::vector<std::string> words_;
};

// "T1", "T_a", "O_T_EE[0]", and neither "t_ms" nor "rec.t".
bool is_letter_among_others(const std::string& name) {
  bool has_letter = false;
  bool has_others = false;
  for (const std::string& word : other_words(name.substr(holder_of(name).size()))) {
    if (word == "t") {
      has_letter = true;
    } else if (guess_of(word).role == Role::kTime) {
      return false;
    } else {
      has_others = true;
    }
  }
  return has_letter && (has_others || guess_of(name).number >= 0);
}

// Names of those that have a column for each joint.
std::vector<std::string> names_of(const std::vector<Family>& families, std::size_t joints) {
  std::vector<std::string> names;
  for (const Family& family : families) {
    if (family.members.size() == joints) names.push_back(family.name);
  }
  return names;
}

}  // namespace

std::optional<std::string> time_in(const std::vector<NamedColumn>& columns,
                                   const std::vector<std::string>& position) {
  const std::string holder = position.empty() ? "" : holder_of(position[0]);
  const auto rank_of = [&](const NamedColumn& column) {
    return std::tuple(!column.ascends, is_letter_among_others(column.name),
                      holder_of(column.name) != holder, words_in(column.name).size());
  };
  const NamedColumn* time = nullptr;
  for (const NamedColumn& column : columns) {
    if (guess_of(column.name, column.said_unit).role != Role::kTime) continue;
    if (!column.ascends && is_letter_among_others(column.name)) continue;
    if (time == nullptr || rank_of(column) < rank_of(*time)) time = &column;
  }
  return time == nullptr ? std::nullopt : std::optional(time->name);
}

Roles roles_of(const std::vector<NamedColumn>& columns, const ExpectedJoints& expected) {
  std::vector<Family> numbered = numbered_families(columns);
  const std::vector<Family> not_measured = take_not_measured(numbered);
  const ByName by_name = usable_by_name(columns, numbered, expected);
  const std::size_t joints =
      expected.count > 0 ? static_cast<std::size_t>(expected.count) : joints_of(numbered);
  Roles roles = Chooser(numbered, joints).choose();
  roles.not_measured = names_of(not_measured, joints);
  std::size_t named_joints = joints;
  if (expected.count == 0) {
    for (const Family& family : by_name.families) {
      named_joints = std::max(named_joints, family.members.size());
    }
  }
  // More joints by name than by number, or all of the robot's by name.
  const bool lacks = roles.position.empty() || roles.torque.empty();
  if (!by_name.families.empty() && (lacks || named_joints > joints || by_name.in_robots_order)) {
    Roles named = Chooser(by_name.families, named_joints).choose();
    if (!named.position.empty() || roles.position.empty()) {
      roles = std::move(named);
      roles.not_measured = names_of(by_name.not_measured, named_joints);
      roles.order = by_name.in_robots_order ? "joints by their names, in the robot's order"
                                            : "joints by their names, in the order of the columns";
    }
  }
  roles.time = time_in(columns, roles.position);
  return roles;
}

}  // namespace offnominal::desk
