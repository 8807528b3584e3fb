#include "exchange/import_urdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <offnominal/model/effects/friction.hpp>
#include <optional>
#include <string>
#include <utility>

#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/nearest.hpp"
#include "common/number.hpp"
#include "exchange/rigid_body.hpp"
#include "exchange/urdf_chain.hpp"
#include "robot/geometry.hpp"

namespace offnominal::desk::exchange {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Kind = ImportNote::Kind;

Vector3d vector_of(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Isometry3d placement_of(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  Isometry3d placement = Isometry3d::Identity();
  placement.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  placement.translation() = vector_of(pose.position);
  return placement;
}

bool turns(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS;
}

// Where a joint outside the chain is held: at 0, or as near to it as its range allows.
double held_position(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::CONTINUOUS || joint.limits == nullptr) return 0;
  const auto [lower, upper] = std::pair(joint.limits->lower, joint.limits->upper);
  return lower < upper ? std::clamp(0.0, lower, upper) : 0;
}

class Importer {
 public:
  Importer(const UrdfDocument& document, UrdfChain chain, InertiaRule inertia)
      : document_(document), chain_(std::move(chain)), inertia_(inertia) {}

  ImportedRobot run(const ChainRequest& request) {
    result_.base = chain_.base->name;
    result_.tip = chain_.tip->name;
    result_.request = request;
    RobotDescription& robot = result_.robot;
    name_robot(robot);
    say_what_was_chosen(request);
    robot.gravity_m_s2 = gravity();
    note(Kind::kAssumed, 0, "the link `world`, which joints name, is the ground",
         document_.has_implied_world);
    say_what_names_lost();
    Isometry3d next = stand_on_base();
    for (std::size_t i = 0; i < chain_.moving.size(); ++i) next = add_joint(i, next);
    for (const auto& [what, entry] : document_.elements.left_out) {
      note(Kind::kLeftOut, entry.line,
           entry.times == 1 ? what : fmt::format("{}, {} times", what, entry.times));
    }
    if (!robot.effects.empty()) {
      note(Kind::kAssumed, 0,
           fmt::format("friction changes its sign over {} rad/s or m/s, the default of `smoothing`",
                       shortest(effects::CoulombFriction::kParameters[1].default_value)),
           any_dry_);
    }
    std::stable_sort(result_.notes.begin(), result_.notes.end(),
                     [](const ImportNote& a, const ImportNote& b) {
                       return std::pair(a.kind, a.line) < std::pair(b.kind, b.line);
                     });
    return std::move(result_);
  }

 private:
  struct Stop {  // a link on the way through what hangs together, in the frame of the first one
    urdf::LinkConstSharedPtr link;
    Isometry3d place;
  };

  void note(Kind kind, int line, std::string text, bool when = true) {
    if (when) result_.notes.push_back({kind, line, std::move(text)});
  }
  int line_of(const urdf::Link& link) const { return document_.elements.link_lines.at(link.name); }
  int line_of(const urdf::Joint& joint) const { return document_.joint(joint.name).line; }

  [[noreturn]] void refuse(const std::string& place, const std::string& found,
                           const std::string& allowed, const std::string& mend) const {
    throw InputError({document_.file, place, found, allowed, mend});
  }
  [[noreturn]] void refuse_joint(const urdf::Joint& joint, const std::string& found,
                                 const std::string& allowed, const std::string& mend) const {
    refuse(document_.joint_place(joint.name), found, allowed, mend);
  }

  void name_robot(RobotDescription& robot) {
    robot.name = document_.elements.robot_name;
    if (robot.name.empty()) {
      robot.name = as_utf8(std::filesystem::path(input_name(document_.file)).stem().string());
      if (robot.name.empty()) robot.name = "robot";
      note(Kind::kAssumed, 0,
           fmt::format("the name `{}`, the file's: <robot> has none", robot.name));
    }
    robot.source = fmt::format("URDF {}, from {} to {}", as_utf8(input_name(document_.file)),
                               chain_.base->name, chain_.tip->name);
  }

