#include "look/look_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/number.hpp"
#include "common/text_table.hpp"
#include "log/read_log.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string percent(double share) { return share > 0 ? fmt::format("{:.3g} %", 100 * share) : ""; }

std::string step_words(const ColumnFacts& facts) {
  if (facts.step == 0) return "";
  return fmt::format("{:.6g}{}", facts.step, facts.is_printed ? " (digits)" : "");
}

std::string number_words(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "none";
}

std::string role_words(const LookedColumn& column) { return name_of(column.role); }

// Time does not rest, however long the recording is.
double rests(const LookedColumn& column) {
  return column.role == Role::kTime ? 0 : column.facts.resting_share;
}

std::string sampling_words(const Look& look) {
  if (!look.sampling) return "time: none";
  const Sampling& sampling = *look.sampling;
  std::string words =
      fmt::format("time: {} samples, {:.6g} s, one every {:.6g} s ({:.6g} Hz)", look.t_s->size(),
                  (*look.t_s)[look.t_s->size() - 1] - (*look.t_s)[0], sampling.median_period_s,
                  1 / sampling.median_period_s);
  if (sampling.jitter > kSamplingJitter) {
    words += fmt::format("; steps off by up to {:.3g} % of their mean", 100 * sampling.jitter);
  }
  if (sampling.largest_gap_s > kMaxGap * sampling.median_period_s) {
    words += fmt::format("; a gap of {:.4g} s after t = {:.6g} s, more than {:g} periods",
                         sampling.largest_gap_s, sampling.largest_gap_at_s, kMaxGap);
  }
  return words;
}

// One line per sentence behind its mark.
std::string lines_of(const char* mark, const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += std::string(mark) + sentence + '\n';
  return text;
}

// What the robot file's own channels read.
std::string by_robot_text(const Look& look) {
  if (look.by_robot.empty()) return {};
  const TextTable table({{"joint", -20},
                         {"quantity", -13},
                         {"unit", -8},
                         {"lowest", 12},
                         {"highest", 12},
                         {"  from", -6}});
  std::string text = "\nas the robot file's [channels] read it, at the joints:\n" + table.heading();
  for (const ReadChannel& channel : look.by_robot) {
    text +=
        table.row(channel.joint, channel.quantity, channel.unit, fmt::format("{:.6g}", channel.low),
                  fmt::format("{:.6g}", channel.high), "  " + channel.from);
  }
  return text;
}

}  // namespace

std::string text_of(const Look& look) {
  const TextTable table({{"column", -24},
                         {"taken for", -10},
                         {"unit", -6},
                         {"lowest", 12},
                         {"highest", 12},
                         {"step", 20},
                         {"rests", 8},
                         {"at its highest", 14},
                         {"at its lowest", 13}});
  std::string text = look.file + "\n" + sampling_words(look) + "\n\n" + table.heading();
  for (const LookedColumn& column : look.columns) {
    const ColumnFacts& facts = column.facts;
    text +=
        table.row(column.name, role_words(column), column.unit, number_words(facts.low),
                  number_words(facts.high), facts.is_constant ? "never changes" : step_words(facts),
                  percent(rests(column)), percent(facts.held_at_high), percent(facts.held_at_low));
  }
  for (const LookedColumn& column : look.columns) {
    if (column.facts.not_finite == 0) continue;
    text += fmt::format("{}: {} of {} values are not finite\n", column.name,
                        column.facts.not_finite, column.facts.values);
  }
  for (const std::string& name : look.unread) text += name + ": no numbers\n";
  text += lines_of("note: ", look.remarks) + lines_of("note: ", look.notes);
  text += by_robot_text(look);
  if (look.by_robot.empty()) return text + "\n" + channels_text(look);
  if (look.to_add.empty()) return text + "\nthe robot file's [channels] read it; nothing to add\n";
  return text + "\nto add to the robot file's [channels]:\n" + lines_of("", look.to_add);
}

