#include "calibrate/joints_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <offnominal/model/quantity.hpp>

#include "common/amount.hpp"
#include "common/number.hpp"
#include "common/text_table.hpp"
#include "replay/residual_chart.hpp"
#include "report/numbers.hpp"
#include "robot/bound_names.hpp"

namespace offnominal::desk {
namespace {

using namespace report;  // a page is written in its own words

std::string bound_words(const JointBoundSettings& bound) {
  if (bound.at.empty()) return shortest(bound.value[0]);
  const auto [least, most] = std::minmax_element(bound.value.begin(), bound.value.end());
  return fmt::format("{} to {} over its {}", shortest(*least), shortest(*most),
                     bound_variable_names(bound.variable).name);
}

// One row of a table: a joint behind one of its filters.
struct BoundOfFilter {
  std::size_t joint = 0;
  const JointCalibration& result;
  const JointBoundSettings& bound;
  std::string name;  // of the joint, and which filter where there are two
};

std::vector<BoundOfFilter> bounds_of(const JointsCalibration& calibration) {
  const BoundSettings& bound = *calibration.robot.bound;
  std::vector<BoundOfFilter> all;
  for (std::size_t i = 0; i < calibration.joints.size(); ++i) {
    const std::string& name = calibration.joints[i].name;
    all.push_back({i, calibration.joints[i], bound.joints[i], name});
    if (calibration.fast.empty()) continue;
    all.push_back({i, calibration.fast[i], bound.fast[i], name + ", fast"});
  }
  return all;
}

struct HeldOut {
  std::int64_t alarms = 0;
  double seconds = 0;
};

HeldOut held_out_of(const JointsCalibration& calibration) {
  HeldOut held_out;
  for (const BoundOfFilter& one : bounds_of(calibration)) {
    held_out.alarms += one.result.calibration.level.held_out_alarms;
    held_out.seconds = one.result.calibration.level.held_out_s;
  }
  return held_out;
}

Level level_of(const JointsCalibration& calibration) {
  if (!calibration.objections.empty()) return Level::kBad;
  const auto remarkable = [](const BoundOfFilter& one) {
    return margin_of(one.result.calibration).is_remarkable();
  };
  const auto all = bounds_of(calibration);
  return std::any_of(all.begin(), all.end(), remarkable) ? Level::kWarn : Level::kGood;
}

Table joints_table(const JointsCalibration& calibration) {
  Table table;
  table.caption = "Bounds, thresholds and the smallest lasting faults that are seen";
  table.columns = {{"joint", ""},
                   {"bound", ""},
                   {"unit", ""},
                   {"mean threshold", "", ".4g"},
                   {"largest ratio", "1", ".3g"},
                   {"seen in 95 of 100", "", ".3g"},
                   {"twice that, within", "s", ".3f"},
                   {"certain", "", ".3g"}};
  if (calibration.act_alarms_per_hour) table.columns.push_back({"act at, times", "1", ".3g"});
  for (const BoundOfFilter& one : bounds_of(calibration)) {
    const JointCalibration& joint = one.result;
    const BoundMargin margin = margin_of(joint.calibration);
    table.rows.push_back({one.name, bound_words(one.bound), joint.calibration.unit,
                          margin.mean_after, margin.largest_ratio_after, joint.fault.usual,
                          joint.fault.twice_s, joint.fault.certain_with});
    if (calibration.act_alarms_per_hour) table.rows.back().emplace_back(one.bound.act_ratio);
  }
  return table;
}

constexpr const char* kExcluded =
    "by itself the count on hold-out data excludes more alarms per hour than that, at 95 %";

Table margins_table(const JointsCalibration& calibration) {
  Table table;
  table.caption = "Against the old bound, and what the hold-out data exclude";
  table.columns = {{"joint", ""},
                   {"mean threshold to the old one's", "1", ".3g"},
                   {"hold-out alarms", "1", "d"},
                   {"excluded from", "1/h", ".3g"}};
  table.note = fmt::format("Excluded from: {}.", kExcluded);
  for (const BoundOfFilter& one : bounds_of(calibration)) {
    const JointCalibration& joint = one.result;
    const auto to_old = margin_of(joint.calibration).new_to_old;
    table.rows.push_back({one.name, to_old ? Cell(*to_old) : Cell(std::string("no old one")),
                          static_cast<double>(joint.calibration.level.held_out_alarms),
                          joint.calibration.level.highest_per_hour});
  }
  return table;
}

std::string margins_text(const JointsCalibration& calibration) {
  const TextTable table({{"joint", -16}, {"to old mu", 10}, {"excluded, 1/h", 13}}, "  ");
  std::string text = "\n" + table.heading();
  for (const BoundOfFilter& one : bounds_of(calibration)) {
    const JointCalibration& joint = one.result;
    const auto to_old = margin_of(joint.calibration).new_to_old;
    text += table.row(fmt::format("{} {}", one.joint + 1, one.name),
                      to_old ? significant(*to_old, 3) : "none",
                      significant(joint.calibration.level.highest_per_hour, 3));
  }
  return text + "\nexcluded: " + kExcluded + "\n";
}

Chart residual_chart(const BoundOfFilter& one, const JudgedStretch& stretch, std::size_t index) {
  const JointCalibration& joint = one.result;
  Chart chart = chart_against_threshold(
      EstimatorSpace::kTorque, joint.calibration.unit,
      {.x = numbers(stretch.t_s), .y = numbers(stretch.error_norm)},
      {.x = numbers(stretch.t_s), .y = numbers(stretch.threshold_after)}, one.bound.act_ratio);
  chart.title =
      fmt::format("{}, {}{}", one.name, stretch.file, stretch.held_out ? ", hold-out" : "");
  chart.zoom_group = fmt::format("recording {}", index);
  return chart;
}

nlohmann::ordered_json bound_json(const JointBoundSettings& bound, JointType type,
                                  const std::string& unit) {
  const BoundVariableName& variable = bound_variable_names(bound.variable);
  nlohmann::ordered_json json = {{"unit", unit},
                                 {"at", bound.at},
                                 {"at_unit", unit_of(variable.quantity, type)},
                                 {"value", bound.value},
                                 {"act_ratio", bound.act_ratio}};
  if (!bound.at.empty()) json["over"] = variable.name;
  return json;
}

nlohmann::ordered_json result_json(const JointCalibration& joint, const JointBoundSettings& bound,
                                   JointType type, const CalibrateNames& names) {
  nlohmann::ordered_json result = {{"bound", bound_json(bound, type, joint.calibration.unit)},
                                   {"smallest_fault",
                                    {{"unit", joint.calibration.unit},
                                     {"seen_in_95_of_100", joint.fault.usual},
                                     {"window_s", joint.fault.window_s},
                                     {"twice_that_within_s", joint.fault.twice_s},
                                     {"certain", joint.fault.certain},
                                     {"certain_with", joint.fault.certain_with},
                                     {"certain_within_s", joint.fault.certain_s}}}};
  nlohmann::ordered_json json = to_json(joint.calibration, names);
  for (const char* key : {"robot", "output", "verdict", "old_bound", "new_bound"}) json.erase(key);
  result.update(json);
  return result;
}

nlohmann::ordered_json joint_json(const JointsCalibration& calibration, std::size_t i,
                                  const CalibrateNames& names) {
  const BoundSettings& bound = *calibration.robot.bound;
  const JointType type = calibration.robot.joints[i].joint.type;
  nlohmann::ordered_json json = {{"joint", i + 1}, {"name", calibration.joints[i].name}};
  json.update(result_json(calibration.joints[i], bound.joints[i], type, names));
  if (!calibration.fast.empty()) {
    json["fast"] = result_json(calibration.fast[i], bound.fast[i], type, names);
  }
  return json;
}

}  // namespace

std::string verdict_of(const JointsCalibration& calibration) {
  if (!calibration.objections.empty()) {
    return "These recordings give no bounds that can be trusted. " + calibration.objections.front();
  }
  const HeldOut held_out = held_out_of(calibration);
  std::string words = "Lasting faults that are seen from";
  for (std::size_t i = 0; i < calibration.joints.size(); ++i) {
    const JointCalibration& joint = calibration.joints[i];
    const double usual = calibration.fast.empty()
                             ? joint.fault.usual
                             : std::min(joint.fault.usual, calibration.fast[i].fault.usual);
    words += fmt::format("{} {} {} on joint {}", i == 0 ? "" : ",", significant(usual, 2),
                         joint.calibration.unit, i + 1);
  }
  return words + fmt::format("; {} of {} in {:g} s of hold-out data.",
                             counted(static_cast<std::size_t>(held_out.alarms), "alarm"),
                             counted(calibration.joints.size(), "joint"), held_out.seconds);
}

std::string text_of(const JointsCalibration& calibration, const CalibrateNames& names) {
  const bool acts = calibration.act_alarms_per_hour.has_value();
  std::vector<TextColumn> columns{{"joint", -16},     {"bound", -34},       {"", -4},
                                  {"mean mu", 9},     {"ratio", 7},         {"seen from", 10},
                                  {"twice in s", 11}, {"certain from", 13}, {"alarms", 7}};
  if (acts) columns.push_back({"act at", 8});
  const TextTable table(columns, "  ");
  std::string text = fmt::format("uncertainty bounds of {}, joint by joint\n", names.robot);
  text += table.heading();
  for (const BoundOfFilter& one : bounds_of(calibration)) {
    const JointCalibration& joint = one.result;
    const BoundMargin margin = margin_of(joint.calibration);
    std::vector<std::string> cells{fmt::format("{} {}", one.joint + 1, one.name),
                                   bound_words(one.bound),
                                   joint.calibration.unit,
                                   significant(margin.mean_after, 4),
                                   fmt::format("{:.3f}", margin.largest_ratio_after),
                                   significant(joint.fault.usual, 3),
                                   fmt::format("{:.3f}", joint.fault.twice_s),
                                   significant(joint.fault.certain_with, 3),
                                   std::to_string(joint.calibration.level.held_out_alarms)};
    if (acts) cells.push_back(significant(one.bound.act_ratio, 3) + " mu");
    text += table.line(cells);
  }
  const SmallestFault& fault = calibration.joints.front().fault;
  text += fmt::format(
      "\nseen from: lasting torque beside the model that is seen within {:.3g} s in 95 of 100 "
      "beginnings in these\nrecordings, half of those twice as large within 'twice in s'; certain "
      "from: within {:.3g} s whatever the\nrobot's errors do inside their bounds\n"
      "false alarms: {:g} per hour of all joints{}, an even share each, extrapolated from the "
      "maxima of {}\nthat the bounds had not seen (blocks taken as independent, "
      "motions as in these recordings)\n",
      fault.window_s, fault.certain_s, calibration.alarms_per_hour,
      calibration.fast.empty() ? "" : " and both filters", blocks_words(calibration));
  if (!calibration.fast.empty()) {
    const SmallestFault& of_fast = calibration.fast.front().fault;
    text += fmt::format("behind the fast filter: seen within {:.3g} s, certain within {:.3g} s\n",
                        of_fast.window_s, of_fast.certain_s);
  }
  if (acts) {
    text +=
        fmt::format("act at: the second level, for {:g} false alarms per hour by the same law\n",
                    *calibration.act_alarms_per_hour);
  }
  return text + margins_text(calibration) +
         remarks_text(calibration.notes, calibration.objections) + verdict_of(calibration) + "\n";
}

nlohmann::ordered_json to_json(const JointsCalibration& calibration, const CalibrateNames& names) {
  using nlohmann::ordered_json;
  const HeldOut held_out = held_out_of(calibration);
  ordered_json joints = ordered_json::array();
  for (std::size_t i = 0; i < calibration.joints.size(); ++i) {
    joints.push_back(joint_json(calibration, i, names));
  }
  return {{"robot", names.robot},
          {"output", calibration.objections.empty() ? ordered_json(names.output) : ordered_json()},
          {"verdict", verdict_of(calibration)},
          {"space", "torque"},
          {"alarms_per_hour", calibration.alarms_per_hour},
          {"act_alarms_per_hour", calibration.act_alarms_per_hour
                                      ? ordered_json(*calibration.act_alarms_per_hour)
                                      : ordered_json()},
          {"held_out_s", held_out.seconds},
          {"held_out_alarms", held_out.alarms},
          {"joints", joints},
          {"notes", calibration.notes},
          {"objections", calibration.objections}};
}

report::Page page_of(const JointsCalibration& calibration, const CalibrateNames& names) {
  Page page;
  page.title = "Calibrated uncertainty bounds of " + names.robot;
  page.subtitle = "joint by joint, judged after the filter";
  page.verdict = {verdict_of(calibration), level_of(calibration)};
  page.command_line = names.command_line;
  Section result{.heading = "The bounds", .text = "", .blocks = {}};
  add_remarks(calibration.notes, calibration.objections, result);
  result.blocks.emplace_back(joints_table(calibration));
  result.blocks.emplace_back(margins_table(calibration));
  page.sections.push_back(result);
  Section time{.heading = "Residual against threshold", .text = "", .blocks = {}};
  for (const BoundOfFilter& one : bounds_of(calibration)) {
    const std::vector<JudgedStretch>& stretches = one.result.calibration.stretches;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      time.blocks.emplace_back(residual_chart(one, stretches[i], i));
    }
  }
  page.sections.push_back(time);
  return page;
}

}  // namespace offnominal::desk
