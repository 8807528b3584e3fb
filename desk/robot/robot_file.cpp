#include "robot/robot_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <offnominal/diagnosis/network.hpp>
#include <offnominal/model/effect_memory.hpp>
#include <set>
#include <sstream>
#include <vector>

#include "common/error.hpp"
#include "common/number.hpp"
#include "common/toml_table.hpp"
#include "drives/drive_table.hpp"
#include "robot/chain_of.hpp"
#include "robot/channels.hpp"
#include "robot/check_mass_matrix.hpp"
#include "robot/effect_text.hpp"
#include "robot/read_drives.hpp"
#include "robot/read_effect.hpp"
#include "robot/read_joint.hpp"
#include "robot/read_settings.hpp"
#include "robot/text_lines.hpp"
#include "robot/text_with_bound.hpp"
#include "robot/text_with_effects.hpp"
#include "robot/text_with_joints.hpp"
#include "robot/transmission.hpp"

namespace offnominal::desk {
namespace {

const std::vector<std::string> kRootKeys{"format",       "name",   "source",
                                         "gravity_m_s2", "joint",  "effect",
                                         "estimator",    "arming", "uncertainty_bound",
                                         "transmission", "drives", "channels"};

void refuse_blanks(const std::vector<TomlTable>& joints, const std::vector<Blank>& blanks) {
  if (blanks.empty()) return;
  refuse_blank(joints[blanks.front().joint], blanks.front().key, blanks.size() - 1);
}

std::vector<RobotJoint> read_joints(const TomlTable& root, Blanks allowed,
                                    std::vector<Blank>& blanks) {
  const std::vector<TomlTable> tables = root.tables("joint", joint_keys());
  if (tables.empty() || tables.size() > static_cast<std::size_t>(kMaxJoints)) {
    root.refuse("joint", std::to_string(tables.size()) + " joints",
                "1 to " + std::to_string(kMaxJoints) + " joints",
                "write one [[joint]] for each joint, from the base outwards");
  }
  std::vector<RobotJoint> joints;
  std::set<std::string> names;
  for (const TomlTable& table : tables) {
    std::vector<std::string> keys;
    joints.push_back(read_joint(table, keys));
    for (std::string& key : keys) blanks.push_back({joints.size() - 1, std::move(key)});
    const std::string& name = joints.back().name;
    if (names.insert(name).second) continue;
    table.refuse("name", "the name \"" + name + "\" a second time", "names that differ",
                 "give this joint another name");
  }
  if (allowed == Blanks::kRefused) refuse_blanks(tables, blanks);
  return joints;
}

std::vector<RobotEffect> read_effects(const TomlTable& root, const std::vector<RobotJoint>& joints,
                                      bool has_transmission) {
  const std::vector<TomlTable> tables = root.tables("effect", effect_keys());
  const std::size_t most = kEffectsPerJoint * joints.size();
  if (tables.size() > most) {
    tables[most].refuse(
        "", std::to_string(tables.size()) + " effects",
        "at most " + std::to_string(most) + " (" + std::to_string(kEffectsPerJoint) + " per joint)",
        "remove those that matter least");
  }
  std::vector<RobotEffect> effects;
  std::vector<double> friction_per_load(joints.size());
  constexpr double kMost = effects::LoadDependentFriction::kMostFactor;
  for (const TomlTable& table : tables) {
    effects.push_back(read_effect(table, joints, has_transmission));
    double& of_joint = friction_per_load[effects.back().joint];
    of_joint += most_friction_per_load<double>(effects.back());
    if (of_joint <= kMost) continue;
    table.refuse(info_of(effects.back().kind)->find(Quantity::kRatio)->name,
                 "friction by the load of this joint that adds up to " + shortest(of_joint),
                 "at most " + shortest(kMost) + " per joint", "make one effect of them");
  }
  return effects;
}

// The radius has to hold the weights that the estimator starts with, which depend on the number of
// joints.
void check_initial_weights(const TomlTable& root, const RobotDescription& robot) {
  const EstimatorSettings& settings = robot.estimator;
  const double norm = std::sqrt(initial_squared_norm<kRuntimeJoints, kMaxHiddenUnits, double>(
      settings.seed, settings.hidden_units, settings.initial_weight_range, robot.joint_count()));
  if (norm < settings.weight_radius) return;
  root.refuse("estimator",
              "initial weights of norm " + shortest(static_cast<double>(static_cast<float>(norm))) +
                  " with a weight_radius of " + shortest(settings.weight_radius),
              "initial weights inside the radius",
              "lower estimator.initial_weight_range, or raise estimator.weight_radius");
}

void check_delays(const TomlTable& root, const RobotDescription& robot) {
  const double most_s = kMaxDelayTicks * robot.estimator.period_s;
  const std::vector<TomlTable> tables = root.tables("effect", effect_keys());
  const auto chain = chain_of<kRuntimeJoints, double>(robot);
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const double delay_s = delay_of_joint(chain, i);
    if (delay_s <= most_s) continue;
    const auto is_its_delay = [&](const RobotEffect& effect) {
      return effect.kind == EffectKind::kTimeDelay && effect.joint == i;
    };
    const auto effect = std::find_if(robot.effects.begin(), robot.effects.end(), is_its_delay);
    tables[static_cast<std::size_t>(effect - robot.effects.begin())].refuse(
        info_of(EffectKind::kTimeDelay)->parameters.front().name,
        fmt::format("a delay of {:g} s on joint {}", delay_s, i + 1),
        fmt::format("at most {:g} s, {} ticks of estimator.period_s", most_s, kMaxDelayTicks),
        "correct the delay, or estimator.period_s");
  }
}

// Bounds of accelerations and of torques are no substitutes for each other.
void check_space(const TomlTable& root, const RobotDescription& robot) {
  if (!robot.bound) return;
  const bool in_torque = robot.estimator.space == EstimatorSpace::kTorque;
  const bool per_joint = robot.bound->kind == BoundSettings::Kind::kPerJoint;
  if (in_torque == per_joint) return;
  const TomlTable table = root.table("uncertainty_bound", bound_keys());
  if (in_torque) {
    table.refuse("kind", "a bound of accelerations beside estimator.space = \"torque\"",
                 "\"per_joint\", N m or N per joint",
                 "leave [uncertainty_bound] out and let `offnominal calibrate` find the bounds, or "
                 "set estimator.space to \"acceleration\"");
  }
  table.refuse("kind",
               "\"per_joint\", a bound of torques, beside estimator.space = \"acceleration\"",
               "\"constant\", \"scaled_norm\" or \"table\"",
               "set estimator.space to \"torque\", or leave [uncertainty_bound] out and let "
               "`offnominal calibrate` find another");
}

// A second filter and its bounds belong together.
void check_fast_filter(const TomlTable& root, const RobotDescription& robot) {
  if (!robot.bound) return;
  const bool has_bounds = !robot.bound->fast.empty();
  if (has_bounds == (robot.estimator.fast_alpha > 0)) return;
  const TomlTable table = root.table("uncertainty_bound", bound_keys());
  if (has_bounds) {
    table.refuse("fast", "bounds of a second filter that the estimator does not have",
                 "none, or estimator.fast_alpha_per_s beside them",
                 "give the filter's pole in estimator.fast_alpha_per_s, or remove them");
  }
  table.refuse("", "no bounds of the second filter, estimator.fast_alpha_per_s",
               "fast = {value = [...]}, N m or N per joint",
               "leave [uncertainty_bound] out and let `offnominal calibrate` find the bounds of "
               "both filters, or remove estimator.fast_alpha_per_s");
}

// A protocol that scales every axis by itself has no joint for the axes of motors that joints
// share.
void check_axes(const TomlTable& root, const RobotDescription& robot) {
  if (!robot.transmission || protocol_of(*robot.drives).joint_keys.empty()) return;
  const std::vector<std::size_t> groups = coupled_groups(*robot.transmission);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    if (groups[i] == i) continue;
    root.refuse(
        "drives",
        fmt::format("{}, whose axes move one joint each, beside joints {} and {} that share "
                    "motors",
                    protocol_of(*robot.drives).name, groups[i] + 1, i + 1),
        "drives whose frames are of joints, as `protected` has them",
        "leave [drives] out where the file is for recordings only");
  }
}

