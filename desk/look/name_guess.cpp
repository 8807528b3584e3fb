#include "look/name_guess.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "common/small_letters.hpp"
#include "log/column_values.hpp"
#include "robot/units.hpp"

namespace offnominal::desk {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return in_small_letter(c) >= 'a' && in_small_letter(c) <= 'z'; }

using Words = std::vector<std::string>;

bool any_of(const Words& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

// Long ones also at the end of a word: "jointposition", "Motorstrom".
bool any_ends(const Words& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::any_of(wanted.begin(), wanted.end(),
                       [&](std::string_view ending) { return word.ends_with(ending); });
  });
}

// What was asked for, what acts from outside, what a model says.
bool is_not_measured(const Words& words) {
  return any_of(words, {"ref",       "reference", "des",      "desired",  "target",   "cmd",
                        "command",   "commanded", "goal",     "set",      "setpoint", "demand",
                        "demanded",  "ff",        "ext",      "external", "contact",  "model",
                        "predicted", "gravity",   "coriolis", "residual"}) ||
         std::any_of(words.begin(), words.end(),
                     [](const std::string& word) { return word.starts_with("soll"); });
}

bool is_position_word(std::string_view word) {
  static constexpr std::array<std::string_view, 14> kWords{
      "q",   "pos", "positions", "angle", "angles", "theta",    "thetas",
      "phi", "enc", "encoder",   "qm",    "lage",   "position", "winkel"};
  return std::find(kWords.begin(), kWords.end(), word) != kWords.end();
}

bool begins_with_position(std::string_view word, std::string_view ending) {
  return word.ends_with(ending) && is_position_word(word.substr(0, word.size() - ending.size()));
}
bool is_position_behind(std::string_view word, std::string_view beginning) {
  return word.starts_with(beginning) && is_position_word(word.substr(beginning.size()));
}

// "ddtheta", "thetaddot", "theta_ddot", "theta_dot_dot".
bool says_second_derivative(const Words& words) {
  return std::count(words.begin(), words.end(), "dot") > 1 ||
         std::any_of(words.begin(), words.end(), [](const std::string& word) {
           return word == "ddot" || is_position_behind(word, "dd") ||
                  begins_with_position(word, "ddot") || begins_with_position(word, "dotdot");
         });
}

// What is no value of a joint, or another one of it.
bool is_other(const Words& words) {
  return is_not_measured(words) || says_second_derivative(words) ||
         any_of(words, {"error", "err", "temp", "temperature", "ddq", "qdd", "acc", "acceleration",
                        "limit", "max", "min", "init", "mode", "state", "status", "enabled", "flag",
                        "d1", "d2"});
}

// "thetadot", "dphi", "actvel", and no "level".
bool is_velocity_word(const std::string& word) {
  const bool is_short = word.ends_with("vel") && !word.ends_with("level") && word != "travel";
  return is_short || is_position_behind(word, "d") || begins_with_position(word, "dot");
}
// What makes a velocity of the position beside it: "theta_dot", "angle_rate".
bool is_rate_word(std::string_view word) {
  return word == "dot" || word == "rate" || word == "rates" || word == "punkt";
}

bool says_position(const Words& words) {
  return std::any_of(words.begin(), words.end(), is_position_word) ||
         any_ends(words, {"position", "winkel"});
}
bool says_velocity(const Words& words) {
  return any_of(words, {"qd", "qp", "velo", "velocities", "speeds", "omega", "rpm", "w"}) ||
         any_ends(words, {"velocity", "speed", "geschwindigkeit", "drehzahl"}) ||
         std::any_of(words.begin(), words.end(), is_velocity_word) ||
         (std::any_of(words.begin(), words.end(), is_rate_word) && says_position(words));
}
bool says_torque(const Words& words) {
  return any_of(words, {"tau", "torques", "trq", "tq", "efforts", "force"}) ||
         any_ends(words, {"torque", "effort", "moment"});
}
bool says_current(const Words& words) {
  return any_of(words, {"currents", "cur", "iq", "i", "amp", "amps"}) ||
         any_ends(words, {"current", "strom"});
}

// "torque current", the part of a motor's current that makes its torque.
bool is_torque_current(const Words& words) {
  const auto at = std::find(words.begin(), words.end(), "torque");
  return at != words.end() && at + 1 != words.end() && *(at + 1) == "current";
}

