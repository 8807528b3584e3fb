#include "explain/add_found.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/nearest.hpp"
#include "compare/inverse_model.hpp"
#include "compare/measurement.hpp"
#include "explain/doubts.hpp"
#include "robot/payload.hpp"

namespace offnominal::desk {

using nlohmann::ordered_json;

namespace {

std::vector<std::string> objections_to(const Explanation& e) {
  // What one joint leaves open stops no other's.
  const bool something = changes_the_file(e);
  if (!e.data_faults.empty() || (!is_to_write(e.verdict) && !something)) {
    return {fmt::format("the verdict is {}: {}", name_of(e.verdict), e.words)};
  }
  if (e.found.empty() && e.shifts.empty() && !gains_by_links(e)) {
    return {"no effect is missing: fit the one that is there again with add"};
  }
  std::vector<std::string> objections;
  for (const HeldNumber& held : e.held) {
    if (held.contradicted && !something) objections.push_back(held.words());
  }
  // A number that is held against the recordings says more of the same joint's friction.
  if (objections.empty()) objections = e.unphysical;
  for (const std::string& why : e.unwritable) {
    objections.push_back(why + "; what else was found is fitted beside it");
  }
  return objections;
}

// As the recordings that were held out have it, where they say anything of a joint.
std::vector<HeldOutSquares> held_out_squares(const AddedFindings& added) {
  std::vector<HeldOutSquares> all = held_out_squares(added.explanation);
  for (std::size_t joint = 0; joint < all.size(); ++joint) {
    HeldOutSquares apart;
    for (const Gain& gain : added.gains) {
      const BeforeAfter& error = gain.joints[joint];
      // Of a joint of which a recording has nothing, it says nothing.
      const bool says = std::isfinite(error.before_rms) && std::isfinite(error.after_rms);
      if (!gain.held_out || !says) continue;
      apart.before += std::pow(error.before_rms, 2);
      apart.after += std::pow(error.after_rms, 2);
      if (std::isfinite(error.rms_torque())) apart.torque += std::pow(error.rms_torque(), 2);
    }
    if (apart.before > 0) all[joint] = apart;
  }
  return all;
}

// Of the readings of a hold map, less the friction that holds by the direction of approach.
std::vector<BeforeAfter> at_rest(const RobotDescription& before, const RobotDescription& after,
                                 const Log& log) {
  const Motion held = motion_of(log, {});
  const auto error_of = [&](const RobotDescription& robot) {
    Eigen::MatrixXd error = log.tau - model_torque(carrying(robot, log.payload), held);
    for (Eigen::Index joint = 0; joint < error.cols(); ++joint) {
      const auto approach = log.approach.col(joint);
      const double readings = approach.squaredNorm();
      if (!(readings > 0)) continue;
      error.col(joint) -= approach * (approach.dot(error.col(joint)) / readings);
    }
    return error;
  };
  const Eigen::MatrixXd was = error_of(before);
  const Eigen::MatrixXd is = error_of(after);
  const double root = std::sqrt(static_cast<double>(log.sample_count()));
  std::vector<BeforeAfter> joints;
  for (Eigen::Index i = 0; i < log.tau.cols(); ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const double torque = log.tau.col(i).norm();
    joints.push_back({joint, unit_of(Quantity::kEffort, before.joints[joint].joint.type),
                      100 * was.col(i).norm() / torque, 100 * is.col(i).norm() / torque,
                      was.col(i).norm() / root, is.col(i).norm() / root});
  }
  return joints;
}

}  // namespace

AddedFindings add_found(const RobotDescription& robot, std::vector<Log> logs,
                        std::vector<Log> holdout, const ExplainOptions& options,
                        const OnProgress& on_progress) {
  AddedFindings added;
  if (on_progress) on_progress("examining the recordings");
  Treated recordings = treated(robot, std::move(logs), std::move(holdout), options.keep);
  added.explanation = explain(robot, recordings, options, on_progress);
  added.objections = objections_to(added.explanation);
  if (!added.objections.empty()) return added;
  const FilterPlan plan = plan_filter(recordings.logs, robot);
  leave_out(added.explanation.pushes, recordings.logs);
  leave_out(added.explanation.pushes, recordings.holdout);
  const auto compare_on = [&](const Log& log, bool held_out) {
    if (on_progress) on_progress("comparing both models on " + log.file);
    if (log.at_rest) {
      added.gains.push_back({log.file, held_out, at_rest(robot, added.explanation.improved, log)});
      return;
    }
    const Measurement measured = measure(held_elsewhere(log), robot, plan);
    added.gains.push_back(
        {log.file, held_out,
         before_after(compare(robot, measured), compare(added.explanation.improved, measured))});
  };
  for (const Log& log : recordings.logs) compare_on(log, false);
  for (const Log& log : recordings.holdout) compare_on(log, true);
  added.doubts = doubts_of(added.explanation, held_out_squares(added));
  return added;
}

ordered_json to_json(const AddedFindings& added, const ExplainNames& names,
                     const std::string& output_file, bool force) {
  const ordered_json explained = to_json(added.explanation, names);
  ordered_json json;
  for (const char* key : {"logs", "holdout", "robot", "verdict", "words", "filter", "found",
                          "pushes", "left_out", "data_faults", "data_hints", "advice"}) {
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
  json["doubts"] = added.doubts;
  json["held"] = ordered_json::array();
  for (const HeldNumber& held : added.explanation.held) json["held"].push_back(held.words());
  json["written"] = added.may_be_written(force) ? ordered_json(output_file) : ordered_json();
  return json;
}

std::string text_of(const AddedFindings& added, const ExplainNames& names, bool force) {
  std::string text = findings_text(added.explanation, names);
  for (const Gain& gain : added.gains) {
    text += fmt::format("\n{}{}\n{}", gain.log, gain.held_out ? ", not used for the fit" : "",
                        text_of(gain.joints));
  }
  for (const std::string& objection : added.objections) {
    text += "\nNothing was written: " + objection + "\n";
  }
  for (const Finding& one : added.explanation.found) {
    if (!added.objections.empty() || is_written(added.explanation, one.what)) continue;
    text += fmt::format("\nnote: {} of joint {} is not written: {}\n", one.what.name(),
                        one.what.joint + 1,
                        holds_in_any(added.explanation.ambiguous, one.what)
                            ? "the recordings do not tell it from others"
                            : "a number of that joint would have to be what cannot be");
  }
  for (const HeldNumber& held : added.explanation.held) {
    if (!held.contradicted || added.objections.empty()) text += "\nnote: " + held.words() + "\n";
  }
  for (const std::string& doubt : added.doubts) {
    text += fmt::format("\n{}: {}{}\n",
                        force ? "Written all the same, as --force says" : "Nothing was written",
                        doubt, force ? "" : "; --force writes it all the same");
  }
  return text;
}

}  // namespace offnominal::desk