  // Of links and joints that `is_so` is true of, the first with its line and how many more there
  // are, in words; none where there are none.
  template <typename IsSo>
  std::optional<std::pair<int, std::string>> names_that(const IsSo& is_so) const {
    std::vector<std::pair<int, std::string>> all;
    for (const auto& [name, line] : document_.elements.link_lines) {
      if (is_so(name)) all.emplace_back(line, name);
    }
    for (const auto& joint : document_.elements.joints) {
      if (is_so(joint.name)) all.emplace_back(joint.line, joint.name);
    }
    if (all.empty()) return std::nullopt;
    const auto& [line, name] = *std::min_element(all.begin(), all.end());
    const std::string more = all.size() > 1 ? fmt::format(" and {} more", all.size() - 1) : "";
    return std::pair(line, fmt::format("`{}`{}", name, more));
  }

  // What read_urdf_elements() made of bytes that are no UTF-8.
  void say_what_names_lost() {
    // What it puts in the place of those that it cannot read.
    const auto lost = names_that(
        [](const std::string& name) { return name.find("\xEF\xBF\xBD") != std::string::npos; });
    if (lost) {
      note(Kind::kAssumed, lost->first,
           fmt::format("U+FFFD for bytes that are no UTF-8 in the name {}: saved in UTF-8 the file "
                       "keeps them",
                       lost->second));
    }
    if (document_.elements.assumed_encoding_line == 0) return;
    const auto read = names_that([](const std::string& name) {
      return std::any_of(name.begin(), name.end(), [](unsigned char c) { return c > 0x7f; });
    });
    if (!read) return;
    note(Kind::kAssumed, read->first,
         fmt::format(
             "Windows-1252 (Latin-1), since the file is no UTF-8 and declares nothing else, "
             "in the name {}: declare its encoding, or save it in UTF-8, where that is wrong",
             read->second));
  }

  void say_what_was_chosen(const ChainRequest& request) {
    note(Kind::kAssumed, line_of(*chain_.base),
         fmt::format("base `{}`: the root", chain_.base->name), !request.base);
    note(Kind::kAssumed, line_of(*chain_.tip),
         fmt::format("tip `{}`: the only chain of moving joints ends in it", chain_.tip->name),
         !request.tip);
    const std::size_t above = links_above_base();
    note(Kind::kLeftOut, line_of(*chain_.base),
         fmt::format("{} {} between the root and the base `{}`, which is taken to stand still",
                     above, above == 1 ? "link" : "links", chain_.base->name),
         above > 0);
  }

  std::size_t links_above_base() const {
    std::size_t count = 0;
    for (auto at = chain_.base->getParent(); at != nullptr; at = at->getParent()) ++count;
    return count;
  }

  // In the base's frame: the root stands upright, and what lies between is held.
  std::array<double, 3> gravity() {
    constexpr double kStandard = 9.81;
    Isometry3d base = Isometry3d::Identity();
    for (auto at = chain_.base; at->parent_joint != nullptr; at = at->getParent()) {
      base = place_of(*at->parent_joint) * base;
    }
    const Vector3d pull = base.linear().transpose() * Vector3d(0, 0, -kStandard);
    note(Kind::kAssumed, 0,
         fmt::format("gravity of {} m/s^2 along -z of the root `{}`", shortest(kStandard),
                     document_.model->getRoot()->name));
    return {pull.x() + 0.0, pull.y() + 0.0, pull.z() + 0.0};
  }

  // The child's frame in the parent's, a joint that moves held.
  Isometry3d place_of(const urdf::Joint& joint) const {
    Isometry3d place = placement_of(joint.parent_to_joint_origin_transform);
    const bool slides = joint.type == urdf::Joint::PRISMATIC;
    if (!slides && !turns(joint)) return place;
    const double position = held_position(joint);
    if (position == 0) return place;
    const Vector3d axis = axis_of(joint);
    if (slides) return place * Eigen::Translation3d(position * axis);
    return place * Eigen::AngleAxisd(position, axis);
  }

  Vector3d axis_of(const urdf::Joint& joint) const {
    const Vector3d axis = vector_of(joint.axis);
    const double length = axis.stableNorm();
    if (!(length > 1e-9)) {
      refuse_joint(joint, "an axis of no length", "a direction", "give the axis, as 0 0 1");
    }
    const std::array<double, 3> given{axis.x(), axis.y(), axis.z()};
    if (const auto unit = unit_vector(given)) return Vector3d(unit->data());
    return axis / length;
  }

