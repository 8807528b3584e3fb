#include "robot/read_settings.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <offnominal/diagnosis/bound.hpp>
#include <offnominal/diagnosis/estimator_config.hpp>
#include <offnominal/diagnosis/joint_bound.hpp>

#include "common/nearest.hpp"
#include "common/number.hpp"
#include "robot/bound_names.hpp"

namespace offnominal::desk {
namespace {

void require_rising(const TomlTable& table, const std::vector<double>& at) {
  for (std::size_t i = 1; i < at.size(); ++i) {
    if (at[i] > at[i - 1]) continue;
    table.refuse("at", shortest(at[i]) + " after " + shortest(at[i - 1]), "strictly rising numbers",
                 "sort the points, and their values with them");
  }
}

constexpr std::array kTableVariables{BoundVariable::kPosition, BoundVariable::kSpeed,
                                     BoundVariable::kTorque};

NumberRule rule_of(BoundVariable variable) {
  switch (variable) {
    case BoundVariable::kPosition:
      return any_number("rad or m");
    case BoundVariable::kSpeed:
      return not_negative("rad/s or m/s");
    case BoundVariable::kTorque:
      break;
  }
  return not_negative("N m or N");
}

// Of joints whose bound depends on that variable of theirs; notes which in `given`.
void read_tables_over(BoundVariable variable, const TomlTable& table,
                      std::vector<JointBoundSettings>& joints, std::vector<bool>& given) {
  for (const TomlTable& of_joint :
       table.tables(key_of_tables(variable), {"joint", "at", "value"})) {
    const auto number = of_joint.integer("joint", 1, static_cast<std::int64_t>(joints.size()));
    const auto joint = static_cast<std::size_t>(number - 1);
    if (given[joint]) {
      of_joint.refuse("joint", "joint " + std::to_string(number) + " a second time",
                      "one table per joint", "make one table of them");
    }
    given[joint] = true;
    joints[joint].variable = variable;
    joints[joint].at = of_joint.numbers("at", physical(rule_of(variable)), 2,
                                        static_cast<std::size_t>(kMaxJointBoundPoints));
    require_rising(of_joint, joints[joint].at);
    joints[joint].value = of_joint.numbers("value", physical(positive("N m or N")),
                                           joints[joint].at.size(), joints[joint].at.size());
  }
}

// Of one filter.
std::vector<JointBoundSettings> read_joint_bounds(const TomlTable& table, std::size_t count) {
  std::vector<JointBoundSettings> joints(count);
  const std::vector<double> values =
      table.numbers("value", physical(not_negative("N m or N")), count, count);
  std::vector<bool> has_table(count);
  for (const BoundVariable variable : kTableVariables) {
    read_tables_over(variable, table, joints, has_table);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (has_table[i] != (values[i] == 0)) {
      table.refuse("value", shortest(values[i]) + " for joint " + std::to_string(i + 1),
                   has_table[i] ? "0, as a table has this joint's values" : "a number above 0",
                   has_table[i] ? "write 0, or remove the joint's table from over_position, "
                                  "over_speed or over_torque"
                                : "give the bound in N m or N, or the joint's table in over_speed, "
                                  "over_position or over_torque");
    }
    if (!has_table[i]) joints[i].value = {values[i]};
  }
  if (!table.has("act_ratio")) return joints;
  NumberRule at_least_one = any_number("");
  at_least_one.min = 1;
  const std::vector<double> ratios =
      table.numbers("act_ratio", physical(at_least_one), count, count);
  for (std::size_t i = 0; i < count; ++i) joints[i].act_ratio = ratios[i];
  return joints;
}

// What the bounds of every filter have.
const std::vector<std::string>& joint_bound_keys() {
  static const std::vector<std::string> keys{"value", "over_position", "over_speed", "over_torque",
                                             "act_ratio"};
  return keys;
}

std::vector<std::string> per_joint_keys() {
  std::vector<std::string> keys = joint_bound_keys();
  keys.insert(keys.end(), {"momentum_error", "fast"});
  return keys;
}

void read_per_joint(const TomlTable& table, std::size_t count, BoundSettings& bound) {
  bound.joints = read_joint_bounds(table, count);
  if (table.has("momentum_error")) {
    const std::vector<double> errors =
        table.numbers("momentum_error", physical(not_negative("N m s or N s")), count, count);
    for (std::size_t i = 0; i < count; ++i) bound.joints[i].momentum_error = errors[i];
  }
  if (const auto fast = table.optional_table("fast", joint_bound_keys())) {
    bound.fast = read_joint_bounds(*fast, count);
  }
}

// Refuses the keys that belong to another kind of bound.
void refuse_keys_other_than(const TomlTable& table, const std::vector<std::string>& own,
                            const std::string& kind) {
  std::vector<std::string> allowed{"kind", "source", "covers_velocities"};
  if (kind != "per_joint") allowed.emplace_back("velocity_error");
  allowed.insert(allowed.end(), own.begin(), own.end());
  for (const std::string& key : bound_keys()) {
    bool known = false;
    for (const std::string& name : allowed) known = known || name == key;
    if (table.has(key) && !known) {
      table.refuse(key, "a key that a bound of kind " + kind + " does not have", list_of(allowed),
                   "remove it, or change kind");
    }
  }
}

TableBoundSettings read_table_bound(const TomlTable& table, int joint_count) {
  TableBoundSettings bound;
  std::vector<std::string> variables;
  for (const BoundVariableName& variable : kBoundVariableNames)
    variables.emplace_back(variable.name);
  bound.variable = static_cast<BoundVariable>(table.choice("variable", variables));
  bound.joint = static_cast<int>(table.integer("joint", 1, joint_count)) - 1;
  bound.at = table.numbers("at", physical(any_number("")), 1, kMaxTablePoints);
  require_rising(table, bound.at);
  bound.value = table.numbers("value", physical(positive("rad/s^2 or m/s^2")), bound.at.size(),
                              bound.at.size());
  return bound;
}

// Refuses a pole that a step of period_s no longer follows.
void require_followed(const TomlTable& table, const std::string& key, double alpha,
                      double period_s) {
  const double pole_per_tick = alpha * period_s;
  if (pole_per_tick <= kMaxPolePerTick) return;
  table.refuse(
      table.has(key) ? key : "period_s", key + " * period_s = " + shortest(pole_per_tick),
      "at most " + shortest(kMaxPolePerTick) +
          ", beyond it a step of period_s no longer follows the filter",
      "lower " + key + " to " + shortest(kMaxPolePerTick / period_s) + ", or shorten period_s");
}

void read_fast_alpha(const TomlTable& table, EstimatorSettings& settings) {
  const std::string key = "fast_alpha_per_s";
  if (!table.has(key)) return;
  settings.fast_alpha =
      table.number(key, positive("1/s",
                                 "give the pole of a second, faster filter, or leave it "
                                 "out"));
  if (settings.space != EstimatorSpace::kTorque) {
    table.refuse(key, "a second filter beside a monitor that judges all joints by one norm",
                 "none, or estimator.space = \"torque\"",
                 "set estimator.space to \"torque\", or leave " + key + " out");
  }
  if (settings.fast_alpha <= settings.alpha) {
    table.refuse(key, shortest(settings.fast_alpha),
                 "above alpha_per_s, which is " + shortest(settings.alpha),
                 "give the faster pole here and the slower one in alpha_per_s");
  }
  require_followed(table, key, settings.fast_alpha, settings.period_s);
}

// A kind of the other space is read all the same: what does not go together is said of both keys
// (robot_file.cpp).
BoundSettings::Kind read_kind(const TomlTable& table, EstimatorSpace space) {
  using Kind = BoundSettings::Kind;
  static const std::vector<std::string> kKinds(kBoundKindNames.begin(), kBoundKindNames.end());
  const std::string found = table.text_or_empty("kind");
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (found == kKinds[i]) return static_cast<Kind>(i);
  }
  const std::vector<std::string> of_accelerations(kKinds.begin(), kKinds.end() - 1);
  const std::vector<std::string> of_torques(kKinds.end() - 1, kKinds.end());
  const bool in_torque = space == EstimatorSpace::kTorque;
  return static_cast<Kind>(table.choice("kind", in_torque ? of_torques : of_accelerations));
}

}  // namespace

