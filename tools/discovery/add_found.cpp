#include "discovery/add_found.hpp"

#include <fmt/format.h>

#include "analysis/measurement.hpp"
#include "common/nearest.hpp"

namespace offnominal::tools::discovery {

using nlohmann::ordered_json;

namespace {

std::vector<std::string> objections_to(const Explanation& e) {
  if (e.verdict != Verdict::kFound && e.verdict != Verdict::kParameterShift) {
    return {fmt::format("the verdict is {}: {}", name_of(e.verdict), e.words)};
  }
  if (e.found.empty()) return {"no effect is missing: fit the one that is there again with add"};
  if (e.not_in_robot_files.empty()) return {};
  return {
      fmt::format("robot files and controllers do not know {} yet, and what else was found is "
                  "fitted beside it",
                  list_of(e.not_in_robot_files))};
}

}  // namespace

AddedFindings add_found(const RobotDescription& robot, const std::vector<Log>& logs,
                        const std::vector<Log>& holdout, const ExplainOptions& options,
                        const OnProgress& on_progress) {
  AddedFindings added;
  added.explanation = explain(robot, logs, holdout, options, on_progress);
  added.objections = objections_to(added.explanation);
  if (!added.objections.empty()) return added;
  const auto compare_on = [&](const Log& log, bool held_out) {
    if (on_progress) on_progress("comparing both models on " + log.file);
    const Measurement measured = measure(log, {});
    added.gains.push_back(
        {log.file, held_out,
         before_after(compare(robot, measured), compare(added.explanation.improved, measured))});
  };
  for (const Log& log : logs) compare_on(log, false);
  for (const Log& log : holdout) compare_on(log, true);
  return added;
}

ordered_json to_json(const AddedFindings& added, const ExplainNames& names,
                     const std::string& output_file) {
  const ordered_json explained = to_json(added.explanation, names);
  ordered_json json;
  for (const char* key : {"logs", "holdout", "robot", "verdict", "words", "found"}) {
    json[key] = explained[key];
  }
  json["recordings"] = ordered_json::array();
  for (const Gain& gain : added.gains) {
    ordered_json joints = ordered_json::array();
    for (const BeforeAfter& error : gain.joints) {
      joints.push_back({{"joint", error.joint + 1},
                        {"unit", error.unit},
                        {"rms_error_before", error.before_rms},
                        {"rms_error_after", error.after_rms},
                        {"relative_error_before_percent", error.before_percent},
                        {"relative_error_after_percent", error.after_percent}});
    }
    json["recordings"].push_back(
        {{"log", gain.log}, {"held_out", gain.held_out}, {"joints", std::move(joints)}});
  }
  json["objections"] = added.objections;
  json["written"] = added.objections.empty() ? ordered_json(output_file) : nullptr;
  return json;
}

std::string text_of(const AddedFindings& added, const ExplainNames& names) {
  std::string text = text_of(added.explanation, names);
  for (const Gain& gain : added.gains) {
    text += fmt::format("\n{}{}\n{:<6} {:>26} {:>26} {:>10}\n", gain.log,
                        gain.held_out ? ", not used for the fit" : "", "joint", "error before",
                        "error after", "fall");
    for (const BeforeAfter& error : gain.joints) {
      const auto both = [&](double percent, double rms) {
        return fmt::format("{:.2f} % ({:.4g} {})", percent, rms, error.unit);
      };
      text += fmt::format("{:<6} {:>26} {:>26} {:>8.1f} %\n", error.joint + 1,
                          both(error.before_percent, error.before_rms),
                          both(error.after_percent, error.after_rms), 100 * error.fall());
    }
  }
  for (const std::string& objection : added.objections) {
    text += "\nNothing was written: " + objection + "\n";
  }
  return text;
}

}  // namespace offnominal::tools::discovery