// KUKA's "$AXIS_ACT.A1" and "$AXIS_ACT_MEAS.A1".
bool is_position_of_axis(const Words& words) {
  if (words.size() < 2 || words[0] != "axis" || words[1] != "act") return false;
  return std::all_of(words.begin() + 2, words.end(), [](const std::string& word) {
    return word == "meas" || word == "a" || word == "e" || is_digit(word[0]);
  });
}

// "joint_p", "joint_dp[2]", "joint1_u": letters that say it right behind a joint, and last.
Role role_of_joints_letter(const Words& words) {
  const auto is_number = [](const std::string& word) { return is_digit(word[0]); };
  auto at = std::find_if(words.begin(), words.end(), [](const std::string& word) {
    return word == "joint" || word == "joints";
  });
  if (at == words.end()) return Role::kNone;
  at = std::find_if_not(at + 1, words.end(), is_number);
  if (at == words.end() || !std::all_of(at + 1, words.end(), is_number)) return Role::kNone;
  if (*at == "p") return Role::kPosition;
  if (*at == "v" || *at == "dp") return Role::kVelocity;
  return *at == "u" ? Role::kTorque : Role::kNone;
}

// Whatever became of it.
Role quantity_of(const Words& words) {
  if (says_velocity(words)) return Role::kVelocity;
  if (is_torque_current(words)) return Role::kCurrent;
  if (says_torque(words)) return Role::kTorque;
  // "current position" is the one of now.
  if (any_ends(words, {"position"})) return Role::kPosition;
  if (says_current(words)) return Role::kCurrent;
  if (says_position(words) || is_position_of_axis(words)) return Role::kPosition;
  // A drive's signal in volts, as the EMPS benchmark calls it.
  if (any_of(words, {"vir"})) return Role::kVoltage;
  if (const Role role = role_of_joints_letter(words); role != Role::kNone) return role;
  if (any_of(words,
             {"t", "time", "timestamp", "stamp", "times", "zeit", "sec", "secs", "seconds", "nsec",
              "nsecs", "nanosec", "nanosecs", "clock", "duration", "uhrzeit", "zeitstempel"})) {
    return Role::kTime;
  }
  return Role::kNone;
}

Role role_of(const Words& words) { return is_other(words) ? Role::kNone : quantity_of(words); }

// Of a column that says nothing but its unit. Of time and of voltages there are too many.
Role role_of_unit(const std::string& name) {
  const SourceUnit* const unit = find_unit(name);
  if (unit == nullptr) return Role::kNone;
  switch (unit->dimension) {
    case Dimension::kAngle:
    case Dimension::kLength:
      return Role::kPosition;
    case Dimension::kAngularVelocity:
    case Dimension::kVelocity:
      return Role::kVelocity;
    case Dimension::kTorque:
    case Dimension::kForce:
      return Role::kTorque;
    case Dimension::kCurrent:
      return Role::kCurrent;
    default:
      return Role::kNone;
  }
}

std::string unit_in_brackets(const std::string& name) {
  std::string unit = unit_in_name(name);
  return find_unit(unit) == nullptr ? std::string() : unit;
}

struct UnitEnding {
  std::string_view text;
  std::string_view unit;
};

// That `name`, in small letters, has; null: none.
const UnitEnding* unit_ending_of(const std::string& name) {
  static constexpr std::array<UnitEnding, 20> kEndings{{
      {"_deg_per_s", "deg/s"}, {"_rad_per_s", "rad/s"}, {"_deg_s", "deg/s"}, {"_rad_s", "rad/s"},
      {"_m_s", "m/s"},         {"_mm_s", "mm/s"},       {"_deg", "deg"},     {"_rad", "rad"},
      {"_rpm", "rpm"},         {"_nm", "Nm"},           {"_mnm", "mNm"},     {"_nmm", "Nmm"},
      {"_ncm", "Ncm"},         {"_ms", "ms"},           {"_us", "us"},       {"_ns", "ns"},
      {"_mm", "mm"},           {"_ma", "mA"},           {"_a", "A"},         {"_s", "s"},
  }};
  const auto* const found =
      std::find_if(kEndings.begin(), kEndings.end(),
                   [&](const UnitEnding& ending) { return name.ends_with(ending.text); });
  return found == kEndings.end() ? nullptr : found;
}

