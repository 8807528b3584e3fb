#include "identify/add_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/effort_name.hpp"
#include "common/nearest.hpp"
#include "common/text_table.hpp"
#include "compare/compare_report.hpp"
#include "compare/torque_charts.hpp"
#include "robot/effect_text.hpp"

namespace offnominal::desk {
namespace {

using nlohmann::ordered_json;
using report::Level;

const BeforeAfter& of_joint(const std::vector<BeforeAfter>& all, std::size_t joint) {
  return *std::find_if(all.begin(), all.end(),
                       [&](const BeforeAfter& entry) { return entry.joint == joint; });
}

// The joint that is told of: of those that have what is asked for the one whose error falls most,
// as a share of its torque.
std::size_t joint_told(const AddResult& result, const AddRequest& request) {
  const std::vector<std::size_t> joints = joints_asked(result.robot, request);
  const auto fall_of = [&](std::size_t joint) {
    const BeforeAfter& error = of_joint(result.held_out, joint);
    return error.before_percent - error.after_percent;
  };
  return *std::max_element(joints.begin(), joints.end(),
                           [&](std::size_t a, std::size_t b) { return fall_of(a) < fall_of(b); });
}

std::string effect_name(const AddResult& result, std::size_t effect) {
  return info_of(result.robot.effects[effect].kind)->name;
}

std::string names_of_added(const AddResult& result) {
  std::vector<std::string> names;
  for (const std::size_t effect : result.added) names.push_back(effect_name(result, effect));
  return list_of(names);
}

// One parameter as it stands in the new robot, with what the fit says of it.
struct ParameterLine {
  std::string name;
  std::string unit;
  double value = 0;
  std::optional<Interval> ci95 = {};
  std::string why_no_interval = {};
  bool fitted = false;
};

std::vector<ParameterLine> lines_of(const AddResult& result, std::size_t effect) {
  std::vector<ParameterLine> lines;
  const RobotEffect& of = result.robot.effects[effect];
  const auto parameters = info_of(of.kind)->parameters;
  const JointType type = result.robot.type_of(of);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    ParameterLine line{parameters[i].name, unit_of(parameters[i].quantity, type), of.parameters[i]};
    for (const FittedParameter& fitted : result.fit.parameters) {
      if (fitted.effect != effect || fitted.parameter != i) continue;
      line.ci95 = fitted.ci95;
      line.why_no_interval = fitted.why_no_interval;
      line.fitted = fitted.fitted;
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

// Effects that were in the model and have been fitted again.
std::vector<std::size_t> refitted(const AddResult& result) {
  std::vector<std::size_t> effects;
  for (const FittedParameter& parameter : result.fit.parameters) {
    if (parameter.effect < result.added.front()) effects.push_back(parameter.effect);
  }
  std::sort(effects.begin(), effects.end());
  effects.erase(std::unique(effects.begin(), effects.end()), effects.end());
  return effects;
}

std::string place_asked(const AddRequest& request) {
  return fmt::format("{} {}", request.of_motor ? "motor" : "joint", request.joint + 1);
}

ordered_json interval_json(const std::optional<Interval>& ci95) {
  if (!ci95) return nullptr;
  return ordered_json::array({(*ci95)[0], (*ci95)[1]});
}

ordered_json effect_json(const AddResult& result, std::size_t effect) {
  ordered_json json;
  json["effect"] = effect_name(result, effect);
  const RobotEffect& of = result.robot.effects[effect];
  json[of.of_motor ? "motor" : "joint"] = of.joint + 1;
  json["parameters"] = ordered_json::object();
  for (const ParameterLine& line : lines_of(result, effect)) {
    json["parameters"][line.name] = {{"value", line.value},
                                     {"unit", line.unit},
                                     {"ci95", interval_json(line.ci95)},
                                     {"fitted", line.fitted}};
    if (line.fitted && !line.ci95)
      json["parameters"][line.name]["why_no_ci95"] = line.why_no_interval;
  }
  return json;
}

ordered_json error_json(double relative_percent, double rms) {
  return {{"relative_error_percent", relative_percent}, {"rms_error", rms}};
}

ordered_json recordings_json(const AddResult& result) {
  ordered_json json = ordered_json::array();
  for (const AddResult::OfRecording& one : result.recordings) {
    ordered_json joints = ordered_json::array();
    for (const BeforeAfter& error : one.joints) {
      joints.push_back({{"joint", error.joint + 1},
                        {"unit", error.unit},
                        {"before", error_json(error.before_percent, error.before_rms)},
                        {"after", error_json(error.after_percent, error.after_rms)}});
    }
    json.push_back({{"log", one.file}, {"held_out", one.held_out}, {"joints", std::move(joints)}});
  }
  return json;
}

// With the recording's name, where there are several.
std::vector<std::string> remarks_of(const AddResult& result) {
  std::vector<std::string> remarks;
  for (const AddResult::OfRecording& one : result.recordings) {
    for (const std::string& remark : one.remarks) {
      remarks.push_back(result.recordings.size() > 1 ? one.file + ": " + remark : remark);
    }
  }
  return remarks;
}

std::string value_text(const ParameterLine& line) {
  std::string text = fmt::format("{:.6g} {}", line.value, line.unit);
  if (line.ci95) {
    text += fmt::format(", 95 % between {:.6g} and {:.6g}", (*line.ci95)[0], (*line.ci95)[1]);
  } else if (!line.fitted) {
    text += ", not fitted";
  } else {
    text += ", " + line.why_no_interval;
  }
  return text;
}

std::string held_out_words(const AddResult& result) {
  const bool several = result.before.recordings.size() > 1;
  if (!result.cross_validated) return several ? "hold-out recordings" : "hold-out recording";
  return fmt::format("each fifth of the recording{} predicted by a fit of the others",
                     several ? "s" : "");
}

report::Table parameter_table(const AddResult& result) {
  report::Table table;
  table.caption = "Parameters";
  table.columns = {{"effect", "", ".4g"}, {"joint", "", "d"},       {"parameter", "", ".4g"},
                   {"value", "", ".6g"},  {"95 % from", "", ".6g"}, {"to", "", ".6g"},
                   {"unit", "", ".4g"},   {"fit", "", ".4g"}};
  std::vector<std::size_t> effects = result.added;
  const std::vector<std::size_t> again = refitted(result);
  effects.insert(effects.end(), again.begin(), again.end());
  for (const std::size_t effect : effects) {
    for (const ParameterLine& line : lines_of(result, effect)) {
      const bool is_new = effect >= result.added.front();
      const RobotEffect& of = result.robot.effects[effect];
      const report::Cell place = of.of_motor ? report::Cell(place_of(of))
                                             : report::Cell(static_cast<double>(of.joint + 1));
      report::Cell low;
      report::Cell high;
      if (line.ci95) {
        low = (*line.ci95)[0];
        high = (*line.ci95)[1];
      }
      table.rows.push_back({effect_name(result, effect), place, line.name, line.value, low, high,
                            line.unit,
                            std::string(!line.fitted ? "not fitted"
                                        : is_new     ? "new"
                                                     : "again")});
    }
  }
  table.note =
      "Intervals hold for errors that are correlated in time: they come from blocks of the "
      "recording, not from its samples.";
  return table;
}

std::vector<NamedErrors> named_errors(const AddResult& result, const AddNames& names) {
  std::vector<NamedErrors> errors;
  // One recording of its kind is all of them.
  const auto each = [&](bool held_out) {
    for (const AddResult::OfRecording& one : result.recordings) {
      if (one.held_out == held_out) errors.push_back({one.file, one.joints});
    }
  };
  if (names.logs.size() > 1) each(false);
  errors.push_back(
      {"fitted: " + (names.logs.size() > 1 ? "all together" : names.logs[0]), result.fitted_logs});
  if (names.holdout.size() > 1) each(true);
  errors.push_back({names.holdout.empty()       ? held_out_words(result)
                    : names.holdout.size() == 1 ? "not used for the fit: " + names.holdout[0]
                                                : "not used for the fit: all together",
                    result.held_out});
  return errors;
}

report::KeyFigures key_figures(const AddResult& result, const AddRequest& request) {
  const BeforeAfter& error = of_joint(result.held_out, joint_told(result, request));
  report::KeyFigures keys;
  for (const bool after : {false, true}) {
    report::KeyFigure figure;
    figure.label = after ? "error after" : "error before";
    figure.value = after ? error.after_percent : error.before_percent;
    figure.unit = "%";
    figure.format = ".2f";
    figure.level = after ? level_of(result, request) : Level::kNeutral;
    figure.note = fmt::format("{:.4g} {} rms, {}", after ? error.after_rms : error.before_rms,
                              error.unit, held_out_words(result));
    keys.figures.push_back(figure);
  }
  return keys;
}

report::Section pictures_of(const AddResult& result, const AddRequest& request,
                            std::size_t recording) {
  report::Section pictures;
  const std::size_t joint = joint_told(result, request);
  const Comparison& before = result.before.recordings[recording];
  pictures.text = before.file;
  if (result.before.recordings.size() > 1) pictures.recording = before.file;
  const std::vector<NamedComparison> models{
      {"before", &before, report::Tone::kFaint},
      {"after", &result.after.recordings[recording], report::Tone::kModel}};
  pictures.blocks.emplace_back(torque_over_time(models, joint));
  pictures.blocks.emplace_back(residual_over_time(models, joint));
  for (const ErrorVariable variable :
       {ErrorVariable::kVelocity, ErrorVariable::kPosition, ErrorVariable::kAcceleration}) {
    pictures.blocks.emplace_back(residual_over(models, joint, {variable, joint}));
  }
  return pictures;
}

}  // namespace

std::string judgement_of(const AddResult& result, const AddRequest& request) {
  const std::string names = names_of_added(result);
  if (!result.objections.empty()) {
    std::string words = result.objections.front();
    for (std::size_t i = 1; i < result.objections.size(); ++i) {
      words += "; " + result.objections[i];
    }
    return words + ".";
  }
  const BeforeAfter& error = of_joint(result.held_out, joint_told(result, request));
  const std::string numbers =
      fmt::format("from {:.2f} % to {:.2f} % of the {} of joint {} ({:.4g} to {:.4g} {} rms)",
                  error.before_percent, error.after_percent, effort_name(error.unit),
                  error.joint + 1, error.before_rms, error.after_rms, error.unit);
  if (!result.doubts.empty()) {
    return error.fall() > 0
               ? fmt::format(
                     "With {} the error of joint {} on data not used for the fit falls {}, but {}.",
                     names, error.joint + 1, numbers, result.doubts.front())
               : fmt::format(
                     "With {} the error on data not used for the fit does not fall: it goes {}. "
                     "These data do not support the effect.",
                     names, numbers);
  }
  return fmt::format("With {} the error on data not used for the fit falls {}.", names, numbers);
}

std::string verdict_of(const AddResult& result, const AddRequest& request, bool force) {
  std::string words = judgement_of(result, request);
  if (!result.objections.empty()) return "Nothing was written: " + words;
  if (result.doubts.empty()) return words;
  return words + (force ? " Written all the same, as --force says."
                        : " Nothing was written; --force writes it all the same.");
}

Level level_of(const AddResult& result, const AddRequest& request) {
  if (!result.objections.empty()) return Level::kBad;
  const double fall = of_joint(result.held_out, joint_told(result, request)).fall();
  if (!result.doubts.empty()) return Level::kBad;
  return fall < kWorthAnEffect ? Level::kWarn : Level::kGood;
}

ordered_json to_json(const AddResult& result, const AddRequest& request, const AddNames& names) {
  ordered_json json = effect_json(result, result.added.front());
  json["also"] = ordered_json::array();
  for (std::size_t i = 1; i < result.added.size(); ++i) {
    json["also"].push_back(effect_json(result, result.added[i]));
  }
  const BeforeAfter& fitted = of_joint(result.fitted_logs, joint_told(result, request));
  const BeforeAfter& held_out = of_joint(result.held_out, joint_told(result, request));
  json["before"] = {{"fit", error_json(fitted.before_percent, fitted.before_rms)},
                    {"holdout", error_json(held_out.before_percent, held_out.before_rms)}};
  json["after"] = {{"fit", error_json(fitted.after_percent, fitted.after_rms)},
                   {"holdout", error_json(held_out.after_percent, held_out.after_rms)}};
  json["unit"] = fitted.unit;
  const auto& held_out_logs = result.cross_validated ? names.logs : names.holdout;
  json["holdout"] = {{"kind", result.cross_validated ? "parts" : "recording"},
                     {"logs", held_out_logs}};
  if (held_out_logs.size() == 1) json["holdout"]["log"] = held_out_logs[0];
  json["recordings"] = recordings_json(result);
  json["refitted"] = ordered_json::array();
  for (const std::size_t effect : refitted(result)) {
    json["refitted"].push_back(effect_json(result, effect));
  }
  json["links"] = ordered_json::array();
  for (const FittedLink& link : result.fit.links) {
    json["links"].push_back(
        {{"link", link.link + 1}, {"factor", link.factor}, {"ci95", interval_json(link.ci95)}});
  }
  json["notes"] = result.notes;
  json["objections"] = result.objections;
  json["doubts"] = result.doubts;
  json["written"] =
      result.may_be_written(names.force) ? ordered_json(names.output_file) : ordered_json();
  json["filter"] = to_json(result.before.recordings[0].plan);
  json["verdict"] = verdict_of(result, request, names.force);
  return json;
}

std::string text_of(const AddResult& result, const AddRequest& request, const AddNames& names) {
  std::string text = fmt::format("{} on {} of {}, fitted to {}\n", names_of_added(result),
                                 place_asked(request), names.robot_file, list_of(names.logs));
  text += words_of(result.before.recordings[0].plan) + "\n";
  const TextTable parameters({{"", -38}, {"", 0}}, "  ");
  const auto describe = [&](std::size_t effect, bool is_new) {
    for (const ParameterLine& line : lines_of(result, effect)) {
      const std::string mark = is_new ? ""
                                      : fmt::format(" ({}{})", line.fitted ? "fitted again, " : "",
                                                    place_of(result.robot.effects[effect]));
      text +=
          parameters.row(effect_name(result, effect) + "." + line.name, value_text(line) + mark);
    }
  };
  for (const std::size_t effect : result.added) describe(effect, true);
  for (const std::size_t effect : refitted(result)) describe(effect, false);
  for (const FittedLink& link : result.fit.links) {
    text +=
        fmt::format("  mass and inertia of link {}: times {:.6g}\n", link.link + 1, link.factor);
  }
  for (const std::string& remark : remarks_of(result)) text += "note: " + remark + "\n";
  for (const std::string& note : result.notes) text += "note: " + note + "\n";
  const TextTable table({{"relative error", -48}, {"before", 12}, {"after", 12}});
  text += table.heading();
  const auto errors = [&](const std::string& what, const std::vector<BeforeAfter>& all) {
    for (const BeforeAfter& error : all) {
      text += table.row(fmt::format("joint {}, {}", error.joint + 1, what),
                        fmt::format("{:.2f} %", error.before_percent),
                        fmt::format("{:.2f} %", error.after_percent));
    }
  };
  // Of the joint that was asked for, in each of several recordings.
  const auto each = [&](bool held_out) {
    for (const AddResult::OfRecording& one : result.recordings) {
      if (one.held_out == held_out)
        errors(one.file, {of_joint(one.joints, joint_told(result, request))});
    }
  };
  const bool several = names.logs.size() > 1;
  if (several) each(false);
  errors(several ? "fitted recordings" : "fitted recording", result.fitted_logs);
  if (names.holdout.size() > 1) each(true);
  errors(result.cross_validated      ? "held-out parts"
         : names.holdout.size() == 1 ? "hold-out recording"
                                     : "hold-out recordings",
         result.held_out);
  return text + verdict_of(result, request, names.force) + "\n";
}

report::Page page_of(const AddResult& result, const AddRequest& request, const AddNames& names) {
  report::Page page;
  page.title = "Adding " + names_of_added(result);
  page.subtitle = fmt::format("{} of {}, fitted to {}", place_asked(request), names.robot_file,
                              list_of(names.logs));
  page.verdict = {verdict_of(result, request, names.force), level_of(result, request)};
  page.command_line = names.command_line;

  report::Section numbers;
  numbers.heading = "Error and parameters";
  numbers.blocks.emplace_back(key_figures(result, request));
  numbers.blocks.emplace_back(
      before_after_table(named_errors(result, names), result.before.recordings[0].plan));
  numbers.blocks.emplace_back(parameter_table(result));
  for (const std::string& note : result.notes) {
    numbers.blocks.emplace_back(report::Note{note, Level::kNeutral});
  }
  for (const std::string& remark : remarks_of(result)) {
    numbers.blocks.emplace_back(report::Note{remark, Level::kWarn});
  }
  page.sections.push_back(std::move(numbers));

  for (std::size_t r = 0; r < result.before.recordings.size(); ++r) {
    page.sections.push_back(pictures_of(result, request, r));
    page.sections.back().heading =
        names.holdout.empty() ? "Fitted recording" : "Hold-out recording";
  }
  return page;
}

}  // namespace offnominal::desk