nlohmann::json to_json(const Look& look) {
  nlohmann::json json;
  json["file"] = look.file;
  json["has_names"] = look.has_names;
  json["columns"] = nlohmann::json::array();
  for (const LookedColumn& column : look.columns) {
    const ColumnFacts& facts = column.facts;
    json["columns"].push_back({{"name", column.name},
                               {"taken_for", role_words(column)},
                               {"unit", column.unit},
                               {"values", facts.values},
                               {"not_finite", facts.not_finite},
                               {"low", facts.low},
                               {"high", facts.high},
                               {"step", facts.step},
                               {"step_is_of_digits", facts.is_printed},
                               {"never_changes", facts.is_constant},
                               {"resting_share", rests(column)},
                               {"held_at_high", facts.held_at_high},
                               {"held_at_low", facts.held_at_low}});
  }
  json["unread"] = look.unread;
  json["time"] = nullptr;
  if (look.sampling) {
    json["time"] = {{"samples", look.t_s->size()},
                    {"first_s", (*look.t_s)[0]},
                    {"last_s", (*look.t_s)[look.t_s->size() - 1]},
                    {"period_s", look.sampling->median_period_s},
                    {"jitter", look.sampling->jitter},
                    {"largest_gap_s", look.sampling->largest_gap_s},
                    {"largest_gap_at_s", look.sampling->largest_gap_at_s}};
  }
  if (!look.by_robot.empty()) {
    for (const ReadChannel& channel : look.by_robot) {
      json["read_by_robot"].push_back({{"joint", channel.joint},
                                       {"quantity", channel.quantity},
                                       {"unit", channel.unit},
                                       {"from", channel.from},
                                       {"low", channel.low},
                                       {"high", channel.high}});
    }
    json["to_add"] = look.to_add;
  }
  json["remarks"] = look.remarks;
  json["notes"] = look.notes;
  json["missing"] = look.missing;
  json["channels"] = channels_text(look);
  return json;
}

report::Page page_of(const Look& look, const std::string& command) {
  report::Page page;
  page.title = "What " + look.file + " holds";
  page.command_line = command;
  page.verdict = look.is_complete()
                     ? report::Verdict{"Every channel that a model is compared with was found.",
                                       report::Level::kGood}
                     : report::Verdict{"Something has to be said first: " + look.missing.front(),
                                       report::Level::kWarn};
  report::Section summary;
  summary.heading = "Understood";
  summary.text = sampling_words(look);
  report::Table table;
  table.caption = "Columns";
  table.columns = {{"column"},      {"taken for"},           {"unit"},
                   {"lowest", "1"}, {"highest", "1"},        {"step", "1"},
                   {"rests", "%"},  {"at its highest", "%"}, {"at its lowest", "%"}};
  for (const LookedColumn& column : look.columns) {
    const ColumnFacts& facts = column.facts;
    const auto number = [&](double value) {
      return facts.has_numbers() ? report::Cell(value) : report::Cell();
    };
    table.rows.push_back({column.name, role_words(column), column.unit, number(facts.low),
                          number(facts.high),
                          facts.step > 0 ? report::Cell(facts.step) : report::Cell(),
                          100 * rests(column), 100 * facts.held_at_high, 100 * facts.held_at_low});
  }
  summary.blocks.emplace_back(std::move(table));
  for (const auto* sentences : {&look.remarks, &look.notes}) {
    for (const std::string& sentence : *sentences) {
      summary.blocks.emplace_back(report::Note{sentence, report::Level::kNeutral});
    }
  }
  summary.blocks.emplace_back(report::Note{channels_text(look), report::Level::kNeutral});
  page.sections.push_back(std::move(summary));
  report::Section channels;
  channels.heading = "Every channel";
  for (const LookedColumn& column : look.columns) {
    const VectorXd& values = look.values.at(column.name);
    if (values.size() < 2) continue;
    report::Chart chart;
    chart.title = column.name;
    const bool in_time = look.t_s && look.t_s->size() == values.size();
    chart.x = in_time ? report::Axis{"time", "s"} : report::Axis{"sample", "1"};
    chart.y = {report::Axis{column.name, column.unit.empty() ? "1" : column.unit}};
    chart.zoom_group = in_time ? "time" : "";
    report::Series series;
    series.name = column.name;
    series.tone = report::Tone::kMeasured;
    for (Index i = 0; i < values.size(); ++i) {
      series.x.push_back(in_time ? (*look.t_s)[i] : static_cast<double>(i));
      series.y.push_back(values[i]);
    }
    chart.series.push_back(std::move(series));
    channels.blocks.emplace_back(std::move(chart));
  }
  if (!channels.blocks.empty()) page.sections.push_back(std::move(channels));
  return page;
}

}  // namespace offnominal::desk
