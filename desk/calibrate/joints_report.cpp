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

namespace offnominal::desk {
namespace {

using namespace report;  // a page is written in its own words

std::string bound_words(const JointBoundSettings& bound) {
  if (bound.at.empty()) return shortest(bound.value[0]);
  const auto [least, most] = std::minmax_element(bound.value.begin(), bound.value.end());
  return fmt::format("{} to {} over its speed", shortest(*least), shortest(*most));
}

struct HeldOut {
  std::int64_t alarms = 0;
  double seconds = 0;
};

HeldOut held_out_of(const JointsCalibration& calibration) {
  HeldOut held_out;
  for (const JointCalibration& joint : calibration.joints) {
    held_out.alarms += joint.calibration.level.held_out_alarms;
    held_out.seconds = joint.calibration.level.held_out_s;
  }
  return held_out;
}

Level level_of(const JointsCalibration& calibration) {
  if (!calibration.objections.empty()) return Level::kBad;
  const auto remarkable = [](const JointCalibration& joint) {
    return margin_of(joint.calibration).is_remarkable();
  };
  const auto& joints = calibration.joints;
  return std::any_of(joints.begin(), joints.end(), remarkable) ? Level::kWarn : Level::kGood;
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
  for (std::size_t i = 0; i < calibration.joints.size(); ++i) {
    const JointCalibration& joint = calibration.joints[i];
    const BoundMargin margin = margin_of(joint.calibration);
    table.rows.push_back({joint.name, bound_words(calibration.robot.bound->joints[i]),
                          joint.calibration.unit, margin.mean_after, margin.largest_ratio_after,
                          joint.fault.usual, joint.fault.twice_s, joint.fault.certain_with});
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
  for (const JointCalibration& joint : calibration.joints) {
    const auto to_old = margin_of(joint.calibration).new_to_old;
    table.rows.push_back({joint.name, to_old ? Cell(*to_old) : Cell(std::string("no old one")),
                          static_cast<double>(joint.calibration.level.held_out_alarms),
                          joint.calibration.level.highest_per_hour});
  }
  return table;
}

std::string margins_text(const JointsCalibration& calibration) {
  const TextTable table({{"joint", -16}, {"to old mu", 10}, {"excluded, 1/h", 13}}, "  ");
  std::string text = "\n" + table.heading();
  for (std::size_t i = 0; i < calibration.joints.size(); ++i) {
    const JointCalibration& joint = calibration.joints[i];
    const auto to_old = margin_of(joint.calibration).new_to_old;
    text += table.row(fmt::format("{} {}", i + 1, joint.name),
                      to_old ? significant(*to_old, 3) : "none",
                      significant(joint.calibration.level.highest_per_hour, 3));
  }
  return text + "\nexcluded: " + kExcluded + "\n";
}

Chart residual_chart(const JointCalibration& joint, const JudgedStretch& stretch,
                     std::size_t index) {
  Chart chart =
      chart_against_threshold(EstimatorSpace::kTorque, joint.calibration.unit,
                              {.x = numbers(stretch.t_s), .y = numbers(stretch.error_norm)},
                              {.x = numbers(stretch.t_s), .y = numbers(stretch.threshold_after)});
  chart.title =
      fmt::format("{}, {}{}", joint.name, stretch.file, stretch.held_out ? ", hold-out" : "");
  chart.zoom_group = fmt::format("recording {}", index);
  return chart;
}

nlohmann::ordered_json joint_json(const JointsCalibration& calibration, std::size_t i,
                                  const CalibrateNames& names) {
  const JointCalibration& joint = calibration.joints[i];
  const JointBoundSettings& bound = calibration.robot.bound->joints[i];
  const JointType type = calibration.robot.joints[i].joint.type;
  nlohmann::ordered_json json = to_json(joint.calibration, names);
  for (const char* key : {"robot", "output", "verdict", "old_bound", "new_bound"}) json.erase(key);
  nlohmann::ordered_json result = {{"joint", i + 1},
                                   {"name", joint.name},
                                   {"bound",
                                    {{"unit", joint.calibration.unit},
                                     {"at", bound.at},
                                     {"at_unit", unit_of(Quantity::kVelocity, type)},
                                     {"value", bound.value}}},
                                   {"smallest_fault",
                                    {{"unit", joint.calibration.unit},
                                     {"seen_in_95_of_100", joint.fault.usual},
                                     {"window_s", joint.fault.window_s},
                                     {"twice_that_within_s", joint.fault.twice_s},
                                     {"certain", joint.fault.certain},
                                     {"certain_with", joint.fault.certain_with},
                                     {"certain_within_s", joint.fault.certain_s}}}};
  result.update(json);
  return result;
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
    words += fmt::format("{} {} {} on joint {}", i == 0 ? "" : ",",
                         significant(joint.fault.usual, 2), joint.calibration.unit, i + 1);
  }
  return words + fmt::format("; {} of {} in {:g} s of hold-out data.",
                             counted(static_cast<std::size_t>(held_out.alarms), "alarm"),
                             counted(calibration.joints.size(), "joint"), held_out.seconds);
}

std::string text_of(const JointsCalibration& calibration, const CalibrateNames& names) {
  const TextTable table({{"joint", -16},
                         {"bound", -34},
                         {"", -4},
                         {"mean mu", 9},
                         {"ratio", 7},
                         {"seen from", 10},
                         {"twice in s", 11},
                         {"certain from", 13},
                         {"alarms", 7}},
                        "  ");
  std::string text = fmt::format("uncertainty bounds of {}, joint by joint\n", names.robot);
  text += table.heading();
  for (std::size_t i = 0; i < calibration.joints.size(); ++i) {
    const JointCalibration& joint = calibration.joints[i];
    const BoundMargin margin = margin_of(joint.calibration);
    text += table.row(
        fmt::format("{} {}", i + 1, joint.name), bound_words(calibration.robot.bound->joints[i]),
        joint.calibration.unit, significant(margin.mean_after, 4),
        fmt::format("{:.3f}", margin.largest_ratio_after), significant(joint.fault.usual, 3),
        fmt::format("{:.3f}", joint.fault.twice_s), significant(joint.fault.certain_with, 3),
        joint.calibration.level.held_out_alarms);
  }
  const SmallestFault& fault = calibration.joints.front().fault;
  const FalseAlarmLevel& level = calibration.joints.front().calibration.level;
  text += fmt::format(
      "\nseen from: lasting torque beside the model that is seen within {:.3g} s in 95 of 100 "
      "beginnings in these\nrecordings, half of those twice as large within 'twice in s'; certain "
      "from: within {:.3g} s whatever the\nrobot's errors do inside their bounds\n"
      "false alarms: {:g} per hour of all joints, an even share each, extrapolated from the maxima "
      "of {} blocks of {:g} s\nthat the bounds had not seen (blocks taken as independent, motions "
      "as in these recordings)\n",
      fault.window_s, fault.certain_s, calibration.alarms_per_hour, level.blocks, level.block_s);
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
  for (const JointCalibration& joint : calibration.joints) {
    for (std::size_t i = 0; i < joint.calibration.stretches.size(); ++i) {
      time.blocks.emplace_back(residual_chart(joint, joint.calibration.stretches[i], i));
    }
  }
  page.sections.push_back(time);
  return page;
}

}  // namespace offnominal::desk
