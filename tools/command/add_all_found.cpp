#include "command/add_all_found.hpp"

#include <iostream>

#include "command/progress.hpp"
#include "command/recordings.hpp"
#include "common/json_text.hpp"
#include "discovery/add_found.hpp"
#include "report/page.hpp"
#include "robot/robot_file.hpp"

namespace offnominal::tools {

void add_all_found(const AddAllFound& options, const std::string& command_line,
                   ExitCode& exit_code) {
  Progress progress;
  const RobotDescription robot = read_robot_file(options.robot);
  const std::vector<Log> logs =
      read_recordings_or_hold_maps(options.logs, robot, options.channels, progress);
  const std::vector<Log> holdout =
      read_recordings_or_hold_maps(options.holdout, robot, options.channels, progress);
  check_recordings_differ("add", "--log", logs, holdout);
  discovery::ExplainOptions explain;
  explain.threads = options.threads;
  explain.link_share = options.link_share.value_or(explain.link_share);
  explain.robot_file = options.robot;
  explain.source = "Fitted to " + file_names(options.logs) + " by offnominal add --all-found.";
  const discovery::AddedFindings added = discovery::add_found(
      robot, logs, holdout, explain, [&](const std::string& doing) { progress.begin(doing); });
  progress.end();
  const discovery::ExplainNames names{options.logs, options.holdout, options.robot, command_line,
                                      options.channels ? options.channels->string() : ""};
  if (options.report) {
    report::write_page(*options.report, page_of(added.explanation, names),
                       existing_if(options.force));
  }
  const bool write = added.may_be_written(options.force);
  if (write) {
    write_robot_file(added.explanation.improved, options.output, existing_if(options.force));
  } else {
    exit_code = ExitCode::kCheckFailed;
  }
  if (options.json) {
    std::cout << json_text(to_json(added, names, options.output, options.force));
    return;
  }
  std::cout << text_of(added, names, options.force);
  if (write) std::cout << "written: " << options.output << '\n';
  if (options.report) std::cout << "written: " << *options.report << '\n';
}

}  // namespace offnominal::tools