// `text` with the path of the robot's DBC file as it is seen from `file`, where that is in another
// folder than the file that the text comes from. The key has to have a line of its own.
std::string with_dbc(const std::string& text, const RobotDescription& robot,
                     const std::string& file) {
  if (!robot.channels || robot.channels->dbc.empty()) return text;
  if (parse_robot(text, file).channels->dbc == robot.channels->dbc) return text;
  const toml::table document = parse_toml(text, file);
  const std::size_t line = document["channels"]["dbc"].node()->source().begin.line;
  const Lines lines = lines_of(text);
  if (!trimmed(lines.at(line - 1)).starts_with("dbc")) return text;
  std::ostringstream key;
  key << toml::table{{"dbc", std::filesystem::absolute(robot.channels->dbc).string()}};
  std::string result;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    result += (i + 1 == line ? key.str() : lines[i]) + "\n";
  }
  return result;
}

// The text that `robot` was read from with what has changed since, for `file`; none where it cannot
// be cut.
std::optional<std::string> text_with_changes(const RobotDescription& robot,
                                             const std::string& file) {
  if (robot.file_text == nullptr) return std::nullopt;
  const auto with_joints =
      text_with_joints(with_dbc(without_returns(*robot.file_text), robot, file), robot, file);
  if (!with_joints) return std::nullopt;
  const std::string& old_text = *with_joints;
  RobotDescription effects_only = robot;
  try {
    effects_only.bound = parse_robot(old_text, file).bound;
  } catch (const InputError&) {
    return std::nullopt;  // a change of a joint in the wrong place
  }
  auto text = text_with_effects(old_text, effects_only, file);
  if (!text) return std::nullopt;
  return text_with_bound(*text, robot, file);
}

