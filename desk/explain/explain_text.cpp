#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/amount.hpp"
#include "common/input_name.hpp"
#include "common/number.hpp"
#include "common/shell_word.hpp"
#include "common/text_table.hpp"
#include "compare/compare_report.hpp"
#include "explain/data_fault_report.hpp"
#include "explain/doubts.hpp"
#include "explain/explain_report.hpp"
#include "explain/remains.hpp"
#include "robot/payload.hpp"

namespace offnominal::desk {
namespace {

std::string words_of(const Estimate& one) {
  std::string words = fmt::format("{} = {:.4g}", one.value.name, one.value.value);
  if (one.ci95) words += fmt::format(" ({:.4g} .. {:.4g})", (*one.ci95)[0], (*one.ci95)[1]);
  if (!one.value.unit.empty() && one.value.unit != "1") words += " " + one.value.unit;
  if (!one.ci95) words += ", " + one.why_no_interval;
  return words;
}

std::string text_of_joints(const Explanation& e) {
  const TextTable table({{"joint", -6},
                         {"rms torque", 12},
                         {"error before", 14},
                         {"error after", 14},
                         {"noise floor", 12},
                         {"held out, bef.", 14},
                         {"held out, aft.", 14},
                         {"held out, floor", 15}});
  std::string text = "\n" + table.heading();
  for (const JointErrors& joint : e.joints) {
    const auto with_unit = [&](double value) {
      return std::isfinite(value) ? fmt::format("{:.4g} {}", value, joint.unit) : std::string("-");
    };
    text += table.row(joint.joint + 1, with_unit(joint.rms_torque), with_unit(joint.rms_before),
                      with_unit(joint.rms_improved), with_unit(joint.noise_floor),
                      with_unit(joint.holdout_before), with_unit(joint.holdout_after),
                      with_unit(joint.holdout_noise_floor));
  }
  return text;
}

std::string text_of_answers(const Explanation& e) {
  std::string text = e.answers.empty() ? "" : "\n";
  for (const JointAnswer& one : e.answers) {
    text += fmt::format("joint {}: {}: {}\n", one.joint + 1, name_of(one.verdict), one.words);
  }
  return text;
}

std::string text_of_findings(const Explanation& e) {
  std::string text;
  for (std::size_t i = 0; i < e.found.size(); ++i) {
    const Finding& finding = e.found[i];
    text += fmt::format("\n{}. {} on joint {}: {}\n", i + 1, title_of(finding),
                        finding.what.joint + 1, finding.words);
    text += "   torque: " + finding.formula + "\n";
    for (const Estimate& one : finding.parameters) text += "   " + words_of(one) + "\n";
    text += fmt::format(
        "   beside all else takes {:.0f} % off {} error on held-out data; p = {:.2g} over "
        "the whole search{}\n",
        100 * finding.takes_of_held_out(),
        finding.seen_on == finding.what.joint ? "the joint's"
                                              : fmt::format("joint {}'s", finding.seen_on + 1),
        finding.p_value,
        finding.p_replay < 1 ? ", and replays of the model without it do not come as far" : "");
  }
  for (const auto& same : e.ambiguous) {
    text += "\nnot told apart:";
    for (const EffectAt& one : same) {
      text += fmt::format(" {} on joint {};", one.name(), one.joint + 1);
    }
    if (may_be_own_numbers(e, same)) text += fmt::format(" {};", kOwnNumbers);
    text.back() = '\n';
  }
  return text;
}

// With the 95 % of each moment that was found.
std::string time_of(const Change& one) {
  if (one.is_between) return "from before to after";
  std::string text = fmt::format("from {:.2f} s", one.at_s);
  if (one.at_ci95_s) {
    text += fmt::format(" ({:.2f} .. {:.2f} s)", (*one.at_ci95_s)[0], (*one.at_ci95_s)[1]);
  }
  if (!one.until_s) return text + fmt::format(" of recording {} on", one.recording + 1);
  return text + fmt::format(" to {:.2f} s ({:.2f} .. {:.2f} s) of recording {}", *one.until_s,
                            one.until_ci95_s[0], one.until_ci95_s[1], one.recording + 1);
}

std::string text_of_changes(const Explanation& e) {
  std::string text;
  for (const Change& one : e.changes) {
    text += fmt::format("\n{}: {} on joint {} changes by\n", time_of(one), one.what.name(),
                        one.what.joint + 1);
    for (const Estimate& by : one.by) text += "   " + words_of(by) + "\n";
    text += fmt::format("   p = {:.2g} over the whole search for changes\n", one.p_value);
    for (const EffectAt& other : one.alike) {
      text += fmt::format("   or it is {} on joint {}: not told apart\n", other.name(),
                          other.joint + 1);
    }
  }
  return text;
}

// The command that writes what was found. What came through a pipe is gone: it is to be kept first.
std::string command_to_add(const ExplainNames& names) {
  bool kept = true;
  const auto word = [&](const std::string& file, const char* instead) {
    if (!is_stream(file)) return " " + shell_word(file);
    kept = false;
    return std::string(" ") + instead;
  };
  std::string command = "offnominal add --all-found --robot" + word(names.robot_file, "ROBOT");
  command += " --log";
  // Of what was made after a change nothing is to be added to a model of what was before it.
  for (std::size_t i = 0; i + names.after.size() < names.logs.size(); ++i) {
    command += word(names.logs[i], "LOG");
  }
  if (!names.holdout.empty()) command += " --holdout";
  for (const std::string& log : names.holdout) command += word(log, "HOLDOUT");
  if (!names.channels.empty()) command += " --channels" + word(names.channels, "CHANNELS");
  for (const RecordingPayload& one : names.payloads) {
    command += " --payload " + shell_word(text_of(one));
  }
  for (const KeepFault& one : names.keep) {
    const std::string joint = one.joint < 0 ? "all" : std::to_string(one.joint + 1);
    command += fmt::format(" --keep {}:{}", joint, name_of(one.kind));
  }
  if (names.link_share) command += " --link-share " + shortest(*names.link_share);
  if (names.keep_effects) command += " --keep-effects";
  return fmt::format("to write a robot file with it{}: {} -o FILE",
                     kept ? "" : ", keep what came through a pipe in a file, and", command);
}

// Of the joint that shows it most: ", 0.014 N m or 0.47 % of the torque,".
std::string how_much_is_left(const Explanation& e) {
  const JointErrors& errors = errors_of(e, e.where.front().joint);
  if (!(errors.rms_torque > 0)) return "";
  return fmt::format(", {} {} or {} % of the torque,", significant(errors.rms_after, 2),
                     errors.unit, significant(100 * errors.rms_after / errors.rms_torque, 2));
}

// How to write it, and what `add` will say to that.
std::string how_to_add(const Explanation& e, const ExplainNames& names) {
  std::string text = command_to_add(names) + "\n";
  const std::vector<std::string> doubts = doubts_of(e);
  for (const std::string& doubt : doubts) text += "doubt: " + doubt + "\n";
  if (!doubts.empty()) text += "so that add writes it only with --force\n";
  return text;
}

}  // namespace

std::string findings_text(const Explanation& e, const ExplainNames& names) {
  std::string text = fmt::format("{}: {}\n", name_of(e.verdict), e.words);
  text += fmt::format("model {}, {} recording{}, held out: {}\n", names.robot_file,
                      names.logs.size(), names.logs.size() == 1 ? "" : "s",
                      e.holdout_is_apart ? "other recordings"
                      : e.at_rest        ? "stretches of readings"
                                         : "blocks of time");
  if (e.filter) text += words_of(*e.filter) + "\n";
  const bool several = names.logs.size() + names.holdout.size() > 1;
  for (const DataFault& fault : e.data_faults) {
    text += "data fault: " + (several ? fault.file + ": " : "") + fault.words + "\n";
  }
  for (const DataFault& fault : e.left_out) text += "left out: " + left_out_line(fault) + "\n";
  for (const Push& push : e.pushes) text += "push: " + words_of(push) + ", left out\n";
  text += text_of_joints(e);
  text += text_of_answers(e);
  text += text_of_findings(e);
  text += text_of_changes(e);
  if (!e.where.empty()) {
    const StructureShare& first = e.where.front();
    text += fmt::format("\nwhat is left{} follows the {} of joint {} by {:.0f} %\n",
                        how_much_is_left(e), first.variable, first.joint + 1, 100 * first.share);
  }
  for (const HoldFriction& one : e.hold_friction) {
    text += fmt::format(
        "joint {} is held by friction, {:.4g} {} by the direction of approach: fitted beside, not "
        "written\n",
        one.joint + 1, one.level, one.unit);
  }
  for (const std::string& advice : e.advice) text += "advice: " + advice + "\n";
  for (const std::string& why : e.unwritable) text += "cannot be written: " + why + "\n";
  return text;
}

std::string text_of(const Explanation& e, const ExplainNames& names) {
  const bool may =
      changes_the_file(e) && e.data_faults.empty() && e.unwritable.empty() && e.unphysical.empty();
  return findings_text(e, names) + (may ? how_to_add(e, names) : "");
}

}  // namespace offnominal::desk
