#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/read_robot.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"
#include "log/read_log.hpp"
#include "motion/design_report.hpp"

namespace offnominal::desk {
namespace {

using motion::Contender;

struct MotionOptions {
  std::string robot;
  std::vector<std::string> separate;
  std::optional<std::string> excite;
  std::vector<std::string> logs;
  ChannelOptions channels;
  std::string output;
  double margin_percent = 10;
  double effect_percent = 5;
  double noise_percent = 1;
  motion::DesignRequest design;
  std::vector<KeepFault> keep;
  AnswerOptions answer;
};

std::vector<Contender> effects_of(const MotionOptions& options, const RobotDescription& robot) {
  std::vector<Contender> effects;
  if (options.excite) {
    if (*options.excite != "all") {
      effects.push_back(motion::contender_of(*options.excite, robot, "--excite"));
    }
    return effects;
  }
  for (const std::string& text : options.separate) {
    const Contender one = motion::contender_of(text, robot, "--separate");
    if (std::find(effects.begin(), effects.end(), one) != effects.end()) {
      refuse_option("motion", "--separate", motion::text_of(one) + " twice", "different effects",
                    "name the two that explain could not tell apart");
    }
    effects.push_back(one);
  }
  if (effects.size() == 1) {
    refuse_option("motion", "--separate", motion::text_of(effects[0]) + " alone",
                  "two effects or more",
                  "write A,B; for one effect: --excite " + motion::text_of(effects[0]));
  }
  return effects;
}

void run(const MotionOptions& options, const std::string& command_line, ExitCode& exit_code) {
  using namespace motion;
  const RobotDescription robot = read_robot(options.robot);
  DesignRequest request = options.design;
  request.effects = effects_of(options, robot);
  request.margin = options.margin_percent / 100;
  request.expectation.effect_share = options.effect_percent / 100;
  request.expectation.noise_share = options.noise_percent / 100;
  Progress progress;
  check_payloads("motion", options.channels, options.logs);
  request.recordings = read_recordings(options.logs, robot, options.channels, read_log, progress);
  const auto faults = treated({request.recordings}, robot, options.keep, progress);
  const Design design = design_motion(
      robot, request,
      {[&](const std::string& doing) { progress.begin(doing); }, [&] { progress.step(); }});
  progress.end();
  const DesignNames names{options.robot, options.logs, options.output, command_line};
  write_report(options.answer, [&] { return with_faults(page_of(robot, design, names), faults); });
  std::vector<std::string> written;
  if (design.worst() != nullptr) {
    write_file_atomically(options.output, csv_of(design.fitted.motion), options.answer.existing());
    written.push_back(options.output);
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  print_answer(
      options.answer, [&] { return with_faults(to_json(robot, design, names), faults); },
      [&] { return text_of(robot, design, names); }, written);
}

constexpr const char* kHowItChooses =
    "Every joint starts and ends at rest, oscillates from slow to fast, then visits poses at "
    "constant speeds, and stays within the robot file's limits of position, velocity and torque "
    "(as the model predicts it) less --margin. Random motions are tried and the best are improved: "
    "best is the one on which the worst pair of effects, at the worst shapes, differs most against "
    "the noise, once everything that explain lets every model adapt has been taken away.\n"
    "Exit code 1, and nothing written, when no motion can tell the effects apart.\n"
    "The motion knows nothing of obstacles or of a cable: look at it, and play it slowly first.";

}  // namespace

void set_up_motion(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<MotionOptions>();
  verb.add_option("--robot", options->robot, "Robot file, with limits")->required();
  CLI::Option* separate =
      verb.add_option("--separate", options->separate,
                      "A,B[,...]: effects to tell apart, each EFFECT@JOINT with joints from 1, as "
                      "explain names them")
          ->delimiter(',');
  verb.add_option("--excite", options->excite,
                  "EFFECT@JOINT to excite, or all (the default): every effect that the robot may "
                  "have")
      ->excludes(separate);
  verb.add_option("-o,--output", options->output, "Motion to write, CSV")
      ->type_name(kNewFile)
      ->required();
  add_force_option(verb, options->answer);
  verb.add_option("--log", options->logs,
                  "Recordings that could not tell, to say how much better the motion is");
  add_channels_option(verb, options->channels, "recordings'");
  add_keep_option(verb, options->keep);
  verb.add_option("--duration", options->design.duration_s, "Length of the motion, s")
      ->check(CLI::Range(8.0, 600.0))
      ->capture_default_str();
  verb.add_option("--rate", options->design.rate_hz, "Rows per second, Hz")
      ->check(CLI::Range(50.0, 10000.0))
      ->capture_default_str();
  verb.add_option("--margin", options->margin_percent,
                  "How much of every limit stays unused, percent")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  verb.add_option("--effect-size", options->effect_percent,
                  "Expected rms torque of an effect, percent of the joint's rms torque")
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  verb.add_option("--noise", options->noise_percent,
                  "Expected rms torque error behind the low-pass, percent of the joint's rms "
                  "torque")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  verb.add_option("--tries", options->design.starts,
                  "Random motions to start from; by default as many as suit the robot")
      ->check(CLI::Range(1, 100000));
  verb.add_option("--seed", options->design.seed, "Seed of the random motions")
      ->capture_default_str();
  add_threads_option(verb, options->design.threads);
  add_report_option(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(kHowItChooses);
  verb.callback([&verb, options, &exit_code] { run(*options, command_line_of(verb), exit_code); });
}

}  // namespace offnominal::desk