const std::vector<std::string>& estimator_keys() {
  static const std::vector<std::string> keys{
      "period_s",      "alpha_per_s",   "hidden_units",
      "learning_rate", "weight_radius", "initial_weight_range",
      "seed",          "dead_zone",     "torque_signal",
      "space",         "isolation",     "fast_alpha_per_s",
      "source"};
  return keys;
}

const std::vector<std::string>& arming_keys() {
  static const std::vector<std::string> keys{"position_window", "speed", "torque_rate", "ramp_s",
                                             "source"};
  return keys;
}

const std::vector<std::string>& bound_keys() {
  static const std::vector<std::string> keys{
      "kind",           "source",           "value",      "scale",       "offset",
      "matrix",         "variable",         "joint",      "at",          "velocity_error",
      "momentum_error", "over_position",    "over_speed", "over_torque", "act_ratio",
      "fast",           "covers_velocities"};
  return keys;
}

EstimatorSettings read_estimator(const TomlTable& table) {
  EstimatorSettings settings;
  settings.period_s = table.number(
      "period_s", positive("s", "give the length of a control tick in s"), settings.period_s);
  settings.alpha = table.number(
      "alpha_per_s", positive("1/s", "give the pole of the filter 1/(s + alpha)"), settings.alpha);
  require_followed(table, "alpha_per_s", settings.alpha, settings.period_s);
  settings.hidden_units =
      static_cast<int>(table.integer("hidden_units", 1, kMaxHiddenUnits, settings.hidden_units));
  settings.learning_rate =
      table.number("learning_rate",
                   physical(not_negative("", "give the rate Gamma; 0 detects without learning")),
                   settings.learning_rate);
  settings.weight_radius =
      table.number("weight_radius",
                   physical(positive("", "give the radius M of the ball that holds the weights")),
                   settings.weight_radius);
  settings.initial_weight_range =
      table.number("initial_weight_range", physical(positive("")), settings.initial_weight_range);
  settings.seed = static_cast<std::uint32_t>(table.integer(
      "seed", 0, std::numeric_limits<std::uint32_t>::max(), std::int64_t{settings.seed}));
  if (table.has("dead_zone")) {
    settings.dead_zone = table.choice("dead_zone", {"continuous", "discontinuous"}) == 0
                             ? DeadZone::kContinuous
                             : DeadZone::kDiscontinuous;
  }
  if (table.has("torque_signal")) {
    settings.torque_signal = table.choice("torque_signal", {"sampled", "held"}) == 0
                                 ? TorqueSignal::kSampled
                                 : TorqueSignal::kHeld;
  }
  if (table.has("space")) {
    settings.space = table.choice("space", {"acceleration", "torque"}) == 0
                         ? EstimatorSpace::kAcceleration
                         : EstimatorSpace::kTorque;
  }
  read_fast_alpha(table, settings);
  settings.isolation = table.boolean("isolation", false);
  if (settings.isolation && settings.space != EstimatorSpace::kTorque) {
    table.refuse(
        "isolation", "true beside a monitor that judges all joints by one norm",
        "false, or estimator.space = \"torque\"",
        "set estimator.space to \"torque\", which says of each joint what it has, or leave "
        "isolation out");
  }
  settings.source = table.text_or_empty("source");
  return settings;
}

