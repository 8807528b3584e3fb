#include <fmt/format.h>

#include <cmath>

#include "common/effort_name.hpp"
#include "common/error.hpp"
#include "common/input_name.hpp"
#include "common/json_text.hpp"
#include "common/nearest.hpp"
#include "common/text_table.hpp"
#include "compare/compare_report.hpp"
#include "inertial/identify_report.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

std::string number_or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-";
}

std::string percent_or_dash(double value) {
  return std::isfinite(value) ? fmt::format("{:.2f} %", value) : "-";
}

std::string interval_of(const IdentifiedNumber& number) {
  if (!number.ci95) return number.why_no_interval.empty() ? "-" : number.why_no_interval;
  return fmt::format("{:.4g} .. {:.4g}", (*number.ci95)[0], (*number.ci95)[1]);
}

std::string file_list(const std::vector<std::string>& files) {
  return as_utf8(list_of(files, input_name));
}

std::string error_line(const BeforeAfter& error) {
  return fmt::format("joint {}: {} before, {} after ({} {} rms)", error.joint + 1,
                     percent_or_dash(error.before_percent), percent_or_dash(error.after_percent),
                     number_or_dash(error.after_rms), error.unit);
}

std::string held_out_words(const Identification& result) {
  return result.cross_validated ? "parts of the recordings, each predicted by a fit of the others"
                                : "held-out recordings";
}

std::string links_text(const Identification& result) {
  const TextTable table({{"link", 4},
                         {"mass kg", 9},
                         {"in the file", 11},
                         {"95 %", 19},
                         {"centre of mass m", 26},
                         {"in the file", 26}});
  std::string text = table.heading();
  const auto place = [](const IdentifiedLink& link, double IdentifiedNumber::*which) {
    return fmt::format("{}, {}, {}", number_or_dash(link.centre[0].*which),
                       number_or_dash(link.centre[1].*which),
                       number_or_dash(link.centre[2].*which));
  };
  for (const IdentifiedLink& link : result.links) {
    text +=
        table.row(link.link + 1, number_or_dash(link.mass.after), number_or_dash(link.mass.before),
                  link.mass.determined ? interval_of(link.mass) : "not determined",
                  place(link, &IdentifiedNumber::after), place(link, &IdentifiedNumber::before));
  }
  return text;
}

std::string drives_text(const Identification& result) {
  if (result.drives.empty()) return {};
  const TextTable table({{"joint", -5},
                         {"drive", -36},
                         {"identified", 11},
                         {"in the file", 11},
                         {"95 %", 22},
                         {"unit", -9}});
  std::string text = table.heading();
  for (const IdentifiedDrive& drive : result.drives) {
    const IdentifiedNumber& number = drive.number;
    text += table.row(drive.joint + 1, number.name, number_or_dash(number.after),
                      number_or_dash(number.before),
                      number.determined ? interval_of(number) : "held at its end", number.unit);
  }
  return text;
}

std::string base_text(const Identification& result) {
  std::string text = fmt::format("base parameters: {}, of which these recordings determine {}\n",
                                 result.base.size(), result.determined_count());
  const TextTable table(
      {{"identified", 11}, {"in the file", 11}, {"95 %", 22}, {"unit", -6}, {"", 0}}, "  ");
  text += table.row("identified", "in the file", "95 %", "unit", "combination");
  for (const IdentifiedNumber& one : result.base) {
    text += table.row(number_or_dash(one.after), number_or_dash(one.before),
                      one.determined ? interval_of(one) : "not determined", one.unit, one.name);
  }
  return text;
}

std::string errors_text(const Identification& result) {
  const TextTable table({{"relative error", -58}, {"before", 10}, {"after", 10}});
  std::string text = table.heading();
  const auto rows = [&](const std::string& what, const std::vector<BeforeAfter>& errors) {
    for (const BeforeAfter& error : errors) {
      text +=
          table.row(fmt::format("joint {}, {}", error.joint + 1, what),
                    percent_or_dash(error.before_percent), percent_or_dash(error.after_percent));
    }
  };
  rows("fitted recordings", result.fitted);
  rows(result.cross_validated ? "held-out parts" : "held-out recordings", result.held_out);
  return text;
}

std::string payload_text(const IdentifiedPayload& payload) {
  std::string text = "carried by the last link beyond what the file says:\n";
  const TextTable table({{"", -6}, {"", 11}, {"", -3}, {"", 0}}, "  ");
  const auto row = [&](const IdentifiedNumber& one) {
    text += table.row(one.name, number_or_dash(one.after), one.unit,
                      one.determined ? "95 %: " + interval_of(one) : "not determined");
  };
  row(payload.mass);
  for (const IdentifiedNumber& one : payload.place) row(one);
  return text;
}

