#include "live/live_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "live/controller_words.hpp"
#include "report/page.hpp"
#include "sil/sil_report.hpp"

namespace offnominal::desk::live {

using nlohmann::ordered_json;

namespace {

// What a picture shows of a number has no more digits, and every one travels thirty times a second.
ordered_json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0) return 0;
  constexpr int kDigits = 5;
  const int digits = kDigits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
  constexpr int kMostDecimals = 15;
  if (digits > kMostDecimals) return 0;
  const double scale = std::pow(10.0, digits);
  return std::round(value * scale) / scale;
}

// To the millisecond.
ordered_json time_number(double value_s) {
  constexpr double kPerS = 1000;
  return std::round(value_s * kPerS) / kPerS;
}

ordered_json numbers(const std::vector<double>& values) {
  ordered_json all = ordered_json::array();
  for (const double value : values) all.push_back(number(value));
  return all;
}

ordered_json times(const std::vector<double>& values_s) {
  ordered_json all = ordered_json::array();
  for (const double value : values_s) all.push_back(time_number(value));
  return all;
}

ordered_json tables(const std::vector<std::vector<double>>& values) {
  ordered_json all = ordered_json::array();
  for (const std::vector<double>& one : values) all.push_back(numbers(one));
  return all;
}

// A size to begin with: what nobody overlooks, and nothing breaks of.
double proposed_size(const sim::FaultEventInfo& info, const RobotDescription& robot) {
  switch (info.kind) {
    case sim::FaultEventKind::kFrictionJump:
    case sim::FaultEventKind::kDisturbanceTorque: {
      constexpr double kTimesBound = 4;
      double largest = 1;
      if (robot.bound && robot.bound->kind == BoundSettings::Kind::kPerJoint) {
        for (const JointBoundSettings& joint : robot.bound->joints) {
          largest = std::max(largest, *std::max_element(joint.value.begin(), joint.value.end()));
        }
        return number(kTimesBound * largest).get<double>();
      }
      constexpr double kTorque = 10;
      return kTorque;
    }
    case sim::FaultEventKind::kPayload: {
      constexpr double kShare = 0.2;
      double mass = 0;
      for (const RobotJoint& joint : robot.joints) mass += joint.joint.mass_kg;
      return number(kShare * mass).get<double>();
    }
    case sim::FaultEventKind::kEncoderBias:
    case sim::FaultEventKind::kEncoderDrift:
      return 0.05;
    case sim::FaultEventKind::kDelayedFrames:
      return 0.002;
    default:
      return info.most <= 1 ? 0.5 : std::max(info.least, 4.0);
  }
}

const char* joint_words(sim::OfJoint of_joint) {
  return of_joint == sim::OfJoint::kNever ? "none" : "one";
}

ordered_json faults_of(const Live& live) {
  ordered_json all = ordered_json::array();
  for (const sim::FaultEventInfo& info : sim::kFaultEventInfos) {
    if (info.kind == sim::FaultEventKind::kNonlinear) continue;  // of the paper's arm alone
    all.push_back(
        {{"kind", info.name},
         {"words", info.words},
         {"joint", joint_words(info.of_joint)},
         {"on_bus", info.on_bus},
         {"unit", info.unit},
         {"least", info.least},
         {"most", info.most},
         {"proposed", info.unit.empty() ? ordered_json(nullptr)
                                        : number(proposed_size(info, live.input().robot))}});
  }
  return all;
}

ordered_json controller_json(const ControllerWord& word) {
  ordered_json json{{"state", sil::name_of(word.state)},
                    {"fault", nullptr},
                    {"fault_words", ""},
                    {"slows", word.slows}};
  if (word.state == hal::ControllerState::kFault) {
    json["fault"] = controller::name_of(word.fault);
    json["fault_words"] = words_of(word.fault);
  }
  return json;
}

ordered_json detection_json(const Detection& detection, const Live& live) {
  ordered_json json{{"number", detection.number}, {"t_s", time_number(detection.t_s)},
                    {"joint", nullptr},           {"act_t_s", nullptr},
                    {"act_joint", nullptr},       {"frozen", detection.frozen},
                    {"answer", nullptr}};
  if (detection.joint >= 0) json["joint"] = detection.joint + 1;
  if (detection.act_t_s) json["act_t_s"] = time_number(*detection.act_t_s);
  if (detection.act_joint >= 0) json["act_joint"] = detection.act_joint + 1;
  if (detection.answer) {
    const IsolatedFault& answer = *detection.answer;
    json["answer"] = {{"words", live.words_of(answer)},
                      {"kind", name_of(answer.kind)},
                      {"decided", answer.decided},
                      {"confidence", number(answer.confidence)},
                      {"size", number(answer.size)},
                      {"unit", answer.unit},
                      {"joint", nullptr}};
    if (answer.kind != FaultKind::kUnknown) json["answer"]["joint"] = answer.joint + 1;
  }
  return json;
}