ArmingSettings read_arming(const TomlTable& table, int joint_count) {
  const auto joints = static_cast<std::size_t>(joint_count);
  const auto per_joint = [&](const char* key, const char* unit) {
    if (!table.has(key)) return std::vector<double>{};
    return table.numbers(key, positive(unit), joints, joints);
  };
  ArmingSettings settings;
  settings.position_window = per_joint("position_window", "rad or m");
  settings.speed = per_joint("speed", "rad/s or m/s");
  settings.torque_rate = per_joint("torque_rate", "N m/s or N/s");
  settings.ramp_s = table.number("ramp_s", positive("s"), settings.ramp_s);
  settings.source = table.text_or_empty("source");
  return settings;
}

BoundSettings read_bound(const TomlTable& table, int joint_count, EstimatorSpace space) {
  BoundSettings bound;
  const auto joints = static_cast<std::size_t>(joint_count);
  bound.kind = read_kind(table, space);
  switch (bound.kind) {
    case BoundSettings::Kind::kConstant:
      refuse_keys_other_than(table, {"value"}, "constant");
      bound.constant.value = table.number("value", physical(positive("rad/s^2 or m/s^2")));
      break;
    case BoundSettings::Kind::kScaledNorm:
      refuse_keys_other_than(table, {"scale", "offset", "matrix"}, "scaled_norm");
      bound.scaled_norm.scale = table.number("scale", physical(positive("")));
      bound.scaled_norm.offset = table.number("offset", physical(not_negative("")));
      bound.scaled_norm.matrix = table.rows("matrix", physical(any_number("")), 1, joints, joints);
      break;
    case BoundSettings::Kind::kTable:
      refuse_keys_other_than(table, {"variable", "joint", "at", "value"}, "table");
      bound.table = read_table_bound(table, joint_count);
      break;
    case BoundSettings::Kind::kPerJoint:
      refuse_keys_other_than(table, per_joint_keys(), "per_joint");
      read_per_joint(table, joints, bound);
      break;
  }
  bound.velocity_error =
      table.number("velocity_error", physical(not_negative("rad/s or m/s")), bound.velocity_error);
  bound.covers_velocities = table.boolean("covers_velocities", false);
  bound.source = table.text_or_empty("source");
  return bound;
}

}  // namespace offnominal::desk