// "line 40, effect[3]", of a robot that was read; one that was changed since has another order.
std::string place_in_file(const RobotDescription& robot, std::size_t effect) {
  std::string path = fmt::format("effect[{}]", effect + 1);
  if (robot.file_text == nullptr) return path;
  const toml::table document = toml::parse(*robot.file_text);
  const toml::node* node = document["effect"][effect].node();
  if (node == nullptr) return path;
  return fmt::format("line {}, {}", node->source().begin.line, path);
}

}  // namespace

void require_carried(const RobotDescription& robot, const std::string& file,
                     const std::string& who) {
  for (std::size_t i = 0; i < robot.effects.size(); ++i) {
    const RobotEffect& effect = robot.effects[i];
    if (chain_may_have(effect.kind)) continue;
    throw InputError(
        {.file = file,
         .place = place_in_file(robot, i),
         .found = fmt::format("{} on {}, which {} cannot carry", info_of(effect.kind)->name,
                              place_of(effect), who),
         .allowed = "effects of rigid transmissions",
         .mend = "remove it from this file, and keep it in the one that compare, add and explain "
                 "are given"});
  }
}

void require_bound(const RobotDescription& robot, const std::string& file) {
  require_carried(robot, file);
  if (robot.bound) return;
  throw InputError({.file = file,
                    .place = "uncertainty_bound",
                    .found = "nothing",
                    .allowed = "a table [uncertainty_bound]",
                    .mend = "add one (docs/robot-file.md), or let `offnominal calibrate` find it: "
                            "without a bound there is no threshold"});
}

RobotDescription parse_robot(std::string_view text, const std::string& file, Blanks blanks) {
  const toml::table document = parse_toml(text, file);
  const TomlTable root(file, "", document, kRootKeys);
  if (root.integer("format", 1, 1'000'000) != kRobotFileFormat) {
    root.refuse("format", "a format that this version does not know",
                std::to_string(kRobotFileFormat), "use the version of offnominal that wrote it");
  }
  RobotDescription robot;
  robot.name = root.text("name");
  robot.source = root.text_or_empty("source");
  const std::vector<double> gravity =
      root.numbers("gravity_m_s2", physical(any_number("m/s^2")), 3, 3);
  robot.gravity_m_s2 = {gravity[0], gravity[1], gravity[2]};
  robot.joints = read_joints(root, blanks, robot.blanks);
  if (const auto table = root.optional_table("transmission", transmission_keys())) {
    robot.transmission = read_transmission(*table, robot.joint_count());
  }
  robot.effects = read_effects(root, robot.joints, robot.transmission.has_value());
  check_mass_matrix(root, robot);
  if (const auto table = root.optional_table("estimator", estimator_keys())) {
    robot.estimator = read_estimator(*table);
  }
  if (const auto table = root.optional_table("arming", arming_keys())) {
    robot.arming = read_arming(*table, robot.joint_count());
  }
  check_initial_weights(root, robot);
  check_delays(root, robot);
  if (const auto table = root.optional_table("uncertainty_bound", bound_keys())) {
    robot.bound = read_bound(*table, robot.joint_count(), robot.estimator.space);
  }
  check_space(root, robot);
  check_fast_filter(root, robot);
  if (const toml::table* table = root.raw_table("drives")) {
    robot.drives = read_drives(*table, file, robot.joint_count(), robot.estimator.period_s);
    check_axes(root, robot);
  }
  if (const toml::table* table = root.raw_table("channels")) {
    robot.channels = parse_channels(*table, file, robot.joint_count());
    check_sides(*robot.channels, robot.transmission, file);
  }
  robot.file_text = std::make_shared<const std::string>(text);
  return robot;
}

RobotDescription read_robot_file(const std::filesystem::path& path, Blanks blanks) {
  return parse_robot(read_text_file(path), path.string(), blanks);
}

KeptComments write_robot_file(const RobotDescription& robot, const std::filesystem::path& path,
                              Existing existing) {
  if (!robot.blanks.empty()) {
    throw InputError({path.string(), fmt::format("joint {}", robot.blanks[0].joint + 1),
                      "a blank for link." + robot.blanks[0].key, "a number",
                      "a robot with blanks is not written again: fill them in before"});
  }
  const std::string plain = robot_text(robot);
  static_cast<void>(parse_robot(plain, path.string() + " (to be written)"));
  const auto as_it_was = text_with_changes(robot, path.string());
  std::string text = as_it_was.value_or(plain);
  const bool is_cut = as_it_was.has_value() || robot.file_text == nullptr;
  if (robot.file_text != nullptr && has_returns(*robot.file_text)) text = with_returns(text);
  write_file_atomically(path, text, existing);
  return is_cut || !has_comments(*robot.file_text) ? KeptComments::kAll : KeptComments::kNone;
}

}  // namespace offnominal::desk
