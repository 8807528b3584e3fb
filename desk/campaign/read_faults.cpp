#include "campaign/read_faults.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "common/number.hpp"

namespace offnominal::desk::campaign {
namespace {

constexpr std::size_t kMostSizes = 1000;

// Which sizes a kind may have.
NumberRule rule_of(FaultKind kind) {
  const std::string unit = info_of(kind).unit;
  NumberRule rule = positive(unit);
  rule.max = 1000;
  if (kind == FaultKind::kTorqueLost) rule.max = 1;
  if (kind == FaultKind::kOffset || kind == FaultKind::kEncoderJump) {
    rule = any_number(unit);
    rule.largest = 1000;
    rule.min = -1000;
    rule.max = 1000;
  }
  return rule;
}

void refuse_key(const TomlTable& table, const char* key, FaultKind kind) {
  if (!table.has(key)) return;
  table.refuse(key, std::string("a key that ") + info_of(kind).name + " does not have",
               "keys of that kind (docs/campaigns.md)", "leave it out");
}

std::vector<double> read_sizes(const TomlTable& table, FaultKind kind) {
  if (*info_of(kind).unit == '\0') {
    refuse_key(table, "sizes", kind);
    return {0};
  }
  std::vector<double> sizes = table.numbers("sizes", rule_of(kind), 1, kMostSizes);
  for (const double size : sizes) {
    if (size == 0) table.refuse("sizes", "0", "sizes of a fault", "fault-free runs are in [runs]");
  }
  std::sort(sizes.begin(), sizes.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (std::adjacent_find(sizes.begin(), sizes.end()) != sizes.end()) {
    table.refuse("sizes", "one size twice", "sizes that differ", "leave one of them out");
  }
  return sizes;
}

// From 0.
std::vector<int> read_joints(const TomlTable& table, const toml::table& raw, FaultKind kind,
                             int joints) {
  const bool is_push = kind == FaultKind::kPush;
  refuse_key(table, is_push ? "joint" : "link", kind);
  if (kind == FaultKind::kPayload) {
    refuse_key(table, "joint", kind);
    return {joints - 1};
  }
  const char* const key = is_push ? "link" : "joint";
  if (!raw.contains(key) || !raw[key].is_string()) {
    return {static_cast<int>(table.integer(key, 1, joints)) - 1};
  }
  static_cast<void>(table.choice(key, {"each"}));
  std::vector<int> each;
  for (int joint = 0; joint < joints; ++joint) each.push_back(joint);
  return each;
}

std::array<double, 3> triple(const std::vector<double>& values) {
  return {values[0], values[1], values[2]};
}

void read_push(const TomlTable& table, Fault& fault) {
  NumberRule lasts = positive("s");
  lasts.max = 3600;
  fault.lasts_s = table.number("lasts_s", lasts, 0.2);
  fault.place_m = {0, 0, 0.05};
  if (!table.has("direction")) return;
  const std::vector<double> given = table.numbers("direction", any_number("1"), 3, 3);
  const Eigen::Vector3d direction(given[0], given[1], given[2]);
  if (!(direction.norm() > 1e-9)) {
    table.refuse("direction", "no direction", "three numbers that are not all 0", "");
  }
  const Eigen::Vector3d unit = direction.normalized();
  fault.direction = {unit.x(), unit.y(), unit.z()};
}

Fault read_shape(const TomlTable& table, FaultKind kind, const Campaign& campaign) {
  Fault fault;
  fault.kind = kind;
  if (kind == FaultKind::kPush) {
    if (campaign.plant.kind != PlantKind::kMujoco) {
      table.refuse("kind", "push, on a plant of the robot file's own rigid body",
                   "push with [plant] kind = \"mujoco\"", "take offset instead");
    }
    read_push(table, fault);
  } else {
    refuse_key(table, "lasts_s", kind);
    refuse_key(table, "direction", kind);
  }
  if (kind == FaultKind::kPayload) {
    fault.place_m = campaign.truth.joints.back().joint.centre_of_mass_m;
  }
  const bool has_place = kind == FaultKind::kPush || kind == FaultKind::kPayload;
  if (!has_place) refuse_key(table, "place_m", kind);
  if (has_place && table.has("place_m")) {
    fault.place_m = triple(table.numbers("place_m", any_number("m"), 3, 3));
  }
  return fault;
}

void require_own_friction(const TomlTable& table, const Campaign& campaign, int joint) {
  if (own_friction_nm(campaign.truth, joint) > 0) return;
  table.refuse("joint", "joint " + std::to_string(joint + 1) + " without Coulomb friction",
               "joints with coulomb_friction in the robot file of the plant",
               "take kind = \"friction\" with sizes in N m");
}

}  // namespace

std::vector<Fault> read_faults(const TomlTable& root, const toml::table& document,
                               const Campaign& campaign) {
  std::vector<std::string> names;
  for (const FaultKindInfo& info : kFaultKinds) names.emplace_back(info.name);
  const std::vector<std::string> keys{"kind",    "joint",   "link",     "sizes",
                                      "place_m", "lasts_s", "direction"};
  std::vector<Fault> faults;
  const std::vector<TomlTable> tables = root.tables("fault", keys);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const TomlTable& table = tables[i];
    const toml::table& raw = *document["fault"][i].as_table();
    const auto kind = static_cast<FaultKind>(table.choice("kind", names));
    Fault fault = read_shape(table, kind, campaign);
    const std::vector<double> sizes = read_sizes(table, kind);
    for (const int joint : read_joints(table, raw, kind, campaign.truth.joint_count())) {
      if (kind == FaultKind::kFrictionShare) require_own_friction(table, campaign, joint);
      for (const double size : sizes) {
        fault.joint = joint;
        fault.size = size;
        const bool is_there = std::any_of(faults.begin(), faults.end(), [&](const Fault& other) {
          return other.kind == kind && other.joint == joint && other.size == size;
        });
        if (is_there) {
          table.refuse("", "a fault that another [[fault]] has too: the same kind, joint and size",
                       "each fault once", "leave one of them out");
        }
        faults.push_back(fault);
      }
    }
  }
  return faults;
}

double own_friction_nm(const RobotDescription& robot, int joint) {
  double level = 0;
  for (const RobotEffect& effect : robot.effects) {
    const bool is_own = effect.kind == EffectKind::kCoulombFriction && effect.joint == joint;
    if (is_own && !effect.of_motor) level += effect.parameters[0];
  }
  return level;
}

}  // namespace offnominal::desk::campaign
