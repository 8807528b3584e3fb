#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "common/nearest.hpp"
#include "compare/compare_report.hpp"
#include "compare/torque_charts.hpp"
#include "inertial/identify_report.hpp"

namespace offnominal::desk {
namespace {

void put_interval(const IdentifiedNumber& number, std::vector<report::Cell>& row) {
  row.push_back(number.ci95 ? report::Cell((*number.ci95)[0]) : report::Cell());
  row.push_back(number.ci95 ? report::Cell((*number.ci95)[1]) : report::Cell());
  row.emplace_back(std::string(number.determined ? "yes" : "no"));
}

std::vector<report::Column> with_number_columns(std::vector<report::Column> columns) {
  for (const char* name : {"identified", "in the file", "95 % from", "to"}) {
    columns.push_back({name, "", ".5g"});
  }
  columns.push_back({"determined", "", ".4g"});
  columns.push_back({"unit", "", ".4g"});
  return columns;
}

std::vector<report::Cell> number_row(std::vector<report::Cell> row,
                                     const IdentifiedNumber& number) {
  row.emplace_back(number.after);
  row.emplace_back(number.before);
  put_interval(number, row);
  row.emplace_back(number.unit);
  return row;
}

report::Table links_table(const Identification& result) {
  report::Table table;
  table.caption = "Links";
  table.columns = with_number_columns({{"link", "", "d"}, {"number", "", ".4g"}});
  for (const IdentifiedLink& link : result.links) {
    const auto number = static_cast<double>(link.link + 1);
    table.rows.push_back(number_row({number, std::string("mass")}, link.mass));
    for (const IdentifiedNumber& one : link.centre) {
      table.rows.push_back(number_row({number, "centre of mass " + one.name}, one));
    }
  }
  table.note =
      "Determined: the recordings tell it five times as sharply as the geometry alone. The rest is "
      "what is believed of the links, moved as far as the determined combinations ask.";
  return table;
}

report::Table payload_table(const IdentifiedPayload& payload) {
  report::Table table;
  table.caption = "Carried by the last link beyond what the file says";
  table.columns = with_number_columns({{"number", "", ".4g"}});
  table.rows.push_back(number_row({std::string("mass")}, payload.mass));
  for (const IdentifiedNumber& one : payload.place) {
    table.rows.push_back(number_row({"place " + one.name}, one));
  }
  return table;
}

report::Table drives_table(const Identification& result) {
  report::Table table;
  table.caption = "Drives";
  table.columns = with_number_columns({{"joint", "", "d"}, {"number", "", ".4g"}});
  for (const IdentifiedDrive& drive : result.drives) {
    table.rows.push_back(
        number_row({static_cast<double>(drive.joint + 1), drive.number.name}, drive.number));
  }
  table.note = "Not determined: held at the end of what is possible, and not written.";
  return table;
}

report::Table base_table(const Identification& result) {
  report::Table table;
  table.caption = "Base parameters: what torques depend on";
  table.columns = with_number_columns({{"combination", "", ".4g"}});
  for (const IdentifiedNumber& one : result.base) {
    table.rows.push_back(number_row({one.name}, one));
  }
  table.note =
      "m mass, h mass times centre of mass, I inertia about the origin of the link's frame, Ia "
      "rotor inertia; the number is the link's or joint's. Intervals hold for errors that are "
      "correlated in time.";
  return table;
}

report::KeyFigures key_figures(const Identification& result) {
  report::KeyFigures keys;
  const auto add = [&](const std::string& label, report::Cell value, const std::string& unit,
                       const std::string& format, const std::string& note) {
    report::KeyFigure figure;
    figure.label = label;
    figure.value = std::move(value);
    figure.unit = unit;
    figure.format = format;
    figure.note = note;
    keys.figures.push_back(figure);
  };
  if (result.payload) {
    add("payload", result.payload->mass.after, "kg", ".3g",
        result.payload->mass.determined ? "beyond what the file says" : "not determined");
  }
  add("determined", static_cast<double>(result.determined_count()), "", "d",
      fmt::format("of {} base parameters", result.base.size()));
  add("condition number", result.condition, "", ".3g", "columns of length 1");
  add("links believed within", 100 * result.share, "%", ".3g", "as held-out parts say");
  return keys;
}

}  // namespace

report::Page page_of(const Identification& result, const IdentifyNames& names) {
  report::Page page;
  page.title = result.payload ? "Payload" : "Identified links and drives";
  page.subtitle = fmt::format("{}, from {}", names.robot_file, list_of(names.logs));
  page.verdict = {verdict_of(result, names), level_of(result)};
  page.command_line = names.command_line;

  report::Section numbers;
  numbers.heading = "Error and numbers";
  numbers.blocks.emplace_back(key_figures(result));
  const std::string held_out = result.cross_validated ? "held-out parts" : "held-out recordings";
  numbers.blocks.emplace_back(before_after_table(
      {{"fitted", result.fitted}, {held_out, result.held_out}}, result.after.plan));
  if (result.payload) {
    numbers.blocks.emplace_back(payload_table(*result.payload));
  } else {
    numbers.blocks.emplace_back(links_table(result));
    if (!result.drives.empty()) numbers.blocks.emplace_back(drives_table(result));
  }
  if (!result.base.empty()) numbers.blocks.emplace_back(base_table(result));
  for (const std::string& note : result.notes) {
    numbers.blocks.emplace_back(report::Note{note, report::Level::kNeutral});
  }
  page.sections.push_back(std::move(numbers));

  report::Section pictures;
  pictures.heading = result.cross_validated ? "Fitted recording" : "Held-out recording";
  pictures.text = result.cross_validated ? names.logs.front() : names.holdout.front();
  std::vector<NamedComparison> models;
  if (result.before) models.push_back({"before", &*result.before, report::Tone::kFaint});
  models.push_back({"after", &result.after, report::Tone::kModel});
  for (std::size_t joint = 0; joint < result.robot.joints.size(); ++joint) {
    pictures.blocks.emplace_back(torque_over_time(models, joint));
    pictures.blocks.emplace_back(residual_over_time(models, joint));
  }
  page.sections.push_back(std::move(pictures));
  return page;
}

}  // namespace offnominal::desk