  // In the place of one that no body has.
  std::array<double, 6> possible_inertia(const urdf::Link& link,
                                         const std::array<double, 6>& tensor,
                                         const std::string& fault) {
    // What is off by rounding, or by a drawing's parts left out, is no reason to have no robot.
    constexpr double kSlightly = 0.1;
    const auto broken = broken_triangle(tensor);
    const auto nearest = nearest_inertia(tensor);
    const bool taken = inertia_ == InertiaRule::kNearest || (broken && *broken <= kSlightly);
    if (!taken || !nearest) {
      refuse(
          document_.link_place(link.name), fault,
          "a positive definite tensor about the centre of mass whose principal moments are each at "
          "most the sum of the others; all zero for a point mass",
          "check the signs of ixy, ixz, iyz, that the tensor is about the centre of mass, and its "
          "unit (kg m^2)" +
              std::string(nearest ? "; or take the nearest that a body can have: --nearest-inertia"
                                  : ""));
    }
    note(Kind::kAssumed, line_of(link),
         fmt::format("the nearest inertia of link `{}` that a body can have: the file's is {}",
                     link.name, fault));
    return *nearest;
  }

  // What a link weighs; none where it weighs nothing. Refused where no body can be like that.
  std::optional<RigidBody> body_of_link(const urdf::Link& link) {
    if (link.inertial == nullptr) return std::nullopt;
    const urdf::Inertial& given = *link.inertial;
    const std::string place = document_.link_place(link.name);
    std::array<double, 6> tensor{given.ixx, given.iyy, given.izz, given.ixy, given.ixz, given.iyz};
    const bool no_tensor = tensor == std::array<double, 6>{};
    if (given.mass == 0 && no_tensor) return std::nullopt;
    if (given.mass == 0) {
      // What simulators ask of a frame that is no body.
      constexpr double kOfAFrame = 1e-4;  // kg m^2
      const double largest =
          Eigen::Map<const Eigen::Array<double, 6, 1>>(tensor.data()).abs().maxCoeff();
      if (largest > kOfAFrame) {
        refuse(place, "an inertia and a mass of 0", "both, or neither",
               "give the link's mass, or an inertia of zeros");
      }
      note(
          Kind::kLeftOut, line_of(link),
          fmt::format("the inertia of link `{}`, {:g} kg m^2: it has no mass", link.name, largest));
      return std::nullopt;
    }
    const std::string fault = inertia_fault(tensor);
    if (!fault.empty()) tensor = possible_inertia(link, tensor, fault);
    note(Kind::kAssumed, line_of(link),
         fmt::format("a point mass: the inertia of link `{}` is zero", link.name), no_tensor);
    RigidBody own{given.mass, Vector3d::Zero(), {}};
    const auto& [xx, yy, zz, xy, xz, yz] = tensor;
    own.inertia_kg_m2 << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return seen_from(own, placement_of(given.origin));
  }

  static std::string mass_words(const urdf::Link& link) {
    const double mass = link.inertial == nullptr ? 0 : link.inertial->mass;
    return mass == 0 ? "no mass" : shortest(mass) + " kg";
  }

  // Everything that stands still as seen from `first`, itself the first of it. `next`: the chain's
  // joint that leads on from it, if any; its place in the first link's frame is left in `to_next`.
  std::vector<Stop> hanging_on(const urdf::LinkConstSharedPtr& first, const urdf::Joint* next,
                               bool is_base, Isometry3d& to_next) {
    std::vector<Stop> stops{{first, Isometry3d::Identity()}};
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const Stop at = stops[i];
      for (const auto& child : at.link->child_links) {
        const urdf::Joint& joint = *child->parent_joint;
        if (&joint == next) {
          to_next = at.place * placement_of(joint.parent_to_joint_origin_transform);
        } else if (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR) {
          note(
              Kind::kLeftOut, line_of(joint),
              fmt::format("link `{}` and what hangs on it: joint `{}` is {}", child->name,
                          joint.name, joint.type == urdf::Joint::FLOATING ? "floating" : "planar"));
        } else {
          say_where_it_goes(*child, *first, is_base);
          stops.push_back({child, at.place * place_of(joint)});
        }
      }
    }
    return stops;
  }

