#include "sil/sil_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/text_table.hpp"
#include "paper/figures.hpp"
#include "paper/paper_json.hpp"
#include "sil/not_held.hpp"

namespace offnominal::desk::sil {
namespace {

using nlohmann::ordered_json;

ordered_json nullable(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

struct Row {
  std::string name;
  std::string value;
};

std::string seconds(const std::optional<double>& value) {
  return value ? fmt::format("{:.3f} s", *value) : "none";
}

ordered_json to_json(const NotHeld& arm) {
  return {{"joint", arm.joint + 1},
          {"name", arm.name},
          {"unit", arm.unit},
          {"moved", arm.moved},
          {"position_window", arm.window},
          {"speed", arm.speed},
          {"arming_speed", arm.speed_limit},
          {"causes", arm.causes}};
}

std::string why(const NotHeld& arm) {
  if (!arm.causes.empty()) {
    return fmt::format("It may be that {}", fmt::join(arm.causes, "; or that "));
  }
  return "Neither weight, torque limits, torque_rate, gains nor friction of the robot file say "
         "why: look at what pushes the arm, and raise kp_per_s2 and kd_per_s of [joint.control]";
}

// Nothing where the run ended before its last quarter.
std::string tracking(const SilResult& result) {
  std::vector<std::string> words;
  const auto add = [&](double rms, const char* unit) {
    if (std::isfinite(rms)) words.push_back(fmt::format("{:.4f} {} rms", rms, unit));
  };
  add(result.run.tracking_rms_rad, "rad");
  if (result.run.tracking_rms_m) add(*result.run.tracking_rms_m, "m");
  return words.empty() ? "none: the run ended early" : fmt::format("{}", fmt::join(words, ", "));
}

std::vector<std::string> names_in(const paper::ExperimentResult& run) {
  std::vector<std::string> names;
  for (const paper::JointRun& joint : run.joints) names.push_back(joint.name);
  return names;
}

std::string joint_words(const paper::ExperimentResult& run, std::size_t joint) {
  return fmt::format("joint {} ({})", joint + 1, run.joints[joint].name);
}

// Every joint that crossed a level, in the order of the chain: "joint 2 (elbow) at 1.031 s".
std::string joints_beyond(const paper::ExperimentResult& run,
                          std::optional<double> paper::JointRun::*time_s) {
  std::string words;
  for (std::size_t i = 0; i < run.joints.size(); ++i) {
    const std::optional<double>& at_s = run.joints[i].*time_s;
    if (!at_s) continue;
    words += fmt::format("{}{} at {:.3f} s", words.empty() ? "" : ", ", joint_words(run, i), *at_s);
  }
  return words.empty() ? "none" : words;
}

// What is only there in runs of some robots, below the row of the detection.
std::vector<Row> rows_of_detection(const SilResult& result) {
  const paper::ExperimentResult& run = result.run;
  std::vector<Row> rows;
  if (!run.joints.empty()) {
    rows.push_back(
        {"first joint off nominal",
         run.first_joint ? joint_words(run, static_cast<std::size_t>(*run.first_joint)) : "none"});
    rows.push_back({"joints off nominal", joints_beyond(run, &paper::JointRun::detection_time_s)});
  }
  if (run.has_two_levels) {
    rows.push_back({"beyond the level to act", seconds(run.act_time_s)});
    rows.push_back({"joints beyond it", joints_beyond(run, &paper::JointRun::act_time_s)});
  }
  if (result.slowed) {
    rows.push_back({"motion slowed", fmt::format("{:.3f} s, {}", result.slowed->time_s,
                                                 slowing_words(result.slowed->as))});
  } else if (result.at_detection == controller::AtDetection::kSlow) {
    rows.push_back({"motion slowed", "never"});
  }
  if (result.isolated) {
    rows.push_back({"which fault", words_of(*result.isolated, names_in(run))});
  }
  return rows;
}

void add_rows_of(const RealTimeReport& time, std::vector<Row>& rows) {
  rows.push_back({"ticks of the controller", std::to_string(time.ticks)});
  rows.push_back({"latest begin of a tick", fmt::format("{} us", time.worst_late_us)});
  rows.push_back({"a tick's work, mean and longest",
                  fmt::format("{:.0f} us, {} us", time.mean_step_us, time.worst_step_us)});
  rows.push_back(
      {"real time of the controller",
       fmt::format("{}, {}",
                   time.fifo_priority > 0 ? fmt::format("SCHED_FIFO {}", time.fifo_priority)
                                          : std::string("ordinary scheduling"),
                   time.memory_locked ? "memory locked" : "memory not locked")});
  rows.push_back({"late ticks of the plant", std::to_string(time.plant_overruns)});
  rows.push_back({"entries that the recordings lost", std::to_string(time.recording_lost)});
}

std::vector<Row> rows_of(const SilResult& result) {
  const paper::ExperimentResult& run = result.run;
  const BusReport& bus = result.bus;
  std::vector<Row> rows = {
      {"faults", words_of(result.faults)},
      {"first fault begins", seconds(run.fault_time_s)},
      {"detected", seconds(run.detection_time_s)},
      {"before the fault: largest |e| / mu",
       fmt::format("{:.4f}", run.max_error_to_threshold_before_fault)},
      {"tracking error, last quarter", tracking(result)},
      {"controller at the end",
       result.fault == controller::Fault::kNone
           ? name_of(result.state)
           : fmt::format("{}: {} ({})", name_of(result.state), controller::name_of(result.fault),
                         static_cast<int>(result.fault))},
      {"time to safe state", seconds(result.time_to_safe_state_s)},
      {"late ticks", std::to_string(result.overruns)},
      {"bus", result.bus_name},
      {"frames", std::to_string(bus.frames)},
      {"lost, by their counters", std::to_string(bus.lost)},
      {"rejected (CRC, counter, value)", std::to_string(bus.rejected)},
      {"ticks without a fresh reading", std::to_string(bus.stale)},
      {"not sent for lateness", std::to_string(bus.late)},
      {"bus load at most, 1 Mbit/s (FD data 5 Mbit/s)", fmt::format("{:.1f} %", 100 * bus.load)},
  };
  constexpr int kBehindDetected = 3;
  const std::vector<Row> of_detection = rows_of_detection(result);
  rows.insert(rows.begin() + kBehindDetected, of_detection.begin(), of_detection.end());
  if (result.real_time) add_rows_of(*result.real_time, rows);
  return rows;
}

}  // namespace

std::string name_of(hal::ControllerState state) {
  switch (state) {
    case hal::ControllerState::kInit:
      return "init";
    case hal::ControllerState::kPassive:
      return "passive";
    case hal::ControllerState::kArmed:
      return "armed";
    case hal::ControllerState::kFault:
      return "fault";
  }
  return "unknown";
}

ordered_json to_json(const SilResult& result) {
  ordered_json json = paper::to_json(result.run);
  json["fault"] = words_of(result.faults);
  json["bus"] = {{"name", result.bus_name},
                 {"frames", result.bus.frames},
                 {"lost", result.bus.lost},
                 {"rejected", result.bus.rejected},
                 {"stale", result.bus.stale},
                 {"late", result.bus.late},
                 {"load_percent", 100 * result.bus.load}};
  json["time_to_safe_state_s"] = nullable(result.time_to_safe_state_s);
  json["overruns"] = result.overruns;
  json["controller_state"] = name_of(result.state);
  json["controller_fault"] = controller::name_of(result.fault);
  json["ended_early_s"] = nullable(result.ended_early_s);
  json["unasked_stop"] = is_unasked_stop(result);
  json["judged"] = result.is_judged;
  json["at_detection"] = offnominal::desk::name_of(result.at_detection);
  json["slowed"] = nullptr;
  if (result.slowed) {
    json["slowed"] = {{"time_s", result.slowed->time_s},
                      {"to", result.slowed->as.to},
                      {"within_s", result.slowed->as.within_s},
                      {"reached", result.slowed->reached}};
  }
  json["not_held"] = result.not_held ? to_json(*result.not_held) : ordered_json(nullptr);
  json["verdict"] = sentence_of(result);
  json["isolated"] =
      result.isolated
          ? ordered_json(offnominal::desk::to_json(*result.isolated, names_in(result.run)))
          : ordered_json(nullptr);
  if (!result.real_time) return json;
  const RealTimeReport& time = *result.real_time;
  json["real_time"] = {{"ticks", time.ticks},
                       {"worst_late_us", time.worst_late_us},
                       {"worst_step_us", time.worst_step_us},
                       {"mean_step_us", time.mean_step_us},
                       {"fifo_priority", time.fifo_priority},
                       {"memory_locked", time.memory_locked},
                       {"plant_overruns", time.plant_overruns},
                       {"recording_lost", time.recording_lost}};
  return json;
}

// Of several faults that one which began last before the detection.
std::string detected_words(const SilResult& result) {
  const double at_s = *result.run.detection_time_s;
  double begin_s = *result.run.fault_time_s;
  for (const sim::FaultEvent& fault : result.faults) {
    if (fault.begin_s <= at_s) begin_s = std::max(begin_s, fault.begin_s);
  }
  if (result.faults.size() < 2) {
    return fmt::format("The fault is detected {:.3f} s after it began.", at_s - begin_s);
  }
  return fmt::format(
      "The first detection is {:.3f} s after a fault began, the one at {:g} s of {} faults.",
      at_s - begin_s, begin_s, result.faults.size());
}

std::string sentence_of(const SilResult& result) {
  const paper::ExperimentResult& run = result.run;
  std::string words;
  if (result.not_held) {
    words = fmt::format("The arm was not held: {}. {}.", words_of(*result.not_held),
                        why(*result.not_held));
  } else if (is_unasked_stop(result)) {
    words =
        fmt::format("The run failed: {}. What it asks for is number {} of docs/troubleshooting.md.",
                    run.fault_time_s ? "it ended before the first fault of the scenario began"
                                     : "the scenario has no fault that could have ended it",
                    static_cast<int>(result.fault));
  } else if (run.detection_time_s && run.fault_time_s &&
             *run.detection_time_s >= *run.fault_time_s) {
    words = detected_words(result);
  } else if (!result.is_judged) {
    words = "Nothing was judged: the robot file has no bound.";
  } else if (run.detection_time_s) {
    words = "There is an alarm while nothing is wrong.";
  } else if (run.fault_time_s) {
    words = "The monitor sees nothing that the uncertainty could not do.";
  } else {
    words = "Nothing is wrong, and nothing is called a fault.";
  }
  if (run.first_joint) {
    words += fmt::format(" First off nominal is {}.",
                         joint_words(run, static_cast<std::size_t>(*run.first_joint)));
  }
  if (run.has_two_levels && run.detection_time_s) {
    words += run.act_time_s ? fmt::format(" Beyond the level to act at {:.3f} s.", *run.act_time_s)
                            : std::string(" Never beyond the level to act.");
  }
  if (result.slowed) {
    words += fmt::format(" The controller slowed the motion {}.", slowing_words(result.slowed->as));
    if (!result.slowed->reached) words += " The run ended before that.";
  }
  if (result.state == hal::ControllerState::kFault) {
    words += fmt::format(" The controller went to its safe state: {}.",
                         controller::name_of(result.fault));
  }
  if (result.time_to_safe_state_s) {
    words += fmt::format(" No drive gave torque {:.3f} s after the first fault.",
                         *result.time_to_safe_state_s);
  }
  return words;
}

std::string text_of(const SilResult& result) {
  std::string text;
  const TextTable table({{"", -46}, {"", 0}});
  for (const Row& row : rows_of(result)) text += table.row(row.name, row.value);
  return text + sentence_of(result) + "\n";
}

report::Page page_of(const SilResult& result, const std::string& command_line) {
  report::Page page = paper::page_of(result.run, command_line);
  page.title = "Controller and arm on a CAN bus";
  page.subtitle = fmt::format("faults: {}; bus: {}", words_of(result.faults), result.bus_name);
  page.verdict.words = sentence_of(result);
  report::Section bus;
  bus.heading = "Bus and controller";
  report::Table table;
  table.caption = "What the run showed";
  for (const char* name : {"what", "value"}) {
    report::Column column;
    column.name = name;
    table.columns.push_back(column);
  }
  for (const Row& row : rows_of(result)) table.rows.push_back({row.name, row.value});
  bus.blocks.emplace_back(std::move(table));
  page.sections.insert(page.sections.begin(), std::move(bus));
  return page;
}

}  // namespace offnominal::desk::sil
