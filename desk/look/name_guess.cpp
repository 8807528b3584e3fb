#include "look/name_guess.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

char small(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return small(c) >= 'a' && small(c) <= 'z'; }

// Words and numbers of a name in small letters: "rec.actPos_mot(2,:)" has rec, act, pos, mot, 2.
std::vector<std::string> words_of(const std::string& name) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : name) {
    const bool is_capital = c >= 'A' && c <= 'Z';
    const bool begins = is_digit(c) != is_digit(before) ||
                        !(is_letter(before) || is_digit(before)) ||
                        (is_capital && before >= 'a' && before <= 'z');
    if (is_digit(c) || is_letter(c)) {
      if (begins) words.emplace_back();
      words.back() += small(c);
    }
    before = c;
  }
  return words;
}

using Words = std::vector<std::string>;

bool any_of(const Words& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

Role role_of(const Words& words) {
  if (any_of(words,
             {"ref",       "reference",   "des", "desired",  "target", "cmd",          "command",
              "commanded", "goal",        "set", "setpoint", "soll",   "error",        "err",
              "temp",      "temperature", "ddq", "qdd",      "acc",    "acceleration", "limit",
              "max",       "min",         "ff",  "init",     "mode",   "state",        "status",
              "enabled",   "flag",        "d1",  "d2"})) {
    return Role::kNone;
  }
  if (any_of(words, {"dq", "qd", "qdot", "qp", "vel", "velocity", "velocities", "speed", "omega",
                     "rpm", "w"})) {
    return Role::kVelocity;
  }
  if (any_of(words,
             {"tau", "torque", "torques", "trq", "tq", "effort", "efforts", "moment", "force"})) {
    return Role::kTorque;
  }
  if (any_of(words, {"current", "currents", "cur", "iq", "i", "amp", "amps"})) {
    return Role::kCurrent;
  }
  if (any_of(words, {"q", "pos", "position", "positions", "angle", "angles", "theta", "phi",
                     "encoder", "enc", "qm"})) {
    return Role::kPosition;
  }
  if (any_of(words, {"t", "time", "timestamp", "stamp", "times", "zeit", "sec", "secs", "seconds",
                     "secs", "nsec", "clock"})) {
    return Role::kTime;
  }
  return Role::kNone;
}

// A unit at the name's end: behind an underscore, or in brackets.
std::string unit_of(const std::string& name) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 18> kEndings{{
      {"_deg_per_s", "deg/s"},
      {"_rad_per_s", "rad/s"},
      {"_deg_s", "deg/s"},
      {"_rad_s", "rad/s"},
      {"_m_s", "m/s"},
      {"_mm_s", "mm/s"},
      {"_deg", "deg"},
      {"_rad", "rad"},
      {"_rpm", "rpm"},
      {"_nm", "Nm"},
      {"_mnm", "mNm"},
      {"_ms", "ms"},
      {"_us", "us"},
      {"_ns", "ns"},
      {"_mm", "mm"},
      {"_ma", "mA"},
      {"_a", "A"},
      {"_s", "s"},
  }};
  std::string text = name;
  // "q_deg(2,:)", "q_deg_2", "q_deg2"
  if (const auto bracket = text.find_last_of('(');
      bracket != std::string::npos &&
      text.find_first_of("0123456789:", bracket) != std::string::npos) {
    text.erase(bracket);
  }
  if (text.size() > 2 && (text.back() == ']' || text.back() == ')')) {
    const auto open = text.find_last_of("[(");
    if (open == std::string::npos) return {};
    const std::string inner = text.substr(open + 1, text.size() - open - 2);
    return find_unit(inner) == nullptr ? std::string() : inner;
  }
  while (!text.empty() && (is_digit(text.back()) || text.back() == '_')) text.pop_back();
  for (char& c : text) c = small(c);
  for (const auto& [ending, unit] : kEndings) {
    if (text.ends_with(ending)) return std::string(unit);
  }
  return {};
}

struct Family {
  std::string name;
  Role role = Role::kNone;
  std::vector<std::pair<int, std::string>> columns;  // by the joint's number
};

