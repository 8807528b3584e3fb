#include "campaign/campaign_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <offnominal/version.hpp>
#include <set>
#include <sstream>

#include "campaign/cad_errors.hpp"
#include "campaign/read_faults.hpp"
#include "common/error.hpp"
#include "common/file.hpp"
#include "common/number.hpp"
#include "common/toml_table.hpp"
#include "exchange/export_robot.hpp"
#include "log/observed_motion.hpp"
#include "offnominal/sim/hidden/arm_motion.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk::campaign {
namespace {

constexpr int kCampaignFormat = 1;
constexpr int kMostRuns = 1'000'000;

NumberRule at_most(NumberRule rule, double most) {
  rule.max = most;
  return rule;
}

NumberRule share_below_one() { return at_most(not_negative("1"), 0.5); }

PlantSettings read_plant(const TomlTable& table) {
  PlantSettings plant;
  plant.kind =
      table.choice("kind", {"robot", "mujoco"}) == 0 ? PlantKind::kRobot : PlantKind::kMujoco;
  plant.cad_error = table.number("cad_error", share_below_one(), 0);
  plant.friction_error = table.number("friction_error", share_below_one(), 0);
  plant.torque_noise = table.number("torque_noise", share_below_one(), 0);
  plant.encoder_bits = static_cast<int>(table.integer("encoder_bits", 8, 40, 0));
  // The controller's observer of velocities needs it (core, velocity_observer.hpp).
  constexpr double kLongestPeriodS = 0.0024;
  plant.period_s =
      table.number("period_s", at_most(positive("s"), kLongestPeriodS), plant.period_s);
  if (table.has("velocity")) {
    constexpr std::array kKinds{VelocityKind::kDerived, VelocityKind::kObserved,
                                VelocityKind::kSent};
    plant.velocity = kKinds.at(table.choice("velocity", {"derived", "observed", "sent"}));
  }
  if (table.has("velocity_noise_rad_s")) {
    plant.velocity_noise_rad_s = table.number("velocity_noise_rad_s", not_negative("rad/s"));
    if (plant.velocity != VelocityKind::kSent) {
      table.refuse("velocity_noise_rad_s", "noise of velocities that are not sent",
                   "it beside velocity = \"sent\" alone", "leave it out");
    }
  }
  return plant;
}

void read_fast_alpha(const TomlTable& table, const std::string& kind, DetectorSettings& detector) {
  if (!table.has("fast_alpha_per_s")) return;
  if (detector.kind != DetectorKind::kTorque) {
    table.refuse("fast_alpha_per_s", "a second filter of a detector of kind " + kind,
                 "it with kind = \"torque\" alone", "leave it out");
  }
  detector.fast_alpha_per_s = table.number("fast_alpha_per_s", at_most(positive("1/s"), 1000));
  if (detector.fast_alpha_per_s > detector.alpha_per_s) return;
  table.refuse("fast_alpha_per_s", shortest(detector.fast_alpha_per_s),
               "above alpha_per_s, which is " + shortest(detector.alpha_per_s),
               "give the faster pole here and the slower one in alpha_per_s");
}

DetectorSettings read_detector(const TomlTable& table, const PlantSettings& plant) {
  const std::vector<std::string> kinds{"torque", "acceleration", "momentum_observer", "kdl"};
  DetectorSettings detector;
  const std::size_t kind = table.choice("kind", kinds);
  detector.kind = static_cast<DetectorKind>(kind);
  detector.alpha_per_s =
      table.number("alpha_per_s", at_most(positive("1/s"), 1000), detector.alpha_per_s);
  if (table.has("filter_share")) {
    if (detector.kind != DetectorKind::kKdl) {
      table.refuse("filter_share", "a filter of " + kinds[kind], "it with kind = \"kdl\" alone",
                   "leave it out");
    }
    detector.filter_share = table.number("filter_share", at_most(not_negative("1"), 0.999));
  }
  read_fast_alpha(table, kinds[kind], detector);
  detector.accommodates = table.boolean("accommodates", false);
  if (detector.accommodates && detector.kind != DetectorKind::kTorque) {
    table.refuse("accommodates", "true of a detector of kind " + kinds[kind],
                 "it with kind = \"torque\" alone, which says which fault it is", "leave it out");
  }
  if (detector.accommodates && plant.velocity == VelocityKind::kDerived) {
    table.refuse("accommodates", "true beside velocity = \"derived\", which is known afterwards",
                 "velocities that a controller has: \"observed\" or \"sent\"",
                 "set [plant] velocity, or leave accommodates out");
  }
  detector.name = table.text_or_empty("name");
  if (detector.name.empty()) {
    detector.name = fmt::format("{} {}", kinds[kind], shortest(detector.alpha_per_s));
    if (detector.fast_alpha_per_s > 0) {
      detector.name += fmt::format(" and {}", shortest(detector.fast_alpha_per_s));
    }
  }
  return detector;
}

std::vector<DetectorSettings> read_detectors(const TomlTable& root, const PlantSettings& plant) {
  std::vector<DetectorSettings> detectors;
  std::set<std::string> names;
  for (const TomlTable& table : root.tables(
           "detector",
           {"kind", "name", "alpha_per_s", "fast_alpha_per_s", "accommodates", "filter_share"})) {
    DetectorSettings detector = read_detector(table, plant);
    if (!names.insert(detector.name).second) {
      table.refuse("", "a second detector called " + detector.name, "a name for each",
                   "give it a name");
    }
    const bool is_fast = detector.fast_alpha_per_s > detector.alpha_per_s;
    const double fastest = is_fast ? detector.fast_alpha_per_s : detector.alpha_per_s;
    if (fastest * plant.period_s > 1) {
      table.refuse(is_fast ? "fast_alpha_per_s" : "alpha_per_s", shortest(fastest),
                   "at most 1 / period_s = " + shortest(1 / plant.period_s),
                   "take a slower filter");
    }
    detectors.push_back(std::move(detector));
  }
  if (detectors.empty()) {
    root.refuse("detector", "none", "a [[detector]] at least",
                "add [[detector]], kind = \"torque\"");
  }
  return detectors;
}

// The filters of calibrate, replay and this file look at joints that turn, within their limits.
void check_joints(const TomlTable& root, const RobotDescription& robot) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (robot.joints[i].joint.type == JointType::kRevolute) continue;
    root.refuse("robot", fmt::format("joint {} ({}), which slides", i + 1, robot.joints[i].name),
                "joints that turn: motions are drawn in rad", "take another robot");
  }
}

