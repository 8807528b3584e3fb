#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command/answer.hpp"
#include "command/command_line.hpp"
#include "command/doctor.hpp"
#include "command/input_options.hpp"
#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "command/refuse_option.hpp"
#include "command/verbs.hpp"
#include "common/file.hpp"
#include "common/output_file.hpp"
#include "inertial/identify.hpp"
#include "inertial/identify_report.hpp"
#include "log/log_format.hpp"
#include "log/read_log.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::desk {
namespace {

struct IdentifyOptions {
  FitFiles files;
  IdentifyRequest request;
  std::string output;
  FilterRequest filter;
  std::vector<KeepFault> keep;
  AnswerOptions answer;
};

void check(const IdentifyOptions& options) {
  if (options.output.empty() && !options.request.payload) {
    refuse_option("identify", "-o", "nothing", "a robot file to write",
                  "add -o, or ask with --find-payload for what the last link carries");
  }
  if (options.request.payload && options.request.from_geometry) {
    refuse_option("identify", "--from-geometry", "given", "nothing of it with --find-payload",
                  "a payload is told against a file that is trusted");
  }
}

void run(const IdentifyOptions& options, const std::string& command_line, ExitCode& exit_code) {
  check(options);
  const FitFiles& files = options.files;
  IdentifyRequest request = options.request;
  request.source = "Identified from " + file_names(files.logs) + " by offnominal identify.";
  Progress progress;
  // A payload is told against a file that is whole.
  RobotDescription robot =
      read_robot_file(files.robot, request.payload ? Blanks::kRefused : Blanks::kAllowed);
  FitData data = read_fit_data("identify", "LOG", files, std::move(robot), read_log, progress);
  const auto faults =
      treated({data.logs, data.holdout}, data.robot, options.keep, progress, RestsOn::kTorque);
  const Identification result =
      identify(data.robot, request, data.logs, data.holdout, options.filter,
               [&](const std::string& doing) { progress.begin(doing); });
  progress.end();
  const IdentifyNames names{files.logs,     files.holdout, files.robot,
                            options.output, command_line,  options.answer.force};
  write_report(options.answer, [&] { return with_faults(page_of(result, names), faults); });
  std::vector<std::string> written;
  if (!result.may_be_written(options.answer.force)) {
    exit_code = ExitCode::kCheckFailed;
  } else if (!options.output.empty()) {
    const std::string text = robot_text_of(result, names);
    static_cast<void>(parse_robot(text, options.output + " (to be written)"));
    write_file_atomically(options.output, text, options.answer.existing());
    written.push_back(options.output);
  }
  print_answer(
      options.answer, [&] { return with_faults(to_json(result, names), faults); },
      [&] { return text_of(result, names); }, written);
}

constexpr const char* kHowItIdentifies =
    "Fitted are the ten inertial numbers of every link and the standard drive of every joint that "
    "moves: viscous and Coulomb friction, rotor inertia, offset. The recordings decide the base "
    "parameters, the combinations that torques depend on; the rest stays near the robot file, or "
    "near bars between the joints where it says nothing (--from-geometry, or links whose mass_kg "
    "and centre_of_mass_m are blanks). Every link that is written is a body that there can be.\n"
    "The error is judged on data that the fit has not seen: --holdout, or else every fifth of the "
    "recordings predicted by a fit of the others.\n"
    "--find-payload trusts the file and fits what its last link carries beyond it: mass, place, "
    "and "
    "what "
    "these recordings cannot tell apart.\n"
    "Exit code 1, and nothing written, when the recordings determine nothing; so too when the "
    "error "
    "on data that the fit has not seen rises, which --force overrules (docs/identify.md).";

}  // namespace

void set_up_identify(CLI::App& verb, ExitCode& exit_code) {
  const auto options = std::make_shared<IdentifyOptions>();
  verb.add_option("LOG", options->files.logs, "Recordings to fit, " + log_format_names())
      ->required();
  verb.add_option("--robot", options->files.robot,
                  "Robot file to start from; mass and centre of mass of a link may be blanks")
      ->required();
  verb.add_option("-o,--output", options->output, "Robot file to write")->type_name(kNewRobotFile);
  verb.add_option("--holdout", options->files.holdout,
                  "Recordings that no fit may see. Without any, parts are held out");
  verb.add_flag("--find-payload", options->request.payload,
                "Fit the last link alone, and say what it carries beyond the file");
  verb.add_flag("--from-geometry", options->request.from_geometry,
                "Believe nothing of the file's links but where their joints are");
  verb.add_flag("--keep-effects", options->request.keep,
                "Leave the effects of the file as they are");
  add_channels_option(verb, options->files.channels, "recordings'");
  add_keep_option(verb, options->keep);
  add_filter_options(verb, options->filter);
  add_force_option(verb, options->answer,
                   "Replace files that are there, for -o be it the robot file that is read, and "
                   "write it even where the error on data not used for the fit rises");
  add_report_option(verb, options->answer);
  add_json_option(verb, options->answer);
  verb.footer(kHowItIdentifies);
  verb.callback([&verb, options, &exit_code] { run(*options, command_line_of(verb), exit_code); });
}

}  // namespace offnominal::desk