std::vector<Family> families_of(const std::vector<std::string>& names) {
  std::vector<Family> families;
  for (const std::string& name : names) {
    const NameGuess guess = guess_of(name);
    if (guess.role == Role::kNone || guess.role == Role::kTime) continue;
    auto at = std::find_if(families.begin(), families.end(),
                           [&](const Family& family) { return family.name == guess.family; });
    if (at == families.end()) {
      families.push_back({guess.family, guess.role, {}});
      at = families.end() - 1;
    }
    at->columns.emplace_back(guess.number, name);
  }
  for (Family& family : families) std::sort(family.columns.begin(), family.columns.end());
  return families;
}

// What a name stands in: "rec." of "rec.pos(1,:)".
std::string holder_of(const std::string& name) {
  const auto dot = name.find_last_of('.');
  return dot == std::string::npos ? std::string() : name.substr(0, dot + 1);
}

// As many joints as the most families of positions and torques have.
std::size_t joints_of(const std::vector<Family>& families) {
  std::map<std::size_t, int> votes;
  for (const Family& family : families) {
    if (family.role != Role::kVelocity) ++votes[family.columns.size()];
  }
  std::size_t best = 0;
  for (const auto& [joints, count] : votes) {
    if (joints <= static_cast<std::size_t>(kMaxJoints) && (best == 0 || count >= votes[best])) {
      best = joints;
    }
  }
  return best;
}

}  // namespace

const char* name_of(Role role) {
  switch (role) {
    case Role::kTime:
      return "time";
    case Role::kPosition:
      return "position";
    case Role::kVelocity:
      return "velocity";
    case Role::kTorque:
      return "torque";
    case Role::kCurrent:
      return "current";
    case Role::kNone:
      break;
  }
  return "";
}

NameGuess guess_of(const std::string& name) {
  NameGuess guess;
  guess.role = role_of(words_of(name));
  guess.unit = unit_of(name);
  if (guess.role == Role::kNone) guess.unit.clear();
  // The last number is the joint's: "axis3_pos", "q[2]", "pos(4,:)".
  std::size_t end = name.size();
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  const bool has_number = begin < end && end - begin <= 3;
  guess.number = has_number ? std::stoi(name.substr(begin, end - begin)) : -1;
  guess.family = has_number ? name.substr(0, begin) + "#" + name.substr(end) : name;
  return guess;
}

Roles roles_of(const std::vector<std::string>& names, int joints) {
  Roles roles;
  const std::vector<Family> families = families_of(names);
  const std::size_t wanted = joints > 0 ? static_cast<std::size_t>(joints) : joints_of(families);
  std::string holder;
  // The first; one that stands where the positions stand before any other.
  const auto best_of = [&](Role role) {
    const Family* best = nullptr;
    for (const Family& family : families) {
      if (family.role != role || family.columns.size() != wanted) continue;
      if (best == nullptr ||
          (holder_of(best->name) != holder && holder_of(family.name) == holder)) {
        best = &family;
      }
    }
    std::vector<std::string> columns;
    if (best == nullptr) return columns;
    for (const auto& [number, name] : best->columns) columns.push_back(name);
    for (const Family& family : families) {
      if (&family == best || family.role != role || family.columns.size() != wanted) continue;
      roles.other_families.push_back(family.name);
    }
    return columns;
  };
  roles.position = best_of(Role::kPosition);
  if (!roles.position.empty()) holder = holder_of(roles.position[0]);
  roles.velocity = best_of(Role::kVelocity);
  roles.torque = best_of(Role::kTorque);
  if (roles.torque.empty()) {
    roles.torque = best_of(Role::kCurrent);
    roles.torque_is_current = !roles.torque.empty();
  }
  for (const std::string& name : names) {
    if (guess_of(name).role != Role::kTime) continue;
    if (!roles.time || (holder_of(*roles.time) != holder && holder_of(name) == holder)) {
      roles.time = name;
    }
  }
  return roles;
}

}  // namespace offnominal::desk