double usual_middle(const Joint<double>& joint) {
  const bool holds_zero = joint.min_position <= -sim::hidden::kArmMotionReachRad &&
                          joint.max_position >= sim::hidden::kArmMotionReachRad;
  return holds_zero ? 0 : 0.5 * (joint.min_position + joint.max_position);
}

std::vector<double> read_middles(const TomlTable& root, const RobotDescription& robot) {
  const std::size_t count = robot.joints.size();
  std::vector<double> middles;
  const auto table = root.optional_table("motion", {"middles_rad"});
  if (table && table->has("middles_rad")) {
    middles = table->numbers("middles_rad", any_number("rad"), count, count);
  } else {
    for (const RobotJoint& joint : robot.joints) middles.push_back(usual_middle(joint.joint));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Joint<double>& joint = robot.joints[i].joint;
    const double reach = sim::hidden::kArmMotionReachRad;
    if (middles[i] - reach >= joint.min_position && middles[i] + reach <= joint.max_position) {
      continue;
    }
    const TomlTable& place = table ? *table : root;
    place.refuse(table ? "middles_rad" : "",
                 fmt::format("motions of joint {} ({}) from {:.4g} to {:.4g} rad", i + 1,
                             robot.joints[i].name, middles[i] - reach, middles[i] + reach),
                 fmt::format("{:.4g} to {:.4g} rad, its limits of position", joint.min_position,
                             joint.max_position),
                 "put the middle of its motion elsewhere ([motion] middles_rad), or widen the "
                 "limits of a copy of the robot file");
  }
  return middles;
}