  void say_where_it_goes(const urdf::Link& child, const urdf::Link& first, bool is_base) {
    if (is_base) return;
    const urdf::Joint& joint = *child.parent_joint;
    if (joint.type == urdf::Joint::FIXED) {
      note(Kind::kMerged, line_of(child),
           fmt::format("link `{}` ({}) into `{}`", child.name, mass_words(child), first.name));
      return;
    }
    const bool follows =
        joint.mimic != nullptr &&
        std::any_of(chain_.moving.begin(), chain_.moving.end(),
                    [&](const auto& moving) { return moving->name == joint.mimic->joint_name; });
    note(Kind::kHeld, line_of(joint),
         fmt::format("joint `{}`, not in the chain, at {} {}: link `{}` ({}) is part of `{}`{}",
                     joint.name, shortest(held_position(joint)), turns(joint) ? "rad" : "m",
                     child.name, mass_words(child), first.name,
                     follows ? fmt::format("; it follows `{}`, which moves: what its motion needs "
                                           "of torque is not in the model",
                                           joint.mimic->joint_name)
                             : ""));
  }

  // The place of the first moving joint in the base's frame.
  Isometry3d stand_on_base() {
    Isometry3d next = Isometry3d::Identity();
    double mass = 0;
    for (const Stop& stop : hanging_on(chain_.base, chain_.moving.front().get(), true, next)) {
      if (stop.link->inertial != nullptr) mass += stop.link->inertial->mass;
    }
    note(Kind::kLeftOut, line_of(*chain_.base),
         fmt::format(
             "the {} kg of base `{}` and what stands on it beside the chain: it does not move",
             shortest(mass), chain_.base->name),
         mass != 0);
    return next;
  }

  Isometry3d add_joint(std::size_t index, const Isometry3d& place) {
    const urdf::Joint& from = *chain_.moving[index];
    check_kind(from);
    const auto link = document_.model->getLink(from.child_link_name);
    RobotJoint to;
    to.name = from.name;
    to.source = fmt::format("link {}", link->name);
    Joint<double>& joint = to.joint;
    joint.type = turns(from) ? JointType::kRevolute : JointType::kPrismatic;
    put_axis(from, joint);
    put_placement(place, joint);
    put_limits(from, joint);

    const bool last = index + 1 == chain_.moving.size();
    Isometry3d next = Isometry3d::Identity();
    const auto stops =
        hanging_on(link, last ? nullptr : chain_.moving[index + 1].get(), false, next);
    std::vector<RigidBody> bodies;
    std::vector<std::string> merged;
    for (const Stop& stop : stops) {
      if (const auto body = body_of_link(*stop.link))
        bodies.push_back(seen_from(*body, stop.place));
      if (stop.link != link) merged.push_back(stop.link->name);
    }
    if (!merged.empty()) to.source += " with " + list_of(merged);
    const RigidBody whole = joined(bodies);
    if (whole.mass_kg == 0) {
      refuse(
          document_.link_place(link->name),
          fmt::format("no mass behind joint `{}`: neither the link nor what is fixed to it has any",
                      from.name),
          "a link with a mass",
          "add its <inertial>; to a link that only joins two joints, give what the part weighs");
    }
    put_body(whole, joint);
    result_.robot.joints.push_back(std::move(to));
    result_.links.push_back(link->name);
    add_friction(from, static_cast<std::uint8_t>(index));
    return next;
  }

  void check_kind(const urdf::Joint& joint) const {
    if (joint.mimic != nullptr) {
      refuse_joint(
          joint, fmt::format("a mimic of `{}` in the chain", joint.mimic->joint_name),
          "joints with a drive each",
          "end the chain before it by --tip, or remove <mimic> where the joint has a drive "
          "of its own");
    }
    if (joint.type == urdf::Joint::FLOATING || joint.type == urdf::Joint::PLANAR) {
      refuse_joint(joint,
                   fmt::format("a {} joint in the chain",
                               joint.type == urdf::Joint::FLOATING ? "floating" : "planar"),
                   "revolute, continuous, prismatic and fixed joints",
                   fmt::format("begin behind it: --base {}", joint.child_link_name));
    }
  }

