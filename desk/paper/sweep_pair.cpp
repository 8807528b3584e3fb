#include "paper/sweep_pair.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "paper/paper_json.hpp"

namespace offnominal::desk::paper {
namespace {

std::string smallest_of(const std::string& robot, const SweepResult& sweep) {
  std::string words = sweep.smallest_detected
                          ? fmt::format("{} detects a mass loss from {:.1f} % on", robot,
                                        100 * *sweep.smallest_detected)
                          : fmt::format("{} detects no mass loss", robot);
  if (sweep.largest_undetected && sweep.smallest_detected &&
      *sweep.largest_undetected > *sweep.smallest_detected) {
    words += fmt::format(" (and misses one of {:.1f} %)", 100 * *sweep.largest_undetected);
  }
  if (sweep.false_alarm_s) {
    words += fmt::format(", with a false alarm at {:.3f} s", *sweep.false_alarm_s);
  }
  return words;
}

report::Series delays_of(const std::string& name, const SweepResult& sweep, report::Tone tone) {
  report::Series series;
  series.name = name;
  series.kind = report::SeriesKind::kPoints;
  series.tone = tone;
  for (const SweepProbe& probe : sweep.probes) {
    if (!probe.detection_time_s) continue;
    series.x.push_back(100 * probe.mass_loss);
    series.y.push_back(*probe.detection_time_s);
  }
  return series;
}

nlohmann::ordered_json named(const std::string& robot, const SweepResult& sweep) {
  nlohmann::ordered_json json{{"robot", robot}};
  json.update(to_json(sweep));
  return json;
}

}  // namespace

std::string words_of(const SweepPair& pair) {
  return smallest_of(pair.before_robot, pair.before) + "; " +
         smallest_of(pair.after_robot, pair.after) + ".";
}

nlohmann::ordered_json to_json(const SweepPair& pair) {
  return {{"before", named(pair.before_robot, pair.before)},
          {"after", named(pair.after_robot, pair.after)},
          {"verdict", words_of(pair)}};
}

report::Page page_of(const SweepPair& pair, const std::string& command_line) {
  using report::Level;
  report::Page page;
  page.title = "Smallest fault that is seen, before and after";
  page.subtitle = "two-link arm, mass of link 1 falling from 10 s on";
  const bool sound = pair.after.smallest_detected && !pair.after.false_alarm_s;
  page.verdict = {words_of(pair), sound ? Level::kGood : Level::kWarn};
  page.command_line = command_line;
  report::Section section;
  section.heading = "Mass loss";
  report::Waterfall bars;
  bars.title = "Smallest mass loss that is detected";
  bars.value_axis = {.name = "mass loss", .unit = "%"};
  if (pair.before.smallest_detected) {
    bars.steps.push_back({pair.before_robot, 100 * *pair.before.smallest_detected});
  }
  if (pair.after.smallest_detected) {
    bars.steps.push_back({pair.after_robot, 100 * *pair.after.smallest_detected});
  }
  if (!bars.steps.empty()) section.blocks.emplace_back(bars);
  report::Chart chart;
  chart.title = "When each loss is detected";
  chart.x = {.name = "mass loss", .unit = "%", .log = true};
  chart.y = {{.name = "time of detection", .unit = "s"}};
  const auto add = [&chart](report::Series series) {
    if (!series.x.empty()) chart.series.push_back(std::move(series));
  };
  add(delays_of(pair.before_robot, pair.before, report::Tone::kFaint));
  add(delays_of(pair.after_robot, pair.after, report::Tone::kModel));
  chart.levels.push_back({10.0, "the fault begins"});
  chart.note = "Losses without a point are not detected within the run.";
  if (!chart.series.empty()) section.blocks.emplace_back(chart);
  page.sections.push_back(std::move(section));
  return page;
}

}  // namespace offnominal::desk::paper