// A unit at the name's end: behind an underscore, or in brackets.
std::string unit_of(const std::string& name) {
  std::string text = name;
  // "q_deg(2,:)", "q_deg_2", "q_deg2"
  if (const auto bracket = text.find_last_of('(');
      bracket != std::string::npos &&
      text.find_first_of("0123456789:", bracket) != std::string::npos) {
    text.erase(bracket);
  }
  if (text.size() > 2 && (text.back() == ']' || text.back() == ')')) return unit_in_brackets(text);
  while (!text.empty() && (is_digit(text.back()) || text.back() == '_')) text.pop_back();
  const UnitEnding* const ending = unit_ending_of(in_small_letters(text));
  return ending == nullptr ? std::string() : std::string(ending->unit);
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
    case Role::kVoltage:
      return "voltage";
    case Role::kNone:
      break;
  }
  return "";
}

std::vector<NameWord> words_in(const std::string& name) {
  std::vector<NameWord> words;
  char before = ' ';
  for (std::size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool is_capital = c >= 'A' && c <= 'Z';
    const bool begins = is_digit(c) != is_digit(before) ||
                        !(is_letter(before) || is_digit(before)) ||
                        (is_capital && before >= 'a' && before <= 'z');
    if (is_digit(c) || is_letter(c)) {
      if (begins) words.push_back({"", i, i});
      words.back().text += in_small_letter(c);
      words.back().end = i + 1;
    }
    before = c;
  }
  return words;
}

std::string without_unit(const std::string& name) {
  if (!unit_in_brackets(name).empty()) {
    const std::size_t end = name.find_last_not_of(' ', name.find_last_of("[(") - 1);
    return name.substr(0, end + 1);
  }
  const std::size_t last = name.find_last_not_of("0123456789_#");
  const std::size_t end = last == std::string::npos ? 0 : last + 1;
  const UnitEnding* const ending = unit_ending_of(in_small_letters(name.substr(0, end)));
  if (ending == nullptr) return name;
  return name.substr(0, end - ending->text.size()) + name.substr(end);
}

bool says_quantity(const std::string& word) {
  const Words one{word};
  return says_velocity(one) || says_torque(one) || says_current(one) || says_position(one) ||
         is_rate_word(word);
}

NameGuess guess_of(const std::string& name, const std::string& said_unit) {
  NameGuess guess;
  Words words;
  // The "min" of "[1/min]" is no least value.
  const std::string in_brackets = unit_in_brackets(name);
  const std::size_t said = in_brackets.empty() ? name.size() : name.find_last_of("[(");
  const std::size_t holder = name.find_last_of("./", said);
  for (const NameWord& word : words_in(name.substr(0, said))) {
    // "state.q[0]" is of what is, "gripper_state" of none.
    const bool in_holder = holder != std::string::npos && word.end <= holder;
    if (!(in_holder && word.text == "state")) words.push_back(word.text);
  }
  guess.role = role_of(words);
  guess.unit = said_unit.empty() ? unit_of(name) : said_unit;
  guess.of_motor = any_of(words, {"motor", "motors", "rotor"}) ||
                   std::any_of(words.begin(), words.end(),
                               [](const std::string& word) { return word.starts_with("motor"); });
  if (guess.role == Role::kNone && !is_other(words)) {
    guess.role = role_of_unit(said_unit.empty() ? in_brackets : said_unit);
  }
  // Whatever it is called, amperes are of a current.
  if (const SourceUnit* unit = find_unit(guess.unit);
      guess.role == Role::kTorque && unit != nullptr) {
    if (unit->dimension == Dimension::kCurrent) guess.role = Role::kCurrent;
    if (unit->dimension == Dimension::kVoltage) guess.role = Role::kVoltage;
  }
  if (guess.role == Role::kNone) guess.unit.clear();
  if (is_not_measured(words)) guess.not_measured = quantity_of(words);
  // The last number is the joint's: "axis3_pos", "q[2]", "pos(4,:)".
  std::size_t end = said;
  while (end > 0 && !is_digit(name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(name[begin - 1])) --begin;
  const bool has_number = begin < end && end - begin <= 3;
  guess.number = has_number ? std::stoi(name.substr(begin, end - begin)) : -1;
  guess.family = has_number ? name.substr(0, begin) + "#" + name.substr(end) : name;
  return guess;
}

}  // namespace offnominal::desk
