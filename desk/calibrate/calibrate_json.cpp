#include <cmath>
#include <nlohmann/json.hpp>

#include "calibrate/calibrate_report.hpp"
#include "robot/bound_names.hpp"

namespace offnominal::desk {
namespace {

using nlohmann::ordered_json;

ordered_json optional(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json();
}

ordered_json calibration_json(const BoundSettings& bound, const std::string& velocity_unit) {
  const bool plain = velocity_unit == "1";
  ordered_json json;
  const char* const kind = name_of(bound.kind);
  switch (bound.kind) {
    case BoundSettings::Kind::kConstant:
      json = {{"kind", kind}, {"value", bound.constant.value}};
      break;
    case BoundSettings::Kind::kScaledNorm:
      json = {{"kind", kind},
              {"scale", bound.scaled_norm.scale},
              {"offset", bound.scaled_norm.offset},
              {"matrix", bound.scaled_norm.matrix}};
      break;
    case BoundSettings::Kind::kTable:
      json = {{"kind", kind},
              {"variable", bound_variable_names(bound.table.variable).name},
              {"joint", bound.table.joint + 1},
              {"at", bound.table.at},
              {"value", bound.table.value}};
      break;
    case BoundSettings::Kind::kPerJoint:  // said joint by joint (joints_report.cpp)
      break;
  }
  json["unit"] = plain ? velocity_unit : velocity_unit + "^2";
  json["velocity_error"] = bound.velocity_error;
  json["velocity_error_unit"] = velocity_unit;
  return json;
}

ordered_json calibration_json(const JudgedStretch& stretch) {
  return {{"log", stretch.file},
          {"begin_s", stretch.begin_s},
          {"end_s", stretch.end_s},
          {"held_out", stretch.held_out},
          {"samples", stretch.samples},
          {"mean_threshold_before", optional(stretch.mean_threshold_before)},
          {"mean_threshold_after", stretch.mean_threshold_after},
          {"max_error_to_threshold_before", optional(stretch.max_ratio_before)},
          {"max_error_to_threshold_after", optional(stretch.max_ratio_after)},
          {"alarms_before",
           stretch.mean_threshold_before ? ordered_json(stretch.alarms_before) : ordered_json()},
          {"alarms_after", stretch.alarms_after},
          {"first_alarm_s", optional(stretch.first_alarm_s)}};
}

ordered_json calibration_json(const std::optional<Transient>& transient) {
  if (!transient) return {};
  return {{"log", transient->file},
          {"time_s", transient->time_s},
          {"joint", transient->joint + 1},
          {"error", transient->error_norm},
          {"times_the_others", transient->ratio},
          {"mean_threshold_if_extrapolated", transient->mean_threshold_with},
          {"mean_threshold", transient->mean_threshold_without}};
}

ordered_json calibration_json(const FalseAlarmLevel& level) {
  return {
      {"alarms_per_hour", level.alarms_per_hour},
      {"block_s", level.block_s},
      {"blocks", level.blocks},
      {"extreme_value_law",
       {{"location", level.law.location}, {"scale", level.law.scale}, {"shape", level.law.shape}}},
      {"held_out_s", level.held_out_s},
      {"held_out_alarms", level.held_out_alarms},
      {"highest_per_hour_95", level.highest_per_hour}};
}

}  // namespace

ordered_json to_json(const Calibration& calibration, const CalibrateNames& names) {
  const BoundMargin margin = margin_of(calibration);
  ordered_json stretches = ordered_json::array();
  for (const JudgedStretch& stretch : calibration.stretches)
    stretches.push_back(calibration_json(stretch));
  ordered_json shapes = ordered_json::array();
  for (const ShapeScore& shape : calibration.shapes) {
    shapes.push_back({{"shape", shape.words},
                      {"largest_unseen_ratio", shape.largest_unseen_ratio},
                      {"widening", shape.widening},
                      {"mean_threshold", shape.mean_threshold},
                      {"chosen", shape.chosen}});
  }
  return {{"robot", names.robot},
          {"output", calibration.objections.empty() ? ordered_json(names.output) : ordered_json()},
          {"verdict", verdict_of(calibration)},
          {"unit", calibration.unit},
          {"old_bound", calibration.old_bound
                            ? calibration_json(*calibration.old_bound, calibration.unit)
                            : ordered_json()},
          {"new_bound", calibration_json(*calibration.robot.bound, calibration.unit)},
          {"mean_threshold_before", optional(margin.mean_before)},
          {"mean_threshold_after", margin.mean_after},
          {"new_to_old", optional(margin.new_to_old)},
          {"max_error_to_threshold_before", optional(margin.largest_ratio_before)},
          {"max_error_to_threshold_after", margin.largest_ratio_after},
          {"transient", calibration_json(calibration.transient)},
          {"false_alarms", calibration_json(calibration.level)},
          {"recordings", stretches},
          {"shapes", shapes},
          {"notes", calibration.notes},
          {"objections", calibration.objections}};
}

}  // namespace offnominal::desk