  void put_axis(const urdf::Joint& from, Joint<double>& joint) {
    const Vector3d axis = axis_of(from);
    joint.axis = {axis.x(), axis.y(), axis.z()};
    const double length = vector_of(from.axis).norm();
    note(Kind::kAssumed, line_of(from),
         fmt::format("the axis of joint `{}`, of length {}, made a unit vector", from.name,
                     shortest(length)),
         std::fabs(length - 1) > 1e-6);
    note(Kind::kAssumed, line_of(from),
         fmt::format("the axis 1 0 0 of joint `{}`: the URDF gives none", from.name),
         !document_.joint(from.name).has_axis);
  }

  void put_limits(const urdf::Joint& from, Joint<double>& joint) {
    std::vector<std::string> unknown;
    if (from.limits == nullptr) return;
    const urdf::JointLimits& limits = *from.limits;
    if (from.type != urdf::Joint::CONTINUOUS) {
      if (limits.lower < limits.upper) {
        joint.min_position = limits.lower;
        joint.max_position = limits.upper;
        note_degrees(from);
      } else if (limits.lower == 0 && limits.upper == 0) {
        unknown.emplace_back("position");
      } else {
        refuse_joint(
            from,
            fmt::format("a range from {} to {}", shortest(limits.lower), shortest(limits.upper)),
            "lower < upper",
            limits.lower > limits.upper ? "exchange them"
                                        : "correct them, or make the joint fixed");
      }
    }
    if (limits.velocity > 0) {
      joint.max_velocity = limits.velocity;
    } else {
      unknown.emplace_back("velocity");
    }
    if (limits.effort > 0) {
      joint.max_torque = limits.effort;
    } else {
      unknown.emplace_back("torque");
    }
    note(Kind::kAssumed, line_of(from),
         fmt::format("no limit of {} is known of joint `{}`: the URDF has 0", choice_of(unknown),
                     from.name),
         !unknown.empty());
  }

  // A joint with stops seldom turns twice: beyond that, degrees are the likelier unit.
  void note_degrees(const urdf::Joint& from) {
    constexpr double kTwoTurns = 4 * std::numbers::pi;
    const urdf::JointLimits& limits = *from.limits;
    const double most = std::max(std::fabs(limits.lower), std::fabs(limits.upper));
    note(Kind::kAssumed, line_of(from),
         fmt::format("the range from {} to {} of joint `{}` is in rad, as a URDF has it: {:.3g} "
                     "turns. Where it is meant in degrees, write {:.6g} and {:.6g}",
                     shortest(limits.lower), shortest(limits.upper), from.name,
                     most / (2 * std::numbers::pi), limits.lower * std::numbers::pi / 180,
                     limits.upper * std::numbers::pi / 180),
         from.type == urdf::Joint::REVOLUTE && most > kTwoTurns);
  }

  void add_friction(const urdf::Joint& from, std::uint8_t joint) {
    if (from.dynamics == nullptr) return;
    const auto add = [&](EffectKind kind, const char* attribute,
                         std::array<double, kMaxEffectParameters> parameters) {
      if (parameters[0] == 0) return;
      RobotEffect effect;
      effect.kind = kind;
      effect.joint = joint;
      effect.parameters = parameters;
      effect.source = fmt::format("URDF, <dynamics {}>", attribute);
      result_.robot.effects.push_back(effect);
    };
    any_dry_ = any_dry_ || from.dynamics->friction != 0;
    add(EffectKind::kViscousFriction, "damping", {from.dynamics->damping});
    add(EffectKind::kCoulombFriction, "friction",
        {from.dynamics->friction, effects::CoulombFriction::kParameters[1].default_value});
  }

  const UrdfDocument& document_;
  UrdfChain chain_;
  InertiaRule inertia_;
  ImportedRobot result_;
  bool any_dry_ = false;
};

}  // namespace

const char* name_of(ImportNote::Kind kind) {
  switch (kind) {
    case Kind::kMerged:
      return "merged";
    case Kind::kHeld:
      return "held";
    case Kind::kLeftOut:
      return "left out";
    case Kind::kAssumed:
      return "assumed";
  }
  return "";
}

std::vector<ChainChoice> chains_in(std::string_view text, const std::string& file) {
  return chains_of(parse_urdf(text, file));
}

ImportedRobot import_urdf(std::string_view text, const std::string& file,
                          const ChainRequest& request, InertiaRule inertia) {
  const UrdfDocument document = parse_urdf(text, file);
  return Importer(document, choose_chain(document, request), inertia).run(request);
}

}  // namespace offnominal::desk::exchange