CalibrationSettings read_calibration(const TomlTable& root) {
  CalibrationSettings settings;
  const auto table = root.optional_table("calibration", {"runs", "duration_s", "alarms_per_hour"});
  if (!table) return settings;
  settings.runs = static_cast<int>(table->integer("runs", 1, 1000, settings.runs));
  settings.duration_s =
      table->number("duration_s", at_most(positive("s"), 3600), settings.duration_s);
  NumberRule rate = at_most(positive("1/h"), 60);
  rate.min = 1e-6;
  settings.alarms_per_hour = table->number("alarms_per_hour", rate, settings.alarms_per_hour);
  return settings;
}

// A recording of observed velocities begins where they are settled.
void check_settled(const TomlTable& runs, double fault_s, const PlantSettings& plant) {
  if (plant.velocity != VelocityKind::kObserved) return;
  const MotionObserver observer(1, plant.period_s);
  const double settled_s = static_cast<double>(observer.ticks_to_settle()) * plant.period_s;
  if (fault_s > settled_s) return;
  runs.refuse("fault_s", shortest(fault_s) + " s",
              fmt::format("above {:g} s, where an observed velocity has settled", settled_s),
              "let the fault begin later");
}

RunSettings read_runs(const TomlTable& root, const PlantSettings& plant) {
  RunSettings runs;
  const auto table = root.optional_table(
      "runs", {"per_fault", "duration_s", "fault_s", "fault_free_hours", "fault_free_duration_s"});
  if (!table) return runs;
  runs.per_fault = static_cast<int>(table->integer("per_fault", 1, kMostRuns, runs.per_fault));
  NumberRule duration = at_most(positive("s"), 3600);
  duration.min = 1;
  runs.duration_s = table->number("duration_s", duration, runs.duration_s);
  runs.fault_s = table->number("fault_s", positive("s"), runs.fault_s);
  runs.fault_free_hours = table->number("fault_free_hours", at_most(not_negative("h"), 1e5), 0);
  runs.fault_free_duration_s =
      table->number("fault_free_duration_s", duration, runs.fault_free_duration_s);
  if (runs.fault_s >= runs.duration_s) {
    table->refuse("fault_s", shortest(runs.fault_s) + " s",
                  "below duration_s = " + shortest(runs.duration_s) + " s",
                  "let the fault begin within the run");
  }
  check_settled(*table, runs.fault_s, plant);
  return runs;
}

void check_plant(const TomlTable& root, const std::string& key, const RobotDescription& plant,
                 const RobotDescription& robot) {
  if (plant.joints.size() != robot.joints.size()) {
    root.refuse(key, fmt::format("a plant of {} joints", plant.joints.size()),
                fmt::format("{} joints, as robot {} has", robot.joints.size(), robot.name),
                "take the file of the same robot");
  }
  for (std::size_t i = 0; i < plant.joints.size(); ++i) {
    if (plant.joints[i].joint.type == robot.joints[i].joint.type) continue;
    root.refuse(key, fmt::format("a plant whose joint {} slides", i + 1), "joints that turn",
                "take the file of the same robot");
  }
}

// MuJoCo has no place for some effects: the model would know what the plant has not.
void check_carried(const TomlTable& table, const RobotDescription& truth) {
  RobotDescription bare = truth;
  bare.effects.clear();
  const auto lost = [](const RobotDescription& robot) {
    return exchange::export_mjcf(robot, "").not_carried;
  };
  const std::vector<std::string> anyway = lost(bare);
  for (const std::string& words : lost(truth)) {
    if (std::find(anyway.begin(), anyway.end(), words) != anyway.end()) continue;
    table.refuse("kind", "a plant of MuJoCo, which has no place for " + words,
                 "a robot whose effects MuJoCo has (docs/your-own-arm.md)",
                 "take kind = \"robot\", or leave the effect out of the robot file");
  }
}

RobotDescription without_limits(RobotDescription robot) {
  for (RobotJoint& joint : robot.joints) {
    joint.joint.max_velocity = std::numeric_limits<double>::max();
  }
  return robot;
}

