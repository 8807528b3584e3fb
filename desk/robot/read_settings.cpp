#include "robot/read_settings.hpp"

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

// Of joints whose bound depends on their speed; returns which.
std::vector<bool> read_over_speed(const TomlTable& table, std::vector<JointBoundSettings>& joints) {
  std::vector<bool> given(joints.size());
  for (const TomlTable& of_joint : table.tables("over_speed", {"joint", "at", "value"})) {
    const auto number = of_joint.integer("joint", 1, static_cast<std::int64_t>(joints.size()));
    const auto joint = static_cast<std::size_t>(number - 1);
    if (given[joint]) {
      of_joint.refuse("joint", "joint " + std::to_string(number) + " a second time",
                      "one table per joint", "make one table of them");
    }
    given[joint] = true;
    joints[joint].at = of_joint.numbers("at", physical(not_negative("rad/s or m/s")), 2,
                                        static_cast<std::size_t>(kMaxJointBoundPoints));
    require_rising(of_joint, joints[joint].at);
    joints[joint].value = of_joint.numbers("value", physical(positive("N m or N")),
                                           joints[joint].at.size(), joints[joint].at.size());
  }
  return given;
}

std::vector<JointBoundSettings> read_joint_bounds(const TomlTable& table, std::size_t count) {
  std::vector<JointBoundSettings> joints(count);
  const std::vector<double> values =
      table.numbers("value", physical(not_negative("N m or N")), count, count);
  const std::vector<bool> over_speed = read_over_speed(table, joints);
  for (std::size_t i = 0; i < count; ++i) {
    if (over_speed[i] != (values[i] == 0)) {
      table.refuse("value", shortest(values[i]) + " for joint " + std::to_string(i + 1),
                   over_speed[i] ? "0, as over_speed has this joint's values" : "a number above 0",
                   over_speed[i]
                       ? "write 0, or remove the joint's table from over_speed"
                       : "give the bound in N m or N, or the joint's table in over_speed");
    }
    if (!over_speed[i]) joints[i].value = {values[i]};
  }
  if (!table.has("momentum_error")) return joints;
  const std::vector<double> errors =
      table.numbers("momentum_error", physical(not_negative("N m s or N s")), count, count);
  for (std::size_t i = 0; i < count; ++i) joints[i].momentum_error = errors[i];
  return joints;
}

// Refuses the keys that belong to another kind of bound.
void refuse_keys_other_than(const TomlTable& table, const std::vector<std::string>& own,
                            const std::string& kind) {
  std::vector<std::string> allowed{"kind", "source"};
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
      "space",         "isolation",     "source"};
  return keys;
}

const std::vector<std::string>& arming_keys() {
  static const std::vector<std::string> keys{"position_window", "speed", "torque_rate", "ramp_s",
                                             "source"};
  return keys;
}

const std::vector<std::string>& bound_keys() {
  static const std::vector<std::string> keys{
      "kind",     "source", "value", "scale",          "offset",     "matrix",
      "variable", "joint",  "at",    "velocity_error", "over_speed", "momentum_error"};
  return keys;
}

EstimatorSettings read_estimator(const TomlTable& table) {
  EstimatorSettings settings;
  settings.period_s = table.number(
      "period_s", positive("s", "give the length of a control tick in s"), settings.period_s);
  settings.alpha = table.number(
      "alpha_per_s", positive("1/s", "give the pole of the filter 1/(s + alpha)"), settings.alpha);
  const double pole_per_tick = settings.alpha * settings.period_s;
  if (pole_per_tick > kMaxPolePerTick) {
    table.refuse(table.has("alpha_per_s") ? "alpha_per_s" : "period_s",
                 "alpha_per_s * period_s = " + shortest(pole_per_tick),
                 "at most " + shortest(kMaxPolePerTick) +
                     ", beyond it a step of period_s no longer follows the filter",
                 "lower alpha_per_s to " + shortest(kMaxPolePerTick / settings.period_s) +
                     ", or shorten period_s");
  }
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
      refuse_keys_other_than(table, {"value", "over_speed", "momentum_error"}, "per_joint");
      bound.joints = read_joint_bounds(table, joints);
      break;
  }
  bound.velocity_error =
      table.number("velocity_error", physical(not_negative("rad/s or m/s")), bound.velocity_error);
  bound.source = table.text_or_empty("source");
  return bound;
}

}  // namespace offnominal::desk
