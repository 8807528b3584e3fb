#include "sil/scenario_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/file.hpp"
#include "common/number.hpp"
#include "common/text_table.hpp"
#include "common/toml_table.hpp"
#include "robot/effect_text.hpp"
#include "robot/read_effect.hpp"
#include "sil/plant_of.hpp"

namespace offnominal::desk::sil {
namespace {

constexpr int kScenarioFormat = 1;

std::vector<std::string> kind_names() {
  std::vector<std::string> names;
  for (const sim::FaultEventInfo& info : sim::kFaultEventInfos) names.emplace_back(info.name);
  return names;
}

sim::FaultEvent read_fault(const TomlTable& table, int joints) {
  const sim::FaultEventInfo& info = sim::kFaultEventInfos[table.choice("kind", kind_names())];
  const auto refuse_key = [&](const char* key, const std::string& allowed) {
    if (table.has(key)) {
      table.refuse(key, "a key that " + std::string(info.name) + " does not have", allowed,
                   "leave it out");
    }
  };
  sim::FaultEvent fault;
  fault.kind = info.kind;
  fault.begin_s = table.number("begin_s", not_negative("s"));
  if (info.develops) {
    refuse_key("end_s", "kind, begin_s, size and rate_per_s: it stays");
    if (table.has("rate_per_s")) fault.rate_per_s = table.number("rate_per_s", positive("1/s"));
  } else {
    refuse_key("rate_per_s", "kind, begin_s, end_s, joint and size: it is there at once");
    if (table.has("end_s")) fault.end_s = table.number("end_s", positive("s"));
  }
  if (info.of_joint == sim::OfJoint::kNever) {
    refuse_key("joint", "no joint: it concerns them all");
  } else if (info.of_joint == sim::OfJoint::kAlways || table.has("joint")) {
    fault.joint = static_cast<int>(table.integer("joint", 1, joints)) - 1;
  }
  if (info.unit.empty()) {
    refuse_key("size", "no size: it is there or not");
  } else {
    NumberRule rule;
    rule.min = info.least;
    rule.max = info.most;
    rule.unit = std::string(info.unit);
    fault.size = table.number("size", rule);
  }
  return fault;
}

void read_act_settings(const TomlTable& root, ActSettings& settings) {
  using controller::AtDetection;
  if (root.has("at_detection")) {
    settings.at_detection =
        static_cast<AtDetection>(root.choice("at_detection", at_detection_names()));
  }
  if (settings.at_detection != AtDetection::kSlow) {
    for (const char* key : {"slow_to", "slow_within_s"}) {
      if (!root.has(key)) continue;
      root.refuse(key,
                  root.has("at_detection")
                      ? "it beside at_detection = \"" + name_of(settings.at_detection) + "\""
                      : std::string("it without at_detection"),
                  "it beside at_detection = \"slow\"",
                  "say at_detection = \"slow\", or leave it out");
    }
    return;
  }
  const NumberRule share{.min = 0, .max = kMostPace};
  settings.slow_down.to = root.number("slow_to", share, settings.slow_down.to);
  const NumberRule within{.min = kShortestSlowingS, .max = kLongestSlowingS, .unit = "s"};
  settings.slow_down.within_s = root.number("slow_within_s", within, settings.slow_down.within_s);
}

// A fault that this plant can have, in this run.
void check_in_run(const TomlTable& table, const sim::FaultEvent& fault, const Scenario& scenario) {
  if (fault.begin_s > scenario.duration_s) {
    table.refuse("begin_s", fmt::format("{:g} s, behind the end of the run", fault.begin_s),
                 fmt::format("0 to {:g} s, the run's length", scenario.duration_s),
                 "begin earlier, or lengthen the run by duration_s (--duration)");
  }
  if (!(fault.end_s > fault.begin_s)) {
    table.refuse("end_s", fmt::format("{:g} s", fault.end_s),
                 fmt::format("after its begin_s, {:g} s", fault.begin_s),
                 "end later, or leave it out for a fault that stays: times count from where the "
                 "arm is free to move");
  }
  if (scenario.plant && fault.kind == sim::FaultEventKind::kNonlinear) {
    table.refuse(
        "kind", "nonlinear, for robot " + scenario.plant->name,
        "every kind but this one, which is a fault of the paper's arm",
        "take friction_jump, payload or disturbance_torque; offnominal sil has --plant paper");
  }
}

}  // namespace

Scenario read_scenario(const std::filesystem::path& path,
                       const std::optional<RobotDescription>& plant,
                       std::optional<double> duration_s) {
  const std::string file = path.string();
  const toml::table document = parse_toml(read_text_file(path), file);
  const TomlTable root(
      file, "", document,
      {"format", "duration_s", "accommodate", "at_detection", "slow_to", "slow_within_s", "frames",
       "velocity", "max_acceleration_rad_s2", "encoder_bits_per_turn", "seed", "fault", "hidden"});
  if (root.integer("format", 1, 1'000'000) != kScenarioFormat) {
    root.refuse("format", "a format that this version does not know",
                std::to_string(kScenarioFormat), "use the version of offnominal that wrote it");
  }
  Scenario scenario;
  scenario.plant = plant;
  NumberRule duration = positive("s");
  duration.max = paper::kLongestRunS;
  scenario.duration_s = root.number("duration_s", duration, scenario.duration_s);
  scenario.duration_s = duration_s.value_or(scenario.duration_s);
  scenario.accommodate = root.boolean("accommodate", false);
  read_act_settings(root, scenario);
  if (root.has("frames")) {
    const bool fd = root.choice("frames", {"classic", "fd"}) == 1;
    scenario.format = fd ? hal::FrameFormat::kFd : hal::FrameFormat::kClassic;
  }
  if (root.has("velocity")) {
    scenario.sends_velocity = root.choice("velocity", {"sent", "observed"}) == 0;
  }
  scenario.max_acceleration =
      root.number("max_acceleration_rad_s2", positive("rad/s^2"), scenario.max_acceleration);
  scenario.encoder_bits_per_turn =
      static_cast<int>(root.integer("encoder_bits_per_turn", 1, 32, 0));
  scenario.seed = static_cast<std::uint64_t>(
      root.integer("seed", 0, std::numeric_limits<std::int64_t>::max(), 1));
  const std::vector<std::string> keys = {"kind", "begin_s", "end_s", "joint", "size", "rate_per_s"};
  for (const TomlTable& table : root.tables("fault", keys)) {
    scenario.faults.push_back(read_fault(table, joint_count_of(scenario)));
    check_in_run(table, scenario.faults.back(), scenario);
  }
  for (const TomlTable& table : root.tables("hidden", effect_keys())) {
    if (!plant) {
      table.refuse("", "an effect hidden in the paper's arm",
                   "none: its friction and disturbance are the paper's",
                   "hide it in the plant of a robot file: --plant FILE");
    }
    scenario.hidden.push_back(read_effect(table, plant->joints, plant->transmission.has_value()));
  }
  return scenario;
}

std::string scenario_text(const Scenario& scenario) {
  std::string text = fmt::format(
      "format = {}\nduration_s = {}\naccommodate = {}\nat_detection = \"{}\"\n"
      "velocity = \"{}\"\nmax_acceleration_rad_s2 = {}\nseed = {}\n",
      kScenarioFormat, shortest_real(scenario.duration_s), scenario.accommodate,
      name_of(scenario.at_detection), scenario.sends_velocity ? "sent" : "observed",
      shortest_real(scenario.max_acceleration), scenario.seed);
  if (scenario.at_detection == controller::AtDetection::kSlow) {
    text += fmt::format("slow_to = {}\nslow_within_s = {}\n", shortest_real(scenario.slow_down.to),
                        shortest_real(scenario.slow_down.within_s));
  }
  if (scenario.format) {
    const bool fd = *scenario.format == hal::FrameFormat::kFd;
    text += fmt::format("frames = \"{}\"\n", fd ? "fd" : "classic");
  }
  if (scenario.encoder_bits_per_turn > 0) {
    text += fmt::format("encoder_bits_per_turn = {}\n", scenario.encoder_bits_per_turn);
  }
  for (const sim::FaultEvent& fault : scenario.faults) {
    const sim::FaultEventInfo& info = info_of(fault.kind);
    text += fmt::format("\n[[fault]]\nkind = \"{}\"\nbegin_s = {}\n", info.name,
                        shortest_real(fault.begin_s));
    const auto add = [&](const char* key, double value) {
      text += fmt::format("{} = {}\n", key, shortest_real(value));
    };
    if (std::isfinite(fault.end_s)) add("end_s", fault.end_s);
    if (std::isfinite(fault.rate_per_s)) add("rate_per_s", fault.rate_per_s);
    if (fault.joint >= 0) text += fmt::format("joint = {}\n", fault.joint + 1);
    if (!info.unit.empty()) add("size", fault.size);
  }
  for (const RobotEffect& effect : scenario.hidden) {
    const std::string as_effect = effect_text(effect);
    text += "\n[[hidden]]" + as_effect.substr(as_effect.find('\n'));
  }
  return text;
}

std::string fault_kinds_text() {
  const TextTable table({{"", -18}, {"", -30}, {"", 0}}, "  ");
  std::string text;
  for (const sim::FaultEventInfo& info : sim::kFaultEventInfos) {
    std::string keys = info.of_joint == sim::OfJoint::kNever    ? ""
                       : info.of_joint == sim::OfJoint::kAlways ? "joint"
                                                                : "(joint)";
    if (!info.unit.empty()) {
      keys += fmt::format("{}size [{}]", keys.empty() ? "" : ", ", info.unit);
    }
    text += table.row(info.name, keys, info.words);
  }
  return text;
}

}  // namespace offnominal::desk::sil
