#include "robot/read_joint.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "common/number.hpp"
#include "robot/geometry.hpp"

namespace offnominal::desk {
namespace {

constexpr std::array<double, 3> kZero{0, 0, 0};

std::array<double, 3> vector_of(const TomlTable& table, const std::string& key,
                                const NumberRule& rule) {
  const std::vector<double> values = table.numbers(key, rule, 3, 3);
  return {values[0], values[1], values[2]};
}

std::array<double, 3> axis_of(const TomlTable& table) {
  const std::array<double, 3> found = vector_of(table, "axis", any_number(""));
  const auto axis = unit_vector(found);
  if (!axis) {
    table.refuse("axis", "a vector of length " + shortest(std::hypot(found[0], found[1], found[2])),
                 "a vector of length 1 (within 1e-6)", "divide the vector by its length");
  }
  return *axis;
}

std::array<double, 9> rotation_of(const TomlTable& table) {
  if (table.has("rpy_rad") && table.has("rotation")) {
    table.refuse("rotation", "rotation beside rpy_rad", "one of them", "remove one");
  }
  if (table.has("rotation")) {
    const auto rows = table.rows("rotation", any_number(""), 3, 3, 3);
    std::array<double, 9> found{};
    for (std::size_t i = 0; i < 9; ++i) found[i] = rows[i / 3][i % 3];
    const auto rotation = nearest_rotation(found);
    if (!rotation) {
      table.refuse("rotation", "a matrix that is no rotation",
                   "rows of length 1 at right angles (within 1e-6), determinant +1",
                   "check the matrix, or give rpy_rad");
    }
    return *rotation;
  }
  if (!table.has("rpy_rad")) return Joint<double>{}.rotation;
  NumberRule rule = any_number("rad");
  rule.max = kMostAngleRad;
  rule.min = -rule.max;
  rule.mend = "give radians: degrees times pi/180";
  return rotation_of_rpy(vector_of(table, "rpy_rad", rule));
}

std::array<double, 6> inertia_of(const TomlTable& link) {
  const std::vector<std::string> keys{"xx", "yy", "zz", "xy", "xz", "yz"};
  const auto table = link.optional_table("inertia_kg_m2", keys);
  std::array<double, 6> inertia{};
  if (!table) return inertia;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const NumberRule rule = physical(any_number("kg m^2"));
    inertia[i] = i < 3 ? table->number(keys[i], rule) : table->number(keys[i], rule, 0);
  }
  const std::string fault = inertia_fault(inertia);
  if (!fault.empty()) {
    link.refuse("inertia_kg_m2", fault,
                "a positive definite tensor about the centre of mass whose principal moments are "
                "each at most the sum of the others; all zero for a point mass",
                "check the signs of xy, xz, yz and that the tensor is about the centre of mass");
  }
  return inertia;
}

constexpr const char* kMass = "mass_kg";
constexpr const char* kCentreOfMass = "centre_of_mass_m";

const std::vector<std::string>& link_keys() {
  static const std::vector<std::string> keys{kMass, kCentreOfMass, "inertia_kg_m2"};
  return keys;
}

void read_link(const TomlTable& table, Joint<double>& joint, std::vector<std::string>& blanks) {
  const auto found = table.optional_table("link", link_keys());
  if (!found) {
    blanks.insert(blanks.end(), {kMass, kCentreOfMass});
    return;
  }
  const TomlTable& link = *found;
  if (link.has(kMass)) {
    joint.mass_kg = link.number(kMass, physical(positive("kg", "give the link's mass in kg")));
  } else {
    blanks.emplace_back(kMass);
  }
  if (link.has(kCentreOfMass)) {
    joint.centre_of_mass_m = vector_of(link, kCentreOfMass, physical(any_number("m")));
  } else {
    blanks.emplace_back(kCentreOfMass);
  }
  joint.inertia_kg_m2 = inertia_of(link);
}

void read_limits(const TomlTable& table, Joint<double>& joint) {
  const auto limits = table.optional_table("limits", {"position", "velocity", "torque"});
  if (!limits) return;
  const bool turns = joint.type == JointType::kRevolute;
  if (limits->has("position")) {
    const auto range = limits->numbers("position", any_number(turns ? "rad" : "m"), 2, 2);
    if (!(range[0] < range[1])) {
      limits->refuse("position", "from " + shortest(range[0]) + " to " + shortest(range[1]),
                     "[lower, upper] with lower < upper", "exchange them");
    }
    joint.min_position = range[0];
    joint.max_position = range[1];
  }
  joint.max_velocity =
      limits->number("velocity", positive(turns ? "rad/s" : "m/s"), joint.max_velocity);
  joint.max_torque = limits->number("torque", positive(turns ? "N m" : "N"), joint.max_torque);
}

Encoder encoder_of(const TomlTable& table, JointType type) {
  Encoder encoder;
  const auto found = table.optional_table("encoder", {"bits", "counts_per_unit"});
  if (!found) return encoder;
  if (found->has("bits") == found->has("counts_per_unit")) {
    found->refuse("", found->has("bits") ? "both keys" : "no key", "either bits or counts_per_unit",
                  "give one of them, or remove the table where nothing is known");
  }
  if (found->has("counts_per_unit")) {
    encoder.counts_per_unit =
        found->number("counts_per_unit", positive(type == JointType::kRevolute ? "1/rad" : "1/m"));
    return encoder;
  }
  if (type == JointType::kPrismatic) {
    found->refuse("bits", "bits of a turn on a prismatic joint", "counts_per_unit",
                  "give the counts per metre");
  }
  const auto bits = static_cast<int>(found->integer("bits", 1, kMaxEncoderBits));
  encoder.counts_per_unit = counts_per_rad(bits);
  return encoder;
}

}  // namespace

