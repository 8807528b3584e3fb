#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/read_robot.hpp"
#include "command/recordings.hpp"
#include "command/verbs.hpp"
#include "common/amount.hpp"
#include "common/error.hpp"
#include "common/text_table.hpp"
#include "common/time_words.hpp"
#include "log/log_format.hpp"
#include "log/observed_motion.hpp"
#include "log/read_log.hpp"
#include "replay/monitor_filter.hpp"
#include "replay/replay.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

constexpr std::size_t kPrinted = 10;  // alarms, blind stretches

struct ReplayOptions {
  std::string log;
  std::string robot;
  ChannelOptions channels;
  bool observe_velocity = false;
  bool check = false;
  AnswerOptions answer;
};

// The first of them, a row each, the name beside the first.
template <typename One, typename Words, typename Row>
void list(const std::vector<One>& all, const std::string& name, const Words& words,
          const Row& row) {
  for (std::size_t i = 0; i < all.size() && i < kPrinted; ++i) {
    row(i == 0 ? name : "", words(all[i]));
  }
  if (all.size() > kPrinted) row("", fmt::format("and {} more (--json)", all.size() - kPrinted));
}

std::string text_of(const Replay& replay, const MonitorFilter& filter) {
  const TextTable table({{"", -28}, {"", 0}}, "  ");
  std::string text = fmt::format("{} on {}: {} samples, tick {:g} ms, {} hidden units, seed {}\n",
                                 replay.robot, replay.log, replay.samples(), 1000 * replay.period_s,
                                 replay.hidden_units, replay.seed) +
                     words_of(filter) + "\n";
  const auto row = [&](const std::string& name, const std::string& value) {
    text += table.row(name, value);
  };
  for (std::size_t i = 0; i < replay.joints.size(); ++i) {
    const JointReplay& joint = replay.joints[i];
    const std::string first = joint.detection_time_s
                                  ? fmt::format(", first alarm at {:.3f} s, {} in all",
                                                *joint.detection_time_s, joint.alarms.size())
                                  : "";
    row(fmt::format("joint {}, {}", i + 1, replay.joint_names[i]),
        fmt::format("residual up to {:.4g}, threshold up to {:.4g} {}, ratio up to {:.3g}{}",
                    joint.max_residual, joint.max_threshold, joint.unit, joint.max_ratio_slow,
                    first));
    if (replay.fast_error.size() > 0) {
      row("",
          fmt::format("behind the fast filter up to {:.4g}, threshold up to {:.4g} {}, ratio up to "
                      "{:.3g}",
                      joint.fast_max_residual, joint.fast_max_threshold, joint.unit,
                      joint.max_ratio_fast));
    }
  }
  // Joint by joint they are of whichever was nearest, and of mixed units.
  if (replay.joints.empty()) {
    row("largest |e|", fmt::format("{:.4g} {}", replay.error_norm.maxCoeff(), replay.unit));
    row("largest threshold mu", fmt::format("{:.4g} {}", replay.threshold.maxCoeff(), replay.unit));
  }
  row(ratio_name(replay), fmt::format("{:.4g}", replay.max_error_to_threshold));
  for (Eigen::Index joint = 0; joint < replay.psi_hat.cols(); ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    row("largest |psi_hat|, " + replay.joint_names[index],
        fmt::format("{:.4g} {}", replay.psi_hat.col(joint).cwiseAbs().maxCoeff(),
                    replay.psi_hat_units[index]));
  }
  list(
      replay.alarms, "alarms",
      [&](const Alarm& alarm) {
        const std::string joints = joints_of(replay, alarm);
        return fmt::format("{:.3f} to {:.3f} s, {} of {:.3g}{}", alarm.start_s, alarm.end_s,
                           ratio_name(replay), alarm.max_error_to_threshold,
                           joints.empty() ? "" : ", " + joints);
      },
      row);
  list(
      replay.blind, "blind",
      [](const BlindStretch& one) {
        return fmt::format("{:.3f} to {:.3f} s, {} refused", one.start_s, one.end_s,
                           counted(static_cast<std::size_t>(one.samples), "sample"));
      },
      row);
  if (replay.blind.size() > 1) row("blind in all", fmt::format("{:.3f} s", replay.blind_s()));
  return text + words_of(replay) + "\n";
}

// The monitor on the controller has no gaps either.
void require_whole(const Log& log) {
  if (log.gaps.empty() && log.cut.empty()) return;
  const bool at_front = !log.cut.empty() && log.cut.front().first == 0;
  const double at_s = !log.gaps.empty() ? log.t_s[log.gaps[0].first]
                      : at_front        ? log.t_s[0]
                                        : log.t_s[log.t_s.size() - 1];
  throw InputError({log.file, fmt::format("t = {} s", words_of_time(at_s)), "a gap",
                    "a recording of every tick, as the monitor sees it",
                    "cut the recording at the gap"});
}

void run(const ReplayOptions& options, const std::string& command_line, ExitCode& exit_code) {
  const RobotDescription robot = read_robot(options.robot);
  require_bound(robot, options.robot);
  check_payloads("replay", options.channels, {options.log});
  Log log = read_log(options.log, robot, options.channels);
  require_whole(log);
  Progress progress;
  const auto faults = examined({std::span(&log, 1)}, robot, progress);
  if (options.observe_velocity) log = as_observed(log);
  progress.begin("the monitor over " + log.file);
  const Replay result = replay(robot, log, [&](double share) { progress.reach(share); });
  progress.end();
  write_report(options.answer, [&] { return with_faults(page_of(result, command_line), faults); });
  std::string notes;
  for (const std::string& remark : log.remarks) notes += "note: " + remark + "\n";
  const MonitorFilter filter = monitor_filter(robot, log);
  const auto json = [&] {
    auto told = to_json(result);
    told["filter"] = to_json(filter);
    return with_faults(std::move(told), faults);
  };
  print_answer(options.answer, json, [&] { return notes + text_of(result, filter); });
  if (options.check && (result.detection_time_s || result.is_blind()))
    exit_code = ExitCode::kCheckFailed;
}

}  // namespace

void set_up_replay(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<ReplayOptions>();
  verb.add_option("LOG", options->log, "Recording, " + log_format_names())->required();
  verb.add_option("--robot", options->robot, "Robot file; its uncertainty bound sets the threshold")
      ->required();
  add_observe_option(verb, options->observe_velocity);
  add_channels_option(verb, options->channels, "recording's");
  add_page_options(verb, options->answer, "figures");
  verb.add_flag(
      "--check", options->check,
      "Exit with 1 when there is an alarm, or samples were refused that one could hide in");
  add_json_option(verb, options->answer);
  verb.footer(
      "The tick is the recording's sampling period. The recording's torque has to be the torque "
      "that was really applied, not the commanded one. Samples that the monitor refuses are not "
      "judged: more than two in a row, or one in a hundred, and the verdict is \"Blind\". Behind "
      "one or two in a row the monitor goes on, behind more it begins afresh.");
  verb.callback([&verb, options, &exit_code] { run(*options, command_line_of(verb), exit_code); });
}

}  // namespace offnominal::desk