RobotDescription model_of(const Campaign& campaign, const RobotDescription& robot) {
  sim::hidden::Draws draws(campaign.seed, sim::hidden::Stream::kKnowledge);
  RobotDescription model = with_cad_errors(robot, campaign.plant.cad_error, draws);
  model = with_friction_errors(std::move(model), campaign.plant.friction_error, draws);
  for (RobotJoint& joint : model.joints) {
    joint.joint.max_velocity = std::numeric_limits<double>::max();
    joint.joint.max_torque = std::numeric_limits<double>::max();
    joint.joint.min_position = -std::numeric_limits<double>::max();
    joint.joint.max_position = std::numeric_limits<double>::max();
  }
  model.bound.reset();
  model.channels.reset();
  model.file_text.reset();
  model.estimator.period_s = campaign.plant.period_s;
  model.estimator.torque_signal = TorqueSignal::kSampled;
  return model;
}

// Comments, order and blanks of the files are no part of it, nor where they lie.
std::string identity_of(const toml::table& document, const Campaign& campaign,
                        const RobotDescription& robot) {
  toml::table keys = document;
  keys.erase("robot");
  if (toml::table* plant = keys["plant"].as_table()) plant->erase("robot");
  std::ostringstream text;
  text << toml::default_formatter(keys);
  return fmt::format("offnominal {}.{}.{}\n{}\n\n# robot\n{}\n# plant\n{}", kVersionMajor,
                     kVersionMinor, kVersionPatch, text.str(), robot_text(robot),
                     robot_text(campaign.truth));
}

}  // namespace

Campaign read_campaign(const std::filesystem::path& path) {
  const std::string file = path.string();
  const toml::table document = parse_toml(read_text_file(path), file);
  const TomlTable root(file, "", document,
                       {"format", "name", "robot", "seed", "plant", "motion", "calibration",
                        "detector", "fault", "runs"});
  if (root.integer("format", 1, 1'000'000) != kCampaignFormat) {
    root.refuse("format", "a format that this version does not know",
                std::to_string(kCampaignFormat), "use the version of offnominal that knows it");
  }
  Campaign campaign;
  campaign.file = file;
  campaign.name = root.text("name");
  campaign.seed = static_cast<std::uint64_t>(
      root.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  const RobotDescription robot = read_robot_file(path.parent_path() / root.text("robot"));
  require_carried(robot, root.text("robot"));
  check_joints(root, robot);
  const TomlTable plant =
      root.table("plant", {"kind", "robot", "cad_error", "friction_error", "torque_noise",
                           "encoder_bits", "period_s", "velocity", "velocity_noise_rad_s"});
  campaign.plant = read_plant(plant);
  campaign.truth = robot;
  if (plant.has("robot")) {
    campaign.truth = read_robot_file(path.parent_path() / plant.text("robot"));
    require_carried(campaign.truth, plant.text("robot"));
    check_plant(plant, "robot", campaign.truth, robot);
  }
  if (campaign.plant.kind == PlantKind::kMujoco) check_carried(plant, campaign.truth);
  campaign.identity = identity_of(document, campaign, robot);
  campaign.truth = without_limits(std::move(campaign.truth));
  campaign.middles_rad = read_middles(root, campaign.truth);
  campaign.model = model_of(campaign, robot);
  campaign.calibration = read_calibration(root);
  campaign.detectors = read_detectors(root, campaign.plant);
  campaign.runs = read_runs(root, campaign.plant);
  campaign.faults = read_faults(root, document, campaign);
  if (campaign.run_count() == 0) {
    root.refuse("fault", "no fault and no fault-free hours", "a run at least",
                "add [[fault]], or fault_free_hours to [runs]");
  }
  if (campaign.run_count() > kMostRuns) {
    root.refuse("runs", fmt::format("{} runs", campaign.run_count()),
                fmt::format("at most {}", kMostRuns), "take fewer faults, sizes or runs");
  }
  return campaign;
}

std::string fault_kinds_text() {
  std::string text;
  for (const FaultKindInfo& info : kFaultKinds) {
    const std::string unit = *info.unit == '\0' ? "no size" : fmt::format("[{}]", info.unit);
    text += fmt::format("  {:<16} {:<8} {}\n", info.name, unit, info.words);
  }
  return text;
}

}  // namespace offnominal::desk::campaign