double counts_per_rad(int bits) { return std::ldexp(1.0, bits) / (2 * std::numbers::pi); }

const std::vector<std::string>& joint_keys() {
  static const std::vector<std::string> keys{"name",    "type",     "axis",   "origin_m",
                                             "rpy_rad", "rotation", "source", "link",
                                             "limits",  "encoder",  "control"};
  return keys;
}

RobotJoint read_joint(const TomlTable& table, std::vector<std::string>& blanks) {
  RobotJoint result;
  result.name = table.text("name");
  result.joint.type = table.choice("type", {"revolute", "prismatic"}) == 0 ? JointType::kRevolute
                                                                           : JointType::kPrismatic;
  result.joint.axis = axis_of(table);
  result.joint.origin_m =
      table.has("origin_m") ? vector_of(table, "origin_m", physical(any_number("m"))) : kZero;
  result.joint.rotation = rotation_of(table);
  result.source = table.text_or_empty("source");
  read_link(table, result.joint, blanks);
  read_limits(table, result.joint);
  result.encoder = encoder_of(table, result.joint.type);
  if (const auto control = table.optional_table("control", {"kp_per_s2", "kd_per_s"})) {
    result.kp = control->number("kp_per_s2", not_negative("1/s^2"));
    result.kd = control->number("kd_per_s", not_negative("1/s"));
  }
  if (const Status status = validate(result.joint); status != Status::kOk) {
    table.refuse("", std::string("a joint that the core refuses: ") + name_of(status),
                 "a joint that validate() accepts", "see docs/troubleshooting.md");
  }
  return result;
}

void refuse_blank(const TomlTable& joint, const std::string& key, std::size_t others) {
  const std::string more = others == 0 ? ""
                                       : fmt::format(" (and {} more blank{} in this file)", others,
                                                     others == 1 ? "" : "s");
  joint.table("link", link_keys())
      .refuse(
          key, "nothing: the key is missing" + more,
          key == "mass_kg" ? "a finite number > 0, in kg" : "a list of 3 finite numbers, in m",
          fmt::format(
              "add `{}` to {}: from CAD, a data sheet or scales; or let `offnominal identify` find "
              "the links' numbers in recordings",
              key, joint.path_of("link")));
}

}  // namespace offnominal::desk
