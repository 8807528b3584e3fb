#include "look/look_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/number.hpp"
#include "common/text_table.hpp"
#include "robot/channel_text.hpp"

namespace offnominal::desk {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

std::string percent(double share) { return share > 0 ? fmt::format("{:.3g} %", 100 * share) : ""; }

std::string step_words(const ColumnFacts& facts) {
  if (facts.step == 0) return "";
  return fmt::format("{:.6g}{}", facts.step, facts.is_printed ? " (digits)" : "");
}

std::string role_words(const LookedColumn& column) { return name_of(column.role); }

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

std::string pasted_lines(const ChannelMap& map, const char* quantity) {
  std::string text;
  for (const std::string& line : channel_lines(map, quantity)) text += line + "\n";
  return text;
}

}  // namespace

std::string channels_text(const Look& look) {
  const ChannelMap& map = look.channels;
  std::string text = "[channels]\n";
  if (map.period_s > 0) {
    text += "period_s = " + shortest_real(map.period_s) + "\n";
  } else {
    text += look.t_s ? pasted_lines(map, "time") : "period_s = ...\n";
  }
  text += map.position.empty() ? "position = [...]\n" : pasted_lines(map, "position");
  const bool any_velocity = std::any_of(map.velocity.begin(), map.velocity.end(),
                                        [](const auto& one) { return one.has_value(); });
  if (any_velocity) text += pasted_lines(map, "velocity");
  text += map.torque.empty() ? "torque = [...]\n" : pasted_lines(map, "torque");
  return text + lines_of("# still to be said: ", look.missing);
}

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
    text += table.row(
        column.name, role_words(column), column.unit, fmt::format("{:.6g}", facts.low),
        fmt::format("{:.6g}", facts.high), facts.is_constant ? "never changes" : step_words(facts),
        percent(facts.resting_share), percent(facts.held_at_high), percent(facts.held_at_low));
  }
  for (const LookedColumn& column : look.columns) {
    if (column.facts.not_finite == 0) continue;
    text += fmt::format("{}: {} of {} values are not finite\n", column.name,
                        column.facts.not_finite, column.facts.values);
  }
  for (const std::string& name : look.unread) text += name + ": no numbers\n";
  text += lines_of("note: ", look.remarks) + lines_of("note: ", look.notes);
  return text + "\n" + channels_text(look);
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
                               {"resting_share", facts.resting_share},
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
    table.rows.push_back({column.name, role_words(column), column.unit, facts.low, facts.high,
                          facts.step > 0 ? report::Cell(facts.step) : report::Cell(),
                          100 * facts.resting_share, 100 * facts.held_at_high,
                          100 * facts.held_at_low});
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