std::string payload_words(const IdentifiedPayload& payload) {
  if (!payload.mass.determined) {
    return "The last link carries something else than the file says, and these recordings do not "
           "tell its mass";
  }
  return fmt::format("The last link carries {:.3g} kg {} than the file says{}",
                     std::abs(payload.mass.after), payload.mass.after < 0 ? "less" : "more",
                     payload.mass.ci95
                         ? fmt::format(" (95 %: {:.3g} to {:.3g} kg)", (*payload.mass.ci95)[0],
                                       (*payload.mass.ci95)[1])
                         : "");
}

const std::vector<BeforeAfter>& judged_on(const Identification& result) {
  return result.held_out.empty() ? result.fitted : result.held_out;
}

// Joints of whose torque the identified robot still misses most: the file is no model of them.
std::vector<std::string> joints_hardly_explained(const Identification& result) {
  constexpr double kMostPercent = 60;
  std::vector<std::string> joints;
  for (const BeforeAfter& one : judged_on(result)) {
    if (one.after_percent > kMostPercent) joints.push_back(std::to_string(one.joint + 1));
  }
  return joints;
}

}  // namespace

std::string verdict_of(const Identification& result, const IdentifyNames& names) {
  if (!result.objections.empty()) {
    std::string words = "Nothing was written: " + result.objections.front();
    for (std::size_t i = 1; i < result.objections.size(); ++i) {
      words += "; " + result.objections[i];
    }
    return words + ".";
  }
  std::string words = result.payload
                          ? payload_words(*result.payload)
                          : fmt::format("These recordings determine {} of {} base parameters",
                                        result.determined_count(), result.base.size());
  const std::vector<BeforeAfter>& errors = judged_on(result);
  // No share is of a torque that is 0 throughout, or that nothing is left of.
  const BeforeAfter* most = nullptr;
  for (const BeforeAfter& one : errors) {
    if (!std::isfinite(one.after_percent)) continue;
    if (most == nullptr || one.after_percent > most->after_percent) most = &one;
  }
  if (most != nullptr) {
    const bool first = errors.size() == 1;
    words += fmt::format("; the error on {} is {:.2f} % of the {}{} ({} before)",
                         result.held_out.empty() ? "what was fitted" : "data not used for the fit",
                         most->after_percent, effort_name(most->unit),
                         first ? "" : fmt::format(" or less, on joint {}", most->joint + 1),
                         percent_or_dash(most->before_percent));
  }
  words += ".";
  if (const auto joints = joints_hardly_explained(result); !joints.empty() && !result.payload) {
    words += fmt::format(
        " Of the {} of joint {} most is still missed, and no bound of this file is worth much "
        "there: "
        "`offnominal explain` says what else acts on it, `offnominal look` whether its signals are "
        "what they are taken for.",
        effort_name(errors.front().unit), list_of(joints));
  }
  if (result.doubts.empty()) return words;
  words += " But " + list_of(result.doubts) + ".";
  return words + (names.force ? " Written all the same, as --force says."
                              : " Nothing was written; --force writes it all the same.");
}

report::Level level_of(const Identification& result) {
  if (!result.objections.empty() || !result.doubts.empty()) return report::Level::kBad;
  const bool all_told =
      result.determined_count() == result.base.size() && joints_hardly_explained(result).empty();
  return !all_told ? report::Level::kWarn : report::Level::kGood;
}

std::string text_of(const Identification& result, const IdentifyNames& names) {
  std::string text = fmt::format("{} from {}\n", names.robot_file, file_list(names.logs));
  if (result.payload) {
    text += payload_text(*result.payload);
  } else {
    text += links_text(result) + drives_text(result);
  }
  text += base_text(result);
  text += fmt::format("condition number {}; links believed within {:g} %, as held-out parts say\n",
                      number_or_dash(result.condition), 100 * result.share);
  text += words_of(result.after.plan) + "\n";
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  text += errors_text(result);
  return text + verdict_of(result, names) + "\n";
}

std::string robot_text_of(const Identification& result, const IdentifyNames& names) {
  const auto comment = [](const std::string& line) {
    return "# " + as_utf8(on_one_line(line)) + "\n";
  };
  std::string text = comment("Identified by `offnominal identify` from " + file_list(names.logs) +
                             ", on " + as_utf8(input_name(names.robot_file)) + ".");
  text += comment(fmt::format("{} of {} base parameters are determined; condition number {}.",
                              result.determined_count(), result.base.size(),
                              number_or_dash(result.condition)));
  text += comment("Relative error, fitted recordings:");
  for (const BeforeAfter& error : result.fitted) text += comment("  " + error_line(error));
  if (!result.held_out.empty()) text += comment("Relative error, " + held_out_words(result) + ":");
  for (const BeforeAfter& error : result.held_out) text += comment("  " + error_line(error));
  for (const std::string& note : result.notes) text += comment("note: " + note);
  return text + "\n" + robot_text(result.robot);
}

}  // namespace offnominal::desk