// `begin`: the key of when they begin.
ordered_json faults_json(const std::vector<sim::FaultEvent>& faults, const char* begin) {
  ordered_json all = ordered_json::array();
  for (const sim::FaultEvent& fault : faults) {
    const sim::FaultEventInfo& info = info_of(fault.kind);
    ordered_json one{
        {"kind", info.name}, {"joint", nullptr}, {"size", nullptr}, {"unit", info.unit}};
    if (fault.joint >= 0) one["joint"] = fault.joint + 1;
    if (!info.unit.empty()) one["size"] = number(fault.size);
    one[begin] = time_number(fault.begin_s);
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace

ordered_json setup_json(const Live& live) {
  const LiveInput& input = live.input();
  ordered_json judged = ordered_json::array();
  for (const Judged& one : live.judged())
    judged.push_back({{"name", one.name}, {"unit", one.unit}});
  ordered_json joints = ordered_json::array();
  for (const RobotJoint& joint : input.robot.joints) joints.push_back(joint.name);
  return {
      {"source", live.is_simulated() ? "sil" : "bus"},
      {"bus", input.bus ? ordered_json(*input.bus) : ordered_json(nullptr)},
      {"plant", input.plant_file ? ordered_json(*input.plant_file) : ordered_json(nullptr)},
      {"robot", {{"name", input.robot.name}, {"file", input.robot_file}}},
      {"space", input.robot.estimator.space == EstimatorSpace::kTorque ? "torque" : "acceleration"},
      {"joints", std::move(joints)},
      {"judged", std::move(judged)},
      {"has_bound", live.has_bound()},
      {"has_two_levels", live.has_two_levels()},
      {"step_s", Strip::kStepS},
      {"kept_s", {kBeforeS, kAfterS}},
      {"explained_s", {kExplainedBeforeS, kExplainedAfterS}},
      {"longest_recording_s", kLongestRecordingS},
      {"faults", live.is_simulated() ? faults_of(live) : ordered_json::array()},
      {"planned", live.is_simulated() ? faults_json(input.scenario.faults, "begin_s")
                                      : ordered_json::array()}};
}

ordered_json moment_json(const Moment& moment, const Live& live) {
  ordered_json json{{"t_s", time_number(moment.t_s)},
                    {"driven", moment.is_driven},
                    {"judging", moment.is_judging},
                    {"words", moment.words},
                    {"ended", moment.ended},
                    {"controller", nullptr},
                    {"residual", numbers(moment.residual)},
                    {"threshold", numbers(moment.threshold)},
                    {"act", ordered_json::array()},
                    {"beyond", moment.beyond},
                    {"detection", nullptr},
                    {"faults", faults_json(moment.faults, "since_s")},
                    {"accommodates", moment.accommodates},
                    {"recording_s", nullptr},
                    {"counts",
                     {{"frames", moment.frames},
                      {"understood", moment.understood},
                      {"lost", moment.lost},
                      {"rejected", moment.rejected},
                      {"missing", moment.missing},
                      {"refused", moment.refused},
                      {"overflow", moment.overflow}}}};
  if (moment.controller) json["controller"] = controller_json(*moment.controller);
  if (moment.detection) json["detection"] = detection_json(*moment.detection, live);
  if (moment.recording_s) json["recording_s"] = number(*moment.recording_s);
  json["steps"] = {
      {"first", moment.steps.first},       {"next", moment.steps.next},
      {"t_s", times(moment.steps.t_s)},    {"low", tables(moment.steps.low)},
      {"high", tables(moment.steps.high)}, {"threshold", tables(moment.steps.threshold)},
      {"act", ordered_json::array()}};
  if (!live.has_two_levels()) return json;
  json["act"] = numbers(moment.act);
  json["steps"]["act"] = tables(moment.steps.act);
  return json;
}

nlohmann::json frozen_json(const Live& live, std::size_t pixels) {
  report::Page page;
  page.title = "live";
  page.verdict.words = "live";
  report::Section section;
  section.heading = "Around the detection";
  for (report::Chart& chart : live.frozen(pixels)) section.blocks.emplace_back(std::move(chart));
  page.sections.push_back(std::move(section));
  return report::to_json(page).at("sections").at(0).at("blocks");
}

}  // namespace offnominal::desk::live
